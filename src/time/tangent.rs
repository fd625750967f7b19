//! Derivatives of the outputs at the end of the last step by its inputs, whatever they mean: the consistent tangent.
//!
//! Every formula of the step is differentiated where the step was solved. All of them are linear in the tangents except
//! the friction problem, whose tangents `dw` and `dLambda` are those of `contact::solve::tangent`. The last step is
//! taken once more from the state before it, so that a step without derivatives costs nothing extra; the repeated step
//! is the same bit for bit. Where a node is just about to change between stick and slip the outputs have a kink: the
//! derivative is then that of the branch on which the step ended. An input enters as its course over the step has it
//! (`input_course`): with its share of the step, with its jump at the beginning, with the slope that it is continued with.
//! Internal steps that `time.tolerance` chose are held fixed: the derivative is that of the step with these sizes, and a
//! refused pair of steps is undone in the tangents too.

use super::companion::{Companion, StagePlace};
use super::memory::{Span, bound_slopes, remembering, state_slopes};
use super::pressed::{Level, PressedStage};
use super::record::{
    add_drives, explicit_part, foundation_energy_slope, integrate, power_of_motions,
};
use super::scheme::MAX_STAGES;
use super::workspace::{Explicit, LoadCourse, Velocity, Workspace};
use crate::body::BodyModel;
use crate::contact::ContactProblem;
use crate::contact::pressed::PressedProblem;
use crate::contact::pressed::tangent::{Derivatives, PressedTangent};
use crate::contact::problem::norm;
use crate::contact::solve::tangent::FrictionTangent;
use crate::error::{Error, Result};
use crate::linalg::dot;
use crate::linalg::multiply;
use crate::model::Model;
use crate::ports::Tangent as PortTangent;
use crate::ports::readout;
use crate::scene::Start;
use crate::simulator::Simulator;
use crate::state::{Instant, State, energy};
use faer::MatRef;

impl Simulator {
    /// Derivative of all outputs (as [`Simulator::get_outputs`] orders them) at the end of the last step by its inputs (with the
    /// meaning they have: at its end or its beginning), along `seed` (one value per input): `out = (d outputs / d inputs) seed`. Counts, indicators and solver figures have
    /// the derivative 0. Costs one step and allocates.
    ///
    /// # Errors
    /// [`Error::CallOrder`] when the state is not the end of a step, [`Error::Length`], [`Error::Value`], [`Error::Overflow`].
    pub fn directional_derivative(&mut self, seed: &[f64], out: &mut [f64]) -> Result<()> {
        check("seed of the inputs", seed, self.model().input_count())?;
        check_len("outputs", out.len(), self.output_len())?;
        let mut tangents = Tangents::new(self.model(), [seed.to_vec()]);
        self.repeat_last_step(&mut tangents)?;
        let mut column = vec![0.0; out.len()];
        for tangent in &tangents.list {
            self.tangent_outputs(&tangent.state, &mut column);
        }
        self.hand_out(&column, out)
    }

    /// The transposed derivative: `out = (d outputs / d inputs)^T seed`, `seed` one value per output, `out` one per input.
    /// Takes the tangent of every input in one repetition of the step.
    ///
    /// # Errors
    /// Those of [`Simulator::directional_derivative`].
    pub fn adjoint_derivative(&mut self, seed: &[f64], out: &mut [f64]) -> Result<()> {
        let inputs = self.model().input_count();
        check("seed of the outputs", seed, self.output_len())?;
        check_len("inputs", out.len(), inputs)?;
        let mut tangents = Tangents::new(self.model(), unit_seeds(inputs));
        self.repeat_last_step(&mut tangents)?;
        self.weigh(&tangents, seed, out)
    }

