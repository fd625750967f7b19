//! The three loops of a dense factorization: the factor of `A = L L^T`, `Z = L^-T`, and `Z Z^T`. By blocks of four columns,
//!
//! ```text
//! L_IJ = (A_IJ - sum_{K<J} L_IK L_JK^T) L_JJ^-T,   Z_IJ = (I_IJ - sum_{K<J} Z_IK L_JK^T) L_JJ^-T,   (A^-1)_IJ = sum_K Z_IK Z_JK^T
//! ```
//!
//! so one loop over columns, with a block of the result in registers, serves all three; the sums are taken over panels of
//! columns that stay in the cache. Matrices are by columns, `stride` apart, of an order that is a whole number of blocks.

use super::tiles::{BLOCK, Corner, MOST_ROWS, difference, for_rows, load, products, store, zero};
use pulp::{Simd, WithSimd};
use std::ops::Range;

/// Columns of a panel, a multiple of those of a block.
const PANEL: usize = 64;

/// `A = L L^T`, in place; false when A is not positive definite.
pub struct Factorization<'a> {
    pub factor: &'a mut [f64],
    pub reciprocals: &'a mut [f64],
    pub stride: usize,
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
        let a = load::<S, R>(simd, factor, stride, (i, j));
        let x = difference::<S, R>(simd, a, &sums);
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
pub struct FactorInversion<'a> {
    pub factor: &'a [f64],
    pub reciprocals: &'a [f64],
    pub inverse: &'a mut [f64],
    pub stride: usize,
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
        // the diagonal block, and below it as far as a block of rows that begins there reaches
        for j in 0..order {
            let first = j - j % BLOCK;
            let last = order.min(first + MOST_ROWS);
            inverse[j * stride..][first..last].fill(0.0);
            inverse[j * stride + j] = 1.0;
        }
        for start in (0..order).step_by(PANEL) {
            let end = order.min(start + PANEL);
            for j in (start..end).step_by(BLOCK) {
                let corner = Corner::of(factor, stride, reciprocals, j);
                let l = (factor, j);
                // what earlier panels have left, what this one is the first to reach, the diagonal
                for_rows!(S, 0, start, |i, R| {
                    let z = (&*inverse, i);
                    let sums = products::<S, R>(simd, zero::<S, R>(simd), z, l, stride, start..j);
                    let a = load::<S, R>(simd, inverse, stride, (i, j));
                    let x = corner.solve(simd, &difference::<S, R>(simd, a, &sums));
                    store::<S, R>(&x, inverse, stride, (i, j));
                });
                for_rows!(S, start, j, |i, R| {
                    let (zero, z) = (zero::<S, R>(simd), (&*inverse, i));
                    let sums = products::<S, R>(simd, zero, z, l, stride, i..j);
                    let x = corner.solve(simd, &difference::<S, R>(simd, zero, &sums));
                    store::<S, R>(&x, inverse, stride, (i, j));
                });
                for_rows!(S, j, j + BLOCK, |i, R| {
                    let unit = load::<S, R>(simd, inverse, stride, (i, j));
                    store::<S, R>(&corner.solve(simd, &unit), inverse, stride, (i, j));
                });
            }
            for j in (end..order).step_by(BLOCK) {
                let l = (factor, j);
                for_rows!(S, 0, start, |i, R| {
                    let z = (&*inverse, i);
                    let sums = products::<S, R>(simd, zero::<S, R>(simd), z, l, stride, start..end);
                    let a = load::<S, R>(simd, inverse, stride, (i, j));
                    let x = difference::<S, R>(simd, a, &sums);
                    store::<S, R>(&x, inverse, stride, (i, j));
                });
                for_rows!(S, start, end, |i, R| {
                    let (zero, z) = (zero::<S, R>(simd), (&*inverse, i));
                    let sums = products::<S, R>(simd, zero, z, l, stride, i..end);
                    let x = difference::<S, R>(simd, zero, &sums);
                    store::<S, R>(&x, inverse, stride, (i, j));
                });
            }
        }
    }
}

/// The lower triangle of `Z Z^T`.
pub struct Square<'a> {
    pub inverse: &'a [f64],
    pub out: &'a mut [f64],
    pub order: usize,
    pub stride: usize,
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
