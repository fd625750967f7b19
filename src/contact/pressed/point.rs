//! A trial point: velocities and forces that obey the laws of the contact, and the imbalance that they leave.

use super::node::{Node, project};
use super::problem::PressedProblem;
use crate::linalg::{dot, multiply};

/// Velocities and forces that fit each other at every node, and all that follows from them.
pub struct Point {
    /// Velocities.
    pub v: Vec<f64>,
    /// Forces.
    pub f: Vec<f64>,
    /// Imbalance `S v + [lam; -p] - r`, N.
    pub imbalance: Vec<f64>,
    pub nodes: Vec<Node>,
    /// Length of the imbalance, N: what a Newton step must decrease.
    pub merit: f64,
}

/// Slopes of the lines along which velocities and forces are projected, per node: tangential and normal, N s/m.
pub type Slopes = Vec<[f64; 2]>;

/// A tangential slope stands so far above the weakening of the bound, so that the projection has one result.
const ABOVE_WEAKENING: f64 = 1.5;
/// How far the weakening may come up to a slope before that is raised.
const LEAST_ABOVE: f64 = 1.2;

impl Point {
    pub fn new(nodes: usize, len: usize) -> Point {
        Point {
            v: vec![0.0; len],
            f: vec![0.0; len],
            imbalance: vec![0.0; len],
            nodes: vec![Node::default(); nodes],
            merit: f64::NAN,
        }
    }

    /// Makes velocities and forces fit each other, and completes the point.
    pub fn project(&mut self, problem: &PressedProblem, slopes: &[[f64; 2]]) {
        let size = problem.size();
        let pairs = self
            .v
            .chunks_exact_mut(size)
            .zip(self.f.chunks_exact_mut(size));
        for (node, (v, f)) in pairs.enumerate() {
            self.nodes[node] = project(problem, node, slopes[node], v, f);
        }
        self.balance(problem);
    }

    /// Computes the imbalance and the merit.
    fn balance(&mut self, problem: &PressedProblem) {
        multiply(problem.s, &self.v, &mut self.imbalance);
        let normal = problem.components;
        for (i, imbalance) in self.imbalance.iter_mut().enumerate() {
            let force = self.f[i];
            let is_normal = i % problem.size() == normal;
            *imbalance += (if is_normal { -force } else { force }) - problem.r[i];
        }
        self.merit = length(&self.imbalance);
    }

    /// `r - S v`: the forces less what is out of balance.
    pub fn reaction(&self, problem: &PressedProblem, out: &mut [f64]) {
        let normal = problem.components;
        for (i, (out, imbalance)) in out.iter_mut().zip(&self.imbalance).enumerate() {
            let is_normal = i % problem.size() == normal;
            let force = self.f[i];
            *out = (if is_normal { -force } else { force }) - imbalance;
        }
    }

    pub fn copy_from(&mut self, other: &Point) {
        self.v.copy_from_slice(&other.v);
        self.f.copy_from_slice(&other.f);
        self.imbalance.copy_from_slice(&other.imbalance);
        self.nodes.copy_from_slice(&other.nodes);
        self.merit = other.merit;
    }
}

/// Sums of squares between which neither overflow nor underflow of a square shows.
const PLAIN_SQUARES: std::ops::Range<f64> = 1e-280..1e300;

/// Length of the imbalance, N; NaN where it is not a number.
pub fn length(imbalance: &[f64]) -> f64 {
    let squares = dot(imbalance, imbalance);
    if PLAIN_SQUARES.contains(&squares) || squares.is_nan() {
        return squares.sqrt();
    }
    let largest = imbalance.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    if largest == 0.0 || largest.is_infinite() {
        return largest;
    }
    let scaled = imbalance.iter().map(|value| (value / largest).powi(2));
    largest * scaled.sum::<f64>().sqrt()
}

/// Slopes before anything is known of the forces.
pub fn set_slopes(problem: &PressedProblem, forces: &[f64], slopes: &mut [[f64; 2]]) {
    for (node, slope) in slopes.iter_mut().enumerate() {
        let yielding: f64 = problem.yielding[problem.tangential(node)].iter().sum();
        let body = problem.components as f64 / yielding;
        let normal = problem.normal(node);
        let weakening = problem.weakening(node, forces[normal]);
        *slope = [
            body.max(ABOVE_WEAKENING * weakening),
            1.0 / problem.yielding[normal],
        ];
    }
}

/// Raises the slopes of nodes whose force, and with it the weakening of their bound, has grown.
pub fn raise_slopes(problem: &PressedProblem, forces: &[f64], slopes: &mut [[f64; 2]]) {
    for (node, slope) in slopes.iter_mut().enumerate() {
        let weakening = problem.weakening(node, forces[problem.normal(node)]);
        if slope[0] < LEAST_ABOVE * weakening {
            slope[0] = ABOVE_WEAKENING * weakening;
        }
    }
}
