//! LU factorization with partial pivoting of matrices without symmetry, in memory of their own.
//!
//! `P A = L U` by blocks of four columns; an order between whole blocks is filled up with the identity. The loops run along
//! columns, which are contiguous, on the vector instructions that the machine has.

use super::products::Entry;
use pulp::{Arch, Simd, WithSimd};

/// Columns of a block.
const BLOCK: usize = 4;
/// Columns this many numbers apart, or a multiple, share their places in a cache.
const CONFLICT: usize = 32;

/// LU factorization of matrices of any order up to a largest one.
pub struct DenseLu {
    /// L below the diagonal (its diagonal is 1), U above and on it, by columns.
    factor: Vec<f64>,
    /// The row that was exchanged with row j before column j was eliminated.
    pivots: Vec<usize>,
    order: usize,
    /// Distance of the columns.
    stride: usize,
}

impl DenseLu {
    /// Room for matrices of order up to `capacity`.
    pub fn new(capacity: usize) -> DenseLu {
        let padded = DenseLu::padded(capacity);
        DenseLu {
            factor: vec![0.0; stride(padded) * padded],
            pivots: vec![0; padded],
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
        DenseLu::padded(self.order)
    }

    /// Factors the matrix of order `order`; `fill(j, column)` writes column j. False when a pivot is zero or not finite.
    pub fn factor(&mut self, order: usize, mut fill: impl FnMut(usize, &mut [f64])) -> bool {
        let padded = DenseLu::padded(order);
        (self.order, self.stride) = (order, stride(padded));
        for j in 0..padded {
            let column = &mut self.factor[j * self.stride..][..padded];
            if j < order {
                fill(j, &mut column[..order]);
                column[order..].fill(0.0);
            } else {
                column.fill(0.0);
                column[j] = 1.0;
            }
        }
        Arch::new().dispatch(Elimination {
            factor: &mut self.factor,
            pivots: &mut self.pivots[..padded],
            stride: self.stride,
        })
    }

    /// Sign of the determinant of the matrix just factored.
    pub fn sign(&self) -> f64 {
        let rows = self.pivots[..self.padded_order()].iter().enumerate();
        rows.fold(1.0, |sign, (j, pivot)| {
            let is_exchanged = *pivot != j;
            let is_negative = self.factor[j * self.stride + j] < 0.0;
            if is_exchanged == is_negative {
                sign
            } else {
                -sign
            }
        })
    }

    /// Solves with the matrix just factored; `x`, of padded length, is the right-hand side and becomes the solution.
    pub fn solve(&self, x: &mut [f64]) {
        assert_eq!(x.len(), self.padded_order());
        for (j, pivot) in self.pivots[..x.len()].iter().enumerate() {
            x.swap(j, *pivot);
        }
        Arch::new().dispatch(Substitution {
            factor: &self.factor,
            stride: self.stride,
            x,
        });
    }
}

/// Distance of the columns of a matrix of this padded order.
fn stride(padded: usize) -> usize {
    if padded.is_multiple_of(CONFLICT) {
        padded + 2 * BLOCK
    } else {
        padded
    }
}

/// `P A = L U` in place.
struct Elimination<'a> {
    factor: &'a mut [f64],
    pivots: &'a mut [usize],
    stride: usize,
}

impl WithSimd for Elimination<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Elimination {
            factor,
            pivots,
            stride,
        } = self;
        let order = pivots.len();
        for first in (0..order).step_by(BLOCK) {
            let (head, trailing) = factor.split_at_mut((first + BLOCK) * stride);
            let (done, panel) = head.split_at_mut(first * stride);
            let chosen = &mut pivots[first..first + BLOCK];
            if !eliminate_panel(simd, panel, chosen, stride, first, order) {
                return false;
            }
            let chosen = &pivots[first..first + BLOCK];
            for column in done.chunks_exact_mut(stride) {
                exchange(column, chosen, first);
            }
            let columns = &mut trailing[..(order - first - BLOCK) * stride];
            for pair in columns.chunks_exact_mut(2 * stride) {
                let (one, other) = pair.split_at_mut(stride);
                let pair = [&mut one[..order], &mut other[..order]];
                update(simd, panel, stride, pair, chosen, first);
            }
        }
        true
    }
}

