//! The net under the Newton steps: node by node minimisation of W, which can never increase it.

use crate::contact::point::Point;
use crate::contact::problem::{ContactProblem, norm};
use crate::linalg::{column, dot};

/// Halvings of a move to where a rising bound, linearised, has its minimum, before the node stays where it is.
const HALVINGS: usize = 30;

/// One sweep over the nodes, each minimising W with its bound frozen and the others held. Where the bound grows with the
/// rate it is linearised, and the move shortened until W does not increase. Keeps `y` up to date, not the rest of the point.
pub fn frozen_bound_sweep(problem: &ContactProblem, point: &mut Point) {
    for node in 0..problem.nodes() {
        let at = problem.at(node);
        let stiffness = problem.stiffness(node);
        let rate = norm(&point.w[at.clone()]);
        let mut target = [0.0; 2];
        for (target, i) in target.iter_mut().zip(at.clone()) {
            *target = stiffness * point.w[i] - point.y[i];
        }
        let pull = norm(&target[..problem.components]);
        let law = problem.weighted_law(node, rate);
        let slope = law.slope.max(0.0);
        let bound = law.bound - slope * rate;
        let new_rate = ((pull - bound) / (stiffness + slope)).max(0.0);
        let mut new = [0.0; 2];
        if new_rate > 0.0 {
            new = target.map(|target| new_rate * target / pull);
        }
        if slope > 0.0 {
            let (old, target) = (&point.w[at.clone()], &target[..problem.components]);
            let energy = |w: &[f64]| {
                let potential = problem.weighted_law(node, norm(w)).potential;
                0.5 * stiffness * dot(w, w) - dot(target, w) + potential
            };
            shorten(energy, old, &mut new[..problem.components]);
        }
        for (i, new) in at.zip(new) {
            let change = new - point.w[i];
            if change != 0.0 {
                point.w[i] = new;
                for (y, s) in point.y.iter_mut().zip(column(problem.s, i)) {
                    *y += change * s;
                }
            }
        }
    }
}

/// Moves `new` towards `old` until the energy there is not larger.
fn shorten(energy: impl Fn(&[f64]) -> f64, old: &[f64], new: &mut [f64]) {
    let before = energy(old);
    for _ in 0..HALVINGS {
        if energy(new) <= before {
            return;
        }
        for (new, old) in new.iter_mut().zip(old) {
            *new = 0.5 * (*new + old);
        }
    }
    new.copy_from_slice(old);
}
