//! Products of the small dense matrices of a step, on the vector instructions that the machine has.
//!
//! Everything is made of two loops: sums of columns and dot products of columns, both along contiguous memory. They are ours
//! for two reasons. The dispatch of a general product costs more than the small products of a step. And faer's general
//! matrix product (reached from its `matmul`, its Cholesky factorizations and its inverses) keeps, on every thread that
//! ever calls it, a buffer of twice the third-level cache with a destructor: a step would allocate, and an unloaded shared
//! library would stay mapped. So whatever loads, instantiates or steps a compiled reduced model calls this module and
//! `dense`, never faer's product; compiling may.
//!
//! Results depend on the vector width of the machine, never on what ran before.
//!
//! Vector operations stand in plain loops: inside the closure of a `map` they would be compiled without the instructions of
//! the machine and called one by one.

use faer::MatRef;
use pulp::{Arch, Simd, WithSimd};

/// Columns added together, so that the result is read and written once for all of them; columns of a block of dot
/// products, which share the loads of the other factor.
const COLUMNS: usize = 4;
/// Partial sums of a dot product: independent, so that they fill the vector units.
const LANES: usize = 8;
/// Vectors of the result kept in registers while all columns are added.
const ROWS: usize = 8;
/// Entries of a matrix that stays in the first-level cache, where rows far apart in memory cost nothing.
const SMALL: usize = 4096;

/// `y = a x`, `a` column-major. In a large matrix, blocks of columns for which `x` vanishes cost nothing.
pub fn multiply(a: MatRef<f64>, x: &[f64], y: &mut [f64]) {
    assert_eq!((a.nrows(), a.ncols()), (y.len(), x.len()));
    Arch::new().dispatch(Product { a, x, y });
}

/// `y = a^T x`, `a` column-major.
pub fn multiply_transposed(a: MatRef<f64>, x: &[f64], y: &mut [f64]) {
    assert_eq!((a.nrows(), a.ncols()), (x.len(), y.len()));
    Arch::new().dispatch(DotColumns { a, x, y });
}

/// `y = a x`.
struct Product<'a> {
    a: MatRef<'a, f64>,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Product { a, x, y } = self;
        if y.len() * x.len() <= SMALL && y.len() >= S::F64_LANES {
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
            return;
        }
        y.fill(0.0);
        let (blocks, rest) = x.as_chunks::<COLUMNS>();
        for (block, x) in blocks.iter().enumerate() {
            // sticking nodes make whole blocks of zeros
            if *x != [0.0; COLUMNS] {
                add_columns(simd, columns(a, COLUMNS * block), *x, y);
            }
        }
        for (j, x) in (COLUMNS * blocks.len()..).zip(rest) {
            add_columns(simd, [column(a, j)], [*x], y);
        }
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

/// `COLUMNS` columns from `at` on.
#[inline(always)]
fn columns(a: MatRef<'_, f64>, at: usize) -> [&[f64]; COLUMNS] {
    let mut columns: [&[f64]; COLUMNS] = [&[]; COLUMNS];
    for (i, to) in columns.iter_mut().enumerate() {
        *to = column(a, at + i);
    }
    columns
}

/// `y += sum_i x_i a_i`.
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

/// The whole vectors of columns that have `count` of them, and what is left of each.
#[inline(always)]
fn split<S: Simd, const N: usize>(a: [&[f64]; N], count: usize) -> ([&[S::f64s]; N], [&[f64]; N]) {
    let (mut vectors, mut rests): ([&[S::f64s]; N], [&[f64]; N]) = ([&[]; N], [&[]; N]);
    for i in 0..N {
        let (vector, rest) = S::as_simd_f64s(a[i]);
        (vectors[i], rests[i]) = (&vector[..count], rest);
    }
    (vectors, rests)
}

/// `y = a^T x`.
struct DotColumns<'a> {
    a: MatRef<'a, f64>,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl WithSimd for DotColumns<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let DotColumns { a, x, y } = self;
        let (blocks, rest) = y.as_chunks_mut::<COLUMNS>();
        let first_of_rest = COLUMNS * blocks.len();
        for (block, y) in blocks.iter_mut().enumerate() {
            *y = dots(simd, columns(a, COLUMNS * block), x);
        }
        for (j, y) in (first_of_rest..).zip(rest) {
            [*y] = dots(simd, [column(a, j)], x);
        }
    }
}

/// `a_i . x`; two partial sums each, so that the additions do not wait for each other.
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

/// A column as a slice. All matrices of this crate are column-major; the product of another would be a programming error.
#[inline(always)]
pub fn column<'a>(a: MatRef<'a, f64>, j: usize) -> &'a [f64] {
    match a.col(j).try_as_col_major() {
        Some(column) => column.as_slice(),
        None => unreachable!("matrices are column-major"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;

    #[test]
    fn products_agree_with_the_library() {
        for (n, m) in [(1, 1), (3, 9), (17, 8), (32, 133), (40, 5)] {
            let a = Mat::from_fn(n, m, |i, j| ((3 * i + 7 * j) % 13) as f64 - 6.0);
            let x: Vec<f64> = (0..m)
                .map(|j| if j % 5 < 3 { 0.0 } else { j as f64 })
                .collect();
            let z: Vec<f64> = (0..n).map(|i| 1.0 / (1.0 + i as f64)).collect();
            let (mut y, mut t) = (vec![0.0; n], vec![0.0; m]);
            multiply(a.as_ref(), &x, &mut y);
            multiply_transposed(a.as_ref(), &z, &mut t);
            let (ey, et) = (
                &a * faer::ColRef::from_slice(&x),
                a.transpose() * faer::ColRef::from_slice(&z),
            );
            for i in 0..n {
                assert!((y[i] - ey[i]).abs() < 1e-12 * (1.0 + ey[i].abs()));
            }
            for j in 0..m {
                assert!((t[j] - et[j]).abs() < 1e-12 * (1.0 + et[j].abs()));
            }
        }
    }
}
