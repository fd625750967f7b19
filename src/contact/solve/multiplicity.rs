//! The two-sided start: a cheap test for a second solution of one stage.
//!
//! Where the bound weakens faster than the body can follow, a stage may have several solutions. Starting from the
//! solution with the largest bound of the law everywhere (as much stick as possible; rest, where a bound rises without
//! limit) and from the one with the smallest bound everywhere (as much slip as possible) finds the two extreme ones. It
//! proves multiplicity, never uniqueness.

use super::newton::linearisation::{Linearisation, block_len};
use super::newton::{Workspace, solve};
use crate::contact::bounds::FrozenBounds;
use crate::contact::law::LawBounds;
use crate::contact::problem::ContactProblem;

/// Solutions that differ by less than this share of the largest slip rate are one.
const SAME: f64 = 1e-6;

/// What the test found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Multiplicity {
    /// Different solutions, the accepted one included.
    pub solutions: usize,
    /// Largest difference in slip rate to the accepted one, m/s.
    pub gap: f64,
}

/// Scratch of the test.
pub struct MultiplicityWorkspace {
    candidates: [Vec<f64>; 2],
    bounds: Vec<f64>,
    blocks: Vec<f64>,
    newton: Workspace,
}

impl MultiplicityWorkspace {
    pub fn new(nodes: usize, contact_len: usize) -> MultiplicityWorkspace {
        MultiplicityWorkspace {
            candidates: [vec![0.0; contact_len], vec![0.0; contact_len]],
            bounds: vec![0.0; nodes],
            blocks: vec![0.0; nodes * block_len(contact_len / nodes)],
            newton: Workspace::new(nodes, contact_len),
        }
    }
}

/// Looks for solutions other than `accepted` of a problem with the bounds of `law`.
pub fn test(
    problem: &ContactProblem,
    law: &LawBounds,
    tolerance: f64,
    max_iterations: usize,
    accepted: &[f64],
    ws: &mut MultiplicityWorkspace,
) -> Multiplicity {
    let mut found = Multiplicity {
        solutions: 1,
        gap: 0.0,
    };
    let largest = accepted.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    for at in 0..2 {
        for (node, bound) in ws.bounds.iter_mut().enumerate() {
            *bound = law.extremes(node)[at];
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
        let scale = w.iter().fold(largest, |m, v| m.max(v.abs()));
        let gap = difference(w, accepted);
        let is_new = gap > SAME * scale
            && before
                .iter()
                .all(|other| difference(w, other) > SAME * scale);
        if is_new {
            found.solutions += 1;
        }
        found.gap = found.gap.max(gap);
    }
    found
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()))
}
