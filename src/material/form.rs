//! The linear form of a material: `sigma = D eps`, isotropic or with a matrix of its own.
//!
//! A matrix has the components of Voigt, (xx, yy, zz, yz, xz, xy), with engineering shear `2 eps_ij`. In two dimensions those of z
//! vanish, as they do for the gradients. Eigenvalues are those in the Frobenius metric, in which a shear counts twice: of the
//! matrix with the rows and columns of the shears times sqrt 2.

use super::voigt::{self, Voigt};
use nalgebra::{Matrix3, Vector3, Vector6};

/// A linear map from strains to stresses (Pa, or Pa s), symmetric.
// a box would be an allocation wherever forms differ from point to point
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// `lambda tr(eps) I + two_mu eps`.
    Isotropic {
        /// Coefficient of the trace.
        lambda: f64,
        /// Coefficient of the strain.
        two_mu: f64,
    },
    /// A matrix on (xx, yy, zz, yz, xz, xy) with engineering shear.
    Matrix(Voigt),
}

impl Form {
    /// `eps(u) : eps(v)`, whose integral is the square of the strain norm.
    pub const STRAIN: Form = Form::Isotropic {
        lambda: 0.0,
        two_mu: 1.0,
    };

    /// Nothing.
    pub const ZERO: Form = Form::Isotropic {
        lambda: 0.0,
        two_mu: 0.0,
    };

    /// Adds the 3 x 3 block of two shape functions with these gradients, times `weight`, to `sum`: rows are the components of the
    /// first, in global axes.
    pub fn add_block(&self, sum: &mut Matrix3<f64>, pair: &GradientPair, weight: f64) {
        match self {
            // eps(u) : eps(v) = 1/2 (grad u : grad v + grad u : grad v^T)
            Form::Isotropic { lambda, two_mu } => {
                *sum += pair.outer * (weight * lambda) + pair.crossed * (weight * two_mu / 2.0);
            }
            Form::Matrix(d) => {
                let [row, column] = [&pair.row, &pair.column].map(voigt::strains);
                *sum += row.tr_mul(&(d * column)) * weight;
            }
        }
    }

    /// The stress of a symmetric strain.
    pub fn stress(&self, strain: &Matrix3<f64>) -> Matrix3<f64> {
        match self {
            Form::Isotropic { lambda, two_mu } => {
                Matrix3::from_diagonal_element(lambda * strain.trace()) + strain * *two_mu
            }
            Form::Matrix(d) => voigt::tensor(&(d * voigt::engineering(strain))),
        }
    }

    /// The stress components of strain components, both in the order (xx, yy, zz, yz, xz, xy), engineering shear.
    pub fn stresses(&self, strain: [f64; 6]) -> [f64; 6] {
        match self {
            Form::Isotropic { lambda, two_mu } => {
                let trace = lambda * (strain[0] + strain[1] + strain[2]);
                std::array::from_fn(|i| match i < 3 {
                    true => trace + two_mu * strain[i],
                    false => two_mu * (0.5 * strain[i]),
                })
            }
            Form::Matrix(d) => (d * Vector6::from(strain)).into(),
        }
    }

    /// The form times a factor.
    pub fn times(&self, factor: f64) -> Form {
        match self {
            Form::Isotropic { lambda, two_mu } => Form::Isotropic {
                lambda: factor * lambda,
                two_mu: factor * two_mu,
            },
            Form::Matrix(d) => Form::Matrix(d * factor),
        }
    }

    /// The sum of two forms.
    pub fn plus(&self, other: &Form) -> Form {
        match (self, other) {
            (
                Form::Isotropic { lambda, two_mu },
                Form::Isotropic {
                    lambda: lambda_other,
                    two_mu: two_mu_other,
                },
            ) => Form::Isotropic {
                lambda: lambda + lambda_other,
                two_mu: two_mu + two_mu_other,
            },
            _ => Form::Matrix(self.voigt() + other.voigt()),
        }
    }

    /// The form as a matrix.
    pub fn voigt(&self) -> Voigt {
        match self {
            Form::Isotropic { lambda, two_mu } => voigt::isotropic(*lambda, *two_mu),
            Form::Matrix(d) => *d,
        }
    }

    /// Smallest and largest eigenvalue over all strains of a dimension: ellipticity and Lipschitz constant of the operator. Not
    /// numbers for a matrix that is not finite.
    pub fn extremes(&self, dimension: usize) -> [f64; 2] {
        match self {
            Form::Isotropic { lambda, two_mu } => {
                let volumetric = dimension as f64 * lambda + two_mu;
                [two_mu.min(volumetric), two_mu.max(volumetric)]
            }
            Form::Matrix(d) => voigt::extremes(d, dimension),
        }
    }

    /// Smallest and largest eigenvalue of `A^-1 B` over all strains, 1/s, for viscosity `a` and elasticity `b`. Not numbers where
    /// a matrix `a` is not positive.
    ///
    /// The generalised eigenvalues of the assembled matrices lie between the two, on every mesh. In an isotropic material deviatoric
    /// strains relax at `two_mu_B / two_mu_A`, the spherical one at the ratio of `d lambda + two_mu`.
    pub fn rates(a: &Form, b: &Form, dimension: usize) -> [f64; 2] {
        let (
            Form::Isotropic {
                lambda: of_a,
                two_mu: a_two_mu,
            },
            Form::Isotropic {
                lambda: of_b,
                two_mu: b_two_mu,
            },
        ) = (a, b)
        else {
            return voigt::rates(&a.voigt(), &b.voigt(), dimension);
        };
        let deviatoric = b_two_mu / a_two_mu;
        let d = dimension as f64;
        let spherical = (d * of_b + b_two_mu) / (d * of_a + a_two_mu);
        [deviatoric.min(spherical), deviatoric.max(spherical)]
    }
}

