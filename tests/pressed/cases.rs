//! A contact problem with data of its own, and its solution.

use crate::body::Condensed;
use crate::laws::{Bounds, Friction};
use crate::random::Random;
use faer::Mat;
use stickslip::contact::pressed::{
    NormalCondition, PressedPoint, PressedProblem, PressedSolution, PressedWorkspace, clear_points,
    points_len, solve,
};

pub const TOLERANCE: f64 = 1e-10;
/// For problems without a good start.
const ITERATIONS: usize = 5000;

/// Data of a problem.
#[derive(Clone)]
pub struct Case {
    pub components: usize,
    pub s: Mat<f64>,
    pub r: Vec<f64>,
    pub yielding: Vec<f64>,
    pub weights: Vec<f64>,
    pub slip_base: Vec<f64>,
    pub friction: Friction,
    pub theta_k: f64,
    pub condition: NormalCondition,
    pub stiffness: Vec<f64>,
    pub gap_base: Vec<f64>,
    pub gap_rate: f64,
}

/// Velocities and forces.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    pub velocity: Vec<f64>,
    pub force: Vec<f64>,
    pub reaction: Vec<f64>,
}

impl Case {
    /// A body without load under these laws.
    pub fn new(body: &Condensed, friction: Friction, condition: NormalCondition, k: f64) -> Case {
        let len = body.s.nrows();
        Case {
            components: body.components,
            s: body.s.clone(),
            r: vec![0.0; len],
            yielding: (0..len).map(|i| body.c[(i, i)]).collect(),
            weights: vec![body.weight; body.nodes],
            slip_base: vec![0.0; body.nodes],
            friction,
            theta_k: k,
            condition,
            stiffness: vec![],
            gap_base: vec![0.0; body.nodes],
            gap_rate: k,
        }
    }

    pub fn nodes(&self) -> usize {
        self.weights.len()
    }

    /// The load that moves the free body like this.
    pub fn set_free_velocity(&mut self, velocity: &[f64]) {
        self.r = product(&self.s, velocity);
    }

    pub fn bounds(&self) -> Bounds {
        Bounds {
            friction: self.friction,
            per_rate: self.theta_k,
        }
    }

    pub fn with<T>(&self, run: impl FnOnce(&PressedProblem) -> T) -> T {
        let bounds = self.bounds();
        run(&PressedProblem {
            s: self.s.as_ref(),
            r: &self.r,
            yielding: &self.yielding,
            components: self.components,
            weights: &self.weights,
            bounds: &bounds,
            slip_base: &self.slip_base,
            theta_k: self.theta_k,
            conditions: self.condition.into(),
            stiffness: &self.stiffness,
            relaxing: &[],
            gap_base: &self.gap_base,
            gap_rate: self.gap_rate,
        })
    }

    pub fn start(&self) -> Found {
        let zeros = vec![0.0; self.r.len()];
        Found {
            velocity: zeros.clone(),
            force: zeros.clone(),
            reaction: zeros,
        }
    }

    /// A start that has nothing to do with the problem.
    pub fn random_start(&self, random: &mut Random, size: f64) -> Found {
        let mut start = self.start();
        for (v, f) in start.velocity.iter_mut().zip(&mut start.force) {
            *v = size * random.between(-1.0, 1.0);
            *f = size * random.between(-1.0, 1.0);
        }
        start
    }

    /// Solves from a start, which becomes the solution.
    pub fn solve(&self, found: &mut Found) -> PressedSolution {
        Solver::new(self).solve(self, found)
    }
}

/// A workspace and the points of a state.
pub struct Solver {
    pub ws: PressedWorkspace,
    pub points: Vec<f64>,
    pub tolerance: f64,
    pub iterations: usize,
}

impl Solver {
    pub fn new(case: &Case) -> Solver {
        let mut points = vec![0.0; points_len(case.nodes(), case.components)];
        clear_points(&mut points);
        Solver {
            ws: PressedWorkspace::new(case.nodes(), case.components),
            points,
            tolerance: TOLERANCE,
            iterations: ITERATIONS,
        }
    }

    pub fn solve(&mut self, case: &Case, found: &mut Found) -> PressedSolution {
        let Found {
            velocity,
            force,
            reaction,
        } = found;
        let mut at = PressedPoint::of(&mut self.points, case.theta_k, case.gap_rate);
        let (tolerance, iterations, ws) = (self.tolerance, self.iterations, &mut self.ws);
        case.with(|problem| {
            solve(
                problem, tolerance, iterations, velocity, force, reaction, &mut at, ws,
            )
        })
    }
}

pub fn product(a: &Mat<f64>, x: &[f64]) -> Vec<f64> {
    (0..a.nrows())
        .map(|i| (0..x.len()).map(|j| a[(i, j)] * x[j]).sum())
        .collect()
}

/// Largest difference, as a share of the largest value.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    let largest = a.iter().chain(b).fold(0.0, |m: f64, x| m.max(x.abs()));
    let apart = a.iter().zip(b).fold(0.0, |m: f64, (a, b)| {
        let apart = (a - b).abs();
        // not a number is far apart
        if apart.is_nan() {
            f64::INFINITY
        } else {
            m.max(apart)
        }
    });
    if apart == 0.0 { 0.0 } else { apart / largest }
}
