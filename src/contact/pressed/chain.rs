//! What all ways to a solution share: Newton's method, sweeps, and what they leave to each other.

use super::linearisation::{PressedPoint, points_len};
use super::newton::{Budget, Newton, Outcome};
use super::point::Point;
use super::problem::PressedProblem;
use super::sweep::sweep;
use crate::linalg::multiply;

/// Sweeps before Newton's method is tried again; every further time twice as many.
pub(super) const SWEEPS: usize = 60;
/// Sweeps that count as one iteration: about as long as a Newton step takes.
const SWEEPS_OF_ITERATION: usize = 10;
/// Work done so far in a workspace.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PressedWork {
    /// Newton steps, those with other bounds on the way included.
    pub newton: u64,
    /// Matrices factored.
    pub factorizations: u64,
    /// Solves with a factor.
    pub solves: u64,
    /// Sweeps over the nodes.
    pub sweeps: u64,
    /// Convex problems with frozen bounds.
    pub frozen: u64,
    /// Problems with a share of the friction.
    pub raised: u64,
}

/// The iteration, and what the ways back need.
pub(super) struct Chain {
    pub newton: Newton,
    /// Frozen bounds.
    pub bounds: Vec<f64>,
    /// Memory of a point of linearisation that no state keeps.
    pub apart: Vec<f64>,
    /// `S v` of the sweeps.
    forces: Vec<f64>,
    /// The point of the least imbalance where Newton's method stalled.
    pub best: Point,
    /// Where sweeps led.
    pub swept: Point,
    pub work: PressedWork,
}

impl Chain {
    /// For `nodes` nodes of `components` tangential components each.
    pub fn new(nodes: usize, components: usize) -> Chain {
        let len = nodes * (components + 1);
        Chain {
            newton: Newton::new(nodes, components),
            bounds: vec![0.0; nodes],
            apart: vec![0.0; points_len(nodes, components)],
            forces: vec![0.0; len],
            best: Point::new(nodes, len),
            swept: Point::new(nodes, len),
            work: PressedWork::default(),
        }
    }

    /// Newton's method with a point of linearisation that no state keeps.
    pub fn descend_apart(
        &mut self,
        problem: &PressedProblem,
        tolerance: f64,
        most: usize,
        budget: &mut Budget,
    ) -> Outcome {
        let mut at = PressedPoint::fresh(&mut self.apart, problem);
        self.newton
            .descend(problem, tolerance, most, budget, &mut at)
    }

    /// Some sweeps.
    pub fn sweep(&mut self, problem: &PressedProblem, count: usize, budget: &mut Budget) {
        let point = &mut self.newton.accepted;
        multiply(problem.s, &point.v, &mut self.forces);
        for sweep_count in 0..count {
            if sweep_count.is_multiple_of(SWEEPS_OF_ITERATION) && !budget.take() {
                break;
            }
            self.work.sweeps += 1;
            sweep(problem, point, &mut self.forces);
        }
        point.project(problem, &self.newton.slopes);
    }
}
