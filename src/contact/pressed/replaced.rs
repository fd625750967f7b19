//! Problems with other friction bounds on the way to the one that is asked: frozen ones, and weaker ones.

use super::chain::{Chain, SWEEPS};
use super::newton::{Budget, Outcome};
use super::problem::{PressedBound, PressedBounds, PressedProblem};
use crate::contact::SlipPath;

/// Bounds that depend on nothing, N.
pub(super) struct Frozen<'a>(pub &'a [f64]);

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

/// A share of other bounds.
struct Share<'a> {
    of: &'a dyn PressedBounds,
    share: f64,
}

impl PressedBounds for Share<'_> {
    fn evaluate(&self, node: usize, rate: f64, force: f64, slip: SlipPath) -> PressedBound {
        let whole = self.of.evaluate(node, rate, force, slip);
        PressedBound {
            bound: self.share * whole.bound,
            by_rate: self.share * whole.by_rate,
            by_force: self.share * whole.by_force,
        }
    }

    fn weakening(&self, node: usize, force: f64) -> f64 {
        self.share * self.of.weakening(node, force)
    }
}

/// Convex problems solved in one attempt.
const OUTER: usize = 30;
/// Newton steps for one replaced problem.
const INNER: usize = 20;
/// How exactly replaced problems are solved.
const INNER_TOLERANCE: f64 = 1e-6;
/// Steps in which friction is raised.
const RISES: u32 = 8;

/// Solves convex problems, each with the bounds that the last one gives, taken over by the share `relaxation`, until
/// they change by less than the share `settled` of the largest.
pub(super) fn settle(
    problem: &PressedProblem,
    relaxation: f64,
    settled: f64,
    budget: &mut Budget,
    chain: &mut Chain,
) {
    let mut bounds = std::mem::take(&mut chain.bounds);
    for (bound, node) in bounds.iter_mut().zip(&chain.newton.accepted.nodes) {
        *bound = node.law.bound;
    }
    for _ in 0..OUTER {
        if budget.is_used_up() {
            break;
        }
        chain.work.frozen += 1;
        approach(problem, &Frozen(&bounds), budget, chain);
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
        let is_settled = change <= settled * largest;
        if is_settled || change.is_nan() {
            break;
        }
    }
    chain.bounds = bounds;
    chain.newton.accepted.project(problem, &chain.newton.slopes);
}

/// Raises friction in steps from none to the whole.
pub(super) fn raise(problem: &PressedProblem, budget: &mut Budget, chain: &mut Chain) {
    for step in 0..RISES {
        if budget.is_used_up() {
            break;
        }
        chain.work.raised += 1;
        let bounds = Share {
            of: problem.bounds,
            share: f64::from(step) / f64::from(RISES),
        };
        approach(problem, &bounds, budget, chain);
    }
    chain.newton.accepted.project(problem, &chain.newton.slopes);
}

/// Newton's method for a problem with other bounds, and sweeps where it stalls.
fn approach(
    problem: &PressedProblem,
    bounds: &dyn PressedBounds,
    budget: &mut Budget,
    chain: &mut Chain,
) {
    let replaced = PressedProblem { bounds, ..*problem };
    chain
        .newton
        .accepted
        .project(&replaced, &chain.newton.slopes);
    let descend = |chain: &mut Chain, budget: &mut Budget| {
        chain.descend_apart(&replaced, INNER_TOLERANCE, INNER, budget)
    };
    if descend(chain, budget) == Outcome::Stalled {
        chain.sweep(&replaced, SWEEPS, budget);
        descend(chain, budget);
    }
}
