//! Products of matrices stored in single precision, in double arithmetic: plain loops, which a compiler vectorizes for the
//! machine they are dispatched to.

use faer::MatRef;
use pulp::{Arch, Simd, WithSimd};

/// Columns handled together.
const COLUMNS: usize = 4;
/// Partial sums of a dot product.
const LANES: usize = 8;

/// `y = a x`, `a` column-major.
pub fn multiply(a: MatRef<f32>, x: &[f64], y: &mut [f64]) {
    assert_eq!((a.nrows(), a.ncols()), (y.len(), x.len()));
    Arch::new().dispatch(Product { a, x, y });
}

/// `y = a^T x`, `a` column-major.
pub fn multiply_transposed(a: MatRef<f32>, x: &[f64], y: &mut [f64]) {
    assert_eq!((a.nrows(), a.ncols()), (x.len(), y.len()));
    Arch::new().dispatch(DotColumns { a, x, y });
}

/// A column as a slice; all matrices of this crate are column-major.
#[inline(always)]
pub fn column(a: MatRef<'_, f32>, j: usize) -> &[f32] {
    match a.col(j).try_as_col_major() {
        Some(column) => column.as_slice(),
        None => unreachable!("matrices are column-major"),
    }
}

#[inline(always)]
fn columns(a: MatRef<'_, f32>, at: usize) -> [&[f32]; COLUMNS] {
    let mut columns: [&[f32]; COLUMNS] = [&[]; COLUMNS];
    for (i, to) in columns.iter_mut().enumerate() {
        *to = column(a, at + i);
    }
    columns
}

/// `y = a x`.
struct Product<'a> {
    a: MatRef<'a, f32>,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Product { a, x, y } = self;
        y.fill(0.0);
        let (blocks, rest) = x.as_chunks::<COLUMNS>();
        for (block, x) in blocks.iter().enumerate() {
            // sticking nodes make whole blocks of zeros
            if *x != [0.0; COLUMNS] {
                add_columns(columns(a, COLUMNS * block), *x, y);
            }
        }
        for (j, x) in (COLUMNS * blocks.len()..).zip(rest) {
            add_columns([column(a, j)], [*x], y);
        }
    }
}

/// `y += sum_i x_i a_i`.
#[inline(always)]
fn add_columns<const N: usize>(a: [&[f32]; N], x: [f64; N], y: &mut [f64]) {
    let a = a.map(|a| &a[..y.len()]);
    for (k, y) in y.iter_mut().enumerate() {
        let mut sum = *y;
        for i in 0..N {
            sum += f64::from(a[i][k]) * x[i];
        }
        *y = sum;
    }
}

/// `y = a^T x`.
struct DotColumns<'a> {
    a: MatRef<'a, f32>,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl WithSimd for DotColumns<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let DotColumns { a, x, y } = self;
        let (blocks, rest) = y.as_chunks_mut::<COLUMNS>();
        let first_of_rest = COLUMNS * blocks.len();
        for (block, y) in blocks.iter_mut().enumerate() {
            *y = dots(columns(a, COLUMNS * block), x);
        }
        for (j, y) in (first_of_rest..).zip(rest) {
            [*y] = dots([column(a, j)], x);
        }
    }
}

/// `a_i . x`.
#[inline(always)]
fn dots<const N: usize>(a: [&[f32]; N], x: &[f64]) -> [f64; N] {
    let mut sums = [[0.0; LANES]; N];
    let (x, x_rest) = x.as_chunks::<LANES>();
    let mut blocks: [&[[f32; LANES]]; N] = [&[]; N];
    let mut rests: [&[f32]; N] = [&[]; N];
    for i in 0..N {
        let (block, rest) = a[i].as_chunks::<LANES>();
        (blocks[i], rests[i]) = (&block[..x.len()], &rest[..x_rest.len()]);
    }
    for (k, x) in x.iter().enumerate() {
        for i in 0..N {
            for lane in 0..LANES {
                sums[i][lane] += f64::from(blocks[i][k][lane]) * x[lane];
            }
        }
    }
    let mut out = [0.0; N];
    for i in 0..N {
        let rest: f64 = rests[i]
            .iter()
            .zip(x_rest)
            .map(|(a, x)| f64::from(*a) * x)
            .sum();
        out[i] = sums[i].iter().sum::<f64>() + rest;
    }
    out
}
