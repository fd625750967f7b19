//! The contact of a stage with normal motion and force: the gap it is solved for, and the solver's vectors, which have the normal
//! component of a node behind its tangential ones.
//!
//! The gap condition is put on the position at the end of the stage, as a function of its velocity:
//!
//! ```text
//! gap = g_0 + p_n - d_f(t) + theta k w_n        p_n  explicit part of the normal displacement, d_f  approach of the foundation
//! ```
//!
//! The midpoint rule puts it on the end of the step, `gap = g_0 + u_n - d_f(t + k) + k w_n`, but for a foundation that gives way. A
//! start and values at the end of a step that has only means are solved at a fixed position: closed nodes then obey the condition
//! of velocities `0 <= p _|_ w_n - d_f' >= 0`, open ones have no force, and a foundation that gives way has the force of the gap.

use super::velocity::Velocity;
use crate::body::Stage;
use crate::contact::multiplicity::Multiplicity;
use crate::contact::pressed::tangent::PressedTangent;
use crate::contact::pressed::{
    NormalCondition, PressedBounds, PressedMultiplicity, PressedPoint, PressedProblem,
    PressedSolution, PressedWorkspace, solve,
};
use crate::model::Model;
use crate::scene::Condition;
use crate::state::Instant;

/// Share of the largest of gap, normal displacement and approach within which a node counts as closed.
const CLOSED: f64 = 1e-10;

/// What the gap is a condition on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Level {
    /// The position that the velocity leads to in `rate` seconds, where the foundation has approached by `approach`.
    Position { rate: f64, approach: f64 },
    /// The velocity itself: the foundation has approached by `approach`, and does so with `velocity`.
    Velocity { approach: f64, velocity: f64 },
}

/// Scratch of the stages.
pub(crate) struct PressedScratch {
    pub workspace: PressedWorkspace,
    velocity: Vec<f64>,
    force: Vec<f64>,
    /// Forces with which the body is in balance, against the body: minus the pressing ones.
    pub reaction: Vec<f64>,
    gap_base: Vec<f64>,
    /// Stiffness of the foundation at every node, where it gives way.
    stiffness: Vec<f64>,
    /// Scratch of the search for other solutions, where there is one.
    multiplicity: Option<PressedMultiplicity>,
}

impl PressedScratch {
    pub fn new(model: &Model) -> PressedScratch {
        let contact = model.contact();
        let len = contact.force_len();
        let stiffness = match model.condition() {
            Condition::Compliance { stiffness, .. } => {
                contact.weights.iter().map(|w| w * stiffness).collect()
            }
            _ => Vec::new(),
        };
        PressedScratch {
            workspace: PressedWorkspace::new(contact.node_count(), contact.components),
            velocity: vec![0.0; len],
            force: vec![0.0; len],
            reaction: vec![0.0; len],
            gap_base: vec![0.0; contact.node_count()],
            stiffness,
            multiplicity: model
                .has_multiplicity_test()
                .then(|| PressedMultiplicity::new(contact.node_count(), contact.components)),
        }
    }

    /// The contact velocities that were solved for.
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Gap at the normal velocity 0, into `gap_base`, and its growth by the velocity.
    fn set_gap(&mut self, model: &Model, displacement: &[f64], level: Level) -> f64 {
        let gaps = &model.contact().gaps;
        let at = |node: usize| gaps.get(node).copied().unwrap_or(0.0) + displacement[node];
        match level {
            Level::Position { rate, approach } => {
                for (node, base) in self.gap_base.iter_mut().enumerate() {
                    *base = at(node) - approach;
                }
                rate
            }
            Level::Velocity { approach, velocity } => match model.condition() {
                Condition::Bilateral => {
                    self.gap_base.fill(-velocity);
                    1.0
                }
                Condition::Unilateral { .. } => {
                    let sizes = (0..self.gap_base.len()).map(|node| {
                        let gap = gaps.get(node).copied().unwrap_or(0.0);
                        gap.abs().max(displacement[node].abs())
                    });
                    let size = sizes.fold(approach.abs(), f64::max);
                    for (node, base) in self.gap_base.iter_mut().enumerate() {
                        let is_closed = at(node) - approach <= CLOSED * size;
                        *base = if is_closed { -velocity } else { f64::INFINITY };
                    }
                    1.0
                }
                Condition::Compliance { .. } => {
                    for (node, base) in self.gap_base.iter_mut().enumerate() {
                        *base = at(node) - approach;
                    }
                    0.0
                }
            },
        }
    }

    /// Solves the contact of a stage from the warm start in `velocity`, and writes what it finds there.
    pub fn solve(
        &mut self,
        at: &PressedStage,
        velocity: &mut Velocity,
        points: &mut [f64],
        (tolerance, max_iterations): (f64, usize),
    ) -> PressedSolution {
        let gap_rate = self.set_gap(at.model, at.displacement, at.level);
        self.gather(at.model, &velocity.instant);
        let PressedScratch {
            workspace,
            velocity: contact_velocity,
            force,
            reaction,
            gap_base,
            stiffness,
            ..
        } = self;
        let solution = solve(
            &at.problem(gap_base, gap_rate, stiffness),
            tolerance,
            max_iterations,
            contact_velocity,
            force,
            reaction,
            &mut PressedPoint::of(points, at.theta_k, gap_rate),
            workspace,
        );
        let found = [&self.velocity[..], &self.force, &self.reaction];
        scatter(at.model.contact().components, found, &mut velocity.instant);
        solution
    }

