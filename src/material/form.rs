//! The linear form of a material: `lambda tr(eps u) tr(eps v) + two_mu eps(u) : eps(v)`.

use nalgebra::{Matrix3, Vector3};

/// Coefficients of `lambda tr(eps u) tr(eps v) + two_mu eps(u) : eps(v)` (Pa, or Pa s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Form {
    /// Coefficient of the traces.
    pub lambda: f64,
    /// Coefficient of the strains.
    pub two_mu: f64,
}

impl Form {
    /// `eps(u) : eps(v)`, whose integral is the square of the strain norm.
    pub const STRAIN: Form = Form {
        lambda: 0.0,
        two_mu: 1.0,
    };

    /// Adds the 3 x 3 block of two shape functions with these gradients, times `weight`, to `sum`: rows are the components of the
    /// first, in global axes.
    pub fn add_block(self, sum: &mut Matrix3<f64>, pair: &GradientPair, weight: f64) {
        // eps(u) : eps(v) = 1/2 (grad u : grad v + grad u : grad v^T)
        *sum += pair.outer * (weight * self.lambda) + pair.crossed * (weight * self.two_mu / 2.0);
    }

    /// The stress of a symmetric strain.
    pub fn stress(self, strain: &Matrix3<f64>) -> Matrix3<f64> {
        Matrix3::from_diagonal_element(self.lambda * strain.trace()) + strain * self.two_mu
    }

    /// Smallest and largest eigenvalue over all strains of a dimension: ellipticity and Lipschitz constant of the operator.
    pub fn extremes(self, dimension: usize) -> [f64; 2] {
        let volumetric = dimension as f64 * self.lambda + self.two_mu;
        [self.two_mu.min(volumetric), self.two_mu.max(volumetric)]
    }

    /// Smallest and largest eigenvalue of `A^-1 B` over all strains, 1/s, for viscosity `a` and elasticity `b`.
    ///
    /// Deviatoric strains relax at `two_mu_B / two_mu_A`, the spherical one at the ratio of `d lambda + two_mu`. The
    /// generalised eigenvalues of the assembled matrices lie between the two, on every mesh.
    pub fn rates(a: Form, b: Form, dimension: usize) -> [f64; 2] {
        let deviatoric = b.two_mu / a.two_mu;
        let d = dimension as f64;
        let spherical = (d * b.lambda + b.two_mu) / (d * a.lambda + a.two_mu);
        [deviatoric.min(spherical), deviatoric.max(spherical)]
    }
}

/// The products of two gradients that every form is made of.
pub struct GradientPair {
    outer: Matrix3<f64>,
    crossed: Matrix3<f64>,
}

impl GradientPair {
    /// Of the gradients of the row and of the column.
    pub fn new(row: &Vector3<f64>, column: &Vector3<f64>) -> GradientPair {
        let outer = row * column.transpose();
        GradientPair {
            outer,
            crossed: outer.transpose() + Matrix3::from_diagonal_element(row.dot(column)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_of_the_example_of_the_paper() {
        let viscosity = Form {
            lambda: 0.05,
            two_mu: 0.1,
        };
        let elasticity = Form {
            lambda: 0.3 / 0.28,
            two_mu: 1.0 / 1.3,
        };
        let [low, high] = Form::rates(viscosity, elasticity, 2);
        assert!((low - 10.0 / 1.3).abs() < 1e-13);
        assert!((high - (0.6 / 0.28 + 1.0 / 1.3) / 0.2).abs() < 1e-13);
    }

    /// The block of two gradients is the energy of the two strains.
    #[test]
    fn a_block_is_the_energy_of_two_strains() {
        let form = Form {
            lambda: 1.7,
            two_mu: 0.9,
        };
        let (g, h) = (Vector3::new(0.3, -0.7, 1.1), Vector3::new(-0.4, 0.2, 0.9));
        let (u, v) = (Vector3::new(1.0, 0.5, -0.3), Vector3::new(0.7, -1.2, 0.4));
        let strain =
            |u: Vector3<f64>, g: Vector3<f64>| (u * g.transpose() + g * u.transpose()) / 2.0;
        let mut block = Matrix3::zeros();
        form.add_block(&mut block, &GradientPair::new(&g, &h), 2.0);
        let energy = 2.0 * form.stress(&strain(u, g)).dot(&strain(v, h));
        assert!((u.dot(&(block * v)) - energy).abs() < 1e-14);
    }
}
