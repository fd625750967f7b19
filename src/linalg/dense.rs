//! Dense algebra on faer with preallocated scratch.

use crate::error::{Error, Result};
use dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::matmul::matmul;
use faer::reborrow::ReborrowMut;
use faer::{Accum, ColMut, ColRef, Conj, Mat, MatMut, MatRef, Par};

/// `y = a x`.
pub fn multiply(a: MatRef<f64>, x: &[f64], y: &mut [f64]) {
    matmul(
        ColMut::from_slice_mut(y),
        Accum::Replace,
        a,
        ColRef::from_slice(x),
        1.0,
        Par::Seq,
    );
}

/// `y = a^T x`.
pub fn multiply_transposed(a: MatRef<f64>, x: &[f64], y: &mut [f64]) {
    multiply(a.transpose(), x, y);
}

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
        let solve = llt::solve::solve_in_place_scratch::<f64>(capacity, 1, Par::Seq);
        let inverse = llt::inverse::inverse_scratch::<f64>(capacity, Par::Seq);
        DenseCholesky {
            values: vec![0.0; capacity * capacity],
            order: 0,
            scratch: MemBuffer::new(factor.or(solve).or(inverse)),
        }
    }

    /// Factors the matrix of order `order` with the given lower triangle; false when it is not positive definite.
    pub fn factor(&mut self, order: usize, entry: impl Fn(usize, usize) -> f64) -> bool {
        self.order = order;
        for j in 0..order {
            for i in j..order {
                self.values[j * order + i] = entry(i, j);
            }
        }
        let lower =
            MatMut::from_column_major_slice_mut(&mut self.values[..order * order], order, order);
        llt::factor::cholesky_in_place(
            lower,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut self.scratch),
            Default::default(),
        )
        .is_ok()
    }

    /// Solves in place with the last factored matrix.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        let n = self.order;
        let factor = MatRef::from_column_major_slice(&self.values[..n * n], n, n);
        llt::solve::solve_in_place_with_conj(
            factor,
            Conj::No,
            ColMut::from_slice_mut(rhs).as_mat_mut(),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
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
