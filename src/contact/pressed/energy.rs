//! The imbalance of a point in the norm of the motion it is worth.
//!
//! An imbalance F moves the free contact by `S^-1 F`, and `(F S^-1 F)^1/2` is its length. Where S is stiff against some
//! motions only (a body that hardly changes its volume), the plain length of F sees these alone: a step that is right for all
//! others looks bad, and is halved to nothing. This length judges all motions by the same measure.

use super::problem::PressedProblem;
use crate::linalg::{DenseCholesky, dot};

/// Share by which the diagonal of S is raised: a body that nothing but its contact holds has an S without inverse.
const RELIEF: f64 = 1e-10;

/// The factor of S for the problems of one key, made when it is first asked for; never changes a result.
pub(super) struct Energy {
    factor: DenseCholesky,
    key: Option<[u64; 2]>,
    force: Vec<f64>,
    half: Vec<f64>,
    motion: Vec<f64>,
}

impl Energy {
    pub fn new(len: usize) -> Energy {
        let padded = vec![0.0; DenseCholesky::padded(len)];
        Energy {
            factor: DenseCholesky::new(len),
            key: None,
            force: padded.clone(),
            half: padded.clone(),
            motion: padded,
        }
    }

    /// Forgets the factor: the problems to come have another S.
    pub fn forget(&mut self) {
        self.key = None;
    }

    /// Makes the factor for the problem; false where S has none.
    pub fn prepare(&mut self, problem: &PressedProblem) -> bool {
        let key = [problem.theta_k, problem.gap_rate].map(f64::to_bits);
        if self.key == Some(key) {
            return true;
        }
        let is_made = self.factor.factor(problem.r.len(), |j, column| {
            column.copy_from_slice(&problem.column(j)[j..]);
            column[0] *= 1.0 + RELIEF;
        });
        if is_made {
            self.factor.prepare_solves();
        }
        self.key = is_made.then_some(key);
        is_made
    }

    /// Length of an imbalance, (N m/s)^1/2; NaN where it is not a number.
    pub fn length(&mut self, imbalance: &[f64]) -> f64 {
        let largest = imbalance.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
        let is_number = imbalance.iter().all(|f| f.is_finite());
        if largest == 0.0 || !is_number {
            return if is_number { 0.0 } else { f64::NAN };
        }
        let padded = self.factor.padded_order();
        let [force, half, motion] =
            [&mut self.force, &mut self.half, &mut self.motion].map(|x| &mut x[..padded]);
        force[imbalance.len()..].fill(0.0);
        for (scaled, f) in force.iter_mut().zip(imbalance) {
            *scaled = f / largest;
        }
        self.factor.solve_lower(force, half);
        self.factor.solve_upper(half, motion);
        largest * dot(force, motion).max(0.0).sqrt()
    }
}
