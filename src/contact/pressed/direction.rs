//! The Newton step of a point, with what a sticking or closed node does eliminated.
//!
//! A sticking node has no tangential velocity and a closed one none in the normal direction; their forces follow from their own
//! rows. So the unknowns are the slip rates (in space also the turns of the directions) and the normal velocities of open or
//! yielding nodes, and the matrix is that of those rows, with the normal forces put into the bounds:
//!
//! ```text
//! (S dv)_t + B_p (S dv)_n + B_r dr = -(F_t + B_p F_n),   dp = F_n + (S dv)_n
//! (S dv)_n + K dv_n = -F_n,                              dp = -K dv_n          F = S v + [lam; -p] - r
//! ```

use super::entries::{Entries, Unknown, entries_of, reduce};
use super::linearisation::Factor;
use super::point::Point;
use super::problem::PressedProblem;
use crate::linalg::multiply;

/// The last Newton step and scratch for it.
pub(super) struct Direction {
    /// Change of the velocities.
    pub dv: Vec<f64>,
    /// Change of the forces.
    pub df: Vec<f64>,
    solution: Vec<f64>,
    /// `S dv`.
    forces: Vec<f64>,
    /// Solves with a factor made so far.
    pub solves: u64,
}

impl Direction {
    pub fn new(len: usize) -> Direction {
        Direction {
            dv: vec![0.0; len],
            df: vec![0.0; len],
            solution: vec![0.0; crate::linalg::DenseLu::padded(len)],
            forces: vec![0.0; len],
            solves: 0,
        }
    }

    /// The step of `point` with the factor of the matrix there, or of one with other slopes.
    pub fn find(&mut self, problem: &PressedProblem, point: &Point, factor: &mut Factor) {
        self.solves += 1;
        let c = problem.components;
        let Direction {
            dv, df, solution, ..
        } = self;
        dv.fill(0.0);
        df.fill(0.0);
        let right = |node: usize, kind: Unknown| {
            let entries = entries_of(c, &point.nodes[node]);
            let entries = Entries::new(&entries);
            -reduce(problem, entries, node, kind, &point.imbalance)
        };
        factor.solve(solution, right, |node, kind, value| {
            let entries = entries_of(c, &point.nodes[node]);
            let entries = Entries::new(&entries);
            // what is not unknown any more does not change
            if !entries.has(c, kind) {
                return;
            }
            let first = problem.at(node).start;
            match (kind, c) {
                (Unknown::Normal, _) => dv[first + c] = value,
                (_, 1) => {
                    dv[first] = value;
                    df[first] = entries.by_rate() * value;
                }
                (kind, _) => {
                    let [x, y] = entries.direction();
                    let ([x, y], [velocity, force]) = match kind {
                        Unknown::Across => ([-y, x], entries.turn()),
                        _ => ([x, y], [1.0, entries.by_rate()]),
                    };
                    dv[first] += velocity * value * x;
                    dv[first + 1] += velocity * value * y;
                    df[first] += force * value * x;
                    df[first + 1] += force * value * y;
                }
            }
        });
        multiply(problem.s, &self.dv, &mut self.forces);
        for node in 0..problem.nodes() {
            self.find_forces(problem, point, node);
        }
    }

    /// The changes of the forces of a node that its velocity does not tell.
    fn find_forces(&mut self, problem: &PressedProblem, point: &Point, node: usize) {
        let c = problem.components;
        let entries = entries_of(c, &point.nodes[node]);
        let entries = Entries::new(&entries);
        let n = problem.normal(node);
        let change = if entries.is_free() {
            -entries.fall() * self.dv[n]
        } else {
            point.imbalance[n] + self.forces[n]
        };
        self.df[n] = change;
        let tangential = problem.tangential(node);
        if !entries.slips() {
            for i in tangential {
                self.df[i] = -(point.imbalance[i] + self.forces[i]);
            }
        } else if c == 1 {
            self.df[tangential.start] += entries.by_force() * change;
        } else {
            for (i, direction) in tangential.zip(entries.direction()) {
                self.df[i] += entries.by_force() * change * direction;
            }
        }
    }
}
