//! Cholesky factorization and inverse of symmetric positive definite matrices, in memory of their own.
//!
//! With `A = L L^T` and `Z = L^-T`, `A^-1 = Z Z^T`. By blocks of four columns,
//!
//! ```text
//! L_IJ = (A_IJ - sum_{K<J} L_IK L_JK^T) L_JJ^-T,   Z_IJ = (I_IJ - sum_{K<J} Z_IK L_JK^T) L_JJ^-T,   (A^-1)_IJ = sum_K Z_IK Z_JK^T
//! ```
//!
//! so one loop over columns, with a block of the result in registers, serves all three; the sums are taken over panels of columns that
//! stay in the cache. An order between multiples of four is
//! filled up with the identity. A solve is two products with the triangle Z: substitutions with L would wait for themselves.

use super::products::Entry;
use super::tiles::{BLOCK, Corner, difference, for_rows, load, products, store, zero};
use faer::MatMut;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Columns of a panel, a multiple of those of a block.
const PANEL: usize = 64;
/// Columns this many numbers apart, or a multiple, share their places in a cache.
const CONFLICT: usize = 32;

/// Cholesky factorization of symmetric positive definite matrices of any order up to a largest one.
pub struct DenseCholesky {
    /// Lower factor L, by columns.
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

    /// Makes Z from the factor: what solves take.
    pub fn invert_factor(&mut self) {
        let padded = self.padded_order();
        Arch::new().dispatch(FactorInversion {
            factor: &self.factor,
            reciprocals: &self.reciprocals[..padded],
            inverse: &mut self.inverse,
            stride: self.stride,
        });
    }

    /// Inverse of the matrix just factored, exactly symmetric; the factor is used up.
    pub fn inverse(&mut self, mut out: MatMut<f64>) {
        self.invert_factor();
        let padded = self.padded_order();
        Arch::new().dispatch(Square {
            inverse: &self.inverse,
            out: &mut self.factor,
            order: padded,
            stride: self.stride,
        });
        for j in 0..self.order {
            for i in j..self.order {
                let value = self.factor[j * self.stride + i];
                out[(i, j)] = value;
                out[(j, i)] = value;
            }
        }
    }

    /// The first half of a solve, `y = Z^T g`; both of padded length.
    pub fn solve_lower(&self, g: &[f64], y: &mut [f64]) {
        Arch::new().dispatch(FirstHalf(self, g, y));
    }

    /// The second half, `x = Z y`; both of padded length.
    pub fn solve_upper(&self, y: &[f64], x: &mut [f64]) {
        Arch::new().dispatch(SecondHalf(self, y, x));
    }

    /// Row `i` of Z from the diagonal on: the first half of a solve for a unit vector.
    pub fn half_of_unit(&self, i: usize) -> impl Iterator<Item = f64> {
        (i..self.padded_order()).map(move |j| self.inverse[j * self.stride + i])
    }

    /// Diagonal of the inverse.
    pub fn inverse_diagonal(&self, out: &mut [f64]) {
        out.fill(0.0);
        for j in 0..self.order {
            let column = &self.inverse[j * self.stride..][..=j];
            for (out, z) in out.iter_mut().zip(column) {
                *out += z * z;
            }
        }
    }

    /// Four columns of Z from `j` on, down to the end of the diagonal block.
    #[inline(always)]
    fn columns(&self, j: usize) -> [&[f64]; BLOCK] {
        std::array::from_fn(|q| &self.inverse[(j + q) * self.stride..][..j + BLOCK])
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

/// `y = Z^T g`.
struct FirstHalf<'a>(&'a DenseCholesky, &'a [f64], &'a mut [f64]);

impl WithSimd for FirstHalf<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let FirstHalf(cholesky, g, y) = self;
        for (block, y) in y.as_chunks_mut::<BLOCK>().0.iter_mut().enumerate() {
            let end = (block + 1) * BLOCK;
            *y = f64::dots(simd, cholesky.columns(end - BLOCK), &g[..end]);
        }
    }
}

