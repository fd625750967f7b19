//! The whole solver: Newton's method, and what leads it back where it stalls.
//!
//! 1. Newton's method from the warm start (see `newton`).
//! 2. Where a body resists some motions far more than others: the same with steeper slopes, then frozen bounds (4).
//! 3. Sweeps over the nodes, then Newton's method; from here on it is patient: the imbalance may rise for a few steps.
//! 4. Convex problems with frozen bounds, the bounds taken over at once, by half or by a fifth, then Newton's method.
//! 5. Friction raised in steps from none, then Newton's method.
//!
//! After the first of these the imbalance is measured by its energy (see `energy`). Between them stand starts that do not know the last solution: where the solution jumps, being near to the last one is no help.
//!
//! No energy decreases along the way: Coulomb friction is not the derivative of one. So whatever led there, a point is accepted by
//! its residual alone.

use super::chain::{Chain, PressedWork, SWEEPS};
use super::linearisation::{Following, PressedPoint};
use super::newton::{Budget, Outcome};
use super::problem::PressedProblem;
use super::replaced;
use super::residual::worst_node;

/// Newton steps from the warm start after which something else is tried.
const STEPS: usize = 25;
/// Newton steps from another start after which the next way is tried.
const FURTHER_STEPS: usize = 12;
/// How often sweeps are continued.
const TURNS: usize = 2;
/// Changes of frozen bounds, as a share of the largest, at which Newton's method is tried.
const SETTLED: [f64; 2] = [1e-3, 3e-5];

/// A way to a point from which Newton's method may find a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    /// The warm start again, with slopes so many times as steep.
    Steeper(f64),
    Sweeps,
    /// A start that does not know the last solution: zeros, and further ones some velocities without a pattern.
    Anew(u32),
    /// Frozen bounds that take over this share of the new ones.
    Frozen(f64),
    /// Friction raised in steps.
    Raised,
}

/// What is tried in turn where Newton's method stalls.
const STAGES: &[Stage] = &[
    Stage::Sweeps,
    Stage::Anew(0),
    Stage::Sweeps,
    Stage::Frozen(1.0),
    Stage::Frozen(0.5),
    Stage::Frozen(0.2),
    Stage::Raised,
    Stage::Anew(1),
    Stage::Sweeps,
    Stage::Anew(2),
    Stage::Sweeps,
    Stage::Anew(3),
    Stage::Sweeps,
    Stage::Frozen(0.5),
];
/// The same for a body that resists some motions far more than others: a sweep, which moves one node at a time, hardly moves it.
const STAGES_ONE_SIDED: &[Stage] = &[
    Stage::Steeper(30.0),
    Stage::Frozen(1.0),
    Stage::Sweeps,
    Stage::Anew(0),
    Stage::Sweeps,
    Stage::Frozen(0.5),
    Stage::Frozen(0.2),
    Stage::Raised,
    Stage::Anew(1),
    Stage::Sweeps,
    Stage::Anew(2),
    Stage::Sweeps,
    Stage::Anew(3),
    Stage::Sweeps,
    Stage::Frozen(0.5),
];
/// A body is one-sided where a component alone resists so many times as much as with the others free.
const ONE_SIDED: f64 = 100.0;

fn is_one_sided(problem: &PressedProblem) -> bool {
    let components = problem.yielding.iter().enumerate();
    components
        .map(|(i, yielding)| problem.s[(i, i)] * yielding)
        .any(|ratio| ratio > ONE_SIDED)
}

/// A problem that is being solved.
struct Task<'a, 'p, 'l> {
    problem: &'a PressedProblem<'p>,
    tolerance: f64,
    budget: Budget,
    at: &'a mut PressedPoint<'l>,
    /// Velocities and forces of the warm start.
    start: [&'a [f64]; 2],
}

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

/// Scratch of the solver, for the problems of one model; never changes a result.
pub struct PressedWorkspace {
    chain: Chain,
}

impl PressedWorkspace {
    /// Scratch for `nodes` nodes of `components` tangential components each.
    pub fn new(nodes: usize, components: usize) -> PressedWorkspace {
        PressedWorkspace {
            chain: Chain::new(nodes, components),
        }
    }

    /// Forgets what was factored: the problems to come have another S. Nothing else that it holds outlives a solve.
    pub fn forget(&mut self) {
        self.chain.newton.forget();
    }

