//! Newton for the contact problem, from a factored matrix nearby, globalised by the decrease of the step energy W.
//!
//! A node either sticks (`w = 0`, force within its bound) or slips. Slipping nodes carry the unknowns, and the second
//! variation of W on them is
//!
//! ```text
//! K = S + omega [ g' n n^T + (g / |w|) (I - n n^T) ],   n = w / |w|;   in the plane S + diag(omega g')
//! ```
//!
//! 1. The direction solves with K, small differences neglected. It uses the factor of K at an earlier point with the same step
//!    size, possibly of an earlier step, and a small correction for the nodes that have changed since then between stick and
//!    slip or in slope (see `direction`, `linearisation`). So an iteration costs a few products of contact order. K is
//!    factored anew, at the present point, when too much has changed or the residual falls slowly: then the step is a
//!    semismooth Newton step.
//! 2. Where `g` decreases K may be indefinite; then the share of the weakening `g'` in the matrix is
//!    lowered in turn to 0.95, 0.8 and 0 until K is positive definite (see `attempts`). At 0 the step is a Newton step of the
//!    frozen-bound problem, a majoriser of W (the paper's Problem 7.4), and it is lengthened while W decreases.
//! 3. A node that would reverse its direction stops at stick. A step must decrease W; when no step length does, neither
//!    from the old nor from the present matrix, a few sweeps of frozen-bound minimisations node by node follow, which can
//!    never increase W.
//! 4. Where steps stay slow because a front between stick and slip has far to go, it is moved on fewer nodes (see `cascade`).
//! 5. The iteration stops on the residual of the friction law itself, so the matrix
//!    affects the number of iterations, not the accuracy.
//!
//! One iteration of `solve`; every accepted point goes back to the top:
//!
//! ```text
//!   residual <= tolerance, point complete ------------------------------> done, converged
//!   residual as small as rounding allows (asked at the start, when slow) -> done, converged at rounding
//!   residual NaN, or iterations used up --------------------------------> done, not converged
//!        | otherwise
//!        v
//!   front far from rest for CRAWLING iterations? --yes--> cascade --moved--> accepted
//!        | no                                               | not moved
//!        v                                                  |
//!   Newton step, matrix kept <------------------------------+
//!        |-- W decreases -----------------------------------------------> accepted
//!        v refused
//!   Newton step, matrix factored at this point (weakening 1, 0.95, 0.8, 0)
//!        |-- W decreases -----------------------------------------------> accepted
//!        v refused
//!   frozen-bound sweeps, which never increase W ------------------------> accepted
//!
//!   accepted: slow counts the steps that left more than SLOW of the residual; from PATIENCE on, the matrix is factored anew
//! ```
//!
//! On large contacts with two components per node the matrix is not factored: every step is solved for iteratively at its own
//! point (see `iterative`).
//!
//! After M. Stadler (SIOPT 2004) and Hueber, Stadler, Wohlmuth (SISC 30, 2008) for the active sets, and the chord method
//! (C. T. Kelley, Iterative Methods for Linear and Nonlinear Equations, SIAM 1995, 5.4) for the matrix that is kept.

mod attempts;
mod cascade;
mod direction;
mod iterative;
mod last;
pub mod linearisation;
mod rounding;
pub(crate) mod second_variation;
mod small;
mod sweep;

use crate::contact::plane;
use crate::contact::point::Point;
use crate::contact::problem::{ContactProblem, Judgement, LARGEST_FLOOR, Yardstick};
use crate::contact::space;
use cascade::Cascade;
use direction::{Direction, PATIENCE};
use iterative::{Iterative, LARGE};
use linearisation::{FactorCache, Linearisation, POINTS};
use pulp::{Arch, Scalar, Simd, WithSimd};
use rounding::{at_rounding, at_rounding_of_slip, rest_the_slowest};
use sweep::frozen_bound_sweep;

/// What a solve reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Newton steps and sweeps taken.
    pub iterations: usize,
    /// Residual of the friction law at the accepted point.
    pub residual: f64,
    /// Contact node with the largest residual; 0 when the solve converged.
    pub node: usize,
    /// Whether the residual is within the tolerance, or the law holds as well as rounding allows.
    pub converged: bool,
    /// Whether rounding allowed for no residual within the tolerance.
    pub is_at_rounding: bool,
}

