//! The contact problem of one stage, its residual and its step energy.

use super::law::{FrictionLaw, SlipPath};
use faer::MatRef;

/// `S w + Lambda = r` with the friction law, on `nodes * components` tangential velocities (node by node).
pub struct ContactProblem<'a, L> {
    /// Condensed operator, symmetric positive definite, N s/m.
    pub s: MatRef<'a, f64>,
    /// Condensed load, N.
    pub r: &'a [f64],
    /// Tangential components per node, 1 or 2.
    pub components: usize,
    /// Nodal contact weights omega, m^2 (m in 2D).
    pub weights: &'a [f64],
    /// Friction law.
    pub law: &'a L,
    /// Accumulated slip of every node before the implicit part of the stage, m.
    pub slip_base: &'a [f64],
    /// Implicit weight of the stage, s: accumulated slip grows by this times the slip rate.
    pub theta_k: f64,
}

/// A per-node quantity below this share of the largest one is measured against that share: a node that carries
/// practically nothing must not dictate the stop.
const SCALE_FLOOR: f64 = 1e-3;

impl<L: FrictionLaw> ContactProblem<'_, L> {
    pub fn nodes(&self) -> usize {
        self.weights.len()
    }

    pub fn slip_path(&self, node: usize) -> SlipPath {
        SlipPath {
            base: self.slip_base[node],
            per_rate: self.theta_k,
        }
    }

    /// Largest admissible nodal force `omega_i g_i(rate)`, N.
    pub fn force_bound(&self, node: usize, rate: f64) -> f64 {
        self.weights[node] * self.law.bound(node, rate, self.slip_path(node))
    }

    /// Residual of the friction law: the largest over the nodes of the violated force divided by the forces that meet
    /// there. `y` is `S w - r`; a node with `w = 0` violates by what exceeds its bound at rest.
    /// Returns the residual and the node where it stands.
    pub fn residual(&self, w: &[f64], y: &[f64]) -> (f64, usize) {
        let scale = |node: usize| {
            let (at, to) = (node * self.components, (node + 1) * self.components);
            let slip_rate = norm(&w[at..to]);
            let applied = norm(&self.r[at..to]);
            // S w = y + r
            let body = (at..to)
                .map(|i| (y[i] + self.r[i]).powi(2))
                .sum::<f64>()
                .sqrt();
            applied + body + self.force_bound(node, slip_rate)
        };
        let largest = (0..self.nodes()).map(scale).fold(0.0, f64::max);
        let mut worst = (0.0, 0);
        for node in 0..self.nodes() {
            let violation = self.violation(node, w, y);
            if violation == 0.0 {
                continue;
            }
            let relative = violation / scale(node).max(SCALE_FLOOR * largest);
            // NaN must not pass for converged
            if relative > worst.0 || relative.is_nan() {
                worst = (relative, node);
            }
            if relative.is_nan() {
                break;
            }
        }
        worst
    }

    /// Violated force at a node, N.
    fn violation(&self, node: usize, w: &[f64], y: &[f64]) -> f64 {
        let (at, to) = (node * self.components, (node + 1) * self.components);
        let slip_rate = norm(&w[at..to]);
        let bound = self.force_bound(node, slip_rate);
        if slip_rate == 0.0 {
            let excess = norm(&y[at..to]) - bound;
            return if excess <= 0.0 { 0.0 } else { excess };
        }
        (at..to)
            .map(|i| (y[i] + bound * w[i] / slip_rate).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    /// `W(trial) - W(w)`, with `y = S w - r` at both ends; written with differences so that it does not cancel.
    pub fn energy_change(&self, w: &[f64], y: &[f64], trial: &[f64], trial_y: &[f64]) -> f64 {
        let smooth: f64 = (0..w.len())
            .map(|i| 0.5 * (trial[i] - w[i]) * (y[i] + trial_y[i]))
            .sum();
        let c = self.components;
        let friction: f64 = (0..self.nodes())
            .map(|node| {
                let path = self.slip_path(node);
                let before = norm(&w[node * c..(node + 1) * c]);
                let after = norm(&trial[node * c..(node + 1) * c]);
                self.weights[node]
                    * (self.law.potential(node, after, path)
                        - self.law.potential(node, before, path))
            })
            .sum();
        smooth + friction
    }
}

/// Euclidean norm of a nodal vector; exact for one component, so that sticking stays exactly zero.
pub fn norm(x: &[f64]) -> f64 {
    match x {
        [a] => a.abs(),
        [a, b] => a.hypot(*b),
        _ => x.iter().map(|v| v * v).sum::<f64>().sqrt(),
    }
}
