//! The contact problem of one stage, and what holds at a trial point: forces, residual, step energy.

use super::bounds::Bounds;
use super::evaluation::{Evaluation, Nodes, SlipPath};
use super::plane;
use super::point::Point;
use crate::linalg::lanes::visit;
use crate::linalg::{column, length, multiply};
use faer::MatRef;
use pulp::Simd;

/// `S w + Lambda = r` with the friction law, on `nodes * components` tangential velocities (node by node).
pub struct ContactProblem<'a> {
    /// Condensed operator, symmetric positive definite, N s/m.
    pub s: MatRef<'a, f64>,
    /// Condensed load, N.
    pub r: &'a [f64],
    /// Tangential components per node, 1 or 2.
    pub components: usize,
    /// Nodal contact weights omega, m^2 (m in 2D).
    pub weights: &'a [f64],
    /// Friction bounds of the nodes.
    pub law: &'a dyn Bounds,
    /// Accumulated slip of every node before the implicit part of the stage, m.
    pub slip_base: &'a [f64],
    /// Implicit weight of the stage, s: accumulated slip grows by this times the slip rate.
    pub theta_k: f64,
}

/// What the violated forces of a point are measured against; by default the forces that meet.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Yardstick {
    /// Smallest bound that a node is measured against, N; zero where there is no friction at all.
    least_bound: f64,
}

/// What the nodes of a point are measured against at least, N: their bounds, or, where there are none, the forces that meet.
#[derive(Clone, Copy)]
struct Measure {
    least_bound: f64,
    least_forces: f64,
}

/// A per-node quantity below this share of the largest one is measured against that share: a node that carries
/// practically nothing must not dictate the stop.
const SCALE_FLOOR: f64 = 1e-3;
/// Share of `eps (|S| |w| + |r|)` by which a node may violate the friction law where rounding allows for no less: the last
/// digits of the slip rates alone make a half of it.
const ROUNDING: f64 = 1.0;
/// Largest share of the forces that meet at a node that is ever left to rounding.
pub const LARGEST_FLOOR: f64 = 1e-8;
/// Below this slip rate, m/s, underflow takes digits from the direction of slip: a slower node is at rest.
pub const SLOWEST: f64 = f64::MIN_POSITIVE / f64::EPSILON;

