//! The direction of a Newton step, from a factor made at a point of linearisation nearby.
//!
//! A Newton step solves with `K = S + D` on the nodes that move, D the second variation of the friction potential there. The
//! solver keeps the factor of `K_0 = S_FF + D_0`, which was made at an earlier point (see `linearisation`). Where D differs
//! noticeably from D_0, and where a free node sticks, the difference is a sum of few terms `delta e e^T` (delta is infinite
//! for a node that sticks), and
//!
//! ```text
//! K^-1 g = K_0^-1 (g - E b),   (Delta^-1 + E^T K_0^-1 E) b = E^T K_0^-1 g                (Woodbury; see `small`)
//! ```
//!
//! Smaller differences are not corrected; they cost iterations, not accuracy. The small matrix is factored as L D L^T with
//! the positive deltas first. K is positive definite exactly when each pivot has the sign of its delta. When it is not, the
//! terms with negative delta are dropped: the matrix is then above K, and the direction still descends. When there are too
//! many terms, or when a node moves that is not free in K_0, K is factored anew at the present point.
//!
//! A step `K_0^-1 rhs` also gives `S step = rhs - D_0 step` on the free nodes without a product with S.

use super::attempts::Attempts;
use super::iterative::Iterative;
use super::last::Last;
use super::linearisation::{Factor, FactorCache, Linearisation};
use super::second_variation::{NOTICEABLE, SecondVariation, term_capacity};
use super::small::{SmallSystem, Term};
use crate::contact::plane::{self, Motion};
use crate::contact::point::Point;
use crate::contact::problem::ContactProblem;
use crate::contact::space;
use crate::linalg::{DenseCholesky, column, lanes, multiply};
use pulp::Simd;

/// Nodes up to which one product with S costs less than a dot product for every node that is not free.
const SMALL: usize = 64;
/// Slow steps in a row after which the matrix is refactored even if nodes have changed between stick and slip meanwhile.
pub const PATIENCE: u32 = 8;

/// Direction of a Newton step, and scratch to find it.
pub struct Direction {
    /// Slip direction of what moves, all components; zero where a node sticks.
    pub normal: Vec<f64>,
    /// Derivative of W along the components of what moves, N; zero where a node sticks.
    pub gradient: Vec<f64>,
    /// The step, m/s.
    pub step: Vec<f64>,
    /// Tangent of the angle by which every node turns its slip direction beside its step; see `space`.
    pub turns: Vec<f64>,
    /// `S step`, N; only when `has_forces`.
    pub forces: Vec<f64>,
    /// Whether the forces of the step are known.
    pub has_forces: bool,
    /// Whether the matrix is above the second variation of W.
    pub is_majorised: bool,
    attempts: Attempts,
    /// Whether the point of linearisation is the present one.
    pub is_new: bool,
    /// Solves so far.
    pub solves: u64,
    last: Last,
    /// How much every node differs from the point of linearisation; infinite where that is not known.
    differences: Vec<f64>,
    rhs: Vec<f64>,
    /// Half-way through a solve.
    half: Vec<f64>,
    solution: Vec<f64>,
    terms: Vec<Term>,
    small: SmallSystem,
}

impl Direction {
    pub fn new(nodes: usize, len: usize) -> Direction {
        let (most, padded) = (term_capacity(nodes, len), DenseCholesky::padded(len));
        Direction {
            normal: vec![0.0; len],
            gradient: vec![0.0; len],
            step: vec![0.0; len],
            turns: vec![0.0; nodes],
            forces: vec![0.0; len],
            has_forces: false,
            is_majorised: false,
            attempts: Attempts::new(len / nodes),
            is_new: false,
            solves: 0,
            last: Last::new(len),
            differences: vec![0.0; nodes],
            rhs: vec![0.0; padded],
            half: vec![0.0; padded],
            solution: vec![0.0; padded],
            terms: Vec::with_capacity(most),
            small: SmallSystem::new(most, padded),
        }
    }

