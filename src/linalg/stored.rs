//! Tall matrices that a step passes over, stored in double or in single precision. All arithmetic is double: a matrix in
//! single precision is the same as one in double precision whose entries were rounded once, and moves half the memory.

use super::gram::weighted_gram;
use super::products::{multiply, multiply_transposed};
use crate::bytes::{Reader, Writer};
use crate::error::Result;
use faer::{Mat, MatRef};

/// A matrix of either precision.
pub enum StoredMatrix {
    Double(Mat<f64>),
    Single(Mat<f32>),
}

impl StoredMatrix {
    /// In single precision, rounded to nearest.
    pub fn single(a: MatRef<f64>) -> StoredMatrix {
        StoredMatrix::Single(Mat::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] as f32))
    }

    pub fn nrows(&self) -> usize {
        match self {
            StoredMatrix::Double(a) => a.nrows(),
            StoredMatrix::Single(a) => a.nrows(),
        }
    }

    pub fn ncols(&self) -> usize {
        match self {
            StoredMatrix::Double(a) => a.ncols(),
            StoredMatrix::Single(a) => a.ncols(),
        }
    }

    /// Memory of the entries, bytes.
    pub fn bytes(&self) -> usize {
        let entry = match self {
            StoredMatrix::Double(_) => std::mem::size_of::<f64>(),
            StoredMatrix::Single(_) => std::mem::size_of::<f32>(),
        };
        entry * self.nrows() * self.ncols()
    }

    /// `y = a x`.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        match self {
            StoredMatrix::Double(a) => multiply(a.as_ref(), x, y),
            StoredMatrix::Single(a) => multiply(a.as_ref(), x, y),
        }
    }

    /// `y = a^T x`.
    pub fn multiply_transposed(&self, x: &[f64], y: &mut [f64]) {
        match self {
            StoredMatrix::Double(a) => multiply_transposed(a.as_ref(), x, y),
            StoredMatrix::Single(a) => multiply_transposed(a.as_ref(), x, y),
        }
    }

    /// Lower triangle of `a^T diag(weights) a`, into the columns of `out`.
    pub fn weighted_gram(&self, weights: &[f64], out: &mut [f64]) {
        match self {
            StoredMatrix::Double(a) => weighted_gram(a.as_ref(), weights, out),
            StoredMatrix::Single(a) => weighted_gram(a.as_ref(), weights, out),
        }
    }

    /// The same entries in double precision.
    pub fn to_double(&self) -> Mat<f64> {
        match self {
            StoredMatrix::Double(a) => a.clone(),
            StoredMatrix::Single(a) => {
                Mat::from_fn(a.nrows(), a.ncols(), |i, j| f64::from(a[(i, j)]))
            }
        }
    }

    pub(crate) fn write(&self, out: &mut Writer) {
        match self {
            StoredMatrix::Double(a) => out.matrix(a.as_ref()),
            StoredMatrix::Single(a) => out.singles(a.as_ref()),
        }
    }

    /// Reads what [`StoredMatrix::write`] wrote.
    ///
    /// # Errors
    /// [`crate::Error::Bytes`].
    pub(crate) fn read(
        from: &mut Reader,
        is_single: bool,
        (rows, columns): (usize, usize),
    ) -> Result<StoredMatrix> {
        Ok(if is_single {
            StoredMatrix::Single(from.singles(rows, columns)?)
        } else {
            StoredMatrix::Double(from.matrix(rows, columns)?)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::StoredMatrix;
    use faer::Mat;

    #[test]
    fn single_precision_is_double_precision_of_rounded_entries() {
        for (r, m) in [(1, 1), (7, 3), (133, 32), (300, 9)] {
            let noise = |i, j| ((i * 7919 + j * 104_729) % 1009) as f64 / 1009.0 - 0.5;
            let a = Mat::from_fn(r, m, noise);
            let single = StoredMatrix::single(a.as_ref());
            let double = StoredMatrix::Double(single.to_double());
            let x: Vec<f64> = (0..m).map(|i| 1.0 - i as f64).collect();
            let z: Vec<f64> = (0..r).map(|i| 1.0 / (1.0 + i as f64)).collect();
            let both = |f: &dyn Fn(&StoredMatrix) -> Vec<f64>| (f(&single), f(&double));
            let products = [
                both(&|a| {
                    let mut y = vec![0.0; r];
                    a.multiply(&x, &mut y);
                    y
                }),
                both(&|a| {
                    let mut y = vec![0.0; m];
                    a.multiply_transposed(&z, &mut y);
                    y
                }),
                both(&|a| {
                    let mut y = vec![0.0; m * m];
                    a.weighted_gram(&z, &mut y);
                    y
                }),
            ];
            for (s, d) in products {
                for (s, d) in s.iter().zip(d) {
                    assert!((s - d).abs() < 1e-12 * (1.0 + d.abs()));
                }
            }
        }
    }
}
