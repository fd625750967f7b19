//! Coefficients of the two isotropic material laws `tau -> lambda tr(tau) I + two_mu tau`.

use super::element::IsotropicForm;
use crate::scene::{Convention, Elasticity, Viscosity};

/// Viscosity A: lambda = mu1, two_mu = mu2, Pa s.
pub(super) fn viscosity(law: &Viscosity) -> IsotropicForm {
    let Viscosity::Isotropic { mu1, mu2 } = *law;
    IsotropicForm {
        lambda: mu1,
        two_mu: mu2,
    }
}

/// Elasticity B: two_mu = E/(1 + kappa), lambda by the convention, Pa.
pub(super) fn elasticity(law: &Elasticity) -> IsotropicForm {
    let Elasticity::Isotropic {
        young: e,
        poisson: k,
        convention,
    } = *law;
    let lambda = match convention {
        Convention::Kazmi2014 => e * k / ((1.0 - k) * (1.0 - 2.0 * k)),
        Convention::PlaneStrain | Convention::ThreeDimensional => {
            e * k / ((1.0 + k) * (1.0 - 2.0 * k))
        }
        Convention::PlaneStress => e * k / (1.0 - k * k),
    };
    IsotropicForm {
        lambda,
        two_mu: e / (1.0 + k),
    }
}

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
        let a = viscosity(&Viscosity::Isotropic {
            mu1: 0.05,
            mu2: 0.1,
        });
        let b = elasticity(&Elasticity::Isotropic {
            young: 1.0,
            poisson: 0.3,
            convention: Convention::Kazmi2014,
        });
        let [low, high] = rates(a, b, 2);
        assert!((low - 10.0 / 1.3).abs() < 1e-13);
        assert!((high - (0.6 / 0.28 + 1.0 / 1.3) / 0.2).abs() < 1e-13);
    }
}
