//! Loops over the entries of several columns at once, on the vector instructions of the machine.
//!
//! What a loop does with the entries is a closure on vectors; it must be marked `#[inline(always)]`, or it is compiled
//! without those instructions and called vector by vector. Where the length is no multiple of the vector's, the last vector
//! is filled up with zeros.

use super::products::Entry;
use pulp::Simd;

/// Calls `f` with the entries of all columns, which are of equal length.
#[inline(always)]
pub fn visit<S: Simd, const N: usize>(
    simd: S,
    columns: [&[f64]; N],
    mut f: impl FnMut([S::f64s; N]),
) {
    map(
        simd,
        columns,
        [],
        #[inline(always)]
        |values| {
            f(values);
            []
        },
    );
}

/// Fills the columns of `out` with what `f` makes of the entries of `columns`; all are of equal length.
#[inline(always)]
pub fn map<S: Simd, const N: usize, const M: usize>(
    simd: S,
    columns: [&[f64]; N],
    out: [&mut [f64]; M],
    mut f: impl FnMut([S::f64s; N]) -> [S::f64s; M],
) {
    let len = columns[0].len();
    let count = len / S::F64_LANES;
    let zero = simd.splat_f64s(0.0);
    let (mut heads, mut tails): ([&[S::f64s]; N], [&[f64]; N]) = ([&[]; N], [&[]; N]);
    for i in 0..N {
        let (head, tail) = S::as_simd_f64s(&columns[i][..len]);
        (heads[i], tails[i]) = (&head[..count], tail);
    }
    let mut out_heads: [&mut [S::f64s]; M] = std::array::from_fn(|_| Default::default());
    let mut out_tails: [&mut [f64]; M] = std::array::from_fn(|_| Default::default());
    for (i, column) in out.into_iter().enumerate() {
        let (head, tail) = S::as_mut_simd_f64s(&mut column[..len]);
        (out_heads[i], out_tails[i]) = (&mut head[..count], tail);
    }
    let mut values = [zero; N];
    for k in 0..count {
        for i in 0..N {
            values[i] = heads[i][k];
        }
        let results = f(values);
        for i in 0..M {
            out_heads[i][k] = results[i];
        }
    }
    if !tails[0].is_empty() {
        for i in 0..N {
            values[i] = simd.partial_load_f64s(tails[i]);
        }
        let results = f(values);
        for i in 0..M {
            simd.partial_store_f64s(out_tails[i], results[i]);
        }
    }
}

/// `to += factor * from`.
#[inline(always)]
pub fn add_scaled<S: Simd>(simd: S, to: &mut [f64], factor: f64, from: &[f64]) {
    let factor = simd.splat_f64s(factor);
    let (to, to_rest) = S::as_mut_simd_f64s(to);
    let (from, from_rest) = S::as_simd_f64s(from);
    for (to, from) in to.iter_mut().zip(from) {
        *to = simd.mul_add_e_f64s(factor, *from, *to);
    }
    if !to_rest.is_empty() {
        let from = simd.partial_load_f64s(from_rest);
        let sum = simd.mul_add_e_f64s(factor, from, simd.partial_load_f64s(to_rest));
        simd.partial_store_f64s(to_rest, sum);
    }
}

/// `a . b`, over the shorter of the two.
#[inline(always)]
pub fn dot<S: Simd>(simd: S, a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    let [sum] = f64::dots(simd, [&a[..count]], &b[..count]);
    sum
}

/// The larger of two; the first where the second is not a number.
#[inline(always)]
pub fn larger<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
    simd.select_f64s(simd.greater_than_f64s(b, a), b, a)
}
