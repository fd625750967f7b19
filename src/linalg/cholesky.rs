//! Cholesky factorization, solves and inverse of symmetric positive definite matrices, in memory of their own.
//!
//! With `A = L L^T` and `Z = L^-T`, `A^-1 = Z Z^T`. An order between whole blocks of columns is filled up with the identity. A
//! solve is two products with triangles, `Z (Z^T g)`: substitutions with L would wait for themselves. A small matrix is
//! inverted: one product then is faster than two, and the inverse costs little.

use super::dense::mirror_lower;
use super::double::dot;
use super::factorization::{FactorInversion, Factorization, Square};
use super::products::multiply;
use super::tiles::BLOCK;
use super::triangle::TriangularProduct;
use faer::{MatMut, MatRef};
use pulp::Arch;

/// Orders up to this are solved with the inverse.
const SMALL: usize = 64;
/// Columns this many numbers apart, or a multiple, share their places in a cache.
const CONFLICT: usize = 32;

/// Cholesky factorization of symmetric positive definite matrices of any order up to a largest one.
pub struct DenseCholesky {
    /// Lower factor L, by columns; for solves L^-1, or the inverse of a small matrix.
    factor: Vec<f64>,
    /// Reciprocals of its diagonal.
    reciprocals: Vec<f64>,
    /// Z, by columns.
    inverse: Vec<f64>,
    order: usize,
    /// Distance of the columns.
    stride: usize,
}

impl DenseCholesky {
    /// Room for matrices of order up to `capacity`.
    pub fn new(capacity: usize) -> DenseCholesky {
        let largest = stride(capacity) * DenseCholesky::padded(capacity);
        DenseCholesky {
            factor: vec![0.0; largest],
            reciprocals: vec![0.0; DenseCholesky::padded(capacity)],
            inverse: vec![0.0; largest],
            order: 0,
            stride: 0,
        }
    }

    /// Length of the vectors of a solve with a matrix of this order: filled up to whole blocks, with zeros.
    pub fn padded(order: usize) -> usize {
        order.next_multiple_of(BLOCK)
    }

    /// The same for the matrix just factored.
    pub fn padded_order(&self) -> usize {
        DenseCholesky::padded(self.order)
    }

    /// Factors the matrix of order `order`; `fill(j, column)` writes rows `j..order` of column j, into `column`. False when
    /// the matrix is not positive definite.
    pub fn factor(&mut self, order: usize, mut fill: impl FnMut(usize, &mut [f64])) -> bool {
        self.set_order(order);
        for j in 0..order {
            fill(j, &mut self.factor[j * self.stride..][j..order]);
        }
        let padded = self.padded_order();
        Arch::new().dispatch(Factorization {
            factor: &mut self.factor,
            reciprocals: &mut self.reciprocals[..padded],
            stride: self.stride,
        })
    }

    /// Sets the order and the identity that fills it up.
    fn set_order(&mut self, order: usize) {
        (self.order, self.stride) = (order, stride(order));
        let padded = self.padded_order();
        for j in 0..padded {
            let column = &mut self.factor[j * self.stride..][..padded];
            if j < order {
                column[order..].fill(0.0);
            } else {
                column.fill(0.0);
                column[j] = 1.0;
                self.reciprocals[j] = 1.0;
            }
        }
    }

    /// Whether solves take the inverse itself: the first half of a solve is then the right-hand side.
    pub fn is_direct(&self) -> bool {
        self.order <= SMALL
    }

    /// Makes what solves take from the factor, which is used up.
    pub fn prepare_solves(&mut self) {
        let (padded, stride) = (self.padded_order(), self.stride);
        if self.is_direct() {
            self.square();
            let a = &mut self.factor;
            mirror_lower(MatMut::from_column_major_slice_with_stride_mut(
                a, padded, padded, stride,
            ));
            return;
        }
        self.invert_factor();
        for j in 0..padded {
            let column = &mut self.factor[j * stride..][..padded];
            column[..j].fill(0.0);
            for (i, value) in column.iter_mut().enumerate().skip(j) {
                *value = self.inverse[i * stride + j];
            }
        }
    }

    /// Makes Z from the factor.
    fn invert_factor(&mut self) {
        let padded = self.padded_order();
        Arch::new().dispatch(FactorInversion {
            factor: &self.factor,
            reciprocals: &self.reciprocals[..padded],
            inverse: &mut self.inverse,
            stride: self.stride,
        });
    }

    /// Makes the lower triangle of the inverse, overwriting the factor.
    fn square(&mut self) {
        self.invert_factor();
        let padded = self.padded_order();
        Arch::new().dispatch(Square {
            inverse: &self.inverse,
            out: &mut self.factor,
            order: padded,
            stride: self.stride,
        });
    }

    /// Inverse of the matrix just factored, exactly symmetric; the factor is used up.
    pub fn inverse(&mut self, mut out: MatMut<f64>) {
        self.square();
        for j in 0..self.order {
            for i in j..self.order {
                let value = self.factor[j * self.stride + i];
                out[(i, j)] = value;
                out[(j, i)] = value;
            }
        }
    }

