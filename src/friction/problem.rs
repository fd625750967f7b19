//! The contact problem of one stage, and what holds at a trial point: forces, residual, step energy.

use super::law::{Evaluation, FrictionLaw, SlipPath};
use crate::linalg::multiply;
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

/// Velocities of the contact and all that follows from them.
pub struct Point {
    /// Tangential velocities w.
    pub w: Vec<f64>,
    /// `S w - r`: minus the contact forces Lambda that the body asks for.
    pub y: Vec<f64>,
    /// Magnitude of the slip rate, one per node.
    pub rates: Vec<f64>,
    /// The law at every node, times the nodal weight: forces (N), their slopes (N s/m) and potentials (W).
    pub law: Vec<Evaluation>,
}

impl Point {
    pub fn new(nodes: usize, len: usize) -> Point {
        Point {
            w: vec![0.0; len],
            y: vec![0.0; len],
            rates: vec![0.0; nodes],
            law: vec![Evaluation::default(); nodes],
        }
    }
}

/// A per-node quantity below this share of the largest one is measured against that share: a node that carries
/// practically nothing must not dictate the stop.
const SCALE_FLOOR: f64 = 1e-3;

impl<L: FrictionLaw> ContactProblem<'_, L> {
    pub fn nodes(&self) -> usize {
        self.weights.len()
    }

    /// Range of the components of a node.
    pub fn at(&self, node: usize) -> std::ops::Range<usize> {
        node * self.components..(node + 1) * self.components
    }

    pub fn slip_path(&self, node: usize) -> SlipPath {
        SlipPath {
            base: self.slip_base[node],
            per_rate: self.theta_k,
        }
    }

    /// The law at a node, times its weight.
    pub fn weighted_law(&self, node: usize, rate: f64) -> Evaluation {
        let weight = self.weights[node];
        let law = self.law.evaluate(node, rate, self.slip_path(node));
        Evaluation {
            bound: weight * law.bound,
            slope: weight * law.slope,
            potential: weight * law.potential,
        }
    }

    /// Largest admissible nodal force at rest, N.
    pub fn bound_at_rest(&self, node: usize) -> f64 {
        self.weights[node] * self.law.bound(node, 0.0, self.slip_path(node))
    }

    /// Completes a point from its velocities.
    pub fn complete(&self, point: &mut Point) {
        multiply(self.s, &point.w, &mut point.y);
        for (y, r) in point.y.iter_mut().zip(self.r) {
            *y -= r;
        }
        for node in 0..self.nodes() {
            let rate = norm(&point.w[self.at(node)]);
            point.rates[node] = rate;
            point.law[node] = self.weighted_law(node, rate);
        }
    }

    /// Residual of the friction law: the largest over the nodes of the violated force divided by the forces that meet
    /// there. A node with `w = 0` violates by what exceeds its bound at rest. Returns the residual and its node.
    pub fn residual(&self, point: &Point) -> (f64, usize) {
        // forces that meet at a node: applied, of the body (S w = y + r), of friction
        let scale = |node: usize| {
            let mut body = [0.0; 2];
            for (body, i) in body.iter_mut().zip(self.at(node)) {
                *body = point.y[i] + self.r[i];
            }
            norm(&self.r[self.at(node)]) + norm(&body[..self.components]) + point.law[node].bound
        };
        let largest = (0..self.nodes()).map(scale).fold(0.0, f64::max);
        let mut worst = (0.0, 0);
        for node in 0..self.nodes() {
            let violation = self.violation(node, point);
            if violation == 0.0 {
                continue;
            }
            let relative = violation / scale(node).max(SCALE_FLOOR * largest);
            // NaN must not pass for converged
            if relative.is_nan() {
                return (relative, node);
            }
            if relative > worst.0 {
                worst = (relative, node);
            }
        }
        worst
    }

    /// Violated force at a node, N.
    fn violation(&self, node: usize, point: &Point) -> f64 {
        let (rate, bound) = (point.rates[node], point.law[node].bound);
        let y = &point.y[self.at(node)];
        if rate == 0.0 {
            let excess = norm(y) - bound;
            return if excess <= 0.0 { 0.0 } else { excess };
        }
        let mut violated = [0.0; 2];
        for ((v, y), w) in violated.iter_mut().zip(y).zip(&point.w[self.at(node)]) {
            *v = y + bound * (w / rate);
        }
        norm(&violated[..self.components])
    }

    /// `W(to) - W(from)`, written with differences so that it does not cancel.
    pub fn energy_change(&self, from: &Point, to: &Point) -> f64 {
        let smooth: f64 = (0..from.w.len())
            .map(|i| 0.5 * (to.w[i] - from.w[i]) * (from.y[i] + to.y[i]))
            .sum();
        let friction: f64 = from
            .law
            .iter()
            .zip(&to.law)
            .map(|(from, to)| to.potential - from.potential)
            .sum();
        smooth + friction
    }

    /// Magnitude of the terms of W.
    pub fn energy_scale(&self, point: &Point) -> f64 {
        let work: f64 = point.w.iter().zip(self.r).map(|(w, r)| (w * r).abs()).sum();
        work + point.law.iter().map(|law| law.potential).sum::<f64>()
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
