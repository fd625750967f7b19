//! Symmetric matrices as wholes. Eigenvalues are faer's: they are for compiling, not for a step (see `products`).

use crate::error::{Error, Result};
use dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt_pivoting::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::{Mat, MatMut, MatRef, Par};

/// Copies the lower triangle onto the upper one.
pub fn mirror_lower(mut a: MatMut<f64>) {
    for j in 0..a.ncols() {
        for i in 0..j {
            a[(i, j)] = a[(j, i)];
        }
    }
}
/// Cholesky factor of a symmetric positive semidefinite matrix (its lower triangle is read) with diagonal pivoting. Stops at the
/// first pivot that is not above `smallest`. Returns the rows in the order they were chosen, and the factor of that part.
///
/// # Errors
/// [`Error::Body`] when an entry is not a number, or a diagonal one negative.
pub fn pivoted_cholesky(
    what: &str,
    mut a: Mat<f64>,
    smallest: f64,
) -> Result<(Vec<usize>, Mat<f64>)> {
    let size = a.nrows();
    let diagonal = (0..size).map(|j| a[(j, j)]);
    // where nothing is above the smallest pivot, the factor would be made of the rounding errors of zeros
    if diagonal.clone().all(|d| (0.0..=smallest).contains(&d)) {
        return Ok((Vec::new(), Mat::zeros(0, 0)));
    }
    let (mut order, mut inverse) = (vec![0_usize; size], vec![0_usize; size]);
    let scratch = cholesky_in_place_scratch::<usize, f64>(size, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(scratch);
    let (info, _) = cholesky_in_place(
        a.as_mut(),
        &mut order,
        &mut inverse,
        Par::Seq,
        MemStack::new(&mut memory),
        Default::default(),
    )
    .map_err(|_| Error::Body {
        what: format!("{what} is not positive semidefinite"),
    })?;
    let pivots = (0..info.rank).take_while(|j| a[(*j, *j)].powi(2) > smallest);
    order.truncate(pivots.count());
    let rank = order.len();
    let lower = |i: usize, j: usize| if i >= j { a[(i, j)] } else { 0.0 };
    Ok((order, Mat::from_fn(rank, rank, lower)))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pivoted_factor_stops_where_nothing_is_left() {
        let rows = |scale: f64| {
            Mat::from_fn(3, 2, |i, j| {
                scale * ((i + 1) * (j + 2)) as f64 + (i * j) as f64
            })
        };
        let gram = |a: Mat<f64>| &a * a.transpose();
        let (order, lower) = pivoted_cholesky("a", gram(rows(1.0)), 1e-12).unwrap();
        assert_eq!((order.len(), lower.nrows()), (2, 2));
        // nothing at all, or nothing but rounding, and no rows at all
        for empty in [Mat::zeros(3, 3), gram(rows(1e-9)), Mat::zeros(0, 0)] {
            let (order, lower) = pivoted_cholesky("a", empty.clone(), 1e-12).unwrap();
            assert_eq!(order.len(), lower.nrows());
            assert!(order.len() <= 1, "{empty:?}");
        }
        assert!(pivoted_cholesky("a", Mat::from_fn(2, 2, |_, _| f64::NAN), 1e-12).is_err());
        assert!(pivoted_cholesky("a", Mat::from_fn(1, 1, |_, _| -1.0), 1e-12).is_err());
    }
}
