//! Loops over columns in double precision, on the vector instructions that the machine has.
//!
//! Vector operations stand in plain loops: inside the closure of a `map` they would be compiled without the instructions of
//! the machine and called one by one.

use super::products::{Entry, column};
use faer::MatRef;
use pulp::Simd;

/// Partial sums of a dot product: independent, so that they fill the vector units.
const LANES: usize = 8;
/// Vectors of the result kept in registers while all columns are added.
const ROWS: usize = 8;
/// Entries of a matrix that stays in the first-level cache, where rows far apart in memory cost nothing.
const SMALL: usize = 4096;

impl Entry for f64 {
    #[inline(always)]
    fn multiply_small<S: Simd>(simd: S, a: MatRef<f64>, x: &[f64], y: &mut [f64]) -> bool {
        if y.len() * x.len() > SMALL || y.len() < S::F64_LANES {
            return false;
        }
        let (count, last) = (y.len() / S::F64_LANES, y.len() - S::F64_LANES);
        let mut at = 0;
        while at + ROWS <= count {
            rows::<S, ROWS>(simd, a, x, &mut y[at * S::F64_LANES..], at * S::F64_LANES);
            at += ROWS;
        }
        if at + ROWS / 2 <= count {
            let first = at * S::F64_LANES;
            rows::<S, { ROWS / 2 }>(simd, a, x, &mut y[first..], first);
            at += ROWS / 2;
        }
        for at in at..count {
            rows::<S, 1>(simd, a, x, &mut y[at * S::F64_LANES..], at * S::F64_LANES);
        }
        // the last rows, some of them once more
        if count * S::F64_LANES < y.len() {
            rows::<S, 1>(simd, a, x, &mut y[last..], last);
        }
        true
    }

    #[inline(always)]
    fn add_columns<S: Simd, const N: usize>(simd: S, a: [&[f64]; N], x: [f64; N], y: &mut [f64]) {
        let (y, y_rest) = S::as_mut_simd_f64s(y);
        let (a, a_rest) = split::<S, N>(a, y.len());
        let mut factors = [simd.splat_f64s(0.0); N];
        for (factor, x) in factors.iter_mut().zip(x) {
            *factor = simd.splat_f64s(x);
        }
        for (k, y) in y.iter_mut().enumerate() {
            let mut sum = *y;
            for i in 0..N {
                sum = simd.mul_add_e_f64s(a[i][k], factors[i], sum);
            }
            *y = sum;
        }
        for (k, y) in y_rest.iter_mut().enumerate() {
            for i in 0..N {
                *y += a_rest[i][k] * x[i];
            }
        }
    }

    /// Two partial sums each, so that the additions do not wait for each other.
    #[inline(always)]
    fn dots<S: Simd, const N: usize>(simd: S, a: [&[f64]; N], x: &[f64]) -> [f64; N] {
        let (x, x_rest) = S::as_simd_f64s(x);
        let (a, a_rest) = split::<S, N>(a, x.len());
        let mut even = [simd.splat_f64s(0.0); N];
        let mut odd = even;
        let mut k = 0;
        while k + 2 <= x.len() {
            for i in 0..N {
                even[i] = simd.mul_add_e_f64s(a[i][k], x[k], even[i]);
                odd[i] = simd.mul_add_e_f64s(a[i][k + 1], x[k + 1], odd[i]);
            }
            k += 2;
        }
        if k < x.len() {
            for i in 0..N {
                even[i] = simd.mul_add_e_f64s(a[i][k], x[k], even[i]);
            }
        }
        let mut sums = [0.0; N];
        for (i, sum) in sums.iter_mut().enumerate() {
            if !x_rest.is_empty() {
                let rest = simd.partial_load_f64s(a_rest[i]);
                odd[i] = simd.mul_add_e_f64s(rest, simd.partial_load_f64s(x_rest), odd[i]);
            }
            *sum = simd.reduce_sum_f64s(simd.add_f64s(even[i], odd[i]));
        }
        sums
    }

    #[inline(always)]
    fn widen<'a>(values: &'a [f64], _: &'a mut [f64]) -> &'a [f64] {
        values
    }
}

/// `N` vectors of rows of `a x`, from row `at` on, into the beginning of `y`.
#[inline(always)]
fn rows<S: Simd, const N: usize>(simd: S, a: MatRef<f64>, x: &[f64], y: &mut [f64], at: usize) {
    let mut sums = [simd.splat_f64s(0.0); N];
    for (j, x) in x.iter().enumerate() {
        let factor = simd.splat_f64s(*x);
        let (vectors, _) = S::as_simd_f64s(&column(a, j)[at..at + N * S::F64_LANES]);
        for i in 0..N {
            sums[i] = simd.mul_add_e_f64s(vectors[i], factor, sums[i]);
        }
    }
    let (y, _) = S::as_mut_simd_f64s(&mut y[..N * S::F64_LANES]);
    y.copy_from_slice(&sums);
}

/// The whole vectors of columns that have `count` of them, and the rows of each that remain.
#[inline(always)]
fn split<S: Simd, const N: usize>(a: [&[f64]; N], count: usize) -> ([&[S::f64s]; N], [&[f64]; N]) {
    let (mut vectors, mut rests): ([&[S::f64s]; N], [&[f64]; N]) = ([&[]; N], [&[]; N]);
    for i in 0..N {
        let (vector, rest) = S::as_simd_f64s(a[i]);
        (vectors[i], rests[i]) = (&vector[..count], rest);
    }
    (vectors, rests)
}

/// `x_p . y_q` of four columns with two, all of the length of the latter.
#[inline(always)]
pub fn tile<S: Simd>(simd: S, x: [&[f64]; 4], y: [&[f64]; 2]) -> [[f64; 4]; 2] {
    let count = S::as_simd_f64s(y[0]).0.len();
    let ([y0, y1], y_rest) = split::<S, 2>(y, count);
    let (x, x_rest) = split::<S, 4>(x, count);
    let mut sums = [[simd.splat_f64s(0.0); 4]; 2];
    for k in 0..count {
        for (column, x) in x.iter().enumerate() {
            sums[0][column] = simd.mul_add_e_f64s(x[k], y0[k], sums[0][column]);
            sums[1][column] = simd.mul_add_e_f64s(x[k], y1[k], sums[1][column]);
        }
    }
    if !y_rest[0].is_empty() {
        let y0 = simd.partial_load_f64s(y_rest[0]);
        let y1 = simd.partial_load_f64s(y_rest[1]);
        for (column, x) in x_rest.iter().enumerate() {
            let x = simd.partial_load_f64s(x);
            sums[0][column] = simd.mul_add_e_f64s(x, y0, sums[0][column]);
            sums[1][column] = simd.mul_add_e_f64s(x, y1, sums[1][column]);
        }
    }
    let mut out = [[0.0; 4]; 2];
    for (out, sums) in out.iter_mut().zip(sums) {
        for (out, sum) in out.iter_mut().zip(sums) {
            *out = simd.reduce_sum_f64s(sum);
        }
    }
    out
}

/// `to += factor * from`.
#[inline(always)]
pub fn add_scaled(to: &mut [f64], factor: f64, from: &[f64]) {
    to.iter_mut().zip(from).for_each(|(t, f)| *t += factor * f);
}

/// `a . b`, over the shorter of the two.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    let (a, b) = (&a[..count], &b[..count]);
    let mut sums = [0.0; LANES];
    let (a_blocks, a_rest) = a.as_chunks::<LANES>();
    let (b_blocks, b_rest) = b.as_chunks::<LANES>();
    for (a, b) in a_blocks.iter().zip(b_blocks) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}
