//! The whole solver: Newton's method, and what leads it back where it stalls.
//!
//! 1. Newton's method from the warm start (see `newton`).
//! 2. Sweeps over the nodes, then Newton's method.
//! 3. Convex problems with frozen bounds, the bounds taken over at once, by half or by a fifth, then Newton's method.
//! 4. Friction raised in steps from none, then Newton's method.
//!
//! No energy decreases along the way: Coulomb friction is not the derivative of one. So whatever led there, a point is accepted by
//! its residual alone.

use super::linearisation::{PressedPoint, points_len};
use super::newton::{Budget, Newton, Outcome};
use super::point::Point;
use super::problem::PressedProblem;
use super::replaced;
use super::residual::worst_node;
use super::sweep::sweep;
use crate::linalg::multiply;

/// Sweeps before Newton's method is tried again.
const SWEEPS: usize = 60;
/// Sweeps that count as one iteration: about as long as a Newton step takes.
const SWEEPS_OF_ITERATION: usize = 10;
/// Newton steps in a row after which something else is tried.
const STEPS: usize = 40;
/// Shares of the new bounds that the frozen ones take over.
const RELAXATIONS: [f64; 3] = [1.0, 0.5, 0.2];

/// What a solve reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressedSolution {
    /// Newton steps and tens of sweeps taken, those with other bounds on the way included.
    pub iterations: usize,
    /// Residual at the accepted point: the imbalance of a node divided by its bound (tangentially) or force (normally).
    pub residual: f64,
    /// Contact node with the largest residual; 0 when the solve converged.
    pub node: usize,
    /// Whether the residual is within the tolerance, or the law holds as well as rounding allows.
    pub converged: bool,
    /// Whether rounding allowed for no residual within the tolerance.
    pub is_at_rounding: bool,
}

/// Work done so far in a workspace.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PressedWork {
    /// Newton steps, those with other bounds on the way included.
    pub newton: u64,
    /// Matrices factored.
    pub factorizations: u64,
    /// Solves with a factor.
    pub solves: u64,
    /// Sweeps over the nodes.
    pub sweeps: u64,
    /// Convex problems with frozen bounds.
    pub frozen: u64,
    /// Problems with a share of the friction.
    pub raised: u64,
}

/// Scratch of the solver, for the problems of one model; never changes a result.
pub struct PressedWorkspace {
    chain: Chain,
}

/// The iteration, and what the ways back need.
pub(super) struct Chain {
    pub newton: Newton,
    /// Frozen bounds.
    pub bounds: Vec<f64>,
    /// Memory of a point of linearisation that no state keeps.
    apart: Vec<f64>,
    /// `S v` of the sweeps.
    forces: Vec<f64>,
    /// The point of the least imbalance where Newton's method stalled.
    best: Point,
    pub work: PressedWork,
}

impl PressedWorkspace {
    /// Scratch for `nodes` nodes of `components` tangential components each.
    pub fn new(nodes: usize, components: usize) -> PressedWorkspace {
        let len = nodes * (components + 1);
        PressedWorkspace {
            chain: Chain {
                newton: Newton::new(nodes, components),
                bounds: vec![0.0; nodes],
                apart: vec![0.0; points_len(nodes, components)],
                forces: vec![0.0; len],
                best: Point::new(nodes, len),
                work: PressedWork::default(),
            },
        }
    }

    /// Work done so far.
    pub fn work(&self) -> PressedWork {
        let Chain { newton, work, .. } = &self.chain;
        PressedWork {
            newton: newton.steps,
            factorizations: newton.cache.factorizations,
            solves: newton.direction.solves,
            ..*work
        }
    }
}

impl Chain {
    /// Newton's method with a point of linearisation that no state keeps.
    pub fn descend_apart(
        &mut self,
        problem: &PressedProblem,
        tolerance: f64,
        most: usize,
        budget: &mut Budget,
    ) -> Outcome {
        let mut at = PressedPoint::fresh(&mut self.apart, problem);
        self.newton
            .descend(problem, tolerance, most, budget, &mut at)
    }