    /// Work done so far.
    pub fn work(&self) -> PressedWork {
        let Chain { newton, work, .. } = &self.chain;
        PressedWork {
            newton: newton.steps,
            factorizations: newton.cache.factorizations,
            solves: newton.direction.solves + newton.cache.border_solves(),
            ..*work
        }
    }
}

impl Chain {
    fn run(&mut self, task: &mut Task) -> Outcome {
        self.newton.is_patient = false;
        self.newton.set_energetic(task.problem, false);
        let (problem, tolerance) = (task.problem, task.tolerance);
        let Task { budget, at, .. } = task;
        let first = self.newton.descend(problem, tolerance, STEPS, budget, at);
        // what is not a number leads nowhere
        if first != Outcome::Stalled || !self.newton.accepted.merit.is_finite() {
            std::mem::swap(&mut self.best, &mut self.newton.accepted);
            return first;
        }
        self.newton.set_energetic(problem, true);
        self.newton.measure();
        self.best.copy_from(&self.newton.accepted);
        self.newton.is_patient = true;
        let stages = match is_one_sided(problem) {
            true => STAGES_ONE_SIDED,
            false => STAGES,
        };
        for stage in stages {
            let outcome = self.run_stage(*stage, task);
            if outcome != Outcome::Stalled {
                return outcome;
            }
        }
        Outcome::Stalled
    }

    fn run_stage(&mut self, stage: Stage, task: &mut Task) -> Outcome {
        match stage {
            Stage::Steeper(times) => {
                let [velocity, force] = task.start;
                self.newton
                    .start_steeper(task.problem, velocity, force, times);
                self.newton.is_patient = false;
                let outcome = self.descend(task);
                self.newton.is_patient = true;
                outcome
            }
            Stage::Sweeps => self.sweep_and_descend(task),
            Stage::Frozen(relaxation) => {
                for settled in SETTLED {
                    replaced::settle(task.problem, relaxation, settled, &mut task.budget, self);
                    let outcome = self.descend(task);
                    if outcome != Outcome::Stalled {
                        return outcome;
                    }
                }
                Outcome::Stalled
            }
            Stage::Raised => {
                replaced::raise(task.problem, &mut task.budget, self);
                self.descend(task)
            }
            Stage::Anew(number) => {
                self.newton.start_anew(task.problem, number);
                self.descend(task)
            }
        }
    }

    /// More and more sweeps, each time from where the last ones led, and Newton's method from there.
    fn sweep_and_descend(&mut self, task: &mut Task) -> Outcome {
        self.swept.copy_from(&self.newton.accepted);
        for turn in 0..TURNS {
            self.newton.accepted.copy_from(&self.swept);
            self.sweep(task.problem, SWEEPS << turn, &mut task.budget);
            self.swept.copy_from(&self.newton.accepted);
            let outcome = self.descend(task);
            if outcome != Outcome::Stalled {
                return outcome;
            }
        }
        Outcome::Stalled
    }

    /// Newton's method for the problem itself; a point that it ends at is kept if it is the best one.
    fn descend(&mut self, task: &mut Task) -> Outcome {
        let (problem, tolerance) = (task.problem, task.tolerance);
        let Task { budget, at, .. } = task;
        let outcome = self
            .newton
            .descend(problem, tolerance, FURTHER_STEPS, budget, at);
        let accepted = &self.newton.accepted;
        let is_better = accepted.merit < self.best.merit;
        if outcome.is_solution() || is_better {
            self.best.copy_from(accepted);
        }
        outcome
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
    let mut task = Task {
        problem,
        tolerance,
        budget: Budget {
            left: max_iterations,
        },
        at,
        start: [velocity, force],
    };
    let outcome = chain.run(&mut task);
    let left = task.budget.left;
    let (residual, node) = match outcome {
        Outcome::Converged(residual) => (residual, 0),
        _ => worst_node(problem, &chain.best),
    };
    if !residual.is_nan() {
        velocity.copy_from_slice(&chain.best.v);
        force.copy_from_slice(&chain.best.f);
    }
    chain.best.reaction(problem, reaction);
    let converged = outcome.is_solution();
    PressedSolution {
        iterations: max_iterations - left,
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
    let nodes = (&newton.accepted.nodes[..], Following::All);
    newton
        .cache
        .at(problem, &at, nodes)
        .map_or(0.0, |factor| factor.sign())
}
