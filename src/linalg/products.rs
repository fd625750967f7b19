//! Products of the small dense matrices of a step, on the vector instructions that the machine has.
//!
//! Everything is made of two loops: sums of columns and dot products of columns, both along contiguous memory, for entries of
//! either precision (see `double`, `single`). They are ours
//! for two reasons. The dispatch of a general product costs more than the small products of a step. And faer's general
//! matrix product (reached from its `matmul`, its Cholesky factorizations and its inverses) keeps, on every thread that
//! ever calls it, a buffer of twice the third-level cache with a destructor: a step would allocate, and an unloaded shared
//! library would stay mapped. So whatever loads, instantiates or steps a compiled reduced model calls this module and
//! `cholesky`, never faer's product; compiling may.
//!
//! Results depend on the vector width of the machine, never on what ran before.

use faer::MatRef;
use pulp::{Arch, Simd, WithSimd};

/// Columns added together, so that the result is read and written once for all of them; columns of a block of dot
/// products, which share the loads of the other factor.
const COLUMNS: usize = 4;

/// What a matrix is made of; all arithmetic is double.
pub trait Entry: Copy + Default + 'static {
    /// `y = a x`, if the matrix is small enough for a loop of its own; whether it was.
    #[inline(always)]
    fn multiply_small<S: Simd>(_: S, _: MatRef<Self>, _: &[f64], _: &mut [f64]) -> bool {
        false
    }

    /// `y += sum_i x_i a_i`.
    fn add_columns<S: Simd, const N: usize>(simd: S, a: [&[Self]; N], x: [f64; N], y: &mut [f64]);

    /// `a_i . x`.
    fn dots<S: Simd, const N: usize>(simd: S, a: [&[Self]; N], x: &[f64]) -> [f64; N];

    /// The same values in double precision: themselves, or converted into `buffer`, which is long enough.
    fn widen<'a>(values: &'a [Self], buffer: &'a mut [f64]) -> &'a [f64];
}

/// `y = a x`, `a` column-major. In a large matrix, blocks of columns for which `x` vanishes cost nothing.
pub fn multiply<T: Entry>(a: MatRef<T>, x: &[f64], y: &mut [f64]) {
    assert_eq!((a.nrows(), a.ncols()), (y.len(), x.len()));
    Arch::new().dispatch(Product { a, x, y });
}

/// `y = a^T x`, `a` column-major.
pub fn multiply_transposed<T: Entry>(a: MatRef<T>, x: &[f64], y: &mut [f64]) {
    assert_eq!((a.nrows(), a.ncols()), (x.len(), y.len()));
    Arch::new().dispatch(DotColumns { a, x, y });
}

/// `y = a x` of a symmetric matrix of which only the lower half is read. Blocks of columns for which `x` vanishes cost nothing, and
/// their rows of `y` are then without meaning.
pub fn multiply_lower<T: Entry>(a: MatRef<T>, x: &[f64], y: &mut [f64]) {
    assert_eq!((a.nrows(), a.ncols()), (y.len(), x.len()));
    Arch::new().dispatch(LowerProduct { a, x, y });
}

/// A column as a slice. All matrices of this crate are column-major; the product of another would be a programming error.
#[inline(always)]
pub fn column<T>(a: MatRef<'_, T>, j: usize) -> &[T] {
    match a.col(j).try_as_col_major() {
        Some(column) => column.as_slice(),
        None => unreachable!("matrices are column-major"),
    }
}

/// `COLUMNS` columns from `at` on.
#[inline(always)]
fn columns<T>(a: MatRef<'_, T>, at: usize) -> [&[T]; COLUMNS] {
    let mut columns: [&[T]; COLUMNS] = [&[]; COLUMNS];
    for (i, to) in columns.iter_mut().enumerate() {
        *to = column(a, at + i);
    }
    columns
}

/// `y = a x`.
struct Product<'a, T> {
    a: MatRef<'a, T>,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl<T: Entry> WithSimd for Product<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Product { a, x, y } = self;
        if T::multiply_small(simd, a, x, y) {
            return;
        }
        y.fill(0.0);
        let (blocks, rest) = x.as_chunks::<COLUMNS>();
        for (block, x) in blocks.iter().enumerate() {
            // sticking nodes make whole blocks of zeros
            if *x != [0.0; COLUMNS] {
                T::add_columns(simd, columns(a, COLUMNS * block), *x, y);
            }
        }
        for (j, x) in (COLUMNS * blocks.len()..).zip(rest) {
            T::add_columns(simd, [column(a, j)], [*x], y);
        }
    }
}

/// `y = a x` from the lower half.
struct LowerProduct<'a, T> {
    a: MatRef<'a, T>,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl<T: Entry> WithSimd for LowerProduct<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let LowerProduct { a, x, y } = self;
        y.fill(0.0);
        for first in (0..x.len()).step_by(COLUMNS) {
            let below = x.len().min(first + COLUMNS);
            let own = &x[first..below];
            if own.iter().all(|x| *x == 0.0) {
                continue;
            }
            for j in first..below {
                let column = &column(a, j)[..below];
                T::add_columns(simd, [&column[j..]], [x[j]], &mut y[j..below]);
                let [sum] = T::dots(simd, [&column[j + 1..]], &x[j + 1..below]);
                y[j] += sum;
            }
            let Ok(factors) = <[f64; COLUMNS]>::try_from(own) else {
                continue;
            };
            let tails = columns(a, first).map(|column| &column[below..]);
            let (head, tail) = y.split_at_mut(below);
            T::add_columns(simd, tails, factors, tail);
            let sums = T::dots(simd, tails, &x[below..]);
            for (y, sum) in head[first..].iter_mut().zip(sums) {
                *y += sum;
            }
        }
    }
}

/// `y = a^T x`.
struct DotColumns<'a, T> {
    a: MatRef<'a, T>,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl<T: Entry> WithSimd for DotColumns<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let DotColumns { a, x, y } = self;
        let (blocks, rest) = y.as_chunks_mut::<COLUMNS>();
        let first_of_rest = COLUMNS * blocks.len();
        for (block, y) in blocks.iter_mut().enumerate() {
            *y = T::dots(simd, columns(a, COLUMNS * block), x);
        }
        for (j, y) in (first_of_rest..).zip(rest) {
            [*y] = T::dots(simd, [column(a, j)], x);
        }
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
            let symmetric = Mat::from_fn(n, n, |i, j| ((i * j + i + j) % 7) as f64 - 3.0);
            let mut halves = vec![0.0; n];
            multiply_lower(symmetric.as_ref(), &z, &mut halves);
            let whole = &symmetric * faer::ColRef::from_slice(&z);
            let single = Mat::from_fn(n, n, |i, j| symmetric[(i, j)] as f32);
            let mut of_single = vec![0.0; n];
            multiply_lower(single.as_ref(), &z, &mut of_single);
            for i in 0..n {
                assert!((halves[i] - whole[i]).abs() < 1e-12 * (1.0 + whole[i].abs()));
                // its entries are exact in single precision
                assert!((of_single[i] - whole[i]).abs() < 1e-12 * (1.0 + whole[i].abs()));
            }
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
