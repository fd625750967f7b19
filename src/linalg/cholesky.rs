//! Cholesky factorization and inverse of symmetric positive definite matrices, in memory of their own.
//!
//! With `A = L L^T` and `Z = L^-T`, `A^-1 = Z Z^T`. By blocks of four columns,
//!
//! ```text
//! L_IJ = (A_IJ - sum_{K<J} L_IK L_JK^T) L_JJ^-T,   Z_IJ = (I_IJ - sum_{K<J} Z_IK L_JK^T) L_JJ^-T,   (A^-1)_IJ = sum_K Z_IK Z_JK^T
//! ```
//!
//! so one loop over columns, with a block of the result in registers, serves all three. An order between multiples of four is
//! filled up with the identity.

use super::tiles::{BLOCK, Corner, for_rows, load, products, store};
use faer::MatMut;
use pulp::{Arch, Simd, WithSimd};

/// Cholesky factorization of symmetric positive definite matrices of any order up to a largest one.
pub struct DenseCholesky {
    /// Lower factor, in columns of `stride`.
    factor: Vec<f64>,
    /// Reciprocals of its diagonal.
    reciprocals: Vec<f64>,
    /// Transposed inverse of the factor.
    inverse: Vec<f64>,
    order: usize,
    /// The order, filled up to whole blocks.
    stride: usize,
    /// Factorizations made so far.
    pub factorizations: u64,
}

impl DenseCholesky {
    /// Room for matrices of order up to `capacity`.
    pub fn new(capacity: usize) -> DenseCholesky {
        let stride = capacity.next_multiple_of(BLOCK);
        DenseCholesky {
            factor: vec![0.0; stride * stride],
            reciprocals: vec![0.0; stride],
            inverse: vec![0.0; stride * stride],
            order: 0,
            stride: 0,
            factorizations: 0,
        }
    }

    /// Factors the matrix of order `order`; `fill(j, column)` writes rows `j..order` of column j, into `column`. False when
    /// the matrix is not positive definite.
    pub fn factor(&mut self, order: usize, mut fill: impl FnMut(usize, &mut [f64])) -> bool {
        self.factorizations += 1;
        self.set_order(order);
        let stride = self.stride;
        for j in 0..order {
            fill(j, &mut self.factor[j * stride..][j..order]);
        }
        Arch::new().dispatch(Factorization {
            factor: &mut self.factor[..stride * stride],
            reciprocals: &mut self.reciprocals[..stride],
        })
    }

    /// Sets the order and the identity that fills it up.
    fn set_order(&mut self, order: usize) {
        (self.order, self.stride) = (order, order.next_multiple_of(BLOCK));
        for j in 0..self.stride {
            let column = &mut self.factor[j * self.stride..][..self.stride];
            if j < order {
                column[order..].fill(0.0);
            } else {
                column.fill(0.0);
                column[j] = 1.0;
                self.reciprocals[j] = 1.0;
            }
        }
    }

    /// Inverse of the matrix just factored, exactly symmetric; the factor is used up.
    pub fn inverse(&mut self, mut out: MatMut<f64>) {
        let (order, stride) = (self.order, self.stride);
        let (factor, inverse) = (
            &mut self.factor[..stride * stride],
            &mut self.inverse[..stride * stride],
        );
        Arch::new().dispatch(Inversion {
            factor,
            reciprocals: &self.reciprocals[..stride],
            inverse,
        });
        for j in 0..order {
            for i in j..order {
                let value = factor[j * stride + i];
                out[(i, j)] = value;
                out[(j, i)] = value;
            }
        }
    }
}

/// `A = L L^T`, in place; false when A is not positive definite.
struct Factorization<'a> {
    factor: &'a mut [f64],
    reciprocals: &'a mut [f64],
}

impl WithSimd for Factorization<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Factorization {
            factor,
            reciprocals,
        } = self;
        let stride = reciprocals.len();
        for j in (0..stride).step_by(BLOCK) {
            // the diagonal block, then what is below it
            for_rows!(S, j, j + BLOCK, |i, R| {
                let a = load::<S, R>(simd, factor, stride, (i, j));
                let mut sums = products::<S, R>(simd, (factor, i), (factor, j), stride, 0..j);
                for (sums, a) in sums.iter_mut().zip(&a) {
                    for (sum, a) in sums.iter_mut().zip(a) {
                        *sum = simd.sub_f64s(*a, *sum);
                    }
                }
                store::<S, R>(&sums, factor, stride, (i, j));
            });
            if !factor_corner(factor, reciprocals, j) {
                return false;
            }
            let corner = Corner::of(factor, reciprocals, j);
            for_rows!(S, j + BLOCK, stride, |i, R| {
                let a = load::<S, R>(simd, factor, stride, (i, j));
                let sums = products::<S, R>(simd, (factor, i), (factor, j), stride, 0..j);
                let x = corner.solve(simd, &a, &sums);
                store::<S, R>(&x, factor, stride, (i, j));
            });
        }
        true
    }
}

/// Factors the diagonal block at `j`, in place.
fn factor_corner(factor: &mut [f64], reciprocals: &mut [f64], j: usize) -> bool {
    let stride = reciprocals.len();
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

/// `Z = L^-T`, upper triangular, and the lower triangle of `Z Z^T` into the memory of L.
struct Inversion<'a> {
    factor: &'a mut [f64],
    reciprocals: &'a [f64],
    inverse: &'a mut [f64],
}

impl WithSimd for Inversion<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Inversion {
            factor,
            reciprocals,
            inverse,
        } = self;
        let stride = reciprocals.len();
        for j in (0..stride).step_by(BLOCK) {
            let corner = Corner::of(factor, reciprocals, j);
            for q in 0..BLOCK {
                let column = &mut inverse[(j + q) * stride + j..(j + q + 1) * stride];
                column.fill(0.0);
                column[q] = 1.0;
            }
            for_rows!(S, j, j + BLOCK, |i, R| {
                let unit = load::<S, R>(simd, inverse, stride, (i, j));
                let zero = [[simd.splat_f64s(0.0); R]; BLOCK];
                let x = corner.solve(simd, &unit, &zero);
                store::<S, R>(&x, inverse, stride, (i, j));
            });
            for_rows!(S, 0, j, |i, R| {
                let first = i / BLOCK * BLOCK;
                let zero = [[simd.splat_f64s(0.0); R]; BLOCK];
                let (z, l) = ((&*inverse, i), (&*factor, j));
                let sums = products::<S, R>(simd, z, l, stride, first..j);
                let x = corner.solve(simd, &zero, &sums);
                store::<S, R>(&x, inverse, stride, (i, j));
            });
        }
        for j in (0..stride).step_by(BLOCK) {
            for_rows!(S, j, stride, |i, R| {
                let first = i / BLOCK * BLOCK;
                let (a, b) = ((&*inverse, i), (&*inverse, j));
                let sums = products::<S, R>(simd, a, b, stride, first..stride);
                store::<S, R>(&sums, factor, stride, (i, j));
            });
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
            let mut inverse = Mat::zeros(m, m);
            cholesky.inverse(inverse.as_mut());
            let product = &a * &inverse;
            for j in 0..m {
                for i in 0..m {
                    let unit = if i == j { 1.0 } else { 0.0 };
                    assert!((product[(i, j)] - unit).abs() < 1e-12);
                    assert_eq!(inverse[(i, j)], inverse[(j, i)]);
                }
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
