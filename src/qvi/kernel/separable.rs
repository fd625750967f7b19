//! Separable kernels `q(t, s) = sum_l phi_l(t) psi_l(s) M_l`: one sum over the past per term.

use super::Own;
use super::sums::{Point, Sums, Term};
use crate::qvi::{Quadrature, SolveError};
use nalgebra::DMatrix;
use std::sync::Arc;

/// A function of an instant, s.
pub type OfTime = Arc<dyn Fn(f64) -> f64>;

/// `phi(t) psi(s) M`, M the identity where it is `None`.
#[derive(Clone)]
pub struct SeparableTerm {
    pub phi: OfTime,
    pub psi: OfTime,
    pub matrix: Option<DMatrix<f64>>,
}

impl SeparableTerm {
    /// `phi(t) psi(s)`.
    pub fn new(
        phi: impl Fn(f64) -> f64 + 'static,
        psi: impl Fn(f64) -> f64 + 'static,
    ) -> SeparableTerm {
        SeparableTerm {
            phi: Arc::new(phi),
            psi: Arc::new(psi),
            matrix: None,
        }
    }

    /// The same times a matrix.
    pub fn times(self, matrix: DMatrix<f64>) -> SeparableTerm {
        SeparableTerm {
            matrix: Some(matrix),
            ..self
        }
    }

    fn add_to(&self, factor: f64, x: &[f64], to: &mut [f64]) {
        match &self.matrix {
            None => Own::Number(1.0).add_to(factor, x, to),
            Some(matrix) => {
                for (x, column) in x.iter().zip(matrix.column_iter()) {
                    for (to, value) in to.iter_mut().zip(column.iter()) {
                        *to += factor * value * x;
                    }
                }
            }
        }
    }
}

/// The kernel at two instants.
pub(super) fn value(terms: &[SeparableTerm], dimension: usize, t: f64, s: f64) -> Own {
    if terms.iter().all(|term| term.matrix.is_none()) {
        let values = terms.iter().map(|term| (term.phi)(t) * (term.psi)(s));
        return Own::Number(values.sum());
    }
    let mut sum = DMatrix::zeros(dimension, dimension);
    for term in terms {
        let factor = (term.phi)(t) * (term.psi)(s);
        match &term.matrix {
            Some(matrix) => sum += matrix * factor,
            None => sum += DMatrix::from_diagonal_element(dimension, dimension, factor),
        }
    }
    Own::Matrix(sum)
}

/// The sums of these terms.
pub(super) fn sums(
    terms: &[SeparableTerm],
    dimension: usize,
    rule: Quadrature,
    k: f64,
) -> Result<Sums<SeparableTerm>, SolveError> {
    for matrix in terms.iter().filter_map(|term| term.matrix.as_ref()) {
        SolveError::check_shape("rows of a matrix of a kernel", dimension, matrix.nrows())?;
        SolveError::check_shape("columns of a matrix of a kernel", dimension, matrix.ncols())?;
    }
    Sums::new(terms.to_vec(), dimension, rule, k)
}

impl Term for SeparableTerm {
    fn add(&self, at: &Point, sum: &[f64], out: &mut [f64]) {
        self.add_to((self.phi)(at.time()), sum, out);
    }

    fn own(terms: &[SeparableTerm], dimension: usize, at: &Point) -> Own {
        let t = at.time();
        value(terms, dimension, t, t).scaled(at.rule.weight(at.k, at.n, at.n))
    }

    /// A sum is `sum_{j < n} w_j psi(t_j) z_j`.
    fn push(&self, at: &Point, z: &[f64], sum: &mut [f64]) {
        let factor = at.settled() * (self.psi)(at.time());
        for (sum, z) in sum.iter_mut().zip(z) {
            *sum += factor * z;
        }
    }
}
