//! Semismooth Newton for the contact problem, globalised by the decrease of the step energy W.
//!
//! A node either sticks (`w = 0`, force within its bound) or slips. Slipping nodes carry the unknowns: the change of
//! the slip rate along the slip direction `n`, and in 3D also across it. The second variation of W on them is
//!
//! ```text
//! S + diag(omega g') along n,   S + diag(omega g / |w|) across n
//! ```
//!
//! Where `g` decreases this may be indefinite; then `g'` is dropped, which is a Newton step of the frozen-bound problem, a
//! majoriser of W (the paper's Problem 7.4), and the step is lengthened while W decreases. A node that would reverse its
//! direction stops at stick. A step must decrease W; when no step length does, a few sweeps of frozen-bound minimisations
//! node by node follow, which can never increase W. The iteration stops on the residual of the friction law itself.
//!
//! After M. Stadler (SIOPT 2004) and Hueeber, Stadler, Wohlmuth (SISC 30, 2008) for the active sets.

use super::law::FrictionLaw;
use super::problem::{ContactProblem, Point, norm};
use crate::linalg::{DenseCholesky, column};

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
/// Doublings of a step of the frozen-bound problem.
const DOUBLINGS: usize = 30;
/// Sweeps taken in the place of a refused Newton step.
const SWEEPS: usize = 4;
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
    accepted: Point,
    trial: Point,
    step: Vec<f64>,
    rhs: Vec<f64>,
    unknowns: Vec<Unknown>,
    cholesky: DenseCholesky,
    /// Whether the direction is that of the frozen-bound problem.
    is_majorised: bool,
}

impl Workspace {
    /// Scratch for the velocities of `nodes` nodes, `len` components in all.
    pub fn new(nodes: usize, len: usize) -> Workspace {
        Workspace {
            accepted: Point::new(nodes, len),
            trial: Point::new(nodes, len),
            step: vec![0.0; len],
            rhs: vec![0.0; len],
            unknowns: Vec::with_capacity(len),
            cholesky: DenseCholesky::new(len),
            is_majorised: false,
        }
    }

    /// Residual of `problem` at `w`.
    pub fn residual_of<L: FrictionLaw>(
        &mut self,
        problem: &ContactProblem<L>,
        w: &[f64],
    ) -> (f64, usize) {
        self.accepted.w.copy_from_slice(w);
        problem.complete(&mut self.accepted);
        problem.residual(&self.accepted)
    }

    /// The accepted point; its contact forces are minus its `y`.
    pub fn accepted(&self) -> &Point {
        &self.accepted
    }
}

/// Solves the contact problem from the warm start `w`, which becomes the solution. Allocates nothing.
pub fn solve<L: FrictionLaw>(
    problem: &ContactProblem<L>,
    tolerance: f64,
    max_iterations: usize,
    w: &mut [f64],
    ws: &mut Workspace,
) -> Solution {
    ws.accepted.w.copy_from_slice(w);
    problem.complete(&mut ws.accepted);
    let (mut residual, mut node) = problem.residual(&ws.accepted);
    let mut iterations = 0;
    while residual > tolerance && iterations < max_iterations {
        iterations += 1;
        if !newton_step(problem, residual, ws) {
            for _ in 0..SWEEPS {
                frozen_bound_sweep(problem, &mut ws.accepted);
            }
            problem.complete(&mut ws.accepted);
        }
        (residual, node) = problem.residual(&ws.accepted);
    }
    w.copy_from_slice(&ws.accepted.w);
    Solution {
        iterations,
        residual,
        node,
        // a residual that is not a number is not within the tolerance
        converged: residual <= tolerance,
    }
}

/// Tries a Newton step; on success `ws.accepted` is the new point.
fn newton_step<L: FrictionLaw>(
    problem: &ContactProblem<L>,
    residual: f64,
    ws: &mut Workspace,
) -> bool {
    list_unknowns(problem, &ws.accepted, &mut ws.unknowns);
    loop {
        if !solve_direction(problem, ws) {
            return false;
        }
        if !drop_false_starts(problem, ws) {
            break;
        }
    }
    let rounding = ENERGY_ROUNDING * problem.energy_scale(&ws.accepted);
    let mut length = 1.0;
    for _ in 0..=HALVINGS {
        let predicted = advance(problem, length, ws);
        problem.complete(&mut ws.trial);
        let change = problem.energy_change(&ws.accepted, &ws.trial);
        let is_decrease = predicted < 0.0 && change <= SUFFICIENT_DECREASE * predicted;
        if is_decrease || (change.abs() <= rounding && problem.residual(&ws.trial).0 < residual) {
            if ws.is_majorised && length == 1.0 {
                lengthen(problem, change, ws);
            }
            std::mem::swap(&mut ws.accepted, &mut ws.trial);
            return true;
        }
        length *= 0.5;
    }
    false
}

/// Doubles the step while W decreases further: where W is not convex the majoriser makes steps far too short.
fn lengthen<L: FrictionLaw>(problem: &ContactProblem<L>, change: f64, ws: &mut Workspace) {
    let (mut length, mut best) = (1.0, change);
    for _ in 0..DOUBLINGS {
        advance(problem, 2.0 * length, ws);
        problem.complete(&mut ws.trial);
        let change = problem.energy_change(&ws.accepted, &ws.trial);
        if change.is_nan() || change >= best {
            break;
        }
        (length, best) = (2.0 * length, change);
    }
    advance(problem, length, ws);
    problem.complete(&mut ws.trial);
}

