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
    NormalCondition, NormalConditions, PressedBounds, PressedMultiplicity, PressedPoint,
    PressedProblem, PressedSolution, PressedWorkspace, solve,
};
use crate::model::Model;
use crate::model::motions::Approach;
use crate::scene::Condition;
use crate::state::Instant;

/// Share of the largest of gap, normal displacement and approach within which a node counts as closed.
const CLOSED: f64 = 1e-10;

/// What the gap is a condition on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Level {
    /// The position that the velocity leads to in `rate` seconds, where the foundation has approached by `approach`.
    Position { rate: f64, approach: Approach },
    /// The velocity itself: the foundation has approached by `approach`, and does so with `velocity`.
    Velocity {
        approach: Approach,
        velocity: Approach,
    },
}

impl Level {
    /// Displacements of the foundations towards the body.
    pub fn approach(&self) -> Approach {
        match self {
            Level::Position { approach, .. } | Level::Velocity { approach, .. } => *approach,
        }
    }

    /// Growth of the gap by the normal velocity where contact is rigid, and where it gives way.
    fn rates(&self) -> [f64; 2] {
        match self {
            Level::Position { rate, .. } => [*rate; 2],
            Level::Velocity { .. } => [1.0, 0.0],
        }
    }
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
    /// Condition of every node, where the contacts of the scene have different ones.
    conditions: Vec<NormalCondition>,
    /// Scratch of the search for other solutions, where there is one.
    multiplicity: Option<PressedMultiplicity>,
}

/// What the solver calls a condition.
fn condition_of(condition: &Condition) -> NormalCondition {
    match condition {
        Condition::Bilateral => NormalCondition::Bilateral,
        Condition::Unilateral { .. } => NormalCondition::Unilateral,
        Condition::Compliance { exponent, .. } => NormalCondition::Compliance {
            exponent: *exponent,
        },
    }
}

impl PressedScratch {
    pub fn new(model: &Model) -> PressedScratch {
        let contact = model.contact();
        let len = contact.force_len();
        let (mut stiffness, mut conditions) = (Vec::new(), Vec::new());
        for (part, condition) in contact.parts.iter().zip(model.conditions()) {
            let own = match condition {
                Condition::Compliance { stiffness, .. } => *stiffness,
                Condition::Bilateral | Condition::Unilateral { .. } => 0.0,
            };
            stiffness.extend(contact.weights[part.nodes.clone()].iter().map(|w| w * own));
            conditions.extend(part.nodes.clone().map(|_| condition_of(condition)));
        }
        let is_mixed = conditions.windows(2).any(|pair| pair[0] != pair[1]);
        if !is_mixed {
            conditions.clear();
        }
        if stiffness.iter().all(|stiffness: &f64| *stiffness == 0.0) {
            stiffness.clear();
        }
        PressedScratch {
            workspace: PressedWorkspace::new(contact.node_count(), contact.components),
            velocity: vec![0.0; len],
            force: vec![0.0; len],
            reaction: vec![0.0; len],
            gap_base: vec![0.0; contact.node_count()],
            stiffness,
            conditions,
            multiplicity: (model.has_multiplicity_test() || model.asks_uniqueness())
                .then(|| PressedMultiplicity::new(contact.node_count(), contact.components)),
        }
    }

    /// The contact velocities that were solved for.
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Gap at the normal velocity 0, into `gap_base`, and its growth by the velocity where no condition of its own is given.
    fn set_gap(&mut self, model: &Model, displacement: &[f64], level: Level) -> f64 {
        let contact = model.contact();
        let gaps = &contact.gaps;
        let at = |node: usize| gaps.get(node).copied().unwrap_or(0.0) + displacement[node];
        for (index, (part, condition)) in contact.parts.iter().zip(model.conditions()).enumerate() {
            let nodes = part.nodes.clone();
            match (level, condition) {
                (Level::Velocity { velocity, .. }, Condition::Bilateral) => {
                    self.gap_base[nodes].fill(-velocity.of(index));
                }
                (Level::Velocity { approach, velocity }, Condition::Unilateral { .. }) => {
                    let (approach, velocity) = (approach.of(index), velocity.of(index));
                    let sizes = nodes.clone().map(|node| {
                        let gap = gaps.get(node).copied().unwrap_or(0.0);
                        gap.abs().max(displacement[node].abs())
                    });
                    let size = sizes.fold(approach.abs(), f64::max);
                    for node in nodes {
                        let is_closed = at(node) - approach <= CLOSED * size;
                        self.gap_base[node] = if is_closed { -velocity } else { f64::INFINITY };
                    }
                }
                (Level::Position { approach, .. }, _)
                | (Level::Velocity { approach, .. }, Condition::Compliance { .. }) => {
                    let approach = approach.of(index);
                    for node in nodes {
                        self.gap_base[node] = at(node) - approach;
                    }
                }
            }
        }
        let [rigid, yielding] = level.rates();
        match (&model.conditions()[0], &self.conditions[..]) {
            (Condition::Compliance { .. }, []) => yielding,
            _ => rigid,
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
            conditions,
            ..
        } = self;
        let solution = solve(
            &at.problem((gap_base, gap_rate), stiffness, conditions),
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
        let gap = (&self.gap_base[..], gap_rate);
        let problem = at.problem(gap, &self.stiffness, &self.conditions);
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
        let gap = (&self.gap_base[..], gap_rate);
        let problem = at.problem(gap, &self.stiffness, &self.conditions);
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
    /// See [`PressedProblem::relaxing`].
    pub relaxing: &'a [[f64; 2]],
    /// Accumulated slip and normal displacement before the implicit part of the stage.
    pub slip: &'a [f64],
    pub displacement: &'a [f64],
}

impl<'a> PressedStage<'a> {
    fn problem<'b>(
        &'b self,
        (gap_base, gap_rate): (&'b [f64], f64),
        stiffness: &'b [f64],
        conditions: &'b [NormalCondition],
    ) -> PressedProblem<'b>
    where
        'a: 'b,
    {
        let contact = self.model.contact();
        PressedProblem {
            s: self.stage.of_contact(),
            r: self.load,
            yielding: &self.stage.yielding,
            components: contact.components,
            weights: &contact.weights,
            bounds: self.bounds,
            slip_base: self.slip,
            theta_k: self.theta_k,
            conditions: match conditions {
                [] => condition_of(&self.model.conditions()[0]).into(),
                nodal => NormalConditions::Nodal(nodal, self.level.rates()[1]),
            },
            stiffness,
            relaxing: self.relaxing,
            gap_base,
            gap_rate,
        }
    }
}

impl Level {
    /// Derivative of the gap at the normal velocity 0, into `out`, from those of the normal displacements and, in `self`, of the
    /// approach and its velocity.
    pub fn gap_slopes(&self, model: &Model, displacement: &[f64], out: &mut [f64]) {
        let parts = model.contact().parts.iter().zip(model.conditions());
        for (index, (part, condition)) in parts.enumerate() {
            match (self, condition) {
                (
                    Level::Velocity { velocity, .. },
                    Condition::Bilateral | Condition::Unilateral { .. },
                ) => {
                    out[part.nodes.clone()].fill(-velocity.of(index));
                }
                (Level::Position { approach, .. } | Level::Velocity { approach, .. }, _) => {
                    for node in part.nodes.clone() {
                        out[node] = displacement[node] - approach.of(index);
                    }
                }
            }
        }
    }
}