/// Eliminates the four columns of a panel, which holds rows from 0 on; false where there is no pivot.
#[inline(always)]
fn eliminate_panel<S: Simd>(
    simd: S,
    panel: &mut [f64],
    pivots: &mut [usize],
    stride: usize,
    first: usize,
    order: usize,
) -> bool {
    for q in 0..BLOCK {
        let row = first + q;
        let column = &panel[q * stride..][..order];
        let (mut pivot, mut largest) = (row, 0.0);
        for (i, value) in column.iter().enumerate().skip(row) {
            // not a number is taken, so that it is found
            if value.abs() > largest || value.is_nan() {
                (pivot, largest) = (i, value.abs());
            }
        }
        if !(largest > 0.0 && largest.is_finite()) {
            return false;
        }
        pivots[q] = pivot;
        if pivot != row {
            for column in panel.chunks_exact_mut(stride) {
                column.swap(row, pivot);
            }
        }
        let (left, right) = panel.split_at_mut((q + 1) * stride);
        let column = &mut left[q * stride..][..order];
        let value = column[row];
        column[row + 1..].iter_mut().for_each(|l| *l /= value);
        let l = &left[q * stride..][row + 1..order];
        for other in right.chunks_exact_mut(stride) {
            let factor = -other[row];
            f64::add_columns(simd, [l], [factor], &mut other[row + 1..order]);
        }
    }
    true
}

/// Exchanges the rows of a column as a panel has.
#[inline(always)]
fn exchange(column: &mut [f64], pivots: &[usize], first: usize) {
    for (q, pivot) in pivots.iter().enumerate() {
        column.swap(first + q, *pivot);
    }
}

/// Takes the four columns of a panel out of two columns behind it.
#[inline(always)]
fn update<S: Simd>(
    simd: S,
    panel: &[f64],
    stride: usize,
    mut pair: [&mut [f64]; 2],
    pivots: &[usize],
    first: usize,
) {
    let mut factors = [[0.0; BLOCK]; 2];
    for (column, factors) in pair.iter_mut().zip(&mut factors) {
        exchange(column, pivots, first);
        for q in 0..BLOCK {
            let u = column[first + q];
            factors[q] = -u;
            for p in q + 1..BLOCK {
                column[first + p] -= panel[q * stride + first + p] * u;
            }
        }
    }
    let [one, other] = pair;
    let rows = first + BLOCK..one.len();
    let l: [&[f64]; BLOCK] = std::array::from_fn(|q| &panel[q * stride..][rows.clone()]);
    add_to_both(simd, l, factors, [&mut one[rows.clone()], &mut other[rows]]);
}

/// `y_p += sum_q x_pq a_q`, with one reading of the columns for both.
#[inline(always)]
fn add_to_both<S: Simd>(
    simd: S,
    a: [&[f64]; BLOCK],
    x: [[f64; BLOCK]; 2],
    [one, other]: [&mut [f64]; 2],
) {
    let len = one.len();
    let (one, one_rest) = S::as_mut_simd_f64s(one);
    let (other, other_rest) = S::as_mut_simd_f64s(other);
    let mut columns: [&[S::f64s]; BLOCK] = [&[]; BLOCK];
    let mut factors = [[simd.splat_f64s(0.0); BLOCK]; 2];
    for q in 0..BLOCK {
        columns[q] = &S::as_simd_f64s(a[q]).0[..one.len()];
        for p in 0..2 {
            factors[p][q] = simd.splat_f64s(x[p][q]);
        }
    }
    let done = len - one_rest.len();
    for (k, (one, other)) in one.iter_mut().zip(other).enumerate() {
        let (mut s, mut t) = (*one, *other);
        for q in 0..BLOCK {
            s = simd.mul_add_e_f64s(columns[q][k], factors[0][q], s);
            t = simd.mul_add_e_f64s(columns[q][k], factors[1][q], t);
        }
        (*one, *other) = (s, t);
    }
    for (k, (one, other)) in one_rest.iter_mut().zip(other_rest).enumerate() {
        for q in 0..BLOCK {
            *one += a[q][done + k] * x[0][q];
            *other += a[q][done + k] * x[1][q];
        }
    }
}

/// `x := U^-1 L^-1 x`.
struct Substitution<'a> {
    factor: &'a [f64],
    stride: usize,
    x: &'a mut [f64],
}