/// Sufficient decrease of W per unit of predicted decrease (Armijo).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Halvings of a Newton step before a sweep is taken instead.
const HALVINGS: usize = 6;
/// Doublings of a step of the frozen-bound problem.
const DOUBLINGS: usize = 30;
/// Sweeps taken instead of a refused Newton step.
const SWEEPS: usize = 4;
/// Changes of W below this share of its terms are rounding, and the residual decides.
const ENERGY_ROUNDING: f64 = 1e-13;
/// A step that leaves more than this share of the residual is slow.
const SLOW: f64 = 0.5;

/// Share of its bound beyond which a force at a node belongs to a front that is not yet where it will rest.
const FAR: f64 = 0.1;
/// Steps in a row that leave a front so far away, after which it is looked for on fewer nodes.
const CRAWLING: u32 = 8;

/// Scratch of the solver, for the problems of one model; never changes a result.
pub struct Workspace {
    accepted: Point,
    trial: Point,
    direction: Direction,
    cache: FactorCache,
    cascade: Cascade,
    /// In place of the factors, on large contacts with two components per node.
    iterative: Option<Box<Iterative>>,
    /// Whether every point takes its own product with S: near rounding.
    is_careful: bool,
    /// What the violated forces of this solve are measured against.
    yardstick: Yardstick,
    /// Whether the trial point is the accepted one and a step, with nothing stopped in between.
    has_plain_trial: bool,
}

/// Work done so far by a simulator's default friction solver.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Work {
    /// Matrices of the order of the slipping contact factored.
    pub factorizations: u64,
    /// Solves with such a factor, or without one.
    pub solves: u64,
    /// Products with the contact operator of the solves without a factor, on large contacts with two components per node.
    pub products: u64,
}

impl Workspace {
    /// Scratch for the velocities of nodes at these places, m, `len` components in all.
    pub fn new(points: &[[f64; 3]], len: usize) -> Workspace {
        let nodes = points.len();
        match len > nodes && len >= LARGE {
            true => Workspace::iterative(points),
            false => Workspace::factored(nodes, len),
        }
    }

    /// The same with factors, whatever the size.
    pub fn factored(nodes: usize, len: usize) -> Workspace {
        let cascade = Cascade::new(nodes, len / nodes);
        Workspace::with(nodes, len, POINTS, cascade)
    }

    /// The same without factors, with two components per node.
    pub fn iterative(points: &[[f64; 3]]) -> Workspace {
        let (nodes, len) = (points.len(), 2 * points.len());
        Workspace {
            iterative: Some(Box::new(Iterative::new(points))),
            ..Workspace::with(nodes, len, 0, Cascade::none())
        }
    }

    /// Scratch for a contact on some of the nodes, one component each.
    pub(super) fn of_level(nodes: usize) -> Workspace {
        Workspace::with(nodes, nodes, 1, Cascade::none())
    }

    fn with(nodes: usize, len: usize, points: usize, cascade: Cascade) -> Workspace {
        Workspace {
            accepted: Point::new(nodes, len),
            trial: Point::new(nodes, len),
            direction: Direction::new(nodes, len),
            cache: FactorCache::new(points, nodes, len),
            cascade,
            iterative: None,
            is_careful: false,
            yardstick: Yardstick::default(),
            has_plain_trial: false,
        }
    }

    /// Residual of `problem` at `w` and its node; `w` becomes the accepted point.
    pub fn residual_of(&mut self, problem: &ContactProblem, w: &[f64]) -> (f64, usize) {
        self.accepted.w.copy_from_slice(w);
        problem.complete(&mut self.accepted);
        problem.worst_node(&self.accepted, problem.yardstick())
    }

    /// Forgets what was factored: the problems to come have another S. Nothing else that it holds outlives a solve.
    pub fn forget(&mut self) {
        self.cache.forget();
        self.cascade.forget();
    }

    /// The accepted point.
    pub fn accepted(&self) -> &Point {
        &self.accepted
    }

    /// Work done so far.
    pub fn work(&self) -> Work {
        Work {
            factorizations: self.cache.factorizations,
            solves: self.direction.solves,
            products: (self.iterative.as_ref()).map_or(0, |iterative| iterative.products),
        }
    }
}

/// Solves the contact problem from the warm start `w`, which becomes the solution; `at` is the point of linearisation, which
/// may move. Allocates nothing.
pub fn solve(
    problem: &ContactProblem,
    tolerance: f64,
    max_iterations: usize,
    w: &mut [f64],
    at: &mut Linearisation,
    ws: &mut Workspace,
) -> Solution {
    Arch::new().dispatch(Solve {
        problem,
        tolerance,
        max_iterations,
        w,
        at,
        ws,
    })
}

