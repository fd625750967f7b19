//! The loop over the contact that runs at every iteration with two tangential components per node.

use super::law::FrictionLaw;
use super::point::Point;
use super::problem::{ContactProblem, norm};

/// Slip directions and gradient of W of what moves; zeros where a node sticks. Whether something moves, and whether from rest.
#[inline(never)]
pub fn motion<L: FrictionLaw>(
    problem: &ContactProblem<L>,
    point: &Point,
    normal: &mut [f64],
    gradient: &mut [f64],
) -> (bool, bool) {
    let (mut moves, mut starts) = (false, false);
    for node in 0..problem.nodes() {
        let (rate, bound) = (point.rates[node], point.law.bound[node]);
        let at = problem.at(node);
        let (w, y) = (&point.w[at.clone()], &point.y[at.clone()]);
        let (normal, gradient) = (&mut normal[at.clone()], &mut gradient[at]);
        let pull = norm(y);
        if rate == 0.0 && pull <= bound {
            normal.fill(0.0);
            gradient.fill(0.0);
            continue;
        }
        moves = true;
        starts |= rate == 0.0;
        // a node at rest starts against the imbalance
        let (from, length) = if rate > 0.0 { (w, rate) } else { (y, -pull) };
        for (i, from) in from.iter().enumerate() {
            normal[i] = from / length;
            gradient[i] = y[i] + bound * normal[i];
        }
    }
    (moves, starts)
}