    /// The first half of a solve, `y = L^-1 g`, or g itself; both of padded length.
    pub fn solve_lower(&self, g: &[f64], y: &mut [f64]) {
        if self.is_direct() {
            y.copy_from_slice(g);
        } else {
            self.multiply_triangle(&self.factor, false, g, y);
        }
    }

    /// The second half, `x = L^-T y`, or the product with the inverse; both of padded length.
    pub fn solve_upper(&self, y: &[f64], x: &mut [f64]) {
        if self.is_direct() {
            let (padded, stride) = (self.padded_order(), self.stride);
            let inverse = &self.factor;
            let inverse =
                MatRef::from_column_major_slice_with_stride(inverse, padded, padded, stride);
            multiply(inverse, y, x);
        } else {
            self.multiply_triangle(&self.inverse, true, y, x);
        }
    }

    /// Row `i` of what the second half multiplies with, as a column: it reads entry i of the solution from half a solve. Zero
    /// before entry i unless [`DenseCholesky::is_direct`].
    pub fn row(&self, i: usize) -> &[f64] {
        &self.factor[i * self.stride..][..self.padded_order()]
    }

    /// Entry `i` of the diagonal of the inverse.
    pub fn inverse_diagonal(&self, i: usize) -> f64 {
        let row = self.row(i);
        if self.is_direct() {
            row[i]
        } else {
            dot(&row[i..], &row[i..])
        }
    }

    fn multiply_triangle(&self, a: &[f64], is_upper: bool, x: &[f64], y: &mut [f64]) {
        Arch::new().dispatch(TriangularProduct {
            a,
            stride: self.stride,
            is_upper,
            x,
            y,
        });
    }
}

/// Distance of the columns of a matrix of order `order`.
fn stride(order: usize) -> usize {
    let padded = DenseCholesky::padded(order);
    if padded.is_multiple_of(CONFLICT) {
        padded + 2 * BLOCK
    } else {
        padded
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;

    #[test]
    fn inverse_is_the_inverse() {
        for m in [1, 3, 4, 9, 32, 70] {
            let noise = |i, j| ((i * 7919 + j * 104_729) % 1009) as f64 / 1009.0 - 0.5;
            let ports = Mat::from_fn(2 * m, m, noise);
            let mut a = ports.transpose() * &ports;
            for i in 0..m {
                a[(i, i)] += 0.3;
            }
            let mut cholesky = DenseCholesky::new(m + 3);
            // entries that remain from a larger matrix must not matter
            assert!(cholesky.factor(m + 3, |_, column| {
                column.fill(0.1);
                column[0] = 7.0;
            }));
            let factor = |cholesky: &mut DenseCholesky| {
                assert!(cholesky.factor(m, |j, column| {
                    for (i, entry) in (j..).zip(column) {
                        *entry = a[(i, j)];
                    }
                }));
            };
            factor(&mut cholesky);
            cholesky.prepare_solves();
            let padded = cholesky.padded_order();
            let mut rhs: Vec<f64> = (0..padded).map(|i| noise(i, 5)).collect();
            rhs[m..].fill(0.0);
            let (mut half, mut x) = (vec![1.0; padded], vec![1.0; padded]);
            cholesky.solve_lower(&rhs, &mut half);
            cholesky.solve_upper(&half, &mut x);
            let back = &a * faer::ColRef::from_slice(&x[..m]);
            assert!((0..m).all(|i| (back[i] - rhs[i]).abs() < 1e-12));
            assert!(x[m..].iter().all(|x| *x == 0.0));
            let diagonal: Vec<f64> = (0..m).map(|i| cholesky.inverse_diagonal(i)).collect();
            for (i, diagonal) in diagonal.iter().enumerate() {
                let read = dot(cholesky.row(i), &half);
                assert!((read - x[i]).abs() < 1e-12);
                let mut unit = vec![0.0; padded];
                unit[i] = 1.0;
                let (mut y, mut column) = (vec![1.0; padded], vec![1.0; padded]);
                cholesky.solve_lower(&unit, &mut y);
                cholesky.solve_upper(&y, &mut column);
                assert!((column[i] / diagonal - 1.0).abs() < 1e-12);
            }
            let mut inverse = Mat::zeros(m, m);
            factor(&mut cholesky);
            cholesky.inverse(inverse.as_mut());
            let product = &a * &inverse;
            for j in 0..m {
                for i in 0..m {
                    let unit = if i == j { 1.0 } else { 0.0 };
                    assert!((product[(i, j)] - unit).abs() < 1e-12);
                    assert_eq!(inverse[(i, j)], inverse[(j, i)]);
                }
                assert!((inverse[(j, j)] / diagonal[j] - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn what_is_not_positive_definite_is_refused() {
        let mut cholesky = DenseCholesky::new(6);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for at in 0..6 {
                assert!(!cholesky.factor(6, |j, column| {
                    column.fill(0.0);
                    column[0] = if j == at { bad } else { 1.0 };
                }));
            }
        }
    }
}