/// A solve: all loops over the contact that run at every iteration are compiled into it, for the instructions of the machine.
struct Solve<'a, 'p, 'l> {
    problem: &'a ContactProblem<'p>,
    tolerance: f64,
    max_iterations: usize,
    w: &'a mut [f64],
    at: &'a mut Linearisation<'l>,
    ws: &'a mut Workspace,
}

impl WithSimd for Solve<'_, '_, '_> {
    type Output = Solution;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Solution {
        let Solve {
            problem,
            tolerance,
            max_iterations,
            w,
            at,
            ws,
        } = self;
        ws.accepted.w.copy_from_slice(w);
        problem.complete(&mut ws.accepted);
        let yardstick = problem.yardstick();
        ws.yardstick = yardstick;
        let mut residual = problem.residual(simd, &ws.accepted, yardstick);
        let mut iterations = 0;
        if let Some(iterative) = &mut ws.iterative {
            iterative.begin();
        } else if residual > tolerance {
            ws.cache.prepare(problem, at);
        }
        let (mut slow, mut is_at_rounding) = (0, false);
        let (mut best, mut stalled) = (residual, 0);
        let mut far = 0;
        ws.is_careful = false;
        ws.direction.begin();
        loop {
            if residual <= tolerance && !ws.accepted.is_exact {
                problem.make_exact(&mut ws.accepted);
                residual = problem.residual(simd, &ws.accepted, yardstick);
                ws.is_careful = true;
            }
            if residual.is_nan() || residual <= tolerance {
                break;
            }
            if (iterations == 0 || slow > 0 || ws.is_careful)
                && problem.residual(simd, &ws.accepted, Yardstick::default()) <= LARGEST_FLOOR
                && let Some(left) = at_rounding(problem, tolerance, ws)
            {
                (residual, is_at_rounding) = (left, true);
                break;
            }
            if stalled >= PATIENCE
                && let Some(left) = at_rounding_of_slip(problem, tolerance, at, ws)
            {
                (residual, is_at_rounding) = (left, true);
                break;
            }
            if iterations >= max_iterations {
                break;
            }
            iterations += 1;
            if let Some(iterative) = &mut ws.iterative {
                iterative.enough = tolerance / residual;
            }
            let crawls = far >= CRAWLING;
            let is_taken = if crawls && cascade(problem, ws) {
                true
            } else {
                loop {
                    let is_taken = newton_step(simd, problem, residual, slow, at, ws);
                    if is_taken || ws.direction.is_new {
                        break is_taken;
                    }
                    slow = PATIENCE;
                }
            };
            if !is_taken {
                sweep(problem, ws);
            }
            let before = std::mem::replace(
                &mut residual,
                problem.residual(simd, &ws.accepted, yardstick),
            );
            slow = if residual > SLOW * before {
                slow + 1
            } else {
                0
            };
            (best, stalled) = if residual > SLOW * best {
                (best, stalled + 1)
            } else {
                (residual, 0)
            };
            far = if residual > FAR && !crawls {
                far + 1
            } else {
                0
            };
        }
        rest_the_slowest(problem, &mut ws.accepted);
        w.copy_from_slice(&ws.accepted.w);
        // a residual that is not a number is not within the tolerance
        let converged = residual <= tolerance || is_at_rounding;
        let node = if converged {
            0
        } else {
            problem.worst_node(&ws.accepted, yardstick).1
        };
        Solution {
            iterations,
            residual,
            node,
            converged,
            is_at_rounding: converged && residual > tolerance,
        }
    }
}

/// Finds the direction at the accepted point; see [`Direction`].
#[inline(always)]
fn find<S: Simd>(
    simd: S,
    problem: &ContactProblem,
    slow: u32,
    at: &mut Linearisation,
    ws: &mut Workspace,
) -> bool {
    let (direction, point) = (&mut ws.direction, &ws.accepted);
    match &mut ws.iterative {
        Some(iterative) => direction.find_iteratively(problem, point, iterative),
        None => direction.find(simd, problem, point, at, &mut ws.cache, slow),
    }
}