impl ContactProblem<'_> {
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
        self.weights[node] * self.law.at_rest(node, self.slip_path(node))
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

    /// Computes the product with S of a point whose other quantities are complete.
    #[inline(always)]
    pub fn make_exact(&self, point: &mut Point) {
        multiply(self.s, &point.w, &mut point.y);
        for (y, r) in point.y.iter_mut().zip(self.r) {
            *y -= r;
        }
        point.is_exact = true;
    }

    /// Completes a point from its velocities.
    #[inline(always)]
    pub fn complete(&self, point: &mut Point) {
        self.make_exact(point);
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

    /// The nodes at these slip rates.
    #[inline(always)]
    fn nodes_at<'b>(&'b self, rates: &'b [f64]) -> Nodes<'b> {
        Nodes {
            weights: self.weights,
            rates,
            slip_base: self.slip_base,
            per_rate: self.theta_k,
        }
    }

    /// The law at the slip rates of a point.
    #[inline(always)]
    pub fn apply_law(&self, point: &mut Point) {
        let Point { rates, law, .. } = point;
        self.law.fill(self.nodes_at(rates), law);
    }

    /// What the violated forces of a point are measured against; it does not change in a solve.
    pub fn yardstick(&self) -> Yardstick {
        Yardstick {
            least_bound: SCALE_FLOOR * self.law.largest_at_rest(self.nodes_at(&[])),
        }
    }

    /// Residual of the friction law: the largest over the nodes of the violated force divided by the bound of the node, those
    /// bounds not below a share of the largest one at rest; where there is no friction, by the forces that meet. A node with
    /// `w = 0` violates by what exceeds its bound at rest. NaN where a force is not a number.
    #[inline(always)]
    pub fn residual<S: Simd>(&self, simd: S, point: &Point, yardstick: Yardstick) -> f64 {
        if self.components == 1 {
            plane::residual(simd, self.r, point, yardstick.least_bound, SCALE_FLOOR)
        } else {
            self.worst_node(point, yardstick).0
        }
    }

    /// The residual and the node where it is largest.
    #[inline(never)]
    pub fn worst_node(&self, point: &Point, yardstick: Yardstick) -> (f64, usize) {
        let Some(measure) = self.measure(point, yardstick) else {
            // NaN must not pass for converged
            return (f64::NAN, 0);
        };
        let mut worst = (0.0, 0);
        for node in 0..self.nodes() {
            let residual = self.violation(node, point) / self.own_forces(node, point, measure);
            if residual > worst.0 {
                worst = (residual, node);
            }
        }
        worst
    }

    /// What the nodes of a point are measured against; `None` where a force is not finite.
    fn measure(&self, point: &Point, yardstick: Yardstick) -> Option<Measure> {
        let scales = (0..self.nodes()).map(|node| self.forces_that_meet(node, point));
        let (largest, total) = scales.fold((0.0, 0.0), |(largest, total): (f64, f64), scale| {
            (largest.max(scale), total + scale)
        });
        total.is_finite().then_some(Measure {
            least_bound: yardstick.least_bound,
            least_forces: (SCALE_FLOOR * largest).max(f64::MIN_POSITIVE),
        })
    }

    /// Force against which the violation at a node is measured, N.
    fn own_forces(&self, node: usize, point: &Point, measure: Measure) -> f64 {
        if measure.least_bound > 0.0 {
            point.law.bound[node].max(measure.least_bound)
        } else {
            self.forces_that_meet(node, point).max(measure.least_forces)
        }
    }

    /// Forces that meet at a node, N: applied, of the body (S w = y + r), of friction.
    fn forces_that_meet(&self, node: usize, point: &Point) -> f64 {
        let mut body = [0.0; 2];
        for (body, i) in body.iter_mut().zip(self.at(node)) {
            *body = point.y[i] + self.r[i];
        }
        norm(&self.r[self.at(node)]) + norm(&body[..self.components]) + point.law.bound[node]
    }

    /// What is left of the residual of an exact point when rounding is taken into account; `None` where some node violates
    /// by more than `tolerance` times its bound and more than rounding.
    ///
    /// The forces of the body are known to `eps (|S| |w| + |r|)` at best, times `ROUNDING`, and rounding is no excuse for
    /// more than [`LARGEST_FLOOR`] of the forces that meet. What is left counts over the forces that meet at such a node.
    #[inline(never)]
    pub fn residual_beyond_rounding(
        &self,
        point: &Point,
        yardstick: Yardstick,
        tolerance: f64,
    ) -> Option<f64> {
        let measure = self.measure(point, yardstick)?;
        let mut left: f64 = 0.0;
        for node in 0..self.nodes() {
            let own = self.own_forces(node, point, measure);
            let violation = self.violation(node, point);
            if violation <= tolerance * own {
                left = left.max(violation / own);
                continue;
            }
            let scale = self.forces_that_meet(node, point).max(measure.least_forces);
            // NaN is beyond rounding
            if !(violation <= LARGEST_FLOOR * scale && violation <= self.rounding(node, point)) {
                return None;
            }
            left = left.max(violation / scale);
        }
        Some(left)
    }

    /// What is left of the residual of an exact point where all nodes slip that rounding keeps from the tolerance, and the
    /// Newton step from there, with the turns of its nodes, changes what they show by less than the tolerance; `None` where that
    /// is not so.
    ///
    /// A body that slips as a whole has forces between its nodes that are far larger than what holds it: neighbours then
    /// differ in the last digits of their slip rates, and those digits alone are forces above the tolerance. The step is the
    /// error of the slip rates, and through the slope of the bound that of the stresses.
    #[inline(never)]
    pub fn residual_of_slip(
        &self,
        point: &Point,
        (step, turns): (&[f64], &[f64]),
        yardstick: Yardstick,
        tolerance: f64,
    ) -> Option<f64> {
        let measure = self.measure(point, yardstick)?;
        let mut left: f64 = 0.0;
        for node in 0..self.nodes() {
            let own = self.own_forces(node, point, measure);
            let violation = self.violation(node, point);
            let rounding = self.rounding(node, point);
            let rate = point.rates[node];
            let mut change = norm(&step[self.at(node)]);
            if self.components > 1 {
                change += turns[node].abs() * rate;
            }
            // written so that what is not a number does not hold
            let is_known = if rate > 0.0 {
                let bound = point.law.bound[node];
                violation <= rounding.max(tolerance * own)
                    && change <= tolerance * rate
                    && point.law.slope[node].abs() * change <= tolerance * bound
            } else {
                violation <= tolerance * own && rounding <= tolerance * own
            };
            if !is_known {
                return None;
            }
            let scale = self.forces_that_meet(node, point).max(measure.least_forces);
            left = left.max(violation / scale);
        }
        Some(left)
    }

    /// What rounding leaves unknown of the forces at a node, N.
    fn rounding(&self, node: usize, point: &Point) -> f64 {
        let mut sum = point.law.bound[node];
        for i in self.at(node) {
            let products = column(self.s, i).iter().zip(&point.w);
            sum += self.r[i].abs() + products.map(|(s, w)| (s * w).abs()).sum::<f64>();
        }
        ROUNDING * f64::EPSILON * sum
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

    /// Contact forces Lambda of a point, N: a node that slips carries exactly its bound against the slip rate, one that sticks
    /// what the body asks for, within its bound.
    pub fn forces(&self, point: &Point, force: &mut [f64]) {
        if self.components == 1 {
            let nodes = point.w.iter().zip(&point.y).zip(&point.law.bound);
            for (force, ((w, y), bound)) in force.iter_mut().zip(nodes) {
                *force = if *w != 0.0 {
                    bound.copysign(*w)
                } else if y.abs() > *bound {
                    -bound.copysign(*y)
                } else {
                    -y
                };
            }
            return;
        }
        for (node, force) in force.chunks_exact_mut(self.components).enumerate() {
            let (rate, bound) = (point.rates[node], point.law.bound[node]);
            let (w, y) = (&point.w[self.at(node)], &point.y[self.at(node)]);
            let pull = norm(y);
            for (i, force) in force.iter_mut().enumerate() {
                *force = if rate > 0.0 {
                    bound * (w[i] / rate)
                } else if pull > bound {
                    -bound * (y[i] / pull)
                } else {
                    -y[i]
                };
            }
        }
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
