//! Matrices of A and of the linear part of phi: dense, or symmetric and sparse on the pattern that the finite elements use.

use super::SolveError;
use crate::fem::OperatorPair;
use crate::linalg::SparseCholesky;
use dyn_stack::MemBuffer;
use faer::MatMut;
use nalgebra::{DMatrix, DVector, Dyn, LU};
use std::sync::Arc;

/// A square or rectangular matrix.
#[derive(Debug, Clone, PartialEq)]
pub enum Matrix {
    Dense(DMatrix<f64>),
    Sparse(SparseSymmetric),
}

/// A symmetric matrix: lower triangle in compressed columns, on a pattern that it may share with others.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseSymmetric {
    pattern: Arc<OperatorPair>,
    values: Vec<f64>,
}

impl SparseSymmetric {
    /// A matrix on the pattern of the operators of a body, whose own entries are not looked at.
    ///
    /// # Errors
    /// [`SolveError::Shape`] for another number of values than the pattern has entries.
    pub fn on(pattern: Arc<OperatorPair>, values: Vec<f64>) -> Result<SparseSymmetric, SolveError> {
        SolveError::check_shape(
            "values of a sparse matrix",
            pattern.row_idx.len(),
            values.len(),
        )?;
        Ok(SparseSymmetric { pattern, values })
    }

    /// A matrix of order n whose column j has the rows `row_idx[col_ptr[j]..col_ptr[j + 1]]`, ascending, not above j.
    ///
    /// # Errors
    /// [`SolveError::Shape`] or [`SolveError::Value`] for lists that are no lower triangle.
    pub fn new(
        col_ptr: Vec<usize>,
        row_idx: Vec<usize>,
        values: Vec<f64>,
    ) -> Result<SparseSymmetric, SolveError> {
        let n = col_ptr.len().saturating_sub(1);
        let last = col_ptr.last().copied().unwrap_or(0);
        SolveError::check_shape("rows of a sparse matrix", last, row_idx.len())?;
        for (j, ends) in col_ptr.windows(2).enumerate() {
            let rows = row_idx.get(ends[0]..ends[1]);
            let is_lower = rows.is_some_and(|rows| {
                rows.first().is_none_or(|first| *first >= j)
                    && rows.is_sorted_by(|a, b| a < b)
                    && rows.last().is_none_or(|last| *last < n)
            });
            if !is_lower {
                return Err(SolveError::Value {
                    what: format!("rows of column {j} of a sparse matrix"),
                    found: f64::NAN,
                    allowed: "ascending rows of the lower triangle",
                });
            }
        }
        let pattern = OperatorPair {
            n,
            col_ptr,
            row_idx,
            a: Vec::new(),
            b: Vec::new(),
            memory: Vec::new(),
        };
        SparseSymmetric::on(Arc::new(pattern), values)
    }
}

impl Matrix {
    /// `factor` times the identity, as a dense matrix.
    pub fn multiple(order: usize, factor: f64) -> Matrix {
        Matrix::Dense(DMatrix::from_diagonal_element(order, order, factor))
    }

    /// Rows and columns.
    pub fn shape(&self) -> (usize, usize) {
        match self {
            Matrix::Dense(matrix) => matrix.shape(),
            Matrix::Sparse(matrix) => (matrix.pattern.n, matrix.pattern.n),
        }
    }

    /// The product with a vector.
    pub fn apply(&self, x: &DVector<f64>) -> DVector<f64> {
        match self {
            Matrix::Dense(matrix) => matrix * x,
            Matrix::Sparse(matrix) => {
                let mut y = DVector::zeros(x.len());
                let (x, to) = (x.as_slice(), y.as_mut_slice());
                matrix.pattern.apply(&matrix.values, x, to);
                y
            }
        }
    }

    /// The matrix with all its entries.
    pub fn to_dense(&self) -> DMatrix<f64> {
        match self {
            Matrix::Dense(matrix) => matrix.clone(),
            Matrix::Sparse(SparseSymmetric { pattern, values }) => {
                let mut dense = DMatrix::zeros(pattern.n, pattern.n);
                for j in 0..pattern.n {
                    let column = pattern.col_ptr[j]..pattern.col_ptr[j + 1];
                    let rows = &pattern.row_idx[column.clone()];
                    for (i, value) in rows.iter().zip(&values[column]) {
                        dense[(*i, j)] = *value;
                        dense[(j, *i)] = *value;
                    }
                }
                dense
            }
        }
    }

    /// `self + factor * other`; sparse where both are on one pattern.
    pub fn plus(&self, factor: f64, other: &Matrix) -> Matrix {
        if let (Matrix::Sparse(a), Matrix::Sparse(b)) = (self, other)
            && (Arc::ptr_eq(&a.pattern, &b.pattern)
                || (a.pattern.col_ptr == b.pattern.col_ptr
                    && a.pattern.row_idx == b.pattern.row_idx))
        {
            let values = a.values.iter().zip(&b.values);
            return Matrix::Sparse(SparseSymmetric {
                pattern: Arc::clone(&a.pattern),
                values: values.map(|(a, b)| a + factor * b).collect(),
            });
        }
        Matrix::Dense(self.to_dense() + factor * other.to_dense())
    }
}

/// A factored matrix.
pub enum Factor {
    Dense(LU<f64, Dyn, Dyn>),
    Sparse {
        cholesky: Box<SparseCholesky>,
        values: Vec<f64>,
        scratch: MemBuffer,
    },
}

impl Factor {
    /// Factors a square matrix: LU of a dense one, Cholesky of a sparse one.
    ///
    /// # Errors
    /// [`SolveError::Singular`] for a dense matrix that is singular to rounding, a sparse one that is not positive definite.
    pub fn new(matrix: &Matrix) -> Result<Factor, SolveError> {
        match matrix {
            Matrix::Dense(matrix) => {
                let lu = matrix.clone().lu();
                let upper = lu.u();
                let diagonal = upper.diagonal().abs();
                let is_regular = diagonal.min() > 4.0 * f64::EPSILON * matrix.amax();
                is_regular
                    .then_some(Factor::Dense(lu))
                    .ok_or(SolveError::Singular)
            }
            Matrix::Sparse(SparseSymmetric { pattern, values }) => {
                let order: Vec<usize> = (0..pattern.n).collect();
                let cholesky =
                    SparseCholesky::with_order(&pattern.col_ptr, &pattern.row_idx, order, 0)
                        .map_err(|_| SolveError::Singular)?;
                let mut factor = vec![0.0; cholesky.len()];
                let mut scratch = cholesky.scratch(1);
                cholesky
                    .factor("the operator", values, &mut factor, &mut scratch)
                    .map_err(|_| SolveError::Singular)?;
                Ok(Factor::Sparse {
                    cholesky: Box::new(cholesky),
                    values: factor,
                    scratch,
                })
            }
        }
    }

    /// Solves in place.
    pub fn solve(&mut self, x: &mut DVector<f64>) {
        match self {
            Factor::Dense(lu) => {
                lu.solve_mut(x);
            }
            Factor::Sparse {
                cholesky,
                values,
                scratch,
            } => {
                let len = x.len();
                let column = MatMut::from_column_major_slice_mut(x.as_mut_slice(), len, 1);
                cholesky.solve(values, column, scratch);
            }
        }
    }
}
