//! Newton's method on the normal map: steps in velocities and forces, projected onto the laws of the nodes.
//!
//! A step takes the factor kept from an earlier point, with a border for the few nodes that do something else by now. Where the laws
//! of many have other slopes, it is taken as it is if it contracts well; otherwise the matrix is factored at the present point,
//! and the step is halved until the imbalance decreases.
//!
//! Where no bound weakens fast, the first steps of a descent are whole whatever the imbalance: a front between stick and slip, or the
//! edge of an open part, moves over many nodes at once, and halving would only move it by fewer. If they do not lead to the
//! solution, the descent goes on from the best of their points. A node whose slip such steps reverse twice is let stick: it would
//! go to and fro for ever, and its solution lies between.

use super::direction::Direction;
use super::energy::Energy;
use super::linearisation::{Distance, FactorCache, Following, PressedPoint};
use super::node::Node;
use super::point::{Point, Slopes, length, raise_slopes, set_slopes};
use super::problem::PressedProblem;
use super::residual::{is_near_balance, residual_beyond_rounding, worst_node};
use crate::linalg::dot;

/// Halvings of a step before Newton's method gives up.
const HALVINGS: usize = 8;
/// Share of the predicted decrease of the imbalance that a step must make.
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// A step with an older factor must leave at most this share of the imbalance.
const CONTRACTION: f64 = 0.1;
/// Points among which a step of a patient descent must find one with more imbalance: where a node starts to slip or stops, the
/// imbalance may have to rise before it falls.
const MEMORY: usize = 3;
/// Steps of a descent that are whole whatever the imbalance.
const BOLD_STEPS: usize = 10;
/// Bold steps end where the imbalance is this many times the least.
const TOO_BOLD: f64 = 10.0;
/// A step that leaves more than this share of the imbalance is slow.
const SLOW: f64 = 0.5;

/// The point of the iteration and all that a step needs.
pub(super) struct Newton {
    pub accepted: Point,
    pub trial: Point,
    pub slopes: Slopes,
    pub direction: Direction,
    pub cache: FactorCache,
    /// Whether the imbalance may rise for a few steps.
    pub is_patient: bool,
    energy: Energy,
    /// Whether the imbalance is measured by its energy.
    is_energetic: bool,
    /// Whether steps are whole whatever the imbalance.
    is_bold: bool,
    /// Whether a node has reversed its slip in this descent.
    has_reversed: Vec<bool>,
    /// The least imbalance among the points of bold steps, N.
    least_merit: f64,
    /// Its point, where that is not the accepted one.
    kept: Point,
    is_least_kept: bool,
    /// Imbalance of the last points, the latest last.
    past: [f64; MEMORY],
    /// Steps taken so far.
    pub steps: u64,
}

/// How a descent ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Outcome {
    /// The residual is within the tolerance.
    Converged(f64),
    /// It is as small as rounding allows; the residual that is left.
    AtRounding(f64),
    /// No step decreases the imbalance, or many did not suffice.
    Stalled,
    /// All iterations are used up.
    Exhausted,
}

impl Outcome {
    pub fn is_solution(self) -> bool {
        matches!(self, Outcome::Converged(_) | Outcome::AtRounding(_))
    }
}

/// Iterations that are left to a solve.
pub(super) struct Budget {
    pub left: usize,
}

impl Budget {
    /// Takes one, if there is one.
    pub fn take(&mut self) -> bool {
        let is_left = !self.is_used_up();
        self.left -= usize::from(is_left);
        is_left
    }

    pub fn is_used_up(&self) -> bool {
        self.left == 0
    }
}

/// Numbers between -1 and 1 without a pattern: the fractions of multiples of the golden ratio, and of their products.
fn noise(i: usize, number: u32) -> f64 {
    let golden = 0.618_033_988_749_894_9;
    let first = (golden * (i + 1) as f64).fract();
    2.0 * (1e3 * first * (1.0 + f64::from(number))).fract() - 1.0
}

impl Newton {
    pub fn new(nodes: usize, components: usize) -> Newton {
        let len = nodes * (components + 1);
        Newton {
            accepted: Point::new(nodes, len),
            trial: Point::new(nodes, len),
            slopes: vec![[0.0; 2]; nodes],
            direction: Direction::new(len),
            cache: FactorCache::new(nodes, components),
            is_patient: false,
            energy: Energy::new(len),
            is_energetic: false,
            is_bold: false,
            has_reversed: vec![false; nodes],
            least_merit: f64::NAN,
            kept: Point::new(nodes, len),
            is_least_kept: false,
            past: [0.0; MEMORY],
            steps: 0,
        }
    }