impl std::ops::Add for Form {
    type Output = Form;

    fn add(self, other: Form) -> Form {
        match (self, other) {
            (
                Form::Isotropic { lambda, two_mu },
                Form::Isotropic {
                    lambda: other_lambda,
                    two_mu: other_two_mu,
                },
            ) => Form::Isotropic {
                lambda: lambda + other_lambda,
                two_mu: two_mu + other_two_mu,
            },
            (a, b) => Form::Matrix(a.voigt() + b.voigt()),
        }
    }
}

/// Two gradients and the products of them that isotropic forms are made of.
pub struct GradientPair {
    row: Vector3<f64>,
    column: Vector3<f64>,
    outer: Matrix3<f64>,
    crossed: Matrix3<f64>,
}

impl GradientPair {
    /// Of the gradients of the row and of the column.
    pub fn new(row: &Vector3<f64>, column: &Vector3<f64>) -> GradientPair {
        let outer = row * column.transpose();
        GradientPair {
            row: *row,
            column: *column,
            outer,
            crossed: outer.transpose() + Matrix3::from_diagonal_element(row.dot(column)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ISOTROPIC: Form = Form::Isotropic {
        lambda: 1.7,
        two_mu: 0.9,
    };

    /// Symmetric and positive, without any symmetry of a material.
    fn anisotropic() -> Form {
        let any = Voigt::from_fn(|i, j| ((3 * i + 5 * j) as f64).sin());
        Form::Matrix(any * any.transpose() + Voigt::identity())
    }

    #[test]
    fn rates_of_the_example_of_the_paper() {
        let viscosity = Form::Isotropic {
            lambda: 0.05,
            two_mu: 0.1,
        };
        let elasticity = Form::Isotropic {
            lambda: 0.3 / 0.28,
            two_mu: 1.0 / 1.3,
        };
        let [low, high] = Form::rates(&viscosity, &elasticity, 2);
        assert!((low - 10.0 / 1.3).abs() < 1e-13);
        assert!((high - (0.6 / 0.28 + 1.0 / 1.3) / 0.2).abs() < 1e-13);
    }

    /// The matrix of an isotropic form has its constants, in both dimensions.
    #[test]
    fn an_isotropic_matrix_has_the_constants_of_the_form() {
        let viscosity = Form::Isotropic {
            lambda: 0.05,
            two_mu: 0.1,
        };
        let [a, b] = [viscosity, ISOTROPIC].map(|form| Form::Matrix(form.voigt()));
        for dimension in [2, 3] {
            for (found, expected) in [
                (b.extremes(dimension), ISOTROPIC.extremes(dimension)),
                (
                    Form::rates(&a, &b, dimension),
                    Form::rates(&viscosity, &ISOTROPIC, dimension),
                ),
            ] {
                for (found, expected) in found.iter().zip(expected) {
                    assert!((found / expected - 1.0).abs() < 1e-13, "{dimension}");
                }
            }
        }
    }

    /// Rates are the extremes of `eps.B eps / eps.A eps` over strains.
    #[test]
    fn rates_bound_the_quotients_of_energies() {
        let (a, b) = (ISOTROPIC, anisotropic());
        let [low, high] = Form::rates(&a, &b, 3);
        for n in 0..20_000 {
            let of = |k: usize| ((n * (2 * k + 3) + k) as f64 * 0.618).sin();
            let strain = Matrix3::from_fn(|i, j| of(i.min(j) + 3 * i.max(j)));
            let energy = |form: &Form| form.stress(&strain).dot(&strain);
            let quotient = energy(&b) / energy(&a);
            assert!(quotient > low * (1.0 - 1e-12) && quotient < high * (1.0 + 1e-12));
        }
        // both are eigenvalues
        for rate in [low, high] {
            let pencil = b.voigt() - a.voigt() * rate;
            let values = pencil.symmetric_eigenvalues().abs();
            assert!(values.min() < 1e-12 * values.max(), "{rate}");
        }
        assert!(Form::rates(&Form::Matrix(Voigt::zeros()), &b, 3)[0].is_nan());
    }

    /// The block of two gradients is the energy of the two strains.
    #[test]
    fn a_block_is_the_energy_of_two_strains() {
        let (g, h) = (Vector3::new(0.3, -0.7, 1.1), Vector3::new(-0.4, 0.2, 0.9));
        let (u, v) = (Vector3::new(1.0, 0.5, -0.3), Vector3::new(0.7, -1.2, 0.4));
        let strain =
            |u: Vector3<f64>, g: Vector3<f64>| (u * g.transpose() + g * u.transpose()) / 2.0;
        for form in [ISOTROPIC, Form::Matrix(ISOTROPIC.voigt()), anisotropic()] {
            let mut block = Matrix3::zeros();
            form.add_block(&mut block, &GradientPair::new(&g, &h), 2.0);
            let energy = 2.0 * form.stress(&strain(u, g)).dot(&strain(v, h));
            assert!((u.dot(&(block * v)) - energy).abs() < 1e-13 * energy.abs().max(1.0));
        }
    }
}
