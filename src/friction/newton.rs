//! Semismooth Newton for the contact problem, globalised by the decrease of the step energy W.
//!
//! A node either sticks (`w = 0`, force within its bound) or slips. Slipping nodes carry the unknowns: the change of
//! the slip rate along the slip direction `n`, and in 3D also across it. The second variation of W on them is
//!
//! ```text
//! S + diag(omega g') along n,   S + diag(omega g / |w|) across n
//! ```
//!
//! Where `g` decreases this may be indefinite; then `g'` is dropped, which is a Newton step of the frozen-bound
//! problem, a majoriser of W (PHYSICS: the paper's Problem 7.4). A node that would reverse its direction stops at
//! stick. A step must decrease W; when no step length does, one sweep of frozen-bound minimisations node by node
//! follows, which can never increase W. The iteration stops on the residual of the friction law itself.
//!
//! After M. Stadler (SIOPT 2004) and Hueeber, Stadler, Wohlmuth (SISC 30, 2008) for the active sets.

use super::law::FrictionLaw;
use super::problem::{ContactProblem, norm};
use crate::linalg::{DenseCholesky, multiply};

/// What a solve reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Newton steps and sweeps taken.
    pub iterations: usize,
    /// Residual of the friction law at the accepted point.
    pub residual: f64,
    /// Contact node with the largest residual.
    pub node: usize,
    /// Whether the residual is within the tolerance.
    pub converged: bool,
}

/// Sufficient decrease of W per unit of predicted decrease (Armijo).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Halvings of a Newton step before a sweep is taken instead.
const HALVINGS: usize = 6;
/// Changes of W below this share of its terms are rounding, and the residual decides.
const ENERGY_ROUNDING: f64 = 1e-13;

/// One unknown of a Newton step: the slip rate of `node` along `direction`.
#[derive(Debug, Clone, Copy)]
struct Unknown {
    node: usize,
    direction: [f64; 2],
    /// Derivative of W along the direction, N.
    gradient: f64,
    /// Second derivative of the friction potential along the direction, N s/m.
    curvature: f64,
}

/// Scratch of the solver; never changes a result.
pub struct Workspace {
    y: Vec<f64>,
    trial: Vec<f64>,
    trial_y: Vec<f64>,
    step: Vec<f64>,
    rhs: Vec<f64>,
    unknowns: Vec<Unknown>,
    cholesky: DenseCholesky,
}

impl Workspace {
    /// Scratch for `len = nodes * components` velocities.
    pub fn new(len: usize) -> Workspace {
        Workspace {
            y: vec![0.0; len],
            trial: vec![0.0; len],
            trial_y: vec![0.0; len],
            step: vec![0.0; len],
            rhs: vec![0.0; len],
            unknowns: Vec::with_capacity(len),
            cholesky: DenseCholesky::new(len),
        }
    }

    /// `S w - r` at the accepted point: minus the contact forces Lambda.
    pub fn imbalance(&self) -> &[f64] {
        &self.y
    }
}

/// Solves the contact problem from the warm start `w`, which becomes the solution; contact forces are
/// `-workspace.imbalance()`. Allocates nothing.
pub fn solve<L: FrictionLaw>(
    problem: &ContactProblem<L>,
    tolerance: f64,
    max_iterations: usize,
    w: &mut [f64],
    ws: &mut Workspace,
) -> Solution {
    imbalance(problem, w, &mut ws.y);
    let (mut residual, mut node) = problem.residual(w, &ws.y);
    let mut iterations = 0;
    while !within(residual, tolerance) && iterations < max_iterations && residual.is_finite() {
        iterations += 1;
        if !newton_step(problem, residual, w, ws) {
            frozen_bound_sweep(problem, w, &mut ws.y);
            imbalance(problem, w, &mut ws.y);
        }
        (residual, node) = problem.residual(w, &ws.y);
    }
    Solution {
        iterations,
        residual,
        node,
        converged: within(residual, tolerance),
    }
}

fn within(residual: f64, tolerance: f64) -> bool {
    residual <= tolerance
}