/// Tries a Newton step; on success `ws.accepted` is the new point.
#[inline(always)]
fn newton_step<S: Simd>(
    simd: S,
    problem: &ContactProblem,
    residual: f64,
    slow: u32,
    at: &mut Linearisation,
    ws: &mut Workspace,
) -> bool {
    if !find(simd, problem, slow, at, ws) {
        return false;
    }
    let mut length = 1.0;
    for _ in 0..=HALVINGS {
        let judgement = advance(simd, problem, length, ws);
        let change = judgement.change;
        let is_decrease =
            judgement.predicted < 0.0 && change <= SUFFICIENT_DECREASE * judgement.predicted;
        let is_rounding = || change.abs() <= ENERGY_ROUNDING * judgement.scale;
        if is_decrease
            || (is_rounding() && problem.residual(simd, &ws.trial, ws.yardstick) < residual)
        {
            if ws.direction.is_majorised && length == 1.0 {
                lengthen(problem, change, ws);
            }
            let is_plain = ws.has_plain_trial;
            ws.direction.note(is_plain.then_some(length));
            std::mem::swap(&mut ws.accepted, &mut ws.trial);
            return true;
        }
        length *= 0.5;
    }
    false
}

/// Doubles the step while W decreases further: where W is not convex the majoriser makes steps far too short.
#[inline(never)]
fn lengthen(problem: &ContactProblem, change: f64, ws: &mut Workspace) {
    let (mut length, mut best) = (1.0, change);
    for _ in 0..DOUBLINGS {
        let change = advance(Scalar, problem, 2.0 * length, ws).change;
        if change.is_nan() || change >= best {
            break;
        }
        (length, best) = (2.0 * length, change);
    }
    advance(Scalar, problem, length, ws);
    ws.has_plain_trial = false;
}

/// `trial = accepted + length * step` with all that follows, a node that would reverse stops at stick. Returns how W changes.
#[inline(always)]
fn advance<S: Simd>(
    simd: S,
    problem: &ContactProblem,
    length: f64,
    ws: &mut Workspace,
) -> Judgement {
    let (accepted, trial, direction) = (&ws.accepted, &mut ws.trial, &ws.direction);
    let reverses = if direction.has_forces {
        let step = (&*direction.step, &*direction.forces, &*direction.normal);
        plane::advance(simd, accepted, length, step, trial)
    } else {
        let step = (&*direction.step, &*direction.turns);
        space::advance(accepted, length, step, &mut trial.w);
        true
    };
    let has_stopped = reverses && stop_reversals(problem, direction, &mut trial.w);
    ws.has_plain_trial = direction.has_forces && !has_stopped;
    trial.is_exact = ws.is_careful || !ws.has_plain_trial;
    if trial.is_exact {
        problem.complete(trial);
    } else {
        problem.apply_law(trial);
    }
    problem.judge(simd, &direction.gradient, accepted, trial)
}

/// Stops the nodes that would reverse at stick. Whether there were any.
#[inline(never)]
fn stop_reversals(problem: &ContactProblem, direction: &Direction, w: &mut [f64]) -> bool {
    let c = problem.components;
    let mut has_stopped = false;
    let nodes = w.chunks_exact_mut(c).zip(direction.normal.chunks_exact(c));
    for (node, (new, normal)) in nodes.enumerate() {
        let forward: f64 = new.iter().zip(normal).map(|(w, n)| w * n).sum();
        let moves = normal.iter().any(|n| *n != 0.0);
        // without a bound at rest there is no kink to stop at
        if moves && forward <= 0.0 && problem.bound_at_rest(node) > 0.0 {
            new.fill(0.0);
            has_stopped = true;
        }
    }
    has_stopped
}

/// Moves to a point found on fewer nodes if W decreases. Whether it does.
#[inline(never)]
fn cascade(problem: &ContactProblem, ws: &mut Workspace) -> bool {
    if !ws.cascade.exists() {
        return false;
    }
    let (accepted, trial) = (&ws.accepted, &mut ws.trial);
    ws.cascade.descend(problem, &accepted.w, &mut trial.w);
    problem.complete(trial);
    let change = problem
        .judge(Scalar, &ws.direction.gradient, accepted, trial)
        .change;
    let is_decrease = change < 0.0;
    if is_decrease {
        ws.direction.note(None);
        std::mem::swap(&mut ws.accepted, &mut ws.trial);
    }
    is_decrease
}

/// Takes sweeps instead of a refused Newton step.
#[inline(never)]
fn sweep(problem: &ContactProblem, ws: &mut Workspace) {
    ws.direction.note(None);
    for _ in 0..SWEEPS {
        frozen_bound_sweep(problem, &mut ws.accepted);
    }
    problem.complete(&mut ws.accepted);
}
