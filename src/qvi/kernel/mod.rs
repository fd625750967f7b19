//! Kernels q(t, s) of history operators, and the sums over the past that a quadrature makes of them.
//!
//! | kernel | numbers kept | work for N points |
//! |---|---|---|
//! | exponential sum `sum_l w_l exp(-(t-s)/tau_l)` | one vector per term | O(N) |
//! | separable `sum_l phi_l(t) psi_l(s) M_l` | one vector per term | O(N) |
//! | convolution `q(t - s)` | the history | O(N log^2 N) |
//! | any q(t, s), a number or a matrix | the history | O(N^2), in blocks |
//!
//! `q(t, t)` times the last weight is what makes a step implicit ([`Own`]).

mod convolution;
mod exponentials;
mod fourier;
mod history;
mod separable;
mod sums;

pub use exponentials::{ExponentialTerm, fractional_kernel};
pub use separable::SeparableTerm;

use super::{Quadrature, SolveError, Space};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// A function of two instants, `t` and `s <= t`, s.
pub type Scalar = Arc<dyn Fn(f64, f64) -> f64>;
/// A matrix by two instants.
pub type MatrixOfTimes = Arc<dyn Fn(f64, f64) -> DMatrix<f64>>;

/// q of a history operator, on vectors of its integrand.
#[derive(Clone)]
pub enum Kernel {
    /// `sum_l w_l exp(-(t-s)/tau_l)`; `tau = inf` is a constant.
    Exponentials(Vec<ExponentialTerm>),
    /// `sum_l phi_l(t) psi_l(s) M_l`.
    Separable(Vec<SeparableTerm>),
    /// A number that depends on `t - s`.
    Convolution(Arc<dyn Fn(f64) -> f64>),
    /// Any number.
    Scalar(Scalar),
    /// Any square matrix.
    Matrix(MatrixOfTimes),
}

impl Kernel {
    /// q = value: with 1 and the velocity as integrand, the displacement.
    pub fn constant(value: f64) -> Kernel {
        Kernel::Exponentials(vec![ExponentialTerm {
            weight: value,
            tau: f64::INFINITY,
        }])
    }

    /// `exp(-(t-s)/tau)`.
    pub fn exponential(tau: f64) -> Kernel {
        Kernel::Exponentials(vec![ExponentialTerm { weight: 1.0, tau }])
    }

    /// Value at two instants, on vectors of this length.
    pub fn value(&self, dimension: usize, t: f64, s: f64) -> Own {
        match self {
            Kernel::Exponentials(terms) => {
                Own::Number(terms.iter().map(|term| term.value(t - s)).sum())
            }
            Kernel::Separable(terms) => separable::value(terms, dimension, t, s),
            Kernel::Convolution(q) => Own::Number(q(t - s)),
            Kernel::Scalar(q) => Own::Number(q(t, s)),
            Kernel::Matrix(q) => Own::Matrix(q(t, s)),
        }
    }

    /// The sums over the past of this kernel with a quadrature of step k, on vectors of this length.
    ///
    /// # Errors
    /// [`SolveError::Rule`] where the kernel cannot take the quadrature, [`SolveError::Value`] for terms out of range.
    pub(super) fn past(
        &self,
        dimension: usize,
        rule: &Quadrature,
        k: f64,
    ) -> Result<Box<dyn Past>, SolveError> {
        if !rule.is_nodal() && !matches!(self, Kernel::Exponentials(_)) {
            return Err(SolveError::Rule {
                rule: rule.name(),
                why: "it integrates exponential sums only",
            });
        }
        Ok(match self {
            Kernel::Exponentials(terms) => {
                Box::new(exponentials::sums(terms, dimension, rule.clone(), k)?)
            }
            Kernel::Separable(terms) => {
                Box::new(separable::sums(terms, dimension, rule.clone(), k)?)
            }
            Kernel::Convolution(q) if rule.settled(k, 0).is_some() => Box::new(
                convolution::Convolution::new(Arc::clone(q), dimension, rule.clone(), k),
            ),
            _ => Box::new(history::History::new(
                self.clone(),
                dimension,
                rule.clone(),
                k,
            )),
        })
    }
}

/// A factor on vectors: a number or a matrix.
#[derive(Debug, Clone, PartialEq)]
pub enum Own {
    Number(f64),
    Matrix(DMatrix<f64>),
}

impl Own {
    /// The product with a vector, added to another.
    pub fn add_to(&self, factor: f64, x: &[f64], to: &mut [f64]) {
        match self {
            Own::Number(number) => {
                for (to, x) in to.iter_mut().zip(x) {
                    *to += factor * number * x;
                }
            }
            Own::Matrix(matrix) => {
                for (x, column) in x.iter().zip(matrix.column_iter()) {
                    for (to, value) in to.iter_mut().zip(column.iter()) {
                        *to += factor * value * x;
                    }
                }
            }
        }
    }

    /// This factor times a number.
    pub fn scaled(self, factor: f64) -> Own {
        match self {
            Own::Number(number) => Own::Number(factor * number),
            Own::Matrix(matrix) => Own::Matrix(matrix * factor),
        }
    }

    /// Norm of the map: in the space where the matrix is one of it, Euclidean elsewhere.
    pub fn norm(&self, space: &Space) -> f64 {
        match self {
            Own::Number(number) => number.abs(),
            Own::Matrix(matrix) if matrix.shape() == (space.dimension(), space.dimension()) => {
                space.map_norm(matrix)
            }
            Own::Matrix(matrix) => super::space::largest_singular_value(matrix),
        }
    }

    /// Whether it does nothing.
    pub fn is_zero(&self) -> bool {
        match self {
            Own::Number(number) => *number == 0.0,
            Own::Matrix(matrix) => matrix.iter().all(|value| *value == 0.0),
        }
    }
}

/// What is kept of the past of an integrand z.
pub(super) trait Past {
    /// `sum_{j < n} w_nj q(t_n, t_j) z_j` for the next point n, into `out`.
    fn sum(&mut self, out: &mut DVector<f64>);

    /// `w_nn q(t_n, t_n)` for the next point.
    fn own(&self) -> Own;

    /// Appends z at the next point.
    fn push(&mut self, z: &DVector<f64>);

    /// Numbers that are kept.
    fn numbers(&self) -> usize;

    /// Multiplications of a vector by a value of the kernel so far: what the sums have cost.
    fn products(&self) -> usize;
}
