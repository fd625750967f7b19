//! Where rounding ends a solve.

use super::linearisation::Linearisation;
use super::{Workspace, find};
use crate::contact::point::Point;
use crate::contact::problem::{ContactProblem, SLOWEST};
use pulp::Scalar;

/// The residual that is left where rounding allows for no less; see [`ContactProblem::residual_beyond_rounding`].
#[inline(never)]
pub(super) fn at_rounding(
    problem: &ContactProblem,
    tolerance: f64,
    ws: &mut Workspace,
) -> Option<f64> {
    if !ws.accepted.is_exact {
        problem.make_exact(&mut ws.accepted);
        ws.is_careful = true;
    }
    problem.residual_beyond_rounding(&ws.accepted, ws.yardstick, tolerance)
}

/// The residual that is left where steps no longer change the slip rates; see [`ContactProblem::residual_of_slip`].
#[inline(never)]
pub(super) fn at_rounding_of_slip(
    problem: &ContactProblem,
    tolerance: f64,
    at: &mut Linearisation,
    ws: &mut Workspace,
) -> Option<f64> {
    if !ws.accepted.is_exact {
        problem.make_exact(&mut ws.accepted);
        ws.is_careful = true;
    }
    ws.direction.note(None);
    if !find(Scalar, problem, 0, at, ws) || ws.direction.is_majorised {
        return None;
    }
    let direction = &ws.direction;
    let changes = (&*direction.step, &*direction.turns);
    problem.residual_of_slip(&ws.accepted, changes, ws.yardstick, tolerance)
}

/// Nodes so slow that underflow takes digits from their slip rate are at rest.
pub(super) fn rest_the_slowest(problem: &ContactProblem, point: &mut Point) {
    let is_slow = |rate: f64| rate > 0.0 && rate < SLOWEST;
    if point.rates.iter().any(|rate| is_slow(*rate)) {
        for node in 0..problem.nodes() {
            if is_slow(point.rates[node]) {
                point.rates[node] = 0.0;
                point.w[problem.at(node)].fill(0.0);
            }
        }
    }
}
