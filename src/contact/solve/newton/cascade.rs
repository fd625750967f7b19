//! Fronts between stick and slip that move over many nodes: the contact problem on ever fewer nodes.
//!
//! A Newton step frees the nodes whose force exceeds the bound; next to a front between stick and slip these are one or two.
//! Where the body is thin or the contact has many nodes, a front that has to move over `n` nodes therefore takes about `n`
//! iterations. On every second node it takes half as many: with `P` the linear interpolation along the contact,
//!
//! ```text
//! S_c = P^T S P,   r_c = P^T r,   omega_c = P^T omega
//! ```
//!
//! is a contact problem with the same law. The nodes are halved down to [`COARSEST`]; from there up every problem is solved
//! roughly from the interpolated solution of the one before (a cascade: F. Bornemann and P. Deuflhard, Numer. Math. 75, 1996).
//! The result is a trial point: it is accepted only when the step energy W decreases.
//!
//! Only for one tangential component per node: there the nodes are ordered along the contact.

use super::linearisation::{Linearisation, block_len};
use crate::contact::bounds::Bounds;
use crate::contact::evaluation::{Evaluation, NodalLaw, Nodes, SlipPath};
use crate::contact::problem::ContactProblem;
use crate::contact::solve::newton::{Workspace, solve};
use crate::linalg::column;
use faer::{Mat, MatRef};

/// Nodes of the smallest problem at least, half of them at most.
const COARSEST: usize = 24;
/// Residual to which the problems are solved: the next one changes the solution far more.
const TOLERANCE: f64 = 1e-3;
const MAX_ITERATIONS: usize = 60;

/// The contact on every second node of the one above it.
struct Level {
    s: Mat<f64>,
    r: Vec<f64>,
    weights: Vec<f64>,
    slip_base: Vec<f64>,
    /// Every node in the numbering of the whole contact.
    nodes: Vec<usize>,
    w: Vec<f64>,
    /// Point of linearisation.
    blocks: Vec<f64>,
    newton: Workspace,
}

/// The problems on fewer nodes, the largest first; none where the contact is small.
pub struct Cascade {
    levels: Vec<Level>,
}

/// The law of the whole contact, at some of its nodes.
struct Sampled<'a> {
    law: &'a dyn Bounds,
    nodes: &'a [usize],
}

impl Bounds for Sampled<'_> {
    fn evaluate(&self, node: usize, rate: f64, slip: SlipPath) -> Evaluation {
        self.law.evaluate(self.nodes[node], rate, slip)
    }

    fn at_rest(&self, node: usize, slip: SlipPath) -> f64 {
        self.law.at_rest(self.nodes[node], slip)
    }

    fn slip_slope(&self, node: usize, rate: f64, slip: SlipPath) -> f64 {
        self.law.slip_slope(self.nodes[node], rate, slip)
    }

    fn fill(&self, nodes: Nodes, out: &mut NodalLaw) {
        out.fill(nodes, |node, rate, slip| self.evaluate(node, rate, slip));
    }

    fn largest_at_rest(&self, nodes: Nodes) -> f64 {
        let bounds = nodes.weights.iter().enumerate().map(|(node, weight)| {
            let slip = SlipPath {
                base: nodes.slip_base[node],
                per_rate: nodes.per_rate,
            };
            weight * self.at_rest(node, slip)
        });
        bounds.fold(0.0, f64::max)
    }
}

/// A problem and its velocities, to be taken onto fewer nodes.
struct Above<'a> {
    s: MatRef<'a, f64>,
    r: &'a [f64],
    weights: &'a [f64],
    slip_base: &'a [f64],
    w: &'a [f64],
}

/// Node of the finer problem at a node, of those `count`: the last one is always among them.
fn finer(node: usize, count: usize) -> usize {
    2 * node + usize::from(count.is_multiple_of(2))
}

/// The nodes of the finer problem, of those `count`, that a node stands for, with their shares: itself and half of its
/// neighbours.
fn shares(node: usize, count: usize) -> impl Iterator<Item = (usize, f64)> {
    let at = finer(node, count);
    let before = at.checked_sub(1).map(|left| (left, 0.5));
    let after = (at + 1 < count).then_some((at + 1, 0.5));
    before.into_iter().chain([(at, 1.0)]).chain(after)
}

