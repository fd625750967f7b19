//! The net under the Newton steps: node by node minimisation of W, which can never increase it.

use crate::contact::law::FrictionLaw;
use crate::contact::point::Point;
use crate::contact::problem::{ContactProblem, norm};
use crate::linalg::column;

/// One sweep over the nodes, each minimising W with its bound frozen (or, where the bound grows with the rate,
/// linearised) and the others held. Keeps `y` up to date, not the rest of the point.
pub fn frozen_bound_sweep<L: FrictionLaw>(problem: &ContactProblem<L>, point: &mut Point) {
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
        for (i, target) in at.zip(target) {
            let new = if new_rate > 0.0 {
                new_rate * target / pull
            } else {
                0.0
            };
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
