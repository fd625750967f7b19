//! The contact problem of one stage, and what holds at a trial point: forces, residual, step energy.

use super::evaluation::{Evaluation, Nodes, SlipPath};
use super::law::FrictionLaw;
use super::plane;
use super::point::Point;
use crate::linalg::lanes::visit;
use crate::linalg::{length, multiply};
use faer::MatRef;
use pulp::Simd;

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

/// Where the friction law is violated most.
struct Worst {
    residual: f64,
    node: usize,
    /// Forces that meet there, N.
    scale: f64,
    /// Largest forces that meet at a node, N.
    largest_scale: f64,
}

/// A per-node quantity below this share of the largest one is measured against that share: a node that carries
/// practically nothing must not dictate the stop.
const SCALE_FLOOR: f64 = 1e-3;

impl<L: FrictionLaw> ContactProblem<'_, L> {
    #[inline(always)]
    pub fn nodes(&self) -> usize {
        self.weights.len()
    }

    /// Range of the components of a node.
    #[inline(always)]
    pub fn at(&self, node: usize) -> std::ops::Range<usize> {
        node * self.components..(node + 1) * self.components
    }

    #[inline(always)]
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

    /// Largest eigenvalue of the diagonal block of S at a node.
    pub fn stiffness(&self, node: usize) -> f64 {
        let at = self.at(node).start;
        let a = self.s[(at, at)];
        if self.components == 1 {
            return a;
        }
        let (b, d) = (self.s[(at, at + 1)], self.s[(at + 1, at + 1)]);
        0.5 * (a + d) + length(0.5 * (a - d), b)
    }

    /// Completes a point from its velocities.
    #[inline(always)]
    pub fn complete(&self, point: &mut Point) {
        multiply(self.s, &point.w, &mut point.y);
        for (y, r) in point.y.iter_mut().zip(self.r) {
            *y -= r;
        }
        point.is_exact = true;
        if self.components == 1 {
            for (rate, w) in point.rates.iter_mut().zip(&point.w) {
                *rate = w.abs();
            }
        } else {
            let nodes = point.w.chunks_exact(self.components);
            for (rate, w) in point.rates.iter_mut().zip(nodes) {
                *rate = norm(w);
            }
        }
        self.apply_law(point);
    }

    /// The law at the slip rates of a point.
    #[inline(always)]
    pub fn apply_law(&self, point: &mut Point) {
        let nodes = Nodes {
            weights: self.weights,
            rates: &point.rates,
            slip_base: self.slip_base,
            per_rate: self.theta_k,
        };
        self.law.evaluate_all(nodes, &mut point.law);
    }

    /// Residual of the friction law: the largest over the nodes of the violated force divided by the forces that meet
    /// there. A node with `w = 0` violates by what exceeds its bound at rest. NaN where a force is not a number.
    #[inline(always)]
    pub fn residual<S: Simd>(&self, simd: S, point: &Point) -> f64 {
        if self.components == 1 {
            plane::residual(simd, self.r, point, SCALE_FLOOR)
        } else {
            self.worst_node(point).0
        }
    }

    /// The residual and the node where it is largest.
    #[inline(never)]
    pub fn worst_node(&self, point: &Point) -> (f64, usize) {
        let found = self.worst_above(point, 0.0);
        let floor = SCALE_FLOOR * found.largest_scale;
        // a floor makes no node worse: where it is not the worst one's, it changes nothing
        let found = if found.scale < floor {
            self.worst_above(point, floor)
        } else {
            found
        };
        (found.residual, found.node)
    }

    /// The node with the largest violated force over the forces that meet there, those not below `floor`.
    #[inline(always)]
    fn worst_above(&self, point: &Point, floor: f64) -> Worst {
        let mut worst = Worst {
            residual: 0.0,
            node: 0,
            scale: f64::INFINITY,
            largest_scale: 0.0,
        };
        for node in 0..self.nodes() {
            // applied, of the body (S w = y + r), of friction
            let mut body = [0.0; 2];
            for (body, i) in body.iter_mut().zip(self.at(node)) {
                *body = point.y[i] + self.r[i];
            }
            let bound = point.law.bound[node];
            let scale = norm(&self.r[self.at(node)]) + norm(&body[..self.components]) + bound;
            worst.largest_scale = worst.largest_scale.max(scale);
            let violation = self.violation(node, point);
            if violation == 0.0 {
                continue;
            }
            let residual = violation / scale.max(floor);
            // NaN must not pass for converged
            if residual > worst.residual || residual.is_nan() {
                (worst.residual, worst.node, worst.scale) = (residual, node, scale);
            }
            if residual.is_nan() {
                break;
            }
        }
        worst
    }

    /// Violated force at a node, N.
    fn violation(&self, node: usize, point: &Point) -> f64 {
        let (rate, bound) = (point.rates[node], point.law.bound[node]);
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

    /// How W changes from one point to another.
    #[inline(always)]
    pub fn judge<S: Simd>(&self, simd: S, gradient: &[f64], from: &Point, to: &Point) -> Judgement {
        let zero = simd.splat_f64s(0.0);
        let half = simd.splat_f64s(0.5);
        let (mut predicted, mut smooth, mut work) = (zero, zero, zero);
        visit(
            simd,
            [gradient, &from.w, &to.w, &from.y, &to.y, self.r],
            #[inline(always)]
            |[gradient, w0, w1, y0, y1, r]| {
                let moved = simd.sub_f64s(w1, w0);
                predicted = simd.mul_add_e_f64s(gradient, moved, predicted);
                let mean = simd.mul_f64s(half, simd.add_f64s(y0, y1));
                smooth = simd.mul_add_e_f64s(moved, mean, smooth);
                work = simd.add_f64s(work, simd.abs_f64s(simd.mul_f64s(w0, r)));
            },
        );
        let (mut friction, mut potential) = (zero, zero);
        visit(
            simd,
            [&from.law.potential, &to.law.potential],
            #[inline(always)]
            |[from, to]| {
                friction = simd.add_f64s(friction, simd.sub_f64s(to, from));
                potential = simd.add_f64s(potential, from);
            },
        );
        Judgement {
            predicted: simd.reduce_sum_f64s(predicted),
            // differences, so that W does not cancel
            change: simd.reduce_sum_f64s(simd.add_f64s(smooth, friction)),
            scale: simd.reduce_sum_f64s(simd.add_f64s(work, potential)),
        }
    }
}

/// Change of the step energy W between two points, W.
#[derive(Debug, Clone, Copy)]
pub struct Judgement {
    /// To first order.
    pub predicted: f64,
    pub change: f64,
    /// Magnitude of the terms of W at the first.
    pub scale: f64,
}

/// Euclidean norm of a nodal vector; exact for one component, so that sticking stays exactly zero.
pub fn norm(x: &[f64]) -> f64 {
    match x {
        [a] => a.abs(),
        [a, b] => length(*a, *b),
        _ => x.iter().map(|v| v * v).sum::<f64>().sqrt(),
    }
}
