//! The functionals phi(y, v) and j(u, v), convex in v.
//!
//! Both have one form, with a linear part and convex functions of parts of v ([`Part`]):
//!
//! ```text
//! phi(y, v) = b(y) . v + sum_i c_i(y) rho_i(v_i),     j(u, v) = sum_i d_i(u) rho_i(v_i),     c_i, d_i >= 0
//! ```
//!
//! phi is asked at `[y_1, ..., y_M]`, the values of the history operators. j is asked at `[u, y_1, ..., y_M]`: beyond the paper it may
//! also depend on the history, as a friction bound of slip rate and slip does. What a functional says at a given first argument is
//! frozen while the inequality is solved in v.

use super::Matrix;
use nalgebra::DVector;

/// The linear part b of phi as far as one history operator goes.
pub enum Linear<'a> {
    /// b does not depend on it.
    Zero,
    /// b has the summand `B y_i`.
    Matrix(&'a Matrix),
    /// b depends on it in another way; the solvers then iterate this part.
    Nonlinear,
}

/// phi or j.
pub trait Functional {
    /// Adds the linear part at `at` to `force` and the coefficients of the parts, each >= 0, to `coefficients`.
    fn freeze(&self, at: &[DVector<f64>], force: &mut DVector<f64>, coefficients: &mut [f64]);

    /// The linear part as far as history operator `i` goes; of phi only.
    fn linear(&self, _i: usize) -> Linear<'_> {
        Linear::Zero
    }

    /// alpha of (2.4) for phi, beta of (2.5) for j, where it is known. That of a phi with a linear part alone is computed.
    fn lipschitz(&self) -> Option<f64> {
        None
    }

    /// Whether all coefficients vanish.
    fn is_linear(&self) -> bool {
        false
    }
}

/// No functional at all.
#[derive(Debug, Clone, Copy)]
pub struct Nothing;

impl Functional for Nothing {
    fn freeze(&self, _: &[DVector<f64>], _: &mut DVector<f64>, _: &mut [f64]) {}

    fn lipschitz(&self) -> Option<f64> {
        Some(0.0)
    }

    fn is_linear(&self) -> bool {
        true
    }
}

/// `phi(y, v) = sum_i (B_i y_i) . v`; `None` for a history operator that it does not contain.
#[derive(Debug, Clone)]
pub struct LinearPhi(pub Vec<Option<Matrix>>);

impl Functional for LinearPhi {
    fn freeze(&self, at: &[DVector<f64>], force: &mut DVector<f64>, _: &mut [f64]) {
        for (matrix, y) in self.0.iter().zip(at) {
            if let Some(matrix) = matrix {
                *force += matrix.apply(y);
            }
        }
    }

    fn linear(&self, i: usize) -> Linear<'_> {
        match self.0.get(i) {
            Some(Some(matrix)) => Linear::Matrix(matrix),
            _ => Linear::Zero,
        }
    }

    fn is_linear(&self) -> bool {
        true
    }
}

/// Coefficients given by a function, without a linear part.
pub struct Coefficients<F> {
    of: F,
    lipschitz: f64,
}

impl<F: Fn(&[DVector<f64>], &mut [f64])> Coefficients<F> {
    /// `of(at, coefficients)` adds to the coefficients; `lipschitz` is alpha or beta.
    pub fn new(lipschitz: f64, of: F) -> Coefficients<F> {
        Coefficients { of, lipschitz }
    }
}

impl<F: Fn(&[DVector<f64>], &mut [f64])> Functional for Coefficients<F> {
    fn freeze(&self, at: &[DVector<f64>], _: &mut DVector<f64>, coefficients: &mut [f64]) {
        (self.of)(at, coefficients);
    }

    fn lipschitz(&self) -> Option<f64> {
        Some(self.lipschitz)
    }
}

/// The sum of two functionals.
pub struct Sum<F, G>(pub F, pub G);

impl<F: Functional, G: Functional> Functional for Sum<F, G> {
    fn freeze(&self, at: &[DVector<f64>], force: &mut DVector<f64>, coefficients: &mut [f64]) {
        self.0.freeze(at, force, coefficients);
        self.1.freeze(at, force, coefficients);
    }

    fn linear(&self, i: usize) -> Linear<'_> {
        match (self.0.linear(i), self.1.linear(i)) {
            (found, Linear::Zero) | (Linear::Zero, found) => found,
            _ => Linear::Nonlinear,
        }
    }

    fn lipschitz(&self) -> Option<f64> {
        Some(self.0.lipschitz()? + self.1.lipschitz()?)
    }

    fn is_linear(&self) -> bool {
        self.0.is_linear() && self.1.is_linear()
    }
}

/// A convex function rho of some components of v, nonnegative, with `rho(0) = 0`, and its proximal map.
pub trait Shape {
    /// `rho(v)`.
    fn value(&self, v: &[f64]) -> f64;

    /// Replaces v by the minimiser of `|x - v|^2 / 2 + t rho(x)`, t >= 0.
    fn prox(&self, t: f64, v: &mut [f64]);
}

/// `rho(v) = |v|`: friction.
#[derive(Debug, Clone, Copy)]
pub struct Norm;

impl Shape for Norm {
    fn value(&self, v: &[f64]) -> f64 {
        norm(v)
    }

    fn prox(&self, t: f64, v: &mut [f64]) {
        let length = norm(v);
        if length <= t {
            v.fill(0.0);
        } else if let [v] = v {
            // exact where the subtraction is
            *v -= v.signum() * t;
        } else {
            v.iter_mut().for_each(|v| *v *= 1.0 - t / length);
        }
    }
}

/// `rho(v) = sum of the positive parts`: a resistance that acts in one direction.
#[derive(Debug, Clone, Copy)]
pub struct PositivePart;

impl Shape for PositivePart {
    fn value(&self, v: &[f64]) -> f64 {
        v.iter().map(|v| v.max(0.0)).sum()
    }

    fn prox(&self, t: f64, v: &mut [f64]) {
        for v in v {
            if *v > 0.0 {
                *v = (*v - t).max(0.0);
            }
        }
    }
}

fn norm(v: &[f64]) -> f64 {
    match v {
        [v] => v.abs(),
        v => v.iter().map(|v| v * v).sum::<f64>().sqrt(),
    }
}

/// Some consecutive components of v and the convex function of them. Parts do not overlap.
pub struct Part {
    pub components: std::ops::Range<usize>,
    pub shape: Box<dyn Shape>,
}

impl Part {
    /// Friction on these components.
    pub fn friction(components: std::ops::Range<usize>) -> Part {
        Part {
            components,
            shape: Box::new(Norm),
        }
    }

    /// Friction on every component by itself.
    pub fn each(dimension: usize) -> Vec<Part> {
        (0..dimension).map(|i| Part::friction(i..i + 1)).collect()
    }
}