impl WithSimd for Substitution<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Substitution { factor, stride, x } = self;
        let order = x.len();
        let column = |j: usize| &factor[j * stride..][..order];
        for first in (0..order).step_by(BLOCK) {
            let (head, tail) = x.split_at_mut(first + BLOCK);
            let head = &mut head[first..];
            for q in 0..BLOCK {
                let l = &column(first + q)[first..];
                for p in q + 1..BLOCK {
                    head[p] -= l[p] * head[q];
                }
            }
            let below: [&[f64]; BLOCK] =
                std::array::from_fn(|q| &column(first + q)[first + BLOCK..]);
            let factors: [f64; BLOCK] = std::array::from_fn(|q| -head[q]);
            f64::add_columns(simd, below, factors, tail);
        }
        for first in (0..order).step_by(BLOCK).rev() {
            let (above, block) = x.split_at_mut(first);
            let block = &mut block[..BLOCK];
            for q in (0..BLOCK).rev() {
                let u = &column(first + q)[first..];
                block[q] /= u[q];
                for p in 0..q {
                    block[p] -= u[p] * block[q];
                }
            }
            let columns: [&[f64]; BLOCK] = std::array::from_fn(|q| &column(first + q)[..first]);
            let factors: [f64; BLOCK] = std::array::from_fn(|q| -block[q]);
            f64::add_columns(simd, columns, factors, above);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries between -1/2 and 1/2 without a pattern.
    fn noise(i: usize, j: usize) -> f64 {
        ((i * 7919 + j * 104_729 + 13 * i * j) % 1009) as f64 / 1009.0 - 0.5
    }

    #[test]
    fn solutions_satisfy_their_equations() {
        let mut lu = DenseLu::new(70);
        for order in [1, 2, 3, 4, 5, 8, 9, 31, 32, 33, 70, 1] {
            // a zero diagonal asks for pivots
            let a = |i: usize, j: usize| if i == j { 0.0 } else { noise(i, j) };
            let a = |i, j| if order == 1 { -3.0 } else { a(i, j) };
            assert!(lu.factor(order, |j, column| {
                for (i, entry) in column.iter_mut().enumerate() {
                    *entry = a(i, j);
                }
            }));
            let mut x = vec![0.0; lu.padded_order()];
            for (i, x) in x[..order].iter_mut().enumerate() {
                *x = noise(i, 3);
            }
            lu.solve(&mut x);
            assert!(x[order..].iter().all(|x| *x == 0.0));
            let scale = x.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
            for i in 0..order {
                let product: f64 = (0..order).map(|j| a(i, j) * x[j]).sum();
                let error = (product - noise(i, 3)).abs();
                assert!(error < 1e-13 * scale * order as f64, "{order}: {error:e}");
            }
        }
    }

    #[test]
    fn the_sign_is_that_of_the_determinant() {
        let mut lu = DenseLu::new(6);
        // permutations of six rows, each with its sign, and one row negative
        for (rows, sign) in [
            ([0, 1, 2, 3, 4, 5], 1.0),
            ([1, 0, 2, 3, 4, 5], -1.0),
            ([1, 2, 0, 3, 4, 5], 1.0),
            ([5, 4, 3, 2, 1, 0], -1.0),
            ([1, 2, 3, 4, 5, 0], -1.0),
        ] {
            for factor in [2.0, -2.0] {
                assert!(lu.factor(6, |j, column| {
                    for (i, entry) in column.iter_mut().enumerate() {
                        let value = if rows[i] == j { 3.0 } else { 0.1 };
                        *entry = if i == 2 { factor * value } else { value };
                    }
                }));
                assert_eq!(lu.sign(), sign * f64::signum(factor), "{rows:?}");
            }
        }
    }

    #[test]
    fn what_has_no_pivot_is_refused() {
        let mut lu = DenseLu::new(6);
        for bad in [0.0, f64::NAN, f64::INFINITY] {
            for at in 0..6 {
                assert!(!lu.factor(6, |j, column| {
                    column.fill(0.0);
                    column[j] = if j == at { bad } else { 1.0 };
                }));
            }
        }
        // two equal columns
        assert!(!lu.factor(2, |_, column| column.copy_from_slice(&[1.0, 2.0])));
    }
}
