//! The tangents of a step along several seeds, and those of its stages: every formula of a stage differentiated where it was solved.

use super::contact::problem;
use super::memory::{Span, bound_slopes, remembering, state_slopes};
use super::nonlinear::set_displacement;
use super::penetration::{self, Course};
use super::pressed::{Level, PressedStage, scatter};
use super::relative::Relative;
use super::scheme::MAX_STAGES;
use super::slip_memory;
use super::velocity::Velocity;
use super::workspace::{Explicit, LoadCourse, Workspace};
use crate::body::nonlinear::ELASTIC;
use crate::contact::pressed::PressedProblem;
use crate::contact::pressed::tangent::{Derivatives, PressedTangent};
use crate::contact::solve::tangent::FrictionTangent;
use crate::error::Result;
use crate::linalg::multiply;
use crate::model::Model;
use crate::model::motions::Approach;
use crate::state::State;
use faer::MatRef;

/// Derivatives of everything in a step along one seed.
pub(super) struct Tangent {
    /// Of the inputs.
    pub seed: Vec<f64>,
    pub state: State,
    pub velocities: [Velocity; MAX_STAGES + 1],
    pub mean: Velocity,
    pub explicit: Explicit,
    pub course: LoadCourse,
    pub load: Vec<f64>,
    /// Of what the gap is a condition on, and of the approach of the foundation at both ends of the internal step.
    pub level: Level,
    pub approach: [Approach; 2],
    /// State and velocity at the start of a part that may be refused.
    pub kept: (State, Velocity),
}

/// The tangents of a step along several seeds.
pub(super) struct Tangents {
    pub list: Vec<Tangent>,
    /// Derivative of the condensed load, or right-hand side.
    condensed_load: Vec<f64>,
    /// Vector of the length of a state.
    pub sum: Vec<f64>,
    relative: Relative,
    /// Contact velocities, forces of the law and of balance, and the gap.
    velocity: Vec<f64>,
    force: Vec<f64>,
    reaction: Vec<f64>,
    gap: Vec<f64>,
    /// Bounds, by the memory of the law where it has one.
    bound: Vec<f64>,
    /// Forces of foundations that relax: lines of a stage, of which only the offsets have a derivative.
    relaxing: Vec<[f64; 2]>,
    pressing: Vec<f64>,
}

impl Tangents {
    pub fn new(model: &Model, seeds: impl IntoIterator<Item = Vec<f64>>) -> Tangents {
        let contact = model.contact().force_len();
        let tangent = |seed: Vec<f64>| Tangent {
            state: State::zero(model),
            velocities: std::array::from_fn(|_| Velocity::new(model)),
            mean: Velocity::new(model),
            explicit: Explicit::new(model),
            course: LoadCourse::new(seed.len()),
            load: seed.clone(),
            seed,
            level: Level::Velocity {
                approach: Approach::NONE,
                velocity: Approach::NONE,
            },
            approach: [Approach::NONE; 2],
            kept: (State::without_history(model), Velocity::new(model)),
        };
        Tangents {
            list: seeds.into_iter().map(tangent).collect(),
            condensed_load: vec![0.0; contact],
            sum: vec![0.0; model.states()],
            relative: Relative::of_tangents(model),
            reaction: vec![0.0; contact],
            velocity: vec![0.0; contact],
            force: vec![0.0; contact],
            gap: vec![0.0; model.contact().node_count()],
            bound: vec![0.0; State::sizes(model).memory()],
            pressing: vec![0.0; model.relaxing_nodes()],
            relaxing: vec![[0.0; 2]; model.relaxing_nodes()],
        }
    }

    /// Tangent of `stage::settle`, whose solution `state` holds; the foundation has approached by `approach`.
    pub fn settle(
        &mut self,
        model: &Model,
        state: &State,
        ws: &mut Workspace,
        approach: Approach,
    ) -> Result<()> {
        ws.velocities[0].load_from(state);
        ws.explicit
            .displacement
            .copy_from_slice(&state.main.displacement);
        ws.explicit
            .accumulated_slip
            .copy_from_slice(&state.main.accumulated_slip);
        ws.explicit
            .normal_displacement
            .copy_from_slice(&state.main.normal_displacement);
        let level = Level::Velocity {
            approach,
            velocity: Approach::NONE,
        };
        self.solve(model, state, ws, (0.0, level, Span::NOTHING), 0)
    }

