//! The operator A: strongly monotone and Lipschitz (2.3), linear or not.
//!
//! ```text
//! (A u - A v, u - v) >= m |u - v|^2,     |A u - A v| <= L |u - v|                                (2.3)
//! ```

use super::Matrix;
use nalgebra::DVector;

/// A, as a covector of u.
pub trait Operator {
    /// `A u`.
    fn apply(&self, u: &DVector<f64>) -> DVector<f64>;

    /// The matrix of a linear operator. It is then solved by a factorization; without one by a
    /// contraction, which needs [`Operator::constants`].
    fn matrix(&self) -> Option<&Matrix> {
        None
    }

    /// `[m, L]` of (2.3), where they are known; those of a matrix are computed.
    fn constants(&self) -> Option<[f64; 2]> {
        None
    }
}

impl Operator for Matrix {
    fn apply(&self, u: &DVector<f64>) -> DVector<f64> {
        Matrix::apply(self, u)
    }

    fn matrix(&self) -> Option<&Matrix> {
        Some(self)
    }
}

/// A given by a function, with `[m, L]`.
pub struct NonlinearOperator<F> {
    of: F,
    constants: [f64; 2],
}

impl<F: Fn(&DVector<f64>) -> DVector<f64>> NonlinearOperator<F> {
    /// `[m, L]` are those of the space in which the inequality is posed.
    pub fn new(constants: [f64; 2], of: F) -> NonlinearOperator<F> {
        NonlinearOperator { of, constants }
    }
}

impl<F: Fn(&DVector<f64>) -> DVector<f64>> Operator for NonlinearOperator<F> {
    fn apply(&self, u: &DVector<f64>) -> DVector<f64> {
        (self.of)(u)
    }

    fn constants(&self) -> Option<[f64; 2]> {
        Some(self.constants)
    }
}