    /// Finds the direction at `point`, after `slow` slow steps in a row. The matrix is factored at this point when the slow
    /// steps are due to the old one, or when a correction of the old one would need too many terms. False when no
    /// node moves, or when no attempt gives a positive definite matrix.
    #[inline(always)]
    pub fn find<S: Simd>(
        &mut self,
        simd: S,
        problem: &ContactProblem,
        point: &Point,
        at: &mut Linearisation,
        cache: &mut FactorCache,
        slow: u32,
    ) -> bool {
        (self.is_majorised, self.is_new) = (self.attempts.is_majorised(), false);
        std::mem::swap(&mut self.normal, &mut self.last.normal);
        std::mem::swap(&mut self.gradient, &mut self.last.gradient);
        let seen = if problem.components == 1 {
            let last = &mut self.last;
            let before = (&*last.normal, &*last.gradient, &*last.step);
            let out = Motion {
                normal: &mut self.normal,
                gradient: &mut self.gradient,
                change: &mut last.change,
            };
            plane::motion(simd, point, before, out)
        } else {
            let found = space::motion(problem, point, &mut self.normal, &mut self.gradient);
            self.last
                .compare(problem.components, found, &self.normal, &self.gradient)
        };
        self.last.look(&seen);
        // a change between stick and slip shows in the residual whatever the matrix
        let mut wants_new = slow >= PATIENCE || (slow > 0 && seen.is_same_set);
        let mut moves = seen.moves;
        while moves {
            match cache.current().filter(|_| !wants_new) {
                Some(factor) if self.list_terms(simd, problem, point, factor) => {
                    self.solve(simd, problem, point, factor);
                }
                _ => {
                    if !self.relinearise(problem, point, at, cache) {
                        return false;
                    }
                    wants_new = false;
                    continue;
                }
            }
            if !seen.starts || !self.drop_false_starts(problem, point) {
                return true;
            }
            self.last.forget();
            moves = self.normal.iter().any(|n| *n != 0.0);
        }
        false
    }

    /// Finds the direction at `point` without a factor. False when no node moves, or when no attempt gives a positive definite
    /// matrix.
    #[inline(never)]
    pub fn find_iteratively(
        &mut self,
        problem: &ContactProblem,
        point: &Point,
        iterative: &mut Iterative,
    ) -> bool {
        (self.is_new, self.has_forces) = (true, false);
        self.attempts.begin_anew();
        let (normal, gradient) = (&mut self.normal, &mut self.gradient);
        let (mut moves, starts) = space::motion(problem, point, normal, gradient);
        while moves {
            loop {
                self.is_majorised = self.attempts.is_majorised();
                let wanted = SecondVariation {
                    problem,
                    point,
                    normal: &self.normal,
                    weakening: self.attempts.current().weakening,
                };
                if iterative.solve(&wanted, &self.gradient, &mut self.step) {
                    break;
                }
                if !self.attempts.advance() {
                    return false;
                }
            }
            self.solves += 1;
            let (step, turns) = (&mut self.step, &mut self.turns);
            space::split_turns(problem, point, &self.normal, step, turns);
            if !starts || !self.drop_false_starts(problem, point) {
                return true;
            }
            moves = self.normal.iter().any(|n| *n != 0.0);
        }
        false
    }

    fn moves(&self, problem: &ContactProblem, node: usize) -> bool {
        self.normal[problem.at(node)].iter().any(|n| *n != 0.0)
    }

    /// Makes the present point the point of linearisation; with the bound frozen where it decreases, if need be.
    #[inline(never)]
    fn relinearise(
        &mut self,
        problem: &ContactProblem,
        point: &Point,
        at: &mut Linearisation,
        cache: &mut FactorCache,
    ) -> bool {
        // again at the same point, with fewer nodes that move: what was indefinite with all of them is not tried again
        if !self.is_new {
            self.attempts.begin_anew();
        }
        self.is_new = true;
        loop {
            let attempt = self.attempts.current();
            self.is_majorised = self.attempts.is_majorised();
            let present = SecondVariation {
                problem,
                point,
                normal: &self.normal,
                weakening: attempt.weakening,
            };
            present.linearise(at, attempt.frees_near, &mut self.differences);
            if cache.prepare(problem, at) {
                return true;
            }
            if !self.attempts.advance() {
                return false;
            }
        }
    }

    /// Lists the terms by which K differs from the factored matrix. False when there are too many of them, or when a node
    /// moves that is not free in the factored matrix.
    #[inline(always)]
    fn list_terms<S: Simd>(
        &mut self,
        simd: S,
        problem: &ContactProblem,
        point: &Point,
        factor: &Factor,
    ) -> bool {
        self.terms.clear();
        if problem.components == 1 && !self.is_majorised {
            let (normal, slope) = (&self.normal, &point.law.slope);
            let at_hand = (&*factor.blocks, &*factor.yielding);
            let differences = &mut self.differences;
            let largest = plane::differences(simd, normal, slope, at_hand, differences);
            // NaN is a difference
            if largest <= NOTICEABLE {
                return true;
            }
        } else {
            self.differences.fill(f64::INFINITY);
        }
        let wanted = SecondVariation {
            problem,
            point,
            normal: &self.normal,
            weakening: self.attempts.current().weakening,
        };
        wanted.list_terms(factor, &self.differences, &mut self.terms)
    }

