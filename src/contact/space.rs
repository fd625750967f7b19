//! The loops over the contact that run at every iteration with two tangential components per node.
//!
//! A node that hardly moves resists a turn of its slip direction with `g / |w|`, far more than the matrix of a Newton step can
//! hold beside its other entries (see `second_variation`). Its step is taken in magnitude and angle: the force across the
//! direction, divided by `g`, is the angle, however small the slip rate is; added to the velocity itself, the same step would
//! turn the direction by the rounding of the magnitude.

use super::point::Point;
use super::problem::{ContactProblem, SLOWEST, norm};
use super::solve::newton::second_variation::LARGEST_ACROSS;

/// Slip directions and gradient of W at the nodes that move; zeros where a node sticks. Returns whether any node moves, and
/// whether any starts from rest.
#[inline(never)]
pub fn motion(
    problem: &ContactProblem,
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

/// Splits the steps of the nodes that hardly move: what is along the slip direction stays, what is across becomes the tangent of
/// an angle (counter-clockwise, as a share of the slip rate). `turns` is zero at all other nodes.
#[inline(never)]
pub fn split_turns(
    problem: &ContactProblem,
    point: &Point,
    normal: &[f64],
    step: &mut [f64],
    turns: &mut [f64],
) {
    for (node, turn) in turns.iter_mut().enumerate() {
        *turn = 0.0;
        let (rate, bound) = (point.rates[node], point.law.bound[node]);
        let at_hand = LARGEST_ACROSS * problem.stiffness(node);
        if rate == 0.0 || bound <= at_hand * rate {
            continue;
        }
        let ([nx, ny], step) = (
            [normal[2 * node], normal[2 * node + 1]],
            &mut step[problem.at(node)],
        );
        let (along, across) = (step[0] * nx + step[1] * ny, step[1] * nx - step[0] * ny);
        *turn = across * at_hand / bound;
        (step[0], step[1]) = (along * nx, along * ny);
    }
}

/// Velocities at `length` steps from a point.
#[inline(never)]
pub fn advance(point: &Point, length: f64, (step, turns): (&[f64], &[f64]), w: &mut [f64]) {
    let nodes = w.chunks_exact_mut(2).zip(point.w.chunks_exact(2));
    for (node, (new, old)) in nodes.enumerate() {
        let step = &step[2 * node..2 * node + 2];
        for ((new, old), step) in new.iter_mut().zip(old).zip(step) {
            *new = old + length * step;
        }
        let turn = length * turns[node];
        if turn != 0.0 {
            let (x, y, secant) = (new[0], new[1], (1.0 + turn * turn).sqrt());
            (new[0], new[1]) = ((x - turn * y) / secant, (y + turn * x) / secant);
        }
        if norm(new) < SLOWEST {
            new.fill(0.0);
        }
    }
}
