//! The paper's iteration (Problem 7.4): the bound is frozen at the last iterate, the resulting Tresca problem is solved
//! exactly, and so on until the iterates change little.
//!
//! The frozen-bound energy touches W at the iterate and lies above it where the bound decreases with the slip rate, so
//! W never increases. The stop test is the paper's, on the change between iterates: it passes before the friction law
//! holds to the same digits, which is why this is not the default solver.

use super::newton::linearisation::{Linearisation, block_len};
use super::newton::{Solution, Workspace, solve as solve_newton};
use crate::contact::bounds::FrozenBounds;
use crate::contact::problem::{ContactProblem, norm};

/// Residual to which each Tresca problem is solved.
const INNER_TOLERANCE: f64 = 1e-13;
const INNER_ITERATIONS: usize = 500;

/// Settings of the iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedPoint {
    pub tolerance: f64,
    /// Whether the change of the contact forces counts beside that of the displacement.
    pub watches_forces: bool,
    pub max_iterations: usize,
}

/// Scratch beyond that of the inner solver.
pub struct FixedPointWorkspace {
    bounds: Vec<f64>,
    force: Vec<f64>,
    /// Point of linearisation of the inner solver.
    blocks: Vec<f64>,
    /// Slip rates and forces of the iterates of the last solve, one after the other; `None` unless asked for.
    trace: Option<Vec<f64>>,
}

impl FixedPointWorkspace {
    pub fn new(nodes: usize, contact_len: usize) -> FixedPointWorkspace {
        FixedPointWorkspace {
            bounds: vec![0.0; nodes],
            force: vec![0.0; contact_len],
            blocks: vec![0.0; nodes * block_len(contact_len / nodes)],
            trace: None,
        }
    }

    /// Keeps the iterates of every solve from now on, for study; allocates.
    pub fn keep_trace(&mut self) {
        self.trace = Some(Vec::new());
    }

    /// Iterates of the last solve: slip rates (m/s) and contact forces Lambda (N). Empty unless kept.
    pub fn iterates(&self) -> impl Iterator<Item = (&[f64], &[f64])> {
        let n = self.force.len();
        let trace = self.trace.as_deref().unwrap_or_default();
        trace.chunks_exact(2 * n).map(move |pair| pair.split_at(n))
    }
}

/// Solves from the warm start `w` and the contact forces `previous_force` of the last instant. `displacement_change`
/// receives every iterate (velocities, forces) and returns the strain norms of the change of the displacement since
/// the iterate before, and of the iterate before.
#[allow(clippy::too_many_arguments)]
pub fn solve(
    problem: &ContactProblem,
    settings: FixedPoint,
    previous_force: &[f64],
    w: &mut [f64],
    ws: &mut Workspace,
    own: &mut FixedPointWorkspace,
    mut displacement_change: impl FnMut(&[f64], &[f64]) -> (f64, f64),
) -> Solution {
    own.force.copy_from_slice(previous_force);
    if let Some(trace) = &mut own.trace {
        trace.clear();
    }
    let c = problem.components;
    let mut at = Linearisation::fresh(&mut own.blocks, problem.theta_k);
    let mut iterations = 0;
    let mut has_settled = false;
    while !has_settled && iterations < settings.max_iterations {
        iterations += 1;
        for node in 0..problem.nodes() {
            let rate = norm(&w[node * c..(node + 1) * c]);
            own.bounds[node] = problem
                .law
                .evaluate(node, rate, problem.slip_path(node))
                .bound;
        }
        let frozen = ContactProblem {
            s: problem.s,
            r: problem.r,
            components: c,
            weights: problem.weights,
            law: &FrozenBounds(&own.bounds),
            slip_base: problem.slip_base,
            theta_k: problem.theta_k,
        };
        let inner = solve_newton(&frozen, INNER_TOLERANCE, INNER_ITERATIONS, w, &mut at, ws);
        if inner.residual.is_nan() {
            break;
        }
        let (mut change, mut size) = (0.0, 0.0);
        for (i, (force, y)) in own.force.iter_mut().zip(&ws.accepted().y).enumerate() {
            // stress = force / weight, its L2 norm weighs the square by the weight
            let weight = problem.weights[i / c];
            change += (-y - *force).powi(2) / weight;
            size += force.powi(2) / weight;
            *force = -y;
        }
        if let Some(trace) = &mut own.trace {
            trace.extend_from_slice(w);
            trace.extend_from_slice(&own.force);
        }
        let (moved, displacement) = displacement_change(w, &own.force);
        has_settled = moved <= settings.tolerance * displacement
            && (!settings.watches_forces || change.sqrt() <= settings.tolerance * size.sqrt());
    }
    let (residual, node) = ws.residual_of(problem, w);
    Solution {
        iterations,
        residual,
        node,
        converged: has_settled,
        is_at_rounding: false,
    }
}
