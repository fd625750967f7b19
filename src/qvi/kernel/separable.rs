//! Separable kernels `q(t, s) = sum_l phi_l(t) psi_l(s) M_l`: one sum over the past per term.

use super::{Own, Past};
use crate::qvi::{Quadrature, SolveError};
use nalgebra::{DMatrix, DVector};
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

/// `sum_{j < n} w_j psi_l(t_j) z_j` for every term.
pub(super) struct Sums {
    terms: Vec<SeparableTerm>,
    rule: Quadrature,
    k: f64,
    n: usize,
    dimension: usize,
    sums: Vec<f64>,
    products: usize,
}

impl Sums {
    pub fn new(
        terms: &[SeparableTerm],
        dimension: usize,
        rule: Quadrature,
        k: f64,
    ) -> Result<Sums, SolveError> {
        if rule.settled(k, 0).is_none() {
            return Err(SolveError::Rule {
                rule: rule.name(),
                why: "its weights change with the row, which takes the whole history: give the kernel as a function",
            });
        }
        for term in terms {
            if let Some(matrix) = &term.matrix {
                SolveError::check_shape("rows of a matrix of a kernel", dimension, matrix.nrows())?;
                SolveError::check_shape(
                    "columns of a matrix of a kernel",
                    dimension,
                    matrix.ncols(),
                )?;
            }
        }
        Ok(Sums {
            terms: terms.to_vec(),
            rule,
            k,
            n: 0,
            dimension,
            sums: vec![0.0; terms.len() * dimension],
            products: 0,
        })
    }

    fn time(&self) -> f64 {
        self.n as f64 * self.k
    }
}

impl Past for Sums {
    fn sum(&mut self, out: &mut DVector<f64>) {
        out.fill(0.0);
        let t = self.time();
        for (term, sum) in self.terms.iter().zip(self.sums.chunks(self.dimension)) {
            term.add_to((term.phi)(t), sum, out.as_mut_slice());
        }
        self.products += self.terms.len();
    }

    fn own(&self) -> Own {
        let t = self.time();
        value(&self.terms, self.dimension, t, t).scaled(self.rule.weight(self.k, self.n, self.n))
    }

    fn push(&mut self, z: &DVector<f64>) {
        let t = self.time();
        let settled = self.rule.settled(self.k, self.n).unwrap_or(f64::NAN);
        for (term, sum) in self.terms.iter().zip(self.sums.chunks_mut(self.dimension)) {
            let factor = settled * (term.psi)(t);
            for (sum, z) in sum.iter_mut().zip(z.iter()) {
                *sum += factor * z;
            }
        }
        self.n += 1;
        self.products += self.terms.len();
    }

    fn numbers(&self) -> usize {
        self.sums.len()
    }

    fn products(&self) -> usize {
        self.products
    }
}