    /// Starts from velocities and forces.
    pub fn start(&mut self, problem: &PressedProblem, velocity: &[f64], force: &[f64]) {
        self.accepted.v.copy_from_slice(velocity);
        self.accepted.f.copy_from_slice(force);
        set_slopes(problem, force, &mut self.slopes);
        self.accepted.project(problem, &self.slopes);
    }

    /// The same with slopes so many times as steep.
    pub fn start_steeper(
        &mut self,
        problem: &PressedProblem,
        velocity: &[f64],
        force: &[f64],
        times: f64,
    ) {
        self.start(problem, velocity, force);
        self.slopes.iter_mut().flatten().for_each(|s| *s *= times);
        self.accepted.v.copy_from_slice(velocity);
        self.accepted.f.copy_from_slice(force);
        self.accepted.project(problem, &self.slopes);
    }

    /// Starts from velocities that have nothing to do with a last solution: zeros, or numbers without a pattern as large as the
    /// loads would make them, others for every `number`.
    pub fn start_anew(&mut self, problem: &PressedProblem, number: u32) {
        let Newton {
            accepted, slopes, ..
        } = self;
        let sizes = problem.r.iter().zip(problem.yielding);
        let largest = sizes.fold(0.0_f64, |most, (r, yielding)| {
            most.max((r * yielding).abs())
        });
        for (i, v) in accepted.v.iter_mut().enumerate() {
            *v = f64::from(number) * noise(i, number) * largest;
        }
        accepted.f.fill(0.0);
        set_slopes(problem, &accepted.f, slopes);
        accepted.project(problem, slopes);
    }

    /// Steps until the problem is solved, no step helps or `most` have been taken.
    pub fn descend(
        &mut self,
        problem: &PressedProblem,
        tolerance: f64,
        most: usize,
        budget: &mut Budget,
        at: &mut PressedPoint,
    ) -> Outcome {
        let mut is_slow = true;
        self.measure();
        self.past = [0.0; MEMORY];
        self.is_bold = !self.is_patient && !problem.can_weaken(&self.accepted.f);
        self.has_reversed.fill(false);
        for step in 0.. {
            self.end_boldness(step);
            let residual = worst_node(problem, &self.accepted).0;
            if residual <= tolerance {
                return Outcome::Converged(residual);
            }
            if is_slow && let Some(left) = self.at_rounding(problem, tolerance) {
                return Outcome::AtRounding(left);
            }
            if step >= most {
                break;
            }
            if !budget.take() {
                self.take_least();
                return Outcome::Exhausted;
            }
            self.steps += 1;
            let before = self.accepted.merit;
            if !self.step(problem, at) {
                return match self.at_rounding(problem, tolerance) {
                    Some(left) => Outcome::AtRounding(left),
                    None => Outcome::Stalled,
                };
            }
            if self.is_bold {
                self.hold_reversing(problem);
            }
            is_slow = self.accepted.merit > SLOW * before;
            raise_slopes(problem, &self.accepted.f, &mut self.slopes);
        }
        Outcome::Stalled
    }

    /// Takes note of the point of a bold step, and goes back to the best one where there were enough of them.
    fn end_boldness(&mut self, step: usize) {
        if !self.is_bold {
            return;
        }
        let merit = self.accepted.merit;
        if step == 0 || merit < self.least_merit {
            (self.least_merit, self.is_least_kept) = (merit, false);
        } else if !self.is_least_kept {
            // the best point is the one before, which a step leaves in `trial`
            self.kept.copy_from(&self.trial);
            self.is_least_kept = true;
        }
        // not a number is far
        let is_near = merit <= TOO_BOLD * self.least_merit;
        if step >= BOLD_STEPS || !is_near {
            self.take_least();
            self.is_bold = false;
        }
    }

    /// Goes back to the point of the least imbalance among those of bold steps.
    fn take_least(&mut self) {
        if self.is_bold && self.is_least_kept {
            self.accepted.copy_from(&self.kept);
        }
    }