/// `y = S w - r`.
fn imbalance<L>(problem: &ContactProblem<L>, w: &[f64], y: &mut [f64]) {
    multiply(problem.s, w, y);
    y.iter_mut().zip(problem.r).for_each(|(y, r)| *y -= r);
}

/// Tries a Newton step; on success `w` and `ws.y` are the new point.
fn newton_step<L: FrictionLaw>(
    problem: &ContactProblem<L>,
    residual: f64,
    w: &mut [f64],
    ws: &mut Workspace,
) -> bool {
    list_unknowns(problem, w, &ws.y, &mut ws.unknowns);
    if !solve_direction(problem, ws) {
        return false;
    }
    let rounding = ENERGY_ROUNDING * energy_scale(problem, w);
    let mut length = 1.0;
    for _ in 0..=HALVINGS {
        let predicted = advance(problem, w, length, ws);
        imbalance(problem, &ws.trial, &mut ws.trial_y);
        let change = problem.energy_change(w, &ws.y, &ws.trial, &ws.trial_y);
        let is_decrease = predicted < 0.0 && change <= SUFFICIENT_DECREASE * predicted;
        let is_rounding =
            change.abs() <= rounding && problem.residual(&ws.trial, &ws.trial_y).0 < residual;
        if is_decrease || is_rounding {
            w.copy_from_slice(&ws.trial);
            std::mem::swap(&mut ws.y, &mut ws.trial_y);
            return true;
        }
        length *= 0.5;
    }
    false
}

/// Magnitude of the terms of W.
fn energy_scale<L: FrictionLaw>(problem: &ContactProblem<L>, w: &[f64]) -> f64 {
    let c = problem.components;
    let work: f64 = w.iter().zip(problem.r).map(|(w, r)| (w * r).abs()).sum();
    let friction: f64 = (0..problem.nodes())
        .map(|i| {
            let rate = norm(&w[i * c..(i + 1) * c]);
            problem.weights[i] * problem.law.potential(i, rate, problem.slip_path(i))
        })
        .sum();
    work + friction
}

/// The slipping nodes: those with a slip rate, and those at rest whose force exceeds their bound.
fn list_unknowns<L: FrictionLaw>(
    problem: &ContactProblem<L>,
    w: &[f64],
    y: &[f64],
    unknowns: &mut Vec<Unknown>,
) {
    unknowns.clear();
    let c = problem.components;
    for node in 0..problem.nodes() {
        let (at, to) = (node * c, (node + 1) * c);
        let rate = norm(&w[at..to]);
        let bound = problem.force_bound(node, rate);
        let pull = norm(&y[at..to]);
        if rate == 0.0 && pull <= bound {
            continue;
        }
        // a node at rest starts against the imbalance
        let n = if rate > 0.0 {
            direction(&w[at..to], rate)
        } else {
            direction(&y[at..to], -pull)
        };
        let along = |e: [f64; 2]| (at..to).map(|i| y[i] * e[i - at]).sum::<f64>();
        let slope = problem.law.slope(node, rate, problem.slip_path(node));
        unknowns.push(Unknown {
            node,
            direction: n,
            gradient: along(n) + bound,
            curvature: problem.weights[node] * slope,
        });
        if c == 2 && rate > 0.0 {
            let across = [-n[1], n[0]];
            unknowns.push(Unknown {
                node,
                direction: across,
                gradient: along(across),
                curvature: bound / rate,
            });
        }
    }
}

fn direction(x: &[f64], length: f64) -> [f64; 2] {
    [x[0] / length, x.get(1).map_or(0.0, |v| v / length)]
}

