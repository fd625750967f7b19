//! The tangent of the contact problem at its solution.
//!
//! With `d` for the derivative, `n` the slip direction, `g'` the slope of the bound by the slip rate and `g_s` by the
//! accumulated slip `s`:
//!
//! ```text
//! sticking nodes:  dw = 0
//! slipping nodes:  (S + D) dw = dr - omega g_s ds n,   D = omega [g' n n^T + (g / |w|) (I - n n^T)]
//! forces:          dLambda = dr - S dw where a node sticks, D dw + omega g_s ds n where it slips
//! ```

use crate::contact::problem::{ContactProblem, norm};
use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};

/// The tangent of the friction problem at its solution.
pub(crate) struct FrictionTangent {
    components: usize,
    /// Places of the slipping components.
    free: Vec<usize>,
    /// Slip directions, all components; zero where nothing slips.
    direction: Vec<f64>,
    /// `omega g_s` of every node.
    slip_slope: Vec<f64>,
    /// D of the slipping nodes, in the order of their places.
    blocks: Vec<[[f64; 2]; 2]>,
    factor: Option<PartialPivLu<f64>>,
}

impl FrictionTangent {
    pub fn new(problem: &ContactProblem, w: &[f64]) -> FrictionTangent {
        let c = problem.components;
        let mut free = Vec::new();
        let mut direction = vec![0.0; w.len()];
        let mut slip_slope = vec![0.0; problem.nodes()];
        // D, block by block of the slipping nodes
        let mut blocks: Vec<[[f64; 2]; 2]> = Vec::new();
        for (node, slip_slope) in slip_slope.iter_mut().enumerate() {
            let at = node * c;
            let rate = norm(&w[at..at + c]);
            // without a bound at rest a node at rest does not stick
            if rate == 0.0 && problem.bound_at_rest(node) > 0.0 {
                continue;
            }
            let path = problem.slip_path(node);
            let weight = problem.weights[node];
            let along = weight * problem.law.evaluate(node, rate, path).slope;
            let mut n = [0.0; 2];
            let mut across = 0.0;
            if rate > 0.0 {
                *slip_slope = weight * problem.law.slip_slope(node, rate, path);
                across = problem.weighted_law(node, rate).bound / rate;
                for p in 0..c {
                    n[p] = w[at + p] / rate;
                    direction[at + p] = n[p];
                }
            }
            // a node at rest without a bound has no direction: what rises with the slip rate resists in all
            if rate == 0.0 {
                across = along;
            }
            let entry = |p: usize, q: usize| {
                let identity = f64::from(u8::from(p == q));
                along * n[p] * n[q] + across * (identity - n[p] * n[q])
            };
            blocks.push([[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]);
            free.extend(at..at + c);
        }
        let matrix = || {
            Mat::from_fn(free.len(), free.len(), |i, j| {
                let coupling = problem.s[(free[i], free[j])];
                let is_same_node = i / c == j / c;
                coupling
                    + if is_same_node {
                        blocks[i / c][i % c][j % c]
                    } else {
                        0.0
                    }
            })
        };
        let factor = (!free.is_empty()).then(|| matrix().partial_piv_lu());
        FrictionTangent {
            components: c,
            free,
            direction,
            slip_slope,
            blocks,
            factor,
        }
    }

    /// Derivatives of slip rates and of their magnitudes, from those of the condensed load and of the accumulated slip.
    pub fn apply(&self, dr: &[f64], slip: &[f64], dw: &mut [f64], magnitude: &mut [f64]) {
        let c = self.components;
        dw.fill(0.0);
        if let Some(factor) = &self.factor {
            let mut column = Mat::from_fn(self.free.len(), 1, |i, _| {
                let at = self.free[i];
                let node = at / c;
                dr[at] - self.slip_slope[node] * slip[node] * self.direction[at]
            });
            factor.solve_in_place(&mut column);
            for (i, &at) in self.free.iter().enumerate() {
                dw[at] = column[(i, 0)];
            }
        }
        let nodes = dw.chunks_exact(c).zip(self.direction.chunks_exact(c));
        for (magnitude, (dw, n)) in magnitude.iter_mut().zip(nodes) {
            *magnitude = dw.iter().zip(n).map(|(a, b)| a * b).sum();
        }
    }
    /// Derivatives of the contact forces of the law, from those of slip rates, accumulated slip and forces of balance.
    pub fn forces(&self, dw: &[f64], slip: &[f64], reaction: &[f64], force: &mut [f64]) {
        let c = self.components;
        force.copy_from_slice(reaction);
        for (free, block) in self.free.chunks_exact(c).zip(&self.blocks) {
            let (first, node) = (free[0], free[0] / c);
            for (p, row) in block.iter().enumerate().take(c) {
                let own = self.slip_slope[node] * slip[node] * self.direction[first + p];
                let along = row.iter().zip(&dw[first..first + c]);
                force[first + p] = own + along.map(|(d, dw)| d * dw).sum::<f64>();
            }
        }
    }
}
