//! The two-sided start: a cheap test for a second solution of one stage.
//!
//! Where the bound weakens faster than the body can follow, a stage may have several solutions. Starting from the
//! solution with the largest bound of the law everywhere (as much stick as possible; rest, where a bound rises without
//! limit) and from the one with the smallest bound everywhere (as much slip as possible) finds the two extreme ones. It
//! proves multiplicity, never uniqueness.

use super::newton::linearisation::{Linearisation, block_len};
use super::newton::{Workspace, solve};
use crate::contact::bounds::FrozenBounds;
use crate::contact::multiplicity::Multiplicity;
use crate::contact::problem::ContactProblem;

/// Scratch of the test.
pub struct MultiplicityWorkspace {
    candidates: [Vec<f64>; 2],
    bounds: Vec<f64>,
    blocks: Vec<f64>,
    newton: Workspace,
}

impl MultiplicityWorkspace {
    pub fn new(points: &[[f64; 3]], contact_len: usize) -> MultiplicityWorkspace {
        let nodes = points.len();
        MultiplicityWorkspace {
            candidates: [vec![0.0; contact_len], vec![0.0; contact_len]],
            bounds: vec![0.0; nodes],
            blocks: vec![0.0; nodes * block_len(contact_len / nodes)],
            newton: Workspace::new(points, contact_len),
        }
    }
}

/// Looks for solutions other than `accepted` of a problem whose law has these largest and smallest bounds at every node, Pa.
pub fn test(
    problem: &ContactProblem,
    extremes: impl Fn(usize) -> [f64; 2],
    tolerance: f64,
    max_iterations: usize,
    accepted: &[f64],
    ws: &mut MultiplicityWorkspace,
) -> Multiplicity {
    let mut found = Multiplicity::ONE;
    for at in 0..2 {
        for (node, bound) in ws.bounds.iter_mut().enumerate() {
            *bound = extremes(node)[at];
        }
        let is_rest = ws.bounds.iter().any(|bound| bound.is_infinite());
        let (before, rest) = ws.candidates.split_at_mut(at);
        let w = &mut rest[0];
        w.fill(0.0);
        let frozen = ContactProblem {
            s: problem.s,
            r: problem.r,
            components: problem.components,
            weights: problem.weights,
            law: &FrozenBounds(&ws.bounds),
            slip_base: problem.slip_base,
            theta_k: problem.theta_k,
        };
        let mut at = Linearisation::fresh(&mut ws.blocks, problem.theta_k);
        let mut converges = |problem: &ContactProblem, w: &mut [f64]| {
            let newton = &mut ws.newton;
            solve(problem, tolerance, max_iterations, w, &mut at, newton).converged
        };
        let has_start = is_rest || converges(&frozen, w);
        if !(converges(problem, w) && has_start) {
            continue;
        }
        found.count(w, accepted, before.iter().map(Vec::as_slice));
    }
    found
}
