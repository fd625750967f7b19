//! Relaxation rates of the two isotropic material laws `tau -> lambda tr(tau) I + two_mu tau`.

use super::element::IsotropicForm;

/// Smallest and largest eigenvalue of `A^-1 B` over all strains, 1/s.
///
/// Deviatoric strains relax at `two_mu_B / two_mu_A`, the spherical one at the ratio of `d lambda + two_mu`. The
/// generalised eigenvalues of the assembled matrices lie between the two, on every mesh.
pub(super) fn rates(a: IsotropicForm, b: IsotropicForm, dimension: usize) -> [f64; 2] {
    let deviatoric = b.two_mu / a.two_mu;
    let d = dimension as f64;
    let spherical = (d * b.lambda + b.two_mu) / (d * a.lambda + a.two_mu);
    [deviatoric.min(spherical), deviatoric.max(spherical)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_of_the_example_of_the_paper() {
        let viscosity = IsotropicForm {
            lambda: 0.05,
            two_mu: 0.1,
        };
        let elasticity = IsotropicForm {
            lambda: 0.3 / 0.28,
            two_mu: 1.0 / 1.3,
        };
        let [low, high] = rates(viscosity, elasticity, 2);
        assert!((low - 10.0 / 1.3).abs() < 1e-13);
        assert!((high - (0.6 / 0.28 + 1.0 / 1.3) / 0.2).abs() < 1e-13);
    }
}