    /// Derivative of all outputs at this instant by the loads at this instant, along `seed`: that of the velocity and the contact
    /// forces that are consistent with them at fixed displacement. Displacements, slips and energies have the derivative 0,
    /// and so has everything where `time.start` is `zero`. Needs no step; costs one solution of the friction problem's tangent
    /// and allocates.
    ///
    /// # Errors
    /// [`Error::CallOrder`] before initialization, [`Error::Length`], [`Error::Value`].
    pub fn instant_derivative(&mut self, seed: &[f64], out: &mut [f64]) -> Result<()> {
        check("seed of the inputs", seed, self.model().input_count())?;
        check_len("outputs", out.len(), self.output_len())?;
        let tangents = self.instant_tangents([seed.to_vec()])?;
        let mut column = vec![0.0; out.len()];
        for tangent in &tangents.list {
            self.tangent_outputs(&tangent.state, &mut column);
        }
        self.hand_out(&column, out)
    }

    /// The transposed derivative of [`Simulator::instant_derivative`]: `out = (d outputs / d loads)^T seed`.
    ///
    /// # Errors
    /// Those of [`Simulator::instant_derivative`].
    pub fn instant_adjoint(&mut self, seed: &[f64], out: &mut [f64]) -> Result<()> {
        let inputs = self.model().input_count();
        check("seed of the outputs", seed, self.output_len())?;
        check_len("inputs", out.len(), inputs)?;
        let tangents = self.instant_tangents(unit_seeds(inputs))?;
        self.weigh(&tangents, seed, out)
    }

    fn instant_tangents(&mut self, seeds: impl IntoIterator<Item = Vec<f64>>) -> Result<Tangents> {
        let mut tangents = Tangents::new(self.model(), seeds);
        self.solve_here("instant_derivative", |model, state, ws| {
            if model.start() == Start::Zero {
                return Ok(());
            }
            let approach = model.motions().approach(&state.loads);
            for t in &mut tangents.list {
                let approach = model.motions().approach(&t.load);
                t.level = Level::Velocity {
                    approach,
                    velocity: 0.0,
                };
            }
            tangents.settle(model, state, ws, approach)?;
            for t in &mut tangents.list {
                t.velocities[0].store_into(&mut t.state);
                t.state.loads.copy_from_slice(&t.load);
            }
            Ok(())
        })?;
        Ok(tangents)
    }

    /// Sums of the outputs' tangents, weighed by `seed`: one per tangent, if all of them are finite.
    fn weigh(&self, tangents: &Tangents, seed: &[f64], out: &mut [f64]) -> Result<()> {
        let mut column = vec![0.0; seed.len()];
        let mut row = vec![0.0; out.len()];
        for (entry, tangent) in row.iter_mut().zip(&tangents.list) {
            self.tangent_outputs(&tangent.state, &mut column);
            *entry = dot(seed, &column);
        }
        self.hand_out(&row, out)
    }

    /// Writes a derivative, if all of it is finite.
    fn hand_out(&self, derivative: &[f64], out: &mut [f64]) -> Result<()> {
        if derivative.iter().any(|v| !v.is_finite()) {
            return Err(Error::Overflow {
                what: "a derivative".into(),
                time: self.time(),
            });
        }
        out.copy_from_slice(derivative);
        Ok(())
    }

    fn tangent_outputs(&self, tangent: &State, out: &mut [f64]) {
        let mut rest = out;
        for port in self.model().ports().outputs() {
            let (head, tail) = rest.split_at_mut(port.len());
            rest = tail;
            match port.quantity.tangent() {
                PortTangent::Linear => readout::read(self.model(), tangent, port, head),
                PortTangent::Gap => {
                    readout::read(self.model(), tangent, port, head);
                    let gaps = &self.model().contact().gaps;
                    head.iter_mut().zip(gaps).for_each(|(d, gap)| *d -= gap);
                }
                PortTangent::Zero => head.fill(0.0),
                PortTangent::LargestRate => head[0] = self.tangent_of_largest_rate(tangent),
            }
        }
    }