/// Newton direction of the unknowns into `ws.step`; false when even the frozen-bound matrix is not positive definite.
fn solve_direction<L: FrictionLaw>(problem: &ContactProblem<L>, ws: &mut Workspace) -> bool {
    let count = ws.unknowns.len();
    if count == 0 {
        return false;
    }
    let c = problem.components;
    let Workspace {
        unknowns, cholesky, ..
    } = ws;
    let mut factor = |is_frozen: bool| {
        cholesky.factor(count, |i, j| {
            let (a, b) = (&unknowns[i], &unknowns[j]);
            let coupling = if c == 1 {
                a.direction[0] * b.direction[0] * problem.s[(a.node, b.node)]
            } else {
                let mut sum = 0.0;
                for p in 0..2 {
                    for q in 0..2 {
                        sum += a.direction[p]
                            * problem.s[(2 * a.node + p, 2 * b.node + q)]
                            * b.direction[q];
                    }
                }
                sum
            };
            let curvature = if is_frozen {
                a.curvature.max(0.0)
            } else {
                a.curvature
            };
            coupling + if i == j { curvature } else { 0.0 }
        })
    };
    if !factor(false) && !factor(true) {
        return false;
    }
    for (rhs, unknown) in ws.rhs.iter_mut().zip(&ws.unknowns) {
        *rhs = -unknown.gradient;
    }
    ws.cholesky.solve(&mut ws.rhs[..count]);
    ws.step.fill(0.0);
    for (unknown, change) in ws.unknowns.iter().zip(&ws.rhs) {
        for p in 0..c {
            ws.step[unknown.node * c + p] += change * unknown.direction[p];
        }
    }
    true
}

/// `trial = w + length * step`, a node that would reverse stops at stick. Returns the predicted first-order change of W.
fn advance<L: FrictionLaw>(
    problem: &ContactProblem<L>,
    w: &[f64],
    length: f64,
    ws: &mut Workspace,
) -> f64 {
    let c = problem.components;
    ws.trial.copy_from_slice(w);
    let mut predicted = 0.0;
    let mut previous = usize::MAX;
    for unknown in &ws.unknowns {
        let node = unknown.node;
        let at = node * c;
        if node != previous {
            previous = node;
            let n = unknown.direction;
            for p in 0..c {
                ws.trial[at + p] += length * ws.step[at + p];
            }
            let forward: f64 = (0..c).map(|p| ws.trial[at + p] * n[p]).sum();
            // without a bound at rest there is no kink to stop at
            if forward <= 0.0 && problem.force_bound(node, 0.0) > 0.0 {
                ws.trial[at..at + c].fill(0.0);
            }
        }
        let moved: f64 = (0..c)
            .map(|p| (ws.trial[at + p] - w[at + p]) * unknown.direction[p])
            .sum();
        predicted += unknown.gradient * moved;
    }
    predicted
}

/// One sweep over the nodes, each minimising W with its bound frozen (or, where the bound grows with the rate,
/// linearised) and the others held. Keeps `y = S w - r` up to date.
fn frozen_bound_sweep<L: FrictionLaw>(problem: &ContactProblem<L>, w: &mut [f64], y: &mut [f64]) {
    let c = problem.components;
    for node in 0..problem.nodes() {
        let at = node * c;
        let stiffness = largest_eigenvalue(problem, node);
        let rate = norm(&w[at..at + c]);
        let mut target = [0.0; 2];
        for p in 0..c {
            target[p] = stiffness * w[at + p] - y[at + p];
        }
        let pull = norm(&target[..c]);
        let slope = (problem.weights[node]
            * problem.law.slope(node, rate, problem.slip_path(node)))
        .max(0.0);
        let bound = problem.force_bound(node, rate) - slope * rate;
        let new_rate = ((pull - bound) / (stiffness + slope)).max(0.0);
        for p in 0..c {
            let new = if new_rate > 0.0 {
                new_rate * target[p] / pull
            } else {
                0.0
            };
            let change = new - w[at + p];
            if change != 0.0 {
                w[at + p] = new;
                let column = problem.s.col(at + p);
                y.iter_mut()
                    .enumerate()
                    .for_each(|(i, y)| *y += change * column[i]);
            }
        }
    }
}

/// Largest eigenvalue of the diagonal block of S at a node.
fn largest_eigenvalue<L>(problem: &ContactProblem<L>, node: usize) -> f64 {
    let at = node * problem.components;
    let a = problem.s[(at, at)];
    if problem.components == 1 {
        return a;
    }
    let (b, d) = (problem.s[(at, at + 1)], problem.s[(at + 1, at + 1)]);
    0.5 * (a + d) + (0.5 * (a - d)).hypot(b)
}
