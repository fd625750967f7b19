//! The last step and the change of the gradient that it made, for a secant (BFGS) correction of the inverse H:
//!
//! ```text
//! B = (1 - s z^T / s.z) H (1 - z s^T / s.z) + s s^T / s.z,   s = step, z = change of the gradient
//! ```
//!
//! One BFGS pair suffices: with an outdated matrix the error that remains is nearly always one slowly converging mode.

use crate::contact::plane::Seen;
use crate::linalg::dot;

/// The pair of the last step.
pub struct Last {
    /// Whether the last step was taken as it was, between the same nodes that move.
    is_known: bool,
    pub step: Vec<f64>,
    /// `S step`.
    pub forces: Vec<f64>,
    pub normal: Vec<f64>,
    pub gradient: Vec<f64>,
    /// Change of the gradient.
    pub change: Vec<f64>,
    /// `step . change`.
    curvature: f64,
    /// `step . gradient`, of the new one.
    progress: f64,
}

impl Last {
    pub fn new(len: usize) -> Last {
        let zeros = || vec![0.0; len];
        Last {
            is_known: false,
            step: zeros(),
            forces: zeros(),
            normal: zeros(),
            gradient: zeros(),
            change: zeros(),
            curvature: 0.0,
            progress: 0.0,
        }
    }

    /// Compares a motion and gradient of `c` components a node with the last ones.
    pub fn compare(
        &mut self,
        c: usize,
        (moves, starts): (bool, bool),
        normal: &[f64],
        gradient: &[f64],
    ) -> Seen {
        let mut motions = normal.chunks_exact(c).zip(self.normal.chunks_exact(c));
        let is_still = |normal: &[f64]| normal.iter().all(|n| *n == 0.0);
        let values = gradient.iter().zip(&self.gradient);
        for (change, (new, old)) in self.change.iter_mut().zip(values) {
            *change = new - old;
        }
        Seen {
            moves,
            starts,
            is_same_set: motions.all(|(a, b)| is_still(a) == is_still(b) && dot(a, b) >= 0.0),
            curvature: dot(&self.step, &self.change),
            progress: dot(&self.step, gradient),
        }
    }

    /// Takes over what was seen at the new point.
    #[inline(always)]
    pub fn look(&mut self, seen: &Seen) {
        self.is_known &= seen.is_same_set && seen.curvature > 0.0;
        (self.curvature, self.progress) = (seen.curvature, seen.progress);
    }

    /// There is no pair until the next step.
    pub fn forget(&mut self) {
        self.is_known = false;
    }

    /// A step was taken, times `length`; its memory is exchanged for that of the last one.
    #[inline(always)]
    pub fn keep(&mut self, step: &mut Vec<f64>, forces: &mut Vec<f64>, length: f64) {
        self.is_known = true;
        std::mem::swap(&mut self.step, step);
        std::mem::swap(&mut self.forces, forces);
        if length != 1.0 {
            self.step.iter_mut().for_each(|s| *s *= length);
            self.forces.iter_mut().for_each(|f| *f *= length);
        }
    }

    /// Share of the change that the gradient loses before the inverse is applied.
    #[inline(always)]
    pub fn share(&self) -> f64 {
        if self.is_known {
            self.progress / self.curvature
        } else {
            0.0
        }
    }

    /// How much of the last step is added after the inverse has given one with this product with the change.
    #[inline(always)]
    pub fn correction(&self, product: f64) -> Option<f64> {
        self.is_known
            .then(|| -(self.progress + product) / self.curvature)
    }
}