/// `x = Z y`.
struct SecondHalf<'a>(&'a DenseCholesky, &'a [f64], &'a mut [f64]);

impl WithSimd for SecondHalf<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let SecondHalf(cholesky, y, x) = self;
        x.fill(0.0);
        for (block, y) in y.as_chunks::<BLOCK>().0.iter().enumerate() {
            let end = (block + 1) * BLOCK;
            f64::add_columns(simd, cholesky.columns(end - BLOCK), *y, &mut x[..end]);
        }
    }
}

/// `A = L L^T`, in place; false when A is not positive definite.
struct Factorization<'a> {
    factor: &'a mut [f64],
    reciprocals: &'a mut [f64],
    stride: usize,
}

impl WithSimd for Factorization<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Factorization {
            factor,
            reciprocals,
            stride,
        } = self;
        let order = reciprocals.len();
        for start in (0..order).step_by(PANEL) {
            let end = order.min(start + PANEL);
            for j in (start..end).step_by(BLOCK) {
                subtract::<S>(simd, factor, stride, j, order, start..j);
                if !factor_corner(factor, stride, reciprocals, j) {
                    return false;
                }
                let corner = Corner::of(factor, stride, reciprocals, j);
                for_rows!(S, j + BLOCK, order, |i, R| {
                    let a = load::<S, R>(simd, factor, stride, (i, j));
                    let x = corner.solve(simd, &a);
                    store::<S, R>(&x, factor, stride, (i, j));
                });
            }
            for j in (end..order).step_by(BLOCK) {
                subtract::<S>(simd, factor, stride, j, order, start..end);
            }
        }
        true
    }
}

/// Subtracts from the block of columns at `j`, below the diagonal, the products of columns that are factored.
#[inline(always)]
fn subtract<S: Simd>(
    simd: S,
    factor: &mut [f64],
    stride: usize,
    j: usize,
    order: usize,
    columns: Range<usize>,
) {
    for_rows!(S, j, order, |i, R| {
        let (rows, block) = ((&*factor, i), (&*factor, j));
        let sums = products::<S, R>(
            simd,
            zero::<S, R>(simd),
            rows,
            block,
            stride,
            columns.clone(),
        );
        let x = difference::<S, R>(simd, factor, stride, (i, j), &sums);
        store::<S, R>(&x, factor, stride, (i, j));
    });
}

/// Factors the diagonal block at `j`, in place.
fn factor_corner(factor: &mut [f64], stride: usize, reciprocals: &mut [f64], j: usize) -> bool {
    for q in j..j + BLOCK {
        for p in q..j + BLOCK {
            let mut value = factor[q * stride + p];
            for k in j..q {
                value -= factor[k * stride + p] * factor[k * stride + q];
            }
            if p > q {
                factor[q * stride + p] = value * reciprocals[q];
            } else if value > 0.0 && value.is_finite() {
                factor[q * stride + q] = value.sqrt();
                reciprocals[q] = 1.0 / factor[q * stride + q];
            } else {
                return false;
            }
        }
    }
    true
}

/// `Z = L^-T`, upper triangular.
struct FactorInversion<'a> {
    factor: &'a [f64],
    reciprocals: &'a [f64],
    inverse: &'a mut [f64],
    stride: usize,
}