impl Level {
    fn new(above: &[usize]) -> Level {
        let count = above.len().div_ceil(2);
        let nodes = (0..count).map(|node| above[finer(node, above.len())]);
        Level {
            s: Mat::zeros(count, count),
            r: vec![0.0; count],
            weights: vec![0.0; count],
            slip_base: vec![0.0; count],
            nodes: nodes.collect(),
            w: vec![0.0; count],
            blocks: vec![0.0; count * block_len(1)],
            newton: Workspace::of_level(count),
        }
    }

    fn as_above(&self) -> Above<'_> {
        Above {
            s: self.s.as_ref(),
            r: &self.r,
            weights: &self.weights,
            slip_base: &self.slip_base,
            w: &self.w,
        }
    }

    /// Takes the problem above and its velocities onto the nodes of this level.
    fn restrict(&mut self, above: Above) {
        let count = above.w.len();
        for j in 0..self.w.len() {
            let (mut r, mut weight) = (0.0, 0.0);
            for (node, share) in shares(j, count) {
                r += share * above.r[node];
                weight += share * above.weights[node];
            }
            (self.r[j], self.weights[j]) = (r, weight);
            let at = finer(j, count);
            (self.w[j], self.slip_base[j]) = (above.w[at], above.slip_base[at]);
            for i in j..self.w.len() {
                let mut sum = 0.0;
                for (column_node, share) in shares(j, count) {
                    let entries = column(above.s, column_node);
                    let rows = shares(i, count).map(|(node, own)| own * entries[node]);
                    sum += share * rows.sum::<f64>();
                }
                self.s[(i, j)] = sum;
                self.s[(j, i)] = sum;
            }
        }
    }

    /// Solves the problem of this level roughly, from its velocities.
    fn solve(&mut self, law: &dyn Bounds, theta_k: f64) {
        let law = Sampled {
            law,
            nodes: &self.nodes,
        };
        let problem = ContactProblem {
            s: self.s.as_ref(),
            r: &self.r,
            components: 1,
            weights: &self.weights,
            law: &law,
            slip_base: &self.slip_base,
            theta_k,
        };
        let mut at = Linearisation::fresh(&mut self.blocks, theta_k);
        let (w, newton) = (&mut self.w, &mut self.newton);
        // a start that is not yet a solution will do
        solve(&problem, TOLERANCE, MAX_ITERATIONS, w, &mut at, newton);
    }

    /// The velocities between the nodes of this level, by interpolation.
    fn prolong(&self, w: &mut [f64]) {
        w.fill(0.0);
        let count = w.len();
        for (node, value) in self.w.iter().enumerate() {
            for (at, share) in shares(node, count) {
                w[at] += share * value;
            }
        }
    }
}

impl Cascade {
    /// Forgets what was factored.
    pub fn forget(&mut self) {
        for level in &mut self.levels {
            level.newton.forget();
        }
    }

    /// For `nodes` nodes with `components` tangential components each.
    pub fn new(nodes: usize, components: usize) -> Cascade {
        let mut levels: Vec<Level> = Vec::new();
        let all: Vec<usize> = (0..nodes).collect();
        if components == 1 {
            let mut above = &all;
            while above.len() >= 2 * COARSEST {
                levels.push(Level::new(above));
                above = &levels[levels.len() - 1].nodes;
            }
        }
        Cascade { levels }
    }

    /// No problem on fewer nodes.
    pub fn none() -> Cascade {
        Cascade { levels: Vec::new() }
    }

    /// Whether there is a problem on fewer nodes.
    pub fn exists(&self) -> bool {
        !self.levels.is_empty()
    }

    /// Velocities `to` near a solution of the problem, from `from`.
    pub fn descend(&mut self, problem: &ContactProblem, from: &[f64], to: &mut [f64]) {
        for at in 0..self.levels.len() {
            let (above, rest) = self.levels.split_at_mut(at);
            rest[0].restrict(match above.last() {
                Some(above) => above.as_above(),
                None => Above {
                    s: problem.s,
                    r: problem.r,
                    weights: problem.weights,
                    slip_base: problem.slip_base,
                    w: from,
                },
            });
        }
        for at in (0..self.levels.len()).rev() {
            let (finer, rest) = self.levels.split_at_mut(at);
            rest[0].solve(problem.law, problem.theta_k);
            match finer.last_mut() {
                Some(finer) => rest[0].prolong(&mut finer.w),
                None => rest[0].prolong(to),
            }
        }
    }
}