    /// Some sweeps.
    pub fn sweep(&mut self, problem: &PressedProblem, budget: &mut Budget) {
        let point = &mut self.newton.accepted;
        multiply(problem.s, &point.v, &mut self.forces);
        for sweep_count in 0..SWEEPS {
            if sweep_count.is_multiple_of(SWEEPS_OF_ITERATION) && !budget.take() {
                break;
            }
            self.work.sweeps += 1;
            sweep(problem, point, &mut self.forces);
        }
        point.project(problem, &self.newton.slopes);
    }

    fn run(
        &mut self,
        problem: &PressedProblem,
        tolerance: f64,
        budget: &mut Budget,
        at: &mut PressedPoint,
    ) -> Outcome {
        let first = self.newton.descend(problem, tolerance, STEPS, budget, at);
        self.best.copy_from(&self.newton.accepted);
        // what is not a number leads nowhere
        if first != Outcome::Stalled || !self.best.merit.is_finite() {
            return first;
        }
        self.sweep(problem, budget);
        let second = self.newton.descend(problem, tolerance, STEPS, budget, at);
        if self.keep_best(second) {
            return second;
        }
        for relaxation in RELAXATIONS {
            replaced::settle(problem, relaxation, budget, self);
            let outcome = self.newton.descend(problem, tolerance, STEPS, budget, at);
            if self.keep_best(outcome) {
                return outcome;
            }
        }
        replaced::raise(problem, budget, self);
        let last = self.newton.descend(problem, tolerance, STEPS, budget, at);
        self.keep_best(last);
        last
    }

    /// Whether this is the end; otherwise the accepted point is kept if it is the best one.
    fn keep_best(&mut self, outcome: Outcome) -> bool {
        let accepted = &self.newton.accepted;
        let is_better = accepted.merit < self.best.merit || self.best.merit.is_nan();
        if outcome.is_solution() || is_better {
            self.best.copy_from(accepted);
        }
        outcome != Outcome::Stalled
    }
}

/// Solves the contact problem from the warm start `velocity` and `force`, which become the solution: velocities and forces that
/// obey friction law and normal condition exactly, and balance to the tolerance. `reaction` becomes `r - S v`. All three have
/// `components + 1` entries per node. `at` is the point of linearisation, which may move. Allocates nothing. Where the data are
/// not numbers, nothing is changed but `reaction`, and the solve has not converged.
#[allow(clippy::too_many_arguments)] // the three vectors of a solve are the caller's
pub fn solve(
    problem: &PressedProblem,
    tolerance: f64,
    max_iterations: usize,
    velocity: &mut [f64],
    force: &mut [f64],
    reaction: &mut [f64],
    at: &mut PressedPoint,
    ws: &mut PressedWorkspace,
) -> PressedSolution {
    let chain = &mut ws.chain;
    chain.newton.start(problem, velocity, force);
    let mut budget = Budget {
        left: max_iterations,
    };
    let outcome = chain.run(problem, tolerance, &mut budget, at);
    let (residual, node) = worst_node(problem, &chain.best);
    if !residual.is_nan() {
        velocity.copy_from_slice(&chain.best.v);
        force.copy_from_slice(&chain.best.f);
    }
    multiply(problem.s, velocity, reaction);
    for (reaction, r) in reaction.iter_mut().zip(problem.r) {
        *reaction = r - *reaction;
    }
    let converged = outcome.is_solution();
    PressedSolution {
        iterations: max_iterations - budget.left,
        residual: match outcome {
            Outcome::AtRounding(left) => left,
            _ => residual,
        },
        node: if converged { 0 } else { node },
        converged,
        is_at_rounding: matches!(outcome, Outcome::AtRounding(_)),
    }
}

/// The sign of the determinant of the normal map at a solution; 0 where it is singular. The signs of all solutions of a problem
/// sum to 1, so a negative one proves that there are at least two others.
pub fn index(
    problem: &PressedProblem,
    velocity: &[f64],
    force: &[f64],
    ws: &mut PressedWorkspace,
) -> f64 {
    let Chain { newton, apart, .. } = &mut ws.chain;
    newton.start(problem, velocity, force);
    let mut at = PressedPoint::fresh(apart, problem);
    at.set(problem.components, &newton.accepted.nodes);
    newton
        .cache
        .at(problem, &at)
        .map_or(0.0, |factor| factor.lu.sign())
}