    fn tangent_of_largest_rate(&self, tangent: &State) -> f64 {
        let c = self.model().contact().components;
        let rates = self.state().main.instant.slip_rate.chunks_exact(c);
        let mut largest = (0.0, 0.0);
        for (w, dw) in rates.zip(tangent.main.instant.slip_rate.chunks_exact(c)) {
            let rate = norm(w);
            if rate > largest.0 {
                largest = (rate, dot(w, dw) / rate);
            }
        }
        largest.1
    }
}

fn unit_seeds(inputs: usize) -> impl Iterator<Item = Vec<f64>> {
    (0..inputs).map(move |i| (0..inputs).map(|j| f64::from(u8::from(i == j))).collect())
}

fn check_len(what: &'static str, found: usize, expected: usize) -> Result<()> {
    if found == expected {
        Ok(())
    } else {
        Err(Error::Length {
            what,
            expected,
            found,
        })
    }
}

fn check(what: &'static str, seed: &[f64], expected: usize) -> Result<()> {
    check_len(what, seed.len(), expected)?;
    match seed.iter().find(|v| !v.is_finite()) {
        None => Ok(()),
        Some(&found) => Err(Error::Value {
            what: what.into(),
            found,
            allowed: "finite numbers",
        }),
    }
}

/// Derivatives of everything in a step along one seed.
struct Tangent {
    /// Of the inputs.
    seed: Vec<f64>,
    state: State,
    velocities: [Velocity; MAX_STAGES + 1],
    mean: Velocity,
    explicit: Explicit,
    course: LoadCourse,
    load: Vec<f64>,
    /// Of what the gap is a condition on, and of the approach of the foundation at both ends of the internal step.
    level: Level,
    approach: [f64; 2],
    /// State and velocity at the start of a part that may be refused.
    kept: (State, Velocity),
}

/// The tangents of a step along several seeds.
struct Tangents {
    list: Vec<Tangent>,
    /// Derivative of the condensed load, or right-hand side.
    condensed_load: Vec<f64>,
    /// `S dw`.
    product: Vec<f64>,
    /// Vector of the length of a state.
    sum: Vec<f64>,
    /// Intensities of the columns of forces, and velocities of what moves.
    forces: Vec<f64>,
    shift: Vec<f64>,
    /// Contact velocities and forces, and the gap.
    velocity: Vec<f64>,
    force: Vec<f64>,
    gap: Vec<f64>,
    /// Bounds, by the memory of the law where it has one.
    bound: Vec<f64>,
}