    /// Other solutions of the stage that was solved last, where the scene asks for them.
    pub fn search(&mut self, at: &PressedStage, limits: (f64, usize)) -> Option<Multiplicity> {
        let gap_rate = self.set_gap(at.model, at.displacement, at.level);
        let problem = at.problem(&self.gap_base, gap_rate, &self.stiffness);
        let search = self.multiplicity.as_mut()?;
        Some(search.search(&problem, limits, &self.velocity, &self.force))
    }

    /// The tangent of a stage at its solution, and the problem that it is of.
    pub fn tangent<'a>(
        &'a mut self,
        at: &'a PressedStage,
        solution: &Instant,
    ) -> (PressedTangent, PressedProblem<'a>) {
        let gap_rate = self.set_gap(at.model, at.displacement, at.level);
        self.gather(at.model, solution);
        let problem = at.problem(&self.gap_base, gap_rate, &self.stiffness);
        let tangent = PressedTangent::new(&problem, &self.velocity, &self.force);
        (tangent, problem)
    }

    /// Velocities and forces of an instant in the solver's order.
    fn gather(&mut self, model: &Model, instant: &Instant) {
        let contact = model.contact();
        let (c, stride) = (contact.components, contact.stride());
        for node in 0..contact.node_count() {
            let (own, all) = (node * c..(node + 1) * c, node * stride..node * stride + c);
            self.velocity[all.clone()].copy_from_slice(&instant.slip_rate[own.clone()]);
            self.force[all].copy_from_slice(&instant.force[own]);
            self.velocity[node * stride + c] = instant.normal_velocity[node];
            self.force[node * stride + c] = instant.normal_force[node];
        }
    }
}

/// Velocities, forces and reactions in the order of the solver, node by node into an instant.
pub(crate) fn scatter(c: usize, [velocity, force, reaction]: [&[f64]; 3], to: &mut Instant) {
    let nodes = velocity.chunks_exact(c + 1).zip(force.chunks_exact(c + 1));
    let nodes = nodes.zip(reaction.chunks_exact(c + 1));
    for (node, ((velocity, force), reaction)) in nodes.enumerate() {
        let own = node * c..(node + 1) * c;
        to.slip_rate[own.clone()].copy_from_slice(&velocity[..c]);
        to.force[own.clone()].copy_from_slice(&force[..c]);
        to.reaction[own].copy_from_slice(&reaction[..c]);
        to.normal_velocity[node] = velocity[c];
        to.normal_force[node] = force[c];
        to.normal_reaction[node] = 0.0 - reaction[c];
    }
}

/// A stage as the solver sees it.
pub(crate) struct PressedStage<'a> {
    pub model: &'a Model,
    pub stage: &'a Stage,
    /// Condensed load.
    pub load: &'a [f64],
    pub bounds: &'a dyn PressedBounds,
    pub theta_k: f64,
    pub level: Level,
    /// Accumulated slip and normal displacement before the implicit part of the stage.
    pub slip: &'a [f64],
    pub displacement: &'a [f64],
}

impl<'a> PressedStage<'a> {
    fn problem<'b>(
        &'b self,
        gap_base: &'b [f64],
        gap_rate: f64,
        stiffness: &'b [f64],
    ) -> PressedProblem<'b>
    where
        'a: 'b,
    {
        let contact = self.model.contact();
        PressedProblem {
            s: self.stage.s.as_ref(),
            r: self.load,
            yielding: &self.stage.yielding,
            components: contact.components,
            weights: &contact.weights,
            bounds: self.bounds,
            slip_base: self.slip,
            theta_k: self.theta_k,
            condition: match self.model.condition() {
                Condition::Bilateral => NormalCondition::Bilateral,
                Condition::Unilateral { .. } => NormalCondition::Unilateral,
                Condition::Compliance { exponent, .. } => NormalCondition::Compliance {
                    exponent: *exponent,
                },
            },
            stiffness,
            gap_base,
            gap_rate,
        }
    }
}

impl Level {
    /// Derivative of the gap at the normal velocity 0, into `out`, from those of the normal displacements and, in `self`, of the
    /// approach and its velocity.
    pub fn gap_slopes(&self, condition: &Condition, displacement: &[f64], out: &mut [f64]) {
        match (self, condition) {
            (
                Level::Velocity { velocity, .. },
                Condition::Bilateral | Condition::Unilateral { .. },
            ) => {
                out.fill(-velocity);
            }
            (Level::Position { approach, .. } | Level::Velocity { approach, .. }, _) => {
                for (out, moved) in out.iter_mut().zip(displacement) {
                    *out = moved - approach;
                }
            }
        }
    }
}
