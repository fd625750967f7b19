//! Friction bounds frozen at the last iterate: the problem is then convex, and its solutions lead to one with the bounds that
//! follow from them.

use super::newton::{Budget, Outcome};
use super::problem::{PressedBound, PressedBounds, PressedProblem};
use super::solve::{Chain, SWEEPS};
use crate::contact::SlipPath;

/// Bounds that depend on nothing, N.
struct Frozen<'a>(&'a [f64]);

impl PressedBounds for Frozen<'_> {
    fn evaluate(&self, node: usize, _: f64, _: f64, _: SlipPath) -> PressedBound {
        PressedBound {
            bound: self.0[node],
            ..PressedBound::default()
        }
    }

    fn weakening(&self, _: usize, _: f64) -> f64 {
        0.0
    }
}

/// Convex problems solved in one attempt.
const OUTER: usize = 30;
/// Newton steps for one of them.
const INNER: usize = 20;
/// How exactly they are solved.
const INNER_TOLERANCE: f64 = 1e-6;
/// Change of the bounds, as a share of the largest, at which Newton's method takes over.
const SETTLED: f64 = 1e-3;

/// Solves convex problems, each with the bounds that the last one gives, taken over by the share `relaxation`, until they settle.
/// Whether iterations are left.
pub(super) fn settle(
    problem: &PressedProblem,
    relaxation: f64,
    budget: &mut Budget,
    chain: &mut Chain,
) -> bool {
    let mut bounds = std::mem::take(&mut chain.bounds);
    for (bound, node) in bounds.iter_mut().zip(&chain.newton.accepted.nodes) {
        *bound = node.law.bound;
    }
    for _ in 0..OUTER {
        if budget.left == 0 {
            break;
        }
        chain.work.frozen += 1;
        {
            let frozen = PressedProblem {
                bounds: &Frozen(&bounds),
                ..*problem
            };
            solve_convex(&frozen, budget, chain);
        }
        let newton = &mut chain.newton;
        let (mut change, mut largest) = (0.0_f64, 0.0_f64);
        for (node, bound) in bounds.iter_mut().enumerate() {
            let rate = newton.accepted.nodes[node].rate;
            let force = newton.accepted.f[problem.normal(node)];
            let new = problem.bound(node, rate, force).bound;
            change = change.max((new - *bound).abs());
            largest = largest.max(new);
            *bound += relaxation * (new - *bound);
        }
        let is_settled = change <= SETTLED * largest;
        if is_settled || change.is_nan() {
            break;
        }
    }
    chain.bounds = bounds;
    chain.newton.accepted.project(problem, &chain.newton.slopes);
    budget.left > 0
}

/// Newton's method, and sweeps where it stalls.
fn solve_convex(frozen: &PressedProblem, budget: &mut Budget, chain: &mut Chain) {
    chain.newton.accepted.project(frozen, &chain.newton.slopes);
    let outcome = chain.descend_apart(frozen, INNER_TOLERANCE, INNER, budget);
    if outcome == Outcome::Stalled {
        chain.sweep(frozen, SWEEPS, budget);
        chain.descend_apart(frozen, INNER_TOLERANCE, INNER, budget);
    }
}