impl WithSimd for FactorInversion<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let FactorInversion {
            factor,
            reciprocals,
            inverse,
            stride,
        } = self;
        let order = reciprocals.len();
        for j in 0..order {
            let column = &mut inverse[j * stride..][..order];
            column.fill(0.0);
            column[j] = 1.0;
        }
        for start in (0..order).step_by(PANEL) {
            let end = order.min(start + PANEL);
            for j in (start..end).step_by(BLOCK) {
                let corner = Corner::of(factor, stride, reciprocals, j);
                for_rows!(S, 0, j + BLOCK, |i, R| {
                    // Z is zero left of its diagonal
                    let (z, l) = ((&*inverse, i), (factor, j));
                    let sums =
                        products::<S, R>(simd, zero::<S, R>(simd), z, l, stride, start.max(i)..j);
                    let a = difference::<S, R>(simd, inverse, stride, (i, j), &sums);
                    let x = corner.solve(simd, &a);
                    store::<S, R>(&x, inverse, stride, (i, j));
                });
            }
            for j in (end..order).step_by(BLOCK) {
                for_rows!(S, 0, end, |i, R| {
                    let (z, l) = ((&*inverse, i), (factor, j));
                    let sums =
                        products::<S, R>(simd, zero::<S, R>(simd), z, l, stride, start.max(i)..end);
                    let x = difference::<S, R>(simd, inverse, stride, (i, j), &sums);
                    store::<S, R>(&x, inverse, stride, (i, j));
                });
            }
        }
    }
}

/// The lower triangle of `Z Z^T`.
struct Square<'a> {
    inverse: &'a [f64],
    out: &'a mut [f64],
    order: usize,
    stride: usize,
}

impl WithSimd for Square<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Square {
            inverse,
            out,
            order,
            stride,
        } = self;
        for start in (0..order).step_by(PANEL) {
            let end = order.min(start + PANEL);
            // rows below a column of Z are zero
            for j in (0..end).step_by(BLOCK) {
                let block = (inverse, j);
                for_rows!(S, j, start, |i, R| {
                    let sum = load::<S, R>(simd, out, stride, (i, j));
                    let x = products::<S, R>(simd, sum, (inverse, i), block, stride, start..end);
                    store::<S, R>(&x, out, stride, (i, j));
                });
                // what this panel is the first to reach
                for_rows!(S, j.max(start), end, |i, R| {
                    let zero = zero::<S, R>(simd);
                    let x = products::<S, R>(simd, zero, (inverse, i), block, stride, i..end);
                    store::<S, R>(&x, out, stride, (i, j));
                });
            }
        }
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
            // what is left of a larger matrix must not matter
            assert!(cholesky.factor(m + 3, |_, column| {
                column.fill(0.1);
                column[0] = 7.0;
            }));
            assert!(cholesky.factor(m, |j, column| {
                for (i, entry) in (j..).zip(column) {
                    *entry = a[(i, j)];
                }
            }));
            cholesky.invert_factor();
            let padded = cholesky.padded_order();
            let mut rhs: Vec<f64> = (0..padded).map(|i| noise(i, 5)).collect();
            rhs[m..].fill(0.0);
            let (mut half, mut x) = (vec![1.0; padded], vec![1.0; padded]);
            cholesky.solve_lower(&rhs, &mut half);
            cholesky.solve_upper(&half, &mut x);
            let back = &a * faer::ColRef::from_slice(&x[..m]);
            assert!((0..m).all(|i| (back[i] - rhs[i]).abs() < 1e-12));
            assert!(x[m..].iter().all(|x| *x == 0.0));
            let mut diagonal = vec![1.0; m];
            cholesky.inverse_diagonal(&mut diagonal);
            for (i, diagonal) in diagonal.iter().enumerate() {
                let row: Vec<f64> = cholesky.half_of_unit(i).collect();
                let square: f64 = row.iter().map(|z| z * z).sum();
                assert!((square / diagonal - 1.0).abs() < 1e-12);
            }
            let mut inverse = Mat::zeros(m, m);
            cholesky.inverse(inverse.as_mut());
            let product = &a * &inverse;
            for j in 0..m {
                for i in 0..m {
                    let unit = if i == j { 1.0 } else { 0.0 };
                    assert!((product[(i, j)] - unit).abs() < 1e-12);
                    assert_eq!(inverse[(i, j)], inverse[(j, i)]);
                }
                assert!((inverse[(j, j)] / diagonal[j] - 1.0).abs() < 1e-12);
                if j == m {}
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