    /// Tangent of `stage::solve_stage`: of the velocity at `index`, from the explicit parts and inputs in the tangents.
    pub fn solve(
        &mut self,
        model: &Model,
        state: &State,
        ws: &mut Workspace,
        (theta_k, level, span): (f64, Level, Span),
        index: usize,
    ) -> Result<()> {
        let previous = index.saturating_sub(1);
        let slip = &mut ws.explicit.accumulated_slip;
        let at = (span.length, theta_k);
        slip_memory::set_base(model, &ws.velocities[previous], at, slip);
        let slip_stage = slip_memory::stage(model, span.length, theta_k);
        let solution = &ws.velocities[index].instant;
        let nonlinear = model.body().nonlinear().zip(ws.nonlinear.as_mut());
        let stage = match nonlinear {
            None => ws.stages.get(model.body(), theta_k, &mut ws.scratch)?,
            // the tangents of the laws at the solution
            Some((cells, own)) => {
                let (p, u) = (&ws.explicit.displacement, &mut own.displacement);
                set_displacement(p, theta_k, &solution.velocity, u);
                cells.gather([&solution.velocity, u], &mut own.point);
                ws.stages
                    .get_at(model.body(), theta_k, &own.point, &mut ws.scratch)?
            }
        };
        let bounds = (model.friction()).in_stage(&state.coefficients, slip_stage);
        let weights = &model.contact().weights;
        ws.before.take(&ws.velocities[previous]);
        let before = &ws.velocities[previous];
        penetration::set_lines(model, before, span.length, &mut ws.relaxing);
        let memory = ws.before.memory(model, span.length);
        let law = model
            .friction()
            .pressed(&state.coefficients, weights, slip_stage);
        let pressed_bounds = remembering(law, memory);
        let at = PressedStage {
            model,
            stage,
            load: &ws.condensed_load,
            bounds: &pressed_bounds,
            theta_k,
            level,
            relaxing: &ws.relaxing,
            slip: &ws.explicit.accumulated_slip,
            displacement: &ws.explicit.normal_displacement,
        };
        let friction = match &mut ws.pressed {
            Some(pressed) => {
                let (tangent, problem) = pressed.tangent(&at, solution);
                ContactTangent::Pressed(tangent, problem)
            }
            None => {
                let (load, slip) = (&ws.condensed_load, &ws.explicit.accumulated_slip);
                let contact = problem(model, (stage, theta_k), load, &bounds, slip);
                ContactTangent::Free(FrictionTangent::new(&contact, &solution.slip_rate))
            }
        };
        let dr = &mut self.condensed_load;
        for tangent in &mut self.list {
            let slip = &mut tangent.explicit.accumulated_slip;
            let before = &tangent.velocities[previous];
            slip_memory::set_base(model, before, (span.length, theta_k), slip);
            penetration::set_lines(model, before, span.length, &mut self.relaxing);
            penetration::offsets(&self.relaxing, &mut self.pressing);
            if let Some(memory) = &memory {
                bound_slopes(
                    (law, memory),
                    &ws.velocities[index],
                    &ws.explicit.accumulated_slip,
                    theta_k,
                    &tangent.velocities[previous],
                    &mut self.bound,
                );
            }
            let velocity = &mut tangent.velocities[index];
            let p = &tangent.explicit.displacement;
            let inputs = &tangent.load;
            if let Some((cells, own)) = model.body().nonlinear().zip(ws.nonlinear.as_ref()) {
                let excess = &mut ws.scratch.excess;
                excess.fill(0.0);
                cells.add_slopes(ELASTIC, &own.displacement, p, excess);
                excess.iter_mut().for_each(|value| *value = -*value);
            }
            self.relative
                .predict(model, stage, p, inputs, dr, &mut ws.scratch);
            let slip = &tangent.explicit.accumulated_slip;
            match &friction {
                ContactTangent::Free(friction) => {
                    let instant = &mut velocity.instant;
                    friction.apply(dr, slip, &mut instant.slip_rate, &mut velocity.magnitude);
                    self.velocity.copy_from_slice(&instant.slip_rate);
                    balance(stage.s.as_ref(), dr, &self.velocity, &mut self.reaction);
                    instant.reaction.copy_from_slice(&self.reaction);
                    friction.forces(&self.velocity, slip, &self.reaction, &mut instant.force);
                }
                ContactTangent::Pressed(friction, problem) => {
                    let moved = &tangent.explicit.normal_displacement;
                    tangent.level.gap_slopes(model, moved, &mut self.gap);
                    friction.apply(
                        problem,
                        &mut Derivatives {
                            load: dr,
                            slip,
                            gap: &self.gap,
                            bound: &self.bound,
                            pressing: &self.pressing,
                            velocity: &mut self.velocity,
                            force: &mut self.force,
                            magnitude: &mut velocity.magnitude,
                        },
                    );
                    balance(stage.of_contact(), dr, &self.velocity, &mut self.reaction);
                    let found = [&self.velocity[..], &self.force, &self.reaction];
                    scatter(model.contact().components, found, &mut velocity.instant);
                }
            }
            self.relative.correct(
                model,
                (stage, theta_k),
                Some([&self.velocity, &self.reaction]),
                (&tangent.load, &mut tangent.explicit.drive_displacement),
                velocity,
                &mut ws.scratch,
            );
            let of = Course {
                velocities: &ws.velocities[..],
                displacement: &ws.explicit.normal_displacement,
                level,
                approach: ws.approach[1],
            };
            let along = Course {
                velocities: &mut tangent.velocities[..],
                displacement: &tangent.explicit.normal_displacement,
                level: tangent.level,
                approach: tangent.approach[1],
            };
            penetration::advance_slopes(model, of, along, (theta_k, span), index);
            if index > 0 {
                let (known, rest) = tangent.velocities.split_at_mut(index);
                slip_memory::advance(model, &known[previous], span.step, &mut rest[0]);
            }
            if let (Some(memory), true) = (ws.before.memory(model, span.step), index > 0) {
                let rates = &ws.velocities[index].magnitude;
                let (known, rest) = tangent.velocities.split_at_mut(index);
                let (before, to) = (&known[previous], &mut rest[0]);
                state_slopes(model, state, &memory, rates, before, to);
            }
        }
        Ok(())
    }
}

/// The tangent of the contact problem, with pressure or without.
enum ContactTangent<'a> {
    Free(FrictionTangent),
    Pressed(PressedTangent, PressedProblem<'a>),
}

/// Forces with which the body is in balance, `dr - S dv`.
fn balance(s: MatRef<f64>, dr: &[f64], velocity: &[f64], out: &mut [f64]) {
    multiply(s, velocity, out);
    for (out, dr) in out.iter_mut().zip(dr) {
        *out = dr - *out;
    }
}