    /// The step of the matrix wanted, from the factor at hand, the terms and the last step.
    #[inline(always)]
    fn solve<S: Simd>(
        &mut self,
        simd: S,
        problem: &ContactProblem,
        point: &Point,
        factor: &Factor,
    ) {
        let (c, order) = (problem.components, factor.order());
        let cholesky = &factor.cholesky;
        let padded = cholesky.padded_order();
        let (rhs, filling) = self.rhs[..padded].split_at_mut(order);
        filling.fill(0.0);
        let share = self.last.share();
        let is_plain = c == 1 && order == self.step.len();
        if is_plain {
            plane::right_side(simd, share, &self.last.change, &self.gradient, rhs);
        } else {
            for (rhs, component) in rhs.iter_mut().zip(&factor.components) {
                *rhs = share * self.last.change[*component] - self.gradient[*component];
            }
        }
        let (half, solution) = (&mut self.half[..padded], &mut self.solution[..padded]);
        cholesky.solve_lower(&self.rhs[..padded], half);
        let rhs = &mut self.rhs[..order];
        if !self.terms.is_empty() && !self.small.apply(&self.terms, factor, c, rhs, half) {
            self.is_majorised = true;
        }
        cholesky.solve_upper(half, solution);
        self.solves += 1;
        self.has_forces = c == 1;
        let product = if is_plain {
            let known = (&solution[..order], &*rhs, &*factor.blocks);
            let (step, forces) = (&mut self.step, &mut self.forces);
            plane::step_of_all(simd, known, &self.normal, &self.last.change, step, forces)
        } else {
            self.scatter(problem, factor);
            if c == 1 {
                self.scatter_forces(simd, problem, factor);
            } else {
                let (step, turns) = (&mut self.step, &mut self.turns);
                space::split_turns(problem, point, &self.normal, step, turns);
            }
            lanes::dot(simd, &self.last.change, &self.step)
        };
        if let Some(factor) = self.last.correction(product) {
            lanes::add_scaled(simd, &mut self.step, factor, &self.last.step);
            lanes::add_scaled(simd, &mut self.forces, factor, &self.last.forces);
        }
    }

    /// The step from the solution where not everything is free.
    #[inline(never)]
    fn scatter(&mut self, problem: &ContactProblem, factor: &Factor) {
        self.step.fill(0.0);
        for (value, component) in self.solution.iter().zip(&factor.components) {
            // what sticks stays exactly at rest
            if self.normal[*component] != 0.0 || problem.components > 1 {
                self.step[*component] = *value;
            }
        }
        if problem.components > 1 {
            for node in 0..problem.nodes() {
                if !self.moves(problem, node) {
                    self.step[problem.at(node)].fill(0.0);
                }
            }
        }
    }

    /// Forces of the step with one component where not everything is free.
    #[inline(always)]
    fn scatter_forces<S: Simd>(&mut self, simd: S, problem: &ContactProblem, factor: &Factor) {
        let clamped = problem.nodes() - factor.order();
        if problem.nodes() <= SMALL || 2 * clamped > problem.nodes() {
            return multiply(problem.s, &self.step, &mut self.forces);
        }
        for (node, force) in self.forces.iter_mut().enumerate() {
            if factor.yielding[node] == 0.0 {
                *force = lanes::dot(simd, column(problem.s, node), &self.step);
            }
        }
        for (rhs, component) in self.rhs.iter().zip(&factor.components) {
            let own = factor.blocks[*component] * self.step[*component];
            self.forces[*component] = rhs - own;
        }
    }

    /// A solve begins.
    pub fn begin(&mut self) {
        self.attempts.begin();
        self.last.forget();
    }

    /// Takes note that the step, times `length`, was taken as it is; or that another one was.
    #[inline(always)]
    pub fn note(&mut self, length: Option<f64>) {
        match length {
            Some(length) => self.last.keep(&mut self.step, &mut self.forces, length),
            None => self.last.forget(),
        }
    }

    /// Drops the nodes at rest that the direction would start backwards: they stay at rest while the others are solved
    /// again. Whether there were any. With two components the others start along their direction only: across it the
    /// bound is infinitely stiff.
    fn drop_false_starts(&mut self, problem: &ContactProblem, point: &Point) -> bool {
        let mut dropped = false;
        for (node, rate) in point.rates.iter().enumerate() {
            if *rate > 0.0 {
                continue;
            }
            let at = problem.at(node);
            let normal = &mut self.normal[at.clone()];
            if normal.iter().all(|n| *n == 0.0) {
                continue;
            }
            let step = &mut self.step[at.clone()];
            let forward: f64 = step.iter().zip(&*normal).map(|(s, n)| s * n).sum();
            // what is not a number is not forward
            if forward > 0.0 {
                if step.len() > 1 {
                    for (step, n) in step.iter_mut().zip(&*normal) {
                        *step = forward * n;
                    }
                }
            } else {
                normal.fill(0.0);
                self.gradient[at].fill(0.0);
                dropped = true;
            }
        }
        dropped
    }
}
