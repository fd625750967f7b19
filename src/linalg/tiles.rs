//! Blocks of a dense factorization, held in registers: `R` vectors of rows by four columns.

use pulp::Simd;
use std::ops::Range;

/// Columns of a block.
pub const BLOCK: usize = 4;

/// A block of the result: `R` vectors of rows by four columns.
pub type Tile<V, const R: usize> = [[V; R]; BLOCK];

/// `start + sum_k a_k b_k^T` over columns of `stride`, of the rows from `i` on of `a` and the four rows from `j` on of `b`.
#[inline(always)]
pub fn products<S: Simd, const R: usize>(
    simd: S,
    start: Tile<S::f64s, R>,
    (a, i): (&[f64], usize),
    (b, j): (&[f64], usize),
    stride: usize,
    columns: Range<usize>,
) -> Tile<S::f64s, R> {
    let mut sums = start;
    let range = columns.start * stride..columns.end * stride;
    let a = a[range.clone()].chunks_exact(stride);
    for (a, b) in a.zip(b[range].chunks_exact(stride)) {
        let a = S::as_simd_f64s(&a[i..i + R * S::F64_LANES]).0;
        let b = &b[j..j + BLOCK];
        for q in 0..BLOCK {
            let factor = simd.splat_f64s(b[q]);
            for p in 0..R {
                sums[q][p] = simd.mul_add_e_f64s(a[p], factor, sums[q][p]);
            }
        }
    }
    sums
}

/// A block minus another.
#[inline(always)]
pub fn difference<S: Simd, const R: usize>(
    simd: S,
    mut tile: Tile<S::f64s, R>,
    other: &Tile<S::f64s, R>,
) -> Tile<S::f64s, R> {
    for (tile, other) in tile.iter_mut().zip(other) {
        for (value, other) in tile.iter_mut().zip(other) {
            *value = simd.sub_f64s(*value, *other);
        }
    }
    tile
}

/// A block of zeros.
#[inline(always)]
pub fn zero<S: Simd, const R: usize>(simd: S) -> Tile<S::f64s, R> {
    [[simd.splat_f64s(0.0); R]; BLOCK]
}

#[inline(always)]
pub fn load<S: Simd, const R: usize>(
    simd: S,
    a: &[f64],
    stride: usize,
    (i, j): (usize, usize),
) -> Tile<S::f64s, R> {
    let mut tile = [[simd.splat_f64s(0.0); R]; BLOCK];
    for q in 0..BLOCK {
        let from = S::as_simd_f64s(&a[(j + q) * stride + i..][..R * S::F64_LANES]).0;
        tile[q].copy_from_slice(from);
    }
    tile
}

#[inline(always)]
pub fn store<S: Simd, const R: usize>(
    tile: &Tile<S::f64s, R>,
    a: &mut [f64],
    stride: usize,
    (i, j): (usize, usize),
) {
    for q in 0..BLOCK {
        let to = S::as_mut_simd_f64s(&mut a[(j + q) * stride + i..][..R * S::F64_LANES]).0;
        to.copy_from_slice(&tile[q]);
    }
}

/// The diagonal block of a factor, by columns, with the reciprocals of its diagonal.
pub struct Corner {
    values: [[f64; BLOCK]; BLOCK],
    reciprocals: [f64; BLOCK],
}

impl Corner {
    pub fn of(factor: &[f64], stride: usize, reciprocals: &[f64], j: usize) -> Corner {
        let mut corner = Corner {
            values: [[0.0; BLOCK]; BLOCK],
            reciprocals: [0.0; BLOCK],
        };
        corner
            .reciprocals
            .copy_from_slice(&reciprocals[j..j + BLOCK]);
        for (q, column) in corner.values.iter_mut().enumerate() {
            column.copy_from_slice(&factor[(j + q) * stride + j..][..BLOCK]);
        }
        corner
    }

    /// `a L_JJ^-T`.
    #[inline(always)]
    pub fn solve<S: Simd, const R: usize>(
        &self,
        simd: S,
        a: &Tile<S::f64s, R>,
    ) -> Tile<S::f64s, R> {
        let mut x = *a;
        for q in 0..BLOCK {
            let reciprocal = simd.splat_f64s(self.reciprocals[q]);
            for p in 0..R {
                let mut value = a[q][p];
                for (x, l) in x[..q].iter().zip(&self.values) {
                    value = simd.mul_add_e_f64s(x[p], simd.splat_f64s(-l[q]), value);
                }
                x[q][p] = simd.mul_f64s(value, reciprocal);
            }
        }
        x
    }
}

/// Most rows of a block of [`for_rows`].
pub const MOST_ROWS: usize = 3 * BLOCK;

/// Runs the body for blocks of rows `$from..$to`, of three vectors (`$R`), then two, then one.
macro_rules! for_rows {
    ($S:ident, $from:expr, $to:expr, |$i:ident, $R:ident| $body:block) => {
        // vectors must not reach from one block of rows into the next
        const { assert!(BLOCK.is_multiple_of($S::F64_LANES)) };
        let mut $i = $from;
        while $i + 3 * $S::F64_LANES <= $to {
            const $R: usize = 3;
            $body
            $i += 3 * $S::F64_LANES;
        }
        while $i + 2 * $S::F64_LANES <= $to {
            const $R: usize = 2;
            $body
            $i += 2 * $S::F64_LANES;
        }
        while $i < $to {
            const $R: usize = 1;
            $body
            $i += $S::F64_LANES;
        }
    };
}
pub(super) use for_rows;