/// The slipping nodes: those with a slip rate, and those at rest whose force exceeds their bound.
fn list_unknowns<L: FrictionLaw>(
    problem: &ContactProblem<L>,
    point: &Point,
    unknowns: &mut Vec<Unknown>,
) {
    unknowns.clear();
    for node in 0..problem.nodes() {
        let (rate, law) = (point.rates[node], point.law[node]);
        let (w, y) = (&point.w[problem.at(node)], &point.y[problem.at(node)]);
        let pull = norm(y);
        if rate == 0.0 && pull <= law.bound {
            continue;
        }
        // a node at rest starts against the imbalance
        let n = if rate > 0.0 {
            direction(w, rate)
        } else {
            direction(y, -pull)
        };
        let along = |e: [f64; 2]| y.iter().zip(e).map(|(y, e)| y * e).sum::<f64>();
        unknowns.push(Unknown {
            node,
            direction: n,
            gradient: along(n) + law.bound,
            curvature: law.slope,
        });
        if y.len() == 2 && rate > 0.0 {
            let across = [-n[1], n[0]];
            unknowns.push(Unknown {
                node,
                direction: across,
                gradient: along(across),
                curvature: law.bound / rate,
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
    ws.is_majorised = !factor(problem, false, ws);
    if ws.is_majorised && !factor(problem, true, ws) {
        return false;
    }
    for (rhs, unknown) in ws.rhs.iter_mut().zip(&ws.unknowns) {
        *rhs = -unknown.gradient;
    }
    ws.cholesky.solve(&mut ws.rhs[..count]);
    ws.step.fill(0.0);
    for (unknown, change) in ws.unknowns.iter().zip(&ws.rhs) {
        for (step, e) in ws.step[problem.at(unknown.node)]
            .iter_mut()
            .zip(unknown.direction)
        {
            *step += change * e;
        }
    }
    true
}

/// Drops the nodes at rest that the direction would start backwards: they stay at rest while the others are solved again.
/// Whether there were any.
fn drop_false_starts<L: FrictionLaw>(problem: &ContactProblem<L>, ws: &mut Workspace) -> bool {
    let (rates, step) = (&ws.accepted.rates, &ws.step);
    let before = ws.unknowns.len();
    ws.unknowns.retain(|unknown| {
        let step = &step[problem.at(unknown.node)];
        let forward: f64 = step.iter().zip(unknown.direction).map(|(s, n)| s * n).sum();
        rates[unknown.node] > 0.0 || forward > 0.0
    });
    ws.unknowns.len() < before
}

/// Factors the second variation on the unknowns; with the bound frozen where it decreases, if asked.
fn factor<L: FrictionLaw>(
    problem: &ContactProblem<L>,
    is_frozen: bool,
    ws: &mut Workspace,
) -> bool {
    let (unknowns, c) = (&ws.unknowns, problem.components);
    ws.cholesky.factor(unknowns.len(), |j, entries| {
        let b = &unknowns[j];
        if c == 1 {
            let s = column(problem.s, b.node);
            for (entry, a) in entries.iter_mut().zip(&unknowns[j..]) {
                *entry = a.direction[0] * b.direction[0] * s[a.node];
            }
        } else {
            let (s0, s1) = (
                column(problem.s, 2 * b.node),
                column(problem.s, 2 * b.node + 1),
            );
            for (entry, a) in entries.iter_mut().zip(&unknowns[j..]) {
                let at = 2 * a.node;
                let row = |p: usize| b.direction[0] * s0[at + p] + b.direction[1] * s1[at + p];
                *entry = a.direction[0] * row(0) + a.direction[1] * row(1);
            }
        }
        entries[0] += if is_frozen {
            b.curvature.max(0.0)
        } else {
            b.curvature
        };
    })
}

/// `trial = accepted + length * step`, a node that would reverse stops at stick. Returns the predicted first-order change
/// of W.
fn advance<L: FrictionLaw>(problem: &ContactProblem<L>, length: f64, ws: &mut Workspace) -> f64 {
    let (w, trial) = (&ws.accepted.w, &mut ws.trial.w);
    trial.copy_from_slice(w);
    let mut predicted = 0.0;
    let mut previous = usize::MAX;
    for unknown in &ws.unknowns {
        let at = problem.at(unknown.node);
        let new = &mut trial[at.clone()];
        // the first unknown of a node is the one along its slip direction
        if unknown.node != previous {
            previous = unknown.node;
            let mut forward = 0.0;
            for ((new, step), n) in new
                .iter_mut()
                .zip(&ws.step[at.clone()])
                .zip(unknown.direction)
            {
                *new += length * step;
                forward += *new * n;
            }
            // without a bound at rest there is no kink to stop at
            if forward <= 0.0 && problem.bound_at_rest(unknown.node) > 0.0 {
                new.fill(0.0);
            }
        }
        let moved: f64 = new
            .iter()
            .zip(&w[at])
            .zip(unknown.direction)
            .map(|((new, old), e)| (new - old) * e)
            .sum();
        predicted += unknown.gradient * moved;
    }
    predicted
}

/// One sweep over the nodes, each minimising W with its bound frozen (or, where the bound grows with the rate,
/// linearised) and the others held. Keeps `y` up to date, not the rest of the point.
fn frozen_bound_sweep<L: FrictionLaw>(problem: &ContactProblem<L>, point: &mut Point) {
    for node in 0..problem.nodes() {
        let at = problem.at(node);
        let stiffness = largest_eigenvalue(problem, node);
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

/// Largest eigenvalue of the diagonal block of S at a node.
fn largest_eigenvalue<L: FrictionLaw>(problem: &ContactProblem<L>, node: usize) -> f64 {
    let at = problem.at(node).start;
    let a = problem.s[(at, at)];
    if problem.components == 1 {
        return a;
    }
    let (b, d) = (problem.s[(at, at + 1)], problem.s[(at + 1, at + 1)]);
    0.5 * (a + d) + (0.5 * (a - d)).hypot(b)
}
