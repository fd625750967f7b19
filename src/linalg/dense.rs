//! Symmetric matrices as wholes. Eigenvalues are faer's: they are for compiling, not for a step (see `kernel`).

use crate::error::{Error, Result};
use faer::{Mat, MatMut, MatRef};

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
