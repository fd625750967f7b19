//! Products with matrices by columns, of an order that is a whole number of blocks: with triangles, and with small matrices.

use super::products::Entry;
use super::tiles::BLOCK;
use pulp::Simd;
use std::ops::Range;

/// Vectors of the result kept in registers while all columns of a small matrix are added.
const ROWS: usize = 8;

/// A matrix in columns `stride` apart.
#[derive(Clone, Copy)]
pub struct Triangle<'a> {
    pub values: &'a [f64],
    pub stride: usize,
}

impl Triangle<'_> {
    /// `y = A x`, A lower triangular.
    #[inline(always)]
    pub fn multiply_lower<S: Simd>(self, simd: S, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (block, x) in x.as_chunks::<BLOCK>().0.iter().enumerate() {
            let first = block * BLOCK;
            let to = &mut y[first..];
            f64::add_columns(simd, self.columns(first, first..first + to.len()), *x, to);
        }
    }

    /// `y = A x`, A upper triangular.
    #[inline(always)]
    pub fn multiply_upper<S: Simd>(self, simd: S, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (block, x) in x.as_chunks::<BLOCK>().0.iter().enumerate() {
            let (first, end) = (block * BLOCK, (block + 1) * BLOCK);
            f64::add_columns(simd, self.columns(first, 0..end), *x, &mut y[..end]);
        }
    }

    /// A block of columns.
    #[inline(always)]
    fn columns(&self, first: usize, rows: Range<usize>) -> [&[f64]; BLOCK] {
        std::array::from_fn(|q| &self.values[(first + q) * self.stride..][rows.clone()])
    }

    /// `y = A x`, rows by rows: for a matrix that stays in the first-level cache, where rows far apart in memory cost nothing.
    #[inline(always)]
    pub fn multiply_small<S: Simd>(self, simd: S, x: &[f64], y: &mut [f64]) {
        let (lanes, len) = (S::F64_LANES, y.len());
        let mut at = 0;
        while at + ROWS * lanes <= len {
            self.rows::<S, ROWS>(simd, x, y, at);
            at += ROWS * lanes;
        }
        if at + ROWS / 2 * lanes <= len {
            self.rows::<S, { ROWS / 2 }>(simd, x, y, at);
            at += ROWS / 2 * lanes;
        }
        while at < len {
            self.rows::<S, 1>(simd, x, y, at);
            at += lanes;
        }
    }

    /// `N` vectors of rows of the product, from row `at` on.
    #[inline(always)]
    fn rows<S: Simd, const N: usize>(self, simd: S, x: &[f64], y: &mut [f64], at: usize) {
        let mut sums = [simd.splat_f64s(0.0); N];
        for (column, x) in self.values.chunks_exact(self.stride).zip(x) {
            let factor = simd.splat_f64s(*x);
            let (vectors, _) = S::as_simd_f64s(&column[at..at + N * S::F64_LANES]);
            for i in 0..N {
                sums[i] = simd.mul_add_e_f64s(vectors[i], factor, sums[i]);
            }
        }
        let (y, _) = S::as_mut_simd_f64s(&mut y[at..at + N * S::F64_LANES]);
        y.copy_from_slice(&sums);
    }
}
