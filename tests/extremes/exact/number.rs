//! Binary floating point of 320 bits with an exponent that does not overflow.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

type Big = FBig<HalfEven, 2>;

/// Bits of the significand: 96 decimal digits.
const BITS: usize = 320;

#[derive(Debug, Clone, PartialEq)]
pub struct Real(Big);

impl Real {
    /// The value of a finite double, exactly.
    pub fn new(value: f64) -> Real {
        let exact = Big::try_from(value).expect("a finite number");
        Real(exact.with_precision(BITS).value())
    }

    pub fn zero() -> Real {
        Real::new(0.0)
    }

    pub fn double(&self) -> f64 {
        self.0.to_f64().value()
    }

    pub fn is_zero(&self) -> bool {
        self.0 == Big::ZERO
    }

    pub fn sqrt(&self) -> Real {
        if self.is_zero() {
            return Real::zero();
        }
        Real(self.0.sqrt())
    }

    /// `exp(x) - 1`, for x <= 0.
    pub fn exp_m1(&self) -> Real {
        // below this the exponential is nothing beside 1
        if self.double() < -1000.0 {
            return Real::new(-1.0);
        }
        if self.is_zero() {
            return Real::zero();
        }
        Real(self.0.exp_m1())
    }

    /// Of a number below 0; nothing below -1000, where it is no double either.
    pub fn exp(&self) -> Real {
        if self.double() < -1000.0 {
            return Real::zero();
        }
        Real(self.0.exp())
    }

    pub fn abs(&self) -> Real {
        if *self < Real::zero() {
            -self
        } else {
            self.clone()
        }
    }
}

impl PartialOrd for Real {
    fn partial_cmp(&self, other: &Real) -> Option<Ordering> {
        self.0.partial_cmp(&other.0)
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl $trait<&Real> for &Real {
            type Output = Real;
            fn $method(self, other: &Real) -> Real {
                Real($trait::$method(&self.0, &other.0))
            }
        }
        impl $trait<Real> for &Real {
            type Output = Real;
            fn $method(self, other: Real) -> Real {
                $trait::$method(self, &other)
            }
        }
        impl $trait<&Real> for Real {
            type Output = Real;
            fn $method(self, other: &Real) -> Real {
                $trait::$method(&self, other)
            }
        }
        impl $trait<Real> for Real {
            type Output = Real;
            fn $method(self, other: Real) -> Real {
                $trait::$method(&self, &other)
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for &Real {
    type Output = Real;
    fn neg(self) -> Real {
        &Real::zero() - self
    }
}

/// `sum of a_i b_i`; zeros cost nothing.
pub fn dot(a: &[Real], b: &[Real]) -> Real {
    let mut sum = Real::zero();
    for (x, y) in a.iter().zip(b) {
        if !x.is_zero() && !y.is_zero() {
            sum = sum + x * y;
        }
    }
    sum
}

/// A dense matrix by rows.
pub type Matrix = Vec<Vec<Real>>;

pub fn zeros(rows: usize, columns: usize) -> Matrix {
    vec![vec![Real::zero(); columns]; rows]
}

/// Solves `matrix X = right` for the columns of `right` by elimination; the matrix is symmetric and positive definite, or
/// at least needs no other pivots than its diagonal. `None` for a pivot that vanishes.
pub fn solve(mut matrix: Matrix, mut right: Matrix) -> Option<Matrix> {
    let n = matrix.len();
    for k in 0..n {
        if matrix[k][k].is_zero() {
            return None;
        }
        let (upper, lower) = matrix.split_at_mut(k + 1);
        let pivot = &upper[k];
        let (right_upper, right_lower) = right.split_at_mut(k + 1);
        for (row, right) in lower.iter_mut().zip(right_lower) {
            if row[k].is_zero() {
                continue;
            }
            let factor = &row[k] / &pivot[k];
            for j in k..n {
                if !pivot[j].is_zero() {
                    row[j] = &row[j] - &factor * &pivot[j];
                }
            }
            for (x, p) in right.iter_mut().zip(&right_upper[k]) {
                if !p.is_zero() {
                    *x = &*x - &factor * p;
                }
            }
        }
    }
    for k in (0..n).rev() {
        let (head, tail) = right.split_at_mut(k + 1);
        for (c, x) in head[k].iter_mut().enumerate() {
            for (j, known) in tail.iter().enumerate() {
                let a = &matrix[k][k + 1 + j];
                if !a.is_zero() && !known[c].is_zero() {
                    *x = &*x - a * &known[c];
                }
            }
            *x = &*x / &matrix[k][k];
        }
    }
    Some(right)
}
