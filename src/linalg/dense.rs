//! Dense algebra on faer with preallocated scratch.

use super::kernel::{column, dot};
use crate::error::{Error, Result};
use dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::reborrow::ReborrowMut;
use faer::{Mat, MatMut, MatRef, Par};

/// Cholesky factorization of symmetric positive definite matrices of any order up to a largest one.
pub struct DenseCholesky {
    values: Vec<f64>,
    order: usize,
    scratch: MemBuffer,
}

impl DenseCholesky {
    /// Room for matrices of order up to `capacity`.
    pub fn new(capacity: usize) -> DenseCholesky {
        let factor =
            llt::factor::cholesky_in_place_scratch::<f64>(capacity, Par::Seq, Default::default());
        let inverse = llt::inverse::inverse_scratch::<f64>(capacity, Par::Seq);
        DenseCholesky {
            values: vec![0.0; capacity * capacity],
            order: 0,
            scratch: MemBuffer::new(factor.or(inverse)),
        }
    }

    /// Factors the matrix of order `order`; `fill(j, column)` writes rows `j..order` of column j, into `column`. False when
    /// the matrix is not positive definite.
    pub fn factor(&mut self, order: usize, mut fill: impl FnMut(usize, &mut [f64])) -> bool {
        self.order = order;
        let values = &mut self.values[..order * order];
        for j in 0..order {
            fill(j, &mut values[j * order + j..(j + 1) * order]);
        }
        llt::factor::cholesky_in_place(
            MatMut::from_column_major_slice_mut(values, order, order),
            Default::default(),
            Par::Seq,
            MemStack::new(&mut self.scratch),
            Default::default(),
        )
        .is_ok()
    }

    /// Takes over a lower Cholesky factor.
    pub fn adopt(&mut self, lower: MatRef<f64>) {
        self.order = lower.nrows();
        for (j, to) in self
            .values
            .chunks_exact_mut(self.order)
            .enumerate()
            .take(self.order)
        {
            to.copy_from_slice(column(lower, j));
        }
    }

    /// Solves in place with the last factored matrix.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        let n = self.order;
        for j in 0..n {
            let column = &self.values[j * n + j..(j + 1) * n];
            let (head, tail) = rhs[j..].split_at_mut(1);
            head[0] /= column[0];
            for (x, l) in tail.iter_mut().zip(&column[1..]) {
                *x -= l * head[0];
            }
        }
        for j in (0..n).rev() {
            let column = &self.values[j * n + j..(j + 1) * n];
            let (head, tail) = rhs[j..].split_at_mut(1);
            head[0] = (head[0] - dot(&column[1..], tail)) / column[0];
        }
    }

    /// Inverse of the last factored matrix, exactly symmetric.
    pub fn inverse(&mut self, mut out: MatMut<f64>) {
        let n = self.order;
        let factor = MatRef::from_column_major_slice(&self.values[..n * n], n, n);
        llt::inverse::inverse(
            out.rb_mut(),
            factor,
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
        mirror_lower(out);
    }
}

/// Copies the lower triangle onto the upper one.
pub fn mirror_lower(mut a: MatMut<f64>) {
    for j in 0..a.ncols() {
        for i in 0..j {
            a[(i, j)] = a[(j, i)];
        }
    }
}

/// Eigenvalues in ascending order and orthonormal eigenvectors of a symmetric matrix (its lower triangle is read).
///
/// # Errors
/// [`Error::Body`] when the iteration fails, which means the matrix holds NaN or infinities.
pub fn symmetric_eigen(what: &str, a: MatRef<f64>) -> Result<(Vec<f64>, Mat<f64>)> {
    let eigen = a
        .self_adjoint_eigen(faer::Side::Lower)
        .map_err(|_| Error::Body {
            what: format!("the eigenvalues of {what} cannot be computed"),
        })?;
    let values = eigen.S().column_vector().iter().copied().collect();
    Ok((values, eigen.U().to_owned()))
}

/// Eigenvalues of a symmetric matrix in ascending order (its lower triangle is read).
///
/// # Errors
/// [`Error::Body`] when the iteration fails, which means the matrix holds NaN or infinities.
pub fn symmetric_eigenvalues(what: &str, a: MatRef<f64>) -> Result<Vec<f64>> {
    a.self_adjoint_eigenvalues(faer::Side::Lower)
        .map_err(|_| Error::Body {
            what: format!("the eigenvalues of {what} cannot be computed"),
        })
}