impl Tangents {
    fn new(model: &Model, seeds: impl IntoIterator<Item = Vec<f64>>) -> Tangents {
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
                approach: 0.0,
                velocity: 0.0,
            },
            approach: [0.0; 2],
            kept: (State::without_history(model), Velocity::new(model)),
        };
        Tangents {
            list: seeds.into_iter().map(tangent).collect(),
            condensed_load: vec![0.0; contact],
            product: vec![0.0; contact],
            sum: vec![0.0; model.states()],
            forces: vec![0.0; model.motions().force_count()],
            shift: vec![0.0; contact],
            velocity: vec![0.0; contact],
            force: vec![0.0; contact],
            gap: vec![0.0; model.contact().node_count()],
            bound: vec![0.0; State::sizes(model).memory()],
        }
    }

    /// Tangent of `stage::settle`, whose solution `state` holds; the foundation has approached by `approach`.
    fn settle(
        &mut self,
        model: &Model,
        state: &State,
        ws: &mut Workspace,
        approach: f64,
    ) -> Result<()> {
        ws.velocities[0].load_from(state);
        ws.explicit
            .accumulated_slip
            .copy_from_slice(&state.main.accumulated_slip);
        ws.explicit
            .normal_displacement
            .copy_from_slice(&state.main.normal_displacement);
        let level = Level::Velocity {
            approach,
            velocity: 0.0,
        };
        self.solve(model, state, ws, (0.0, level, Span::NOTHING), 0)
    }

    /// Tangent of `stage::solve_stage`: of the velocity at `index`, from the explicit parts and inputs in the tangents.
    fn solve(
        &mut self,
        model: &Model,
        state: &State,
        ws: &mut Workspace,
        (theta_k, level, span): (f64, Level, Span),
        index: usize,
    ) -> Result<()> {
        let (body, motions) = (model.body(), model.motions());
        let solution = &ws.velocities[index].instant;
        let stage = ws.stages.get(body, theta_k, &mut ws.scratch)?;
        let bounds = model.friction().with(&state.coefficients);
        let weights = &model.contact().weights;
        let previous = index.saturating_sub(1);
        ws.before.take(&ws.velocities[previous]);
        let memory = ws.before.memory(model, span.length);
        let law = model
            .friction()
            .pressed(&state.coefficients, weights, theta_k);
        let pressed_bounds = remembering(law, memory);
        let at = PressedStage {
            model,
            stage,
            load: &ws.condensed_load,
            bounds: &pressed_bounds,
            theta_k,
            level,
            slip: &ws.explicit.accumulated_slip,
            displacement: &ws.explicit.normal_displacement,
        };
        let friction = match &mut ws.pressed {
            Some(pressed) => {
                let (tangent, problem) = pressed.tangent(&at, solution);
                ContactTangent::Pressed(tangent, problem)
            }
            None => {
                let contact = ContactProblem {
                    s: stage.s.as_ref(),
                    r: &ws.condensed_load,
                    components: model.contact().components,
                    weights,
                    law: &bounds,
                    slip_base: &ws.explicit.accumulated_slip,
                    theta_k,
                };
                ContactTangent::Free(FrictionTangent::new(&contact, &solution.slip_rate))
            }
        };
        let has_motions = !motions.is_empty();
        let dr = &mut self.condensed_load;
        for tangent in &mut self.list {
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
            motions.forces(&tangent.load, &mut self.forces);
            let p = &tangent.explicit.displacement;
            body.predict(stage, p, &self.forces, dr, &mut ws.scratch);
            if has_motions {
                motions.shift(&tangent.load, &mut self.shift);
                multiply(stage.s.as_ref(), &self.shift, &mut self.product);
                for (dr, product) in dr.iter_mut().zip(&self.product) {
                    *dr -= product;
                }
            }
            let slip = &tangent.explicit.accumulated_slip;
            match &friction {
                ContactTangent::Free(friction) => {
                    let instant = &mut velocity.instant;
                    friction.apply(dr, slip, &mut instant.slip_rate, &mut velocity.magnitude);
                    self.velocity.copy_from_slice(&instant.slip_rate);
                    balance(stage.s.as_ref(), dr, &self.velocity, &mut self.product);
                    instant.reaction.copy_from_slice(&self.product);
                    friction.forces(&self.velocity, slip, &self.product, &mut instant.force);
                }
                ContactTangent::Pressed(friction, problem) => {
                    let moved = &tangent.explicit.normal_displacement;
                    tangent
                        .level
                        .gap_slopes(model.condition(), moved, &mut self.gap);
                    friction.apply(
                        problem,
                        &mut Derivatives {
                            load: dr,
                            slip,
                            gap: &self.gap,
                            bound: &self.bound,
                            velocity: &mut self.velocity,
                            force: &mut self.force,
                            magnitude: &mut velocity.magnitude,
                        },
                    );
                    balance(stage.s.as_ref(), dr, &self.velocity, &mut self.product);
                    let found = [&self.velocity[..], &self.force, &self.product];
                    scatter(model.contact().components, found, &mut velocity.instant);
                }
            }
            if has_motions {
                for (velocity, shift) in self.velocity.iter_mut().zip(&self.shift) {
                    *velocity += shift;
                }
            }
            let instant = &mut velocity.instant;
            let (contact, reaction) = (&self.velocity, &self.product);
            body.correct(
                stage,
                contact,
                reaction,
                &mut instant.velocity,
                &mut ws.scratch,
            );
            body.outputs(&instant.velocity, &mut instant.output_velocity);
            velocity.load.copy_from_slice(&tangent.load);
            if has_motions {
                let load = &tangent.load;
                let displacement = &mut tangent.explicit.drive_displacement;
                add_drives(motions, displacement, theta_k, load);
                let conjugates = &instant.output_velocity;
                let to = &mut instant.drive_force;
                motions.drive_forces(load, displacement, conjugates, reaction, to);
                motions.foundation_forces(reaction, &mut instant.foundation_force);
                let drive = |drive: usize| load[motions.drive_input(drive)];
                motions.add_outputs(drive, &mut instant.output_velocity);
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

/// Velocities, forces and reactions in the order of the solver with pressure, node by node into an instant.
fn scatter(c: usize, [velocity, force, reaction]: [&[f64]; 3], to: &mut Instant) {
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

impl Companion for Tangents {
    fn start(&mut self, model: &Model, state: &State, ws: &mut Workspace) -> Result<()> {
        let mut has_jump = ws.has_settled;
        for t in &mut self.list {
            for (i, seed) in t.seed.iter().enumerate() {
                t.course.start[i] = ws.course.start_by_input[i] * seed;
                t.course.end[i] = ws.course.end_by_input[i] * seed;
            }
            t.load.copy_from_slice(&t.course.start);
            has_jump |= t.load.iter().any(|v| *v != 0.0);
        }
        if has_jump && model.tableau().uses_start_velocity() && model.start() != Start::Zero {
            let motions = model.motions();
            for t in &mut self.list {
                let [start, end] = [&t.course.start, &t.course.end].map(|at| motions.approach(at));
                t.level = Level::Velocity {
                    approach: start,
                    velocity: (end - start) / ws.course.size,
                };
            }
            let approach = motions.approach(&ws.course.start);
            self.settle(model, state, ws, approach)?;
        }
        Ok(())
    }

    fn keep(&mut self) {
        for t in &mut self.list {
            t.kept.0.copy_steps_from(&t.state);
            t.kept.1.copy_from(&t.velocities[0]);
        }
    }

    fn go_back(&mut self) {
        for t in &mut self.list {
            t.state.copy_steps_from(&t.kept.0);
            t.velocities[0].copy_from(&t.kept.1);
        }
    }

    fn begin(&mut self, fraction: f64) {
        for t in &mut self.list {
            t.course.at(fraction, &mut t.load);
            t.velocities[0].load.copy_from_slice(&t.load);
        }
    }

    fn stage(
        &mut self,
        model: &Model,
        state: &State,
        ws: &mut Workspace,
        k: f64,
        place: StagePlace,
    ) -> Result<()> {
        let motions = model.motions();
        let rate = match place.level {
            Level::Position { rate, .. } => rate,
            Level::Velocity { .. } => 0.0,
        };
        for t in &mut self.list {
            let known = &t.velocities[..place.index];
            explicit_part(motions, &t.state, known, place.stage, k, &mut t.explicit);
            t.course.at(place.end, &mut t.load);
            t.approach = [
                motions.approach(&t.velocities[0].load),
                motions.approach(&t.load),
            ];
            t.course.at(place.fraction, &mut t.load);
            // at the end of the step where the stage is not the new instant
            let is_stage = rate == place.stage.theta * k;
            let approach = match is_stage {
                true => motions.approach(&t.load),
                false => t.approach[1],
            };
            t.level = Level::Position { rate, approach };
        }
        self.solve(
            model,
            state,
            ws,
            (place.stage.theta * k, place.level, place.span),
            place.index,
        )
    }

    fn settle_end(
        &mut self,
        model: &Model,
        state: &State,
        ws: &mut Workspace,
        k: f64,
        fraction: f64,
    ) -> Result<()> {
        for t in &mut self.list {
            t.course.at(fraction, &mut t.load);
            t.explicit.follow(&t.state);
            t.level = Level::Velocity {
                approach: t.approach[1],
                velocity: (t.approach[1] - t.approach[0]) / k,
            };
        }
        self.settle(model, state, ws, ws.approach[1])?;
        for t in &mut self.list {
            t.velocities[0].store_into(&mut t.state);
            t.state.loads.copy_from_slice(&t.load);
        }
        Ok(())
    }

    fn end(&mut self, model: &Model, state: &State, ws: &Workspace, k: f64) {
        let tableau = model.tableau();
        let last = tableau.stages().len();
        let body = model.body();
        for t in &mut self.list {
            t.velocities[last].store_into(&mut t.state);
            integrate(model, &mut t.state, &t.velocities[..=last], k);
            t.mean.set_mean(tableau, &t.velocities);
            let (mean, d) = (&ws.mean, &t.mean);
            let (viscous, _) = mixed_products(
                body,
                &mean.instant.velocity,
                &d.instant.velocity,
                &mut self.sum,
            );
            let displacement = &t.state.main.displacement;
            let (_, elastic) =
                mixed_products(body, &state.main.displacement, displacement, &mut self.sum);
            let motions = model.motions();
            let loads = |inputs: &'_ [f64]| inputs[..motions.loads()].to_vec();
            let mut external = dot(&loads(&mean.load), &d.instant.output_velocity)
                + dot(&loads(&d.load), &mean.instant.output_velocity);
            let (mut viscous, mut elastic) = (viscous, elastic);
            if !motions.is_empty() {
                let rate = |ends: [f64; 2]| (ends[1] - ends[0]) / k;
                let (approach, approaches) = (rate(ws.approach), rate(t.approach));
                external += power_of_motions(motions, &mean.load, &d.instant, approach)
                    + power_of_motions(motions, &d.load, &mean.instant, approaches);
                let own: [&[f64]; 2] = [&mean.load, &mean.instant.output_velocity];
                let along: [&[f64]; 2] = [&d.load, &d.instant.output_velocity];
                viscous += motions.viscous_product(own, along);
                let displacement = [&state.drive_displacement, &t.state.drive_displacement];
                elastic += motions.elastic_product(displacement[0], displacement[1]);
            }
            let moves = &t.state.main.normal_displacement;
            let ends = (ws.approach[1], t.approach[1]);
            elastic += foundation_energy_slope(model, state, ends.0, moves, ends.1);
            // what is read of the inputs there
            t.state.loads.copy_from_slice(&t.velocities[last].load);
            if !tableau.ends_with_stage() {
                let to = &mut t.state;
                to.mean_slip_rate.copy_from_slice(&d.instant.slip_rate);
                to.mean_force.copy_from_slice(&d.instant.force);
                to.mean_normal_force
                    .copy_from_slice(&d.instant.normal_force);
            }
            let energy = &mut t.state.energy;
            energy[energy::EXTERNAL_WORK] += k * external;
            energy[energy::VISCOUS] += 2.0 * k * viscous;
            energy[energy::FRICTION] += k
                * (dot(&mean.instant.reaction, &d.instant.slip_rate)
                    + dot(&d.instant.reaction, &mean.instant.slip_rate));
            energy[energy::ELASTIC] = elastic;
            t.velocities.swap(0, last);
        }
    }
}

/// `(x.A y, x.B y)`, by polarisation of the squares with `y` brought to the size of `x`.
fn mixed_products(body: &dyn BodyModel, x: &[f64], y: &[f64], sum: &mut [f64]) -> (f64, f64) {
    let size = |(a, b): (f64, f64)| (a + b).sqrt();
    let (x_size, y_size) = (size(body.products(x)), size(body.products(y)));
    if !(x_size > 0.0 && y_size > 0.0) {
        return (0.0, 0.0);
    }
    let scale = x_size / y_size;
    let mut squares = |sign: f64| {
        for (sum, (x, y)) in sum.iter_mut().zip(x.iter().zip(y)) {
            *sum = x + sign * scale * y;
        }
        body.products(sum)
    };
    let (plus, minus) = (squares(1.0), squares(-1.0));
    let part = |plus: f64, minus: f64| (plus - minus) / (4.0 * scale);
    (part(plus.0, minus.0), part(plus.1, minus.1))
}