    /// Lets nodes stick whose slip a bold step has reversed, if it is not for the first time: they would go to and fro for ever.
    fn hold_reversing(&mut self, problem: &PressedProblem) {
        let c = problem.components;
        let Newton {
            accepted,
            trial,
            has_reversed,
            ..
        } = self;
        let mut is_changed = false;
        let nodes = accepted.nodes.iter().zip(&trial.nodes);
        for (node, ((now, before), has_reversed)) in nodes.zip(has_reversed).enumerate() {
            let turn = dot(&now.direction[..c], &before.direction[..c]);
            let is_pressed = |node: &Node| !node.is_free || node.fall > 0.0;
            let resists = |node: &Node| node.slips && is_pressed(node);
            if !(resists(now) && resists(before) && turn < 0.0) {
                continue;
            }
            if *has_reversed {
                accepted.v[problem.tangential(node)].fill(0.0);
                accepted.f[problem.tangential(node)].fill(0.0);
                is_changed = true;
            }
            *has_reversed = true;
        }
        if is_changed {
            accepted.project(problem, &self.slopes);
            if self.is_energetic {
                self.measure();
            }
        }
    }

    fn at_rounding(&self, problem: &PressedProblem, tolerance: f64) -> Option<f64> {
        is_near_balance(problem, &self.accepted)
            .then(|| residual_beyond_rounding(problem, &self.accepted, tolerance))
            .flatten()
    }

    /// One step; false when none decreases the imbalance, or the matrix is singular.
    fn step(&mut self, problem: &PressedProblem, at: &mut PressedPoint) -> bool {
        let distance = at.compare(problem.components, &self.accepted.nodes);
        if distance == Distance::Slopes && self.find(problem, at, Following::Statuses) {
            self.advance(problem, 1.0);
            if self.trial.merit <= CONTRACTION * self.accepted.merit {
                std::mem::swap(&mut self.accepted, &mut self.trial);
                return true;
            }
        }
        let most = self.most_imbalance();
        if distance == Distance::Bordered
            && self.find(problem, at, Following::All)
            && self.search(problem, most)
        {
            return true;
        }
        if at.set(problem.components, &self.accepted.nodes) {
            self.find(problem, at, Following::All) && self.search(problem, most)
        } else {
            false
        }
    }

    /// What the imbalance of the next point must stay below.
    fn most_imbalance(&mut self) -> f64 {
        self.past.rotate_left(1);
        self.past[MEMORY - 1] = self.accepted.merit;
        if self.is_bold {
            f64::MAX
        } else if self.is_patient {
            let past = self.past.iter();
            past.fold(0.0, |most: f64, past| most.max(*past))
        } else {
            self.accepted.merit
        }
    }

    /// Halves the step until the imbalance decreases enough below `most`; false where it does not.
    fn search(&mut self, problem: &PressedProblem, most: f64) -> bool {
        let mut length = 1.0;
        for _ in 0..=HALVINGS {
            self.advance(problem, length);
            // not a number is no decrease
            if self.trial.merit <= (1.0 - SUFFICIENT_DECREASE * length) * most {
                std::mem::swap(&mut self.accepted, &mut self.trial);
                return true;
            }
            length *= 0.5;
        }
        false
    }

    /// The step with the factor at a point; false where that is singular.
    fn find(&mut self, problem: &PressedProblem, at: &PressedPoint, what: Following) -> bool {
        let nodes = (&self.accepted.nodes[..], what);
        let Some(factor) = self.cache.at(problem, at, nodes) else {
            return false;
        };
        self.direction.find(problem, &self.accepted, factor);
        true
    }

    /// The trial point at `length` steps.
    fn advance(&mut self, problem: &PressedProblem, length: f64) {
        let Newton {
            accepted,
            trial,
            direction,
            ..
        } = self;
        let velocities = trial.v.iter_mut().zip(&accepted.v).zip(&direction.dv);
        for ((new, old), change) in velocities {
            *new = old + length * change;
        }
        let forces = trial.f.iter_mut().zip(&accepted.f).zip(&direction.df);
        for ((new, old), change) in forces {
            *new = old + length * change;
        }
        trial.project(problem, &self.slopes);
        if self.is_energetic {
            trial.merit = self.energy.length(&trial.imbalance);
        }
    }

    /// Whether the imbalance is measured by its energy from here on, where S has a factor, or by its plain length.
    pub fn set_energetic(&mut self, problem: &PressedProblem, is_energetic: bool) {
        self.is_energetic = is_energetic && self.energy.prepare(problem);
    }

    /// Measures the imbalance of the accepted point.
    pub fn measure(&mut self) {
        let Newton {
            accepted, energy, ..
        } = self;
        accepted.merit = match self.is_energetic {
            true => energy.length(&accepted.imbalance),
            false => length(&accepted.imbalance),
        };
    }

    /// Forgets what was factored.
    pub fn forget(&mut self) {
        self.cache.forget();
        self.energy.forget();
    }
}
