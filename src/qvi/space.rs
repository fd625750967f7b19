//! The space X: vectors of coordinates with the inner product `(u, v) = u . G v`, G symmetric and positive definite.
//!
//! Operators and loads are given as covectors: `A u` and f are the vectors a, f with `(A u, v) = a . v`. With G = I both readings
//! are the same. Lengths of covectors are those of the dual, `sqrt(f . G^-1 f)`.

use super::{Matrix, SolveError};
use nalgebra::{Cholesky, DMatrix, DVector};

/// R^n with an inner product.
#[derive(Debug, Clone)]
pub struct Space {
    dimension: usize,
    gram: Option<Matrix>,
}

impl Space {
    /// R^n with `(u, v) = u . v`.
    pub fn euclidean(dimension: usize) -> Space {
        Space {
            dimension,
            gram: None,
        }
    }

    /// With the inner product of a symmetric positive definite matrix.
    ///
    /// # Errors
    /// [`SolveError::Shape`] for a matrix that is not square.
    pub fn with_product(gram: Matrix) -> Result<Space, SolveError> {
        let (rows, columns) = gram.shape();
        SolveError::check_shape("columns of the matrix of the inner product", rows, columns)?;
        Ok(Space {
            dimension: rows,
            gram: Some(gram),
        })
    }

    /// Number of coordinates.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// `|u|`.
    pub fn norm(&self, u: &DVector<f64>) -> f64 {
        match &self.gram {
            None => u.norm(),
            // the difference of two positive terms may round below zero
            Some(gram) => u.dot(&gram.apply(u)).max(0.0).sqrt(),
        }
    }

    /// Norm of a map of this space into itself; NaN where G is not positive definite.
    pub fn map_norm(&self, m: &DMatrix<f64>) -> f64 {
        match self.factor() {
            Err(_) => f64::NAN,
            Ok(None) => largest_singular_value(m),
            // |u| = |C^T u|
            Ok(Some(c)) => match c.solve_lower_triangular(&(m.transpose() * &c)) {
                Some(turned) => largest_singular_value(&turned),
                None => f64::NAN,
            },
        }
    }

    /// The lower Cholesky factor C of G; `None` where G is the identity.
    ///
    /// # Errors
    /// [`SolveError::Singular`] where G is not positive definite.
    pub fn factor(&self) -> Result<Option<DMatrix<f64>>, SolveError> {
        let Some(gram) = &self.gram else {
            return Ok(None);
        };
        let factor = Cholesky::new(gram.to_dense()).ok_or(SolveError::Singular)?;
        Ok(Some(factor.unpack()))
    }

    /// Smallest and largest eigenvalue of G.
    pub fn extremes(&self) -> [f64; 2] {
        match &self.gram {
            None => [1.0; 2],
            Some(gram) => {
                let values = gram.to_dense().symmetric_eigenvalues();
                [values.min(), values.max()]
            }
        }
    }
}

/// `C^-1 M D^-T`: a map from covectors or vectors of one space to covectors of another in orthonormal coordinates; an absent factor
/// is the identity.
pub fn orthonormal(
    m: &DMatrix<f64>,
    [to, from]: [Option<&DMatrix<f64>>; 2],
) -> Result<DMatrix<f64>, SolveError> {
    let mut m = m.clone();
    if let Some(c) = to {
        m = c.solve_lower_triangular(&m).ok_or(SolveError::Singular)?;
    }
    if let Some(d) = from {
        m = d
            .solve_lower_triangular(&m.transpose())
            .ok_or(SolveError::Singular)?
            .transpose();
    }
    Ok(m)
}

/// Largest singular value.
pub fn largest_singular_value(m: &DMatrix<f64>) -> f64 {
    let square = m.transpose() * m;
    square.symmetric_eigenvalues().max().max(0.0).sqrt()
}

/// Smallest eigenvalue of the symmetric part.
pub fn smallest_symmetric_eigenvalue(m: &DMatrix<f64>) -> f64 {
    ((m + m.transpose()) * 0.5).symmetric_eigenvalues().min()
}
