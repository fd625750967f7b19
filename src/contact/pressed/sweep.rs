//! Sweeps over the nodes: each is brought into balance with the others held. Slow and hard to lead astray.

use super::node::{project_normal, project_tangential};
use super::point::Point;
use super::problem::PressedProblem;
use crate::contact::problem::norm;
use crate::linalg::{add_scaled, dot};

/// Turns between the normal and the tangential balance of a node.
const TURNS: usize = 4;

/// One sweep. Keeps velocities and forces, and in `forces` the product `S v`.
pub(super) fn sweep(problem: &PressedProblem, point: &mut Point, forces: &mut [f64]) {
    let c = problem.components;
    for node in 0..problem.nodes() {
        let at = problem.at(node);
        let (first, n) = (at.start, problem.normal(node));
        let resistance = [problem.resistance(node), problem.s[(n, n)]];
        let mut local = [0.0; 3];
        let mut v = [0.0; 3];
        for (k, i) in at.clone().enumerate() {
            local[k] = forces[i] - problem.r[i];
            v[k] = point.v[i];
        }
        let old = v;
        let moved = |local: &mut [f64; 3], k: usize, change: f64| {
            for (q, local) in local[..=c].iter_mut().enumerate() {
                *local += problem.s[(first + q, first + k)] * change;
            }
        };
        for _ in 0..TURNS {
            let before = v;
            let open = v[c] - local[c] / resistance[1];
            let normal = project_normal(problem, node, resistance[1], open, 0.0);
            moved(&mut local, c, normal.velocity - v[c]);
            v[c] = normal.velocity;
            point.f[n] = normal.force;
            let mut z = [0.0; 2];
            for k in 0..c {
                z[k] = resistance[0] * v[k] - local[k];
            }
            let pull = norm(&z[..c]);
            let directions = z.map(|z| if pull > 0.0 { z / pull } else { 0.0 });
            let along = |x: &[f64; 3]| dot(&x[..c], &directions[..c]);
            let own = (along(&v), 0.0 - along(&local));
            let friction =
                project_tangential(problem, node, resistance[0], pull, normal.force, own);
            let rate = friction.rate;
            for (k, direction) in directions[..c].iter().enumerate() {
                let new = rate * direction;
                moved(&mut local, k, new - v[k]);
                v[k] = new;
                let force = if friction.slips {
                    friction.law.bound
                } else {
                    pull
                };
                point.f[first + k] = force * direction;
            }
            if v == before {
                break;
            }
        }
        for (k, i) in at.enumerate() {
            let change = v[k] - old[k];
            if change != 0.0 {
                point.v[i] = v[k];
                add_scaled(forces, change, problem.column(i));
            }
        }
    }
}
