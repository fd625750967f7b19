//! The numbers that a program is evaluated with: plain ones, and dual ones that carry derivatives along.

use super::function::{BinaryFunction, UnaryFunction};

/// What a program computes with.
pub trait Number: Copy {
    fn constant(value: f64) -> Self;
    fn negated(self) -> Self;
    fn unary(self, function: &UnaryFunction) -> Self;
    fn binary(self, other: Self, function: &BinaryFunction) -> Self;
}

impl Number for f64 {
    fn constant(value: f64) -> f64 {
        value
    }

    fn negated(self) -> f64 {
        -self
    }

    fn unary(self, function: &UnaryFunction) -> f64 {
        (function.value)(self)
    }

    fn binary(self, other: f64, function: &BinaryFunction) -> f64 {
        (function.value)(self, other)
    }
}

/// A value with its derivatives by N variables.
#[derive(Debug, Clone, Copy)]
pub struct Dual<const N: usize> {
    pub value: f64,
    pub slopes: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// A variable; one beyond the first N is a constant.
    pub fn variable(value: f64, place: usize) -> Dual<N> {
        let mut slopes = [0.0; N];
        if let Some(own) = slopes.get_mut(place) {
            *own = 1.0;
        }
        Dual { value, slopes }
    }
}

/// A product in which what does not depend on a variable stays independent, however steep the factor.
fn times(slope: f64, own: f64) -> f64 {
    if own == 0.0 { 0.0 } else { slope * own }
}

impl<const N: usize> Number for Dual<N> {
    fn constant(value: f64) -> Dual<N> {
        Dual {
            value,
            slopes: [0.0; N],
        }
    }

    fn negated(self) -> Dual<N> {
        Dual {
            value: -self.value,
            slopes: self.slopes.map(|slope| -slope),
        }
    }

    fn unary(self, function: &UnaryFunction) -> Dual<N> {
        let value = (function.value)(self.value);
        let slope = (function.slope)(self.value, value);
        Dual {
            value,
            slopes: self.slopes.map(|own| times(slope, own)),
        }
    }

    fn binary(self, other: Dual<N>, function: &BinaryFunction) -> Dual<N> {
        let value = (function.value)(self.value, other.value);
        let [first, second] = (function.slopes)(self.value, other.value, value);
        let mut slopes = self.slopes;
        for (own, other) in slopes.iter_mut().zip(other.slopes) {
            *own = times(first, *own) + times(second, other);
        }
        Dual { value, slopes }
    }
}
