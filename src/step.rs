//! The algorithm of a step: predict, solve friction, correct, record.
//!
//! ```text
//! for every internal step of size k
//!     for every stage i of the scheme                                          (qvi::Tableau)
//!         p   = u_n + k sum_{j<i} a_ij w_j                                     explicit part of the history
//!         r   = S E^T M^-1 (F f_i - B p),   M = A + theta k B                  predict
//!         S w_c + Lambda = r,  Lambda in omega g(|w_c|) d|w_c|                 friction
//!         w_i = M^-1 (F f_i - B p - E Lambda)                                  correct
//!     u_{n+1} = p + theta k w,  slip and accumulated slip alike                record
//! ```
//!
//! The step works on a trial state; the caller keeps the old one until the last internal step has succeeded.

use crate::error::{Error, Result};
use crate::friction::{ContactProblem, Law, fixed_point, multiplicity, newton, problem::norm};
use crate::model::{Model, SolverSettings};
use crate::qvi::{Stage, Tableau};
use crate::scene::{Interpolation, Start};
use crate::state::{State, energy, report};
use crate::workspace::{Explicit, Velocity, Workspace};

/// What goes along with a step and may look at it, but not change it: nothing, or its tangents.
pub(crate) trait Companion {
    /// The communication step begins; jumps at its beginning have been made.
    fn start(&mut self, model: &Model, state: &State, ws: &mut Workspace) -> Result<()>;
    /// An internal step begins, at this fraction of the communication step.
    fn begin(&mut self, fraction: f64);
    /// A stage has been solved; its place and its fraction of the communication step.
    fn stage(
        &mut self,
        model: &Model,
        state: &State,
        ws: &mut Workspace,
        k: f64,
        place: StagePlace,
    ) -> Result<()>;
    /// The internal step of size `k` is complete.
    fn end(&mut self, model: &Model, state: &State, ws: &Workspace, k: f64);
}

/// Which stage of an internal step.
pub(crate) struct StagePlace<'a> {
    pub stage: &'a Stage,
    /// Place in `Workspace::velocities`.
    pub index: usize,
    /// Fraction of the communication step.
    pub fraction: f64,
}

/// A step without a companion.
pub(crate) struct Alone;

impl Companion for Alone {
    fn start(&mut self, _: &Model, _: &State, _: &mut Workspace) -> Result<()> {
        Ok(())
    }
    fn begin(&mut self, _: f64) {}
    fn stage(
        &mut self,
        _: &Model,
        _: &State,
        _: &mut Workspace,
        _: f64,
        _: StagePlace,
    ) -> Result<()> {
        Ok(())
    }
    fn end(&mut self, _: &Model, _: &State, _: &Workspace, _: f64) {}
}

/// Advances `state` by one communication step of `h`, cut into equal internal steps; its inputs are the loads at the end.
///
/// # Errors
/// [`Error::NotConverged`]; `state` is then spoilt.
pub(crate) fn advance(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    h: f64,
    companion: &mut impl Companion,
) -> Result<()> {
    state.report.fill(0.0);
    apply_jumps(model, state, ws)?;
    companion.start(model, state, ws)?;
    let (start, count) = (state.time, substeps(h, model.largest_step()));
    let k = without_jitter(h / count as f64);
    ws.loads_at_start.copy_from_slice(&state.loads);
    for i in 0..count {
        let at = |instant: f64| (i as f64 + instant) / count as f64;
        internal_step(model, state, ws, k, at, companion)?;
        state.time = start + h * at(1.0);
        record(model, state);
    }
    state.loads.copy_from_slice(&state.inputs);
    Ok(())
}

/// Makes velocity and contact forces consistent with the loads of this instant: the inequality at fixed displacement.
///
/// # Errors
/// [`Error::NotConverged`].
pub(crate) fn settle(model: &Model, state: &mut State, ws: &mut Workspace) -> Result<()> {
    if model.start() == Start::Zero {
        return Ok(());
    }
    ws.explicit
        .displacement
        .copy_from_slice(&state.displacement);
    ws.explicit
        .accumulated_slip
        .copy_from_slice(&state.accumulated_slip);
    ws.load.copy_from_slice(&state.loads);
    ws.velocities[0].load_from(state);
    solve_stage(model, state, ws, 0.0, 0)?;
    ws.velocities[0].store_into(state);
    Ok(())
}

/// Internal steps that cut `h` into equal parts not larger than `largest`.
fn substeps(h: f64, largest: f64) -> u64 {
    // a communication step meant as a multiple of the internal one must not gain a step by rounding
    ((h / largest) * (1.0 - 1e-9)).ceil().max(1.0) as u64
}

/// Rounds away the last bits of a step size: masters compute `t[i+1] - t[i]`, and sizes equal but for rounding must
/// share one factorization. The relative change is below 1e-12.
fn without_jitter(k: f64) -> f64 {
    f64::from_bits((k.to_bits() + 0x800) & !0xfff)
}

/// Held inputs jump at the beginning of the step, coefficients have changed since the last one: the velocity follows.
fn apply_jumps(model: &Model, state: &mut State, ws: &mut Workspace) -> Result<()> {
    let mut has_jumped = state.needs_settling != 0;
    for (i, kind) in model.interpolations().iter().enumerate() {
        if *kind == Interpolation::Hold && state.loads[i] != state.inputs[i] {
            state.loads[i] = state.inputs[i];
            has_jumped = true;
        }
    }
    state.needs_settling = 0;
    if has_jumped && model.tableau().uses_start_velocity() {
        settle(model, state, ws)?;
    }
    Ok(())
}

/// One internal step; `at` maps an instant of it to a fraction of the communication step.
fn internal_step(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    k: f64,
    at: impl Fn(f64) -> f64,
    companion: &mut impl Companion,
) -> Result<()> {
    let tableau = model.tableau();
    ws.velocities[0].load_from(state);
    interpolate_loads(&ws.loads_at_start, &state.inputs, at(0.0), &mut ws.load);
    ws.velocities[0].load.copy_from_slice(&ws.load);
    companion.begin(at(0.0));
    for (i, stage) in tableau.stages().iter().enumerate() {
        let (index, fraction) = (i + 1, at(stage.instant));
        explicit_part(state, &ws.velocities[..index], stage, k, &mut ws.explicit);
        interpolate_loads(&ws.loads_at_start, &state.inputs, fraction, &mut ws.load);
        ws.velocities[index].copy_warm_start(state);
        solve_stage(model, state, ws, stage.theta * k, index)?;
        ws.velocities[index].store_contact(state);
        let place = StagePlace {
            stage,
            index,
            fraction,
        };
        companion.stage(model, state, ws, k, place)?;
    }
    let last = tableau.stages().len();
    ws.velocities[last].store_into(state);
    integrate(tableau, state, &ws.velocities[..=last], k);
    add_energies(model, state, ws, k);
    companion.end(model, state, ws, k);
    state.steps += 1;
    Ok(())
}

/// `p = u_n + k sum_j a_j w_j`, for the displacement of the body and the accumulated slip.
pub(crate) fn explicit_part(
    state: &State,
    known: &[Velocity],
    stage: &Stage,
    k: f64,
    explicit: &mut Explicit,
) {
    explicit.displacement.copy_from_slice(&state.displacement);
    explicit
        .accumulated_slip
        .copy_from_slice(&state.accumulated_slip);
    for (a, velocity) in stage.explicit.iter().zip(known) {
        if *a != 0.0 {
            add_scaled(&mut explicit.displacement, a * k, &velocity.body);
            add_scaled(&mut explicit.accumulated_slip, a * k, &velocity.magnitude);
        }
    }
}

/// Loads at a fraction of the communication step.
pub(crate) fn interpolate_loads(start: &[f64], end: &[f64], fraction: f64, loads: &mut [f64]) {
    for (load, (from, to)) in loads.iter_mut().zip(start.iter().zip(end)) {
        *load = if fraction == 1.0 {
            *to
        } else {
            from + (to - from) * fraction
        };
    }
}

/// Solves one stage with implicit weight `theta_k` for the explicit part and loads in `ws`, into `ws.velocities[index]`,
/// whose contact velocity is the warm start.
fn solve_stage(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    theta_k: f64,
    index: usize,
) -> Result<()> {
    let body = model.body();
    let law = model.law().with_coefficients(&state.coefficient_array())?;
    let stage = ws.stages.get(body, theta_k, &mut ws.scratch)?;
    body.predict(
        stage,
        &ws.explicit.displacement,
        &ws.load,
        &mut ws.condensed_load,
        &mut ws.scratch,
    );
    let contact = ContactProblem {
        s: stage.s.as_ref(),
        r: &ws.condensed_load,
        components: model.contact().components,
        weights: &model.contact().weights,
        law: &law,
        slip_base: &ws.explicit.accumulated_slip,
        theta_k,
    };
    let velocity = &mut ws.velocities[index];
    let settings = model.solver();
    let solution = match settings {
        SolverSettings::Newton {
            tolerance,
            max_iterations,
        } => newton::solve(
            &contact,
            *tolerance,
            *max_iterations,
            &mut velocity.contact,
            &mut ws.newton,
        ),
        SolverSettings::FixedPoint(settings) => {
            let (trial, scratch) = (&mut velocity.body, &mut ws.scratch);
            let (last, explicit) = (&mut ws.last_iterate, &ws.explicit.displacement);
            last.copy_from_slice(&state.displacement);
            fixed_point::solve(
                &contact,
                *settings,
                &state.force,
                &mut velocity.contact,
                &mut ws.newton,
                &mut ws.fixed_point,
                |w, force| {
                    body.correct(stage, w, force, trial, scratch);
                    let size = model.strain_norm(last);
                    for (i, w) in trial.iter_mut().enumerate() {
                        let displacement = explicit[i] + theta_k * *w;
                        *w = displacement - last[i];
                        last[i] = displacement;
                    }
                    (model.strain_norm(trial), size)
                },
            )
        }
    };
    if !solution.converged {
        return Err(Error::NotConverged {
            time: state.time,
            residual: solution.residual,
            tolerance: settings.tolerance(),
            iterations: solution.iterations,
            node: solution.node,
        });
    }
    if model.has_multiplicity_test() {
        test_multiplicity(
            &contact,
            &velocity.contact,
            &mut ws.multiplicity,
            settings,
            state,
        );
    }
    let entry = &mut state.report;
    entry[report::ITERATIONS] += solution.iterations as f64;
    entry[report::RESIDUAL] = entry[report::RESIDUAL].max(solution.residual);

    for (force, y) in velocity.force.iter_mut().zip(&ws.newton.accepted().y) {
        *force = -y;
    }
    let components = model.contact().components;
    for (magnitude, w) in velocity
        .magnitude
        .iter_mut()
        .zip(velocity.contact.chunks_exact(components))
    {
        *magnitude = norm(w);
    }
    body.correct(
        stage,
        &velocity.contact,
        &velocity.force,
        &mut velocity.body,
        &mut ws.scratch,
    );
    body.outputs(&velocity.body, &mut velocity.outputs);
    velocity.load.copy_from_slice(&ws.load);
    Ok(())
}

fn test_multiplicity(
    contact: &ContactProblem<Law>,
    accepted: &[f64],
    ws: &mut multiplicity::MultiplicityWorkspace,
    settings: &SolverSettings,
    state: &mut State,
) {
    let (tolerance, iterations) = (settings.tolerance(), settings.max_iterations());
    let found = multiplicity::test(contact, tolerance, iterations, accepted, ws);
    let entry = &mut state.report;
    entry[report::SOLUTIONS] = entry[report::SOLUTIONS].max(found.solutions as f64);
    entry[report::SOLUTION_GAP] = entry[report::SOLUTION_GAP].max(found.gap);
}

/// `u_{n+1} = u_n + k sum_j b_j w_j` for everything that is integrated.
pub(crate) fn integrate(tableau: &Tableau, state: &mut State, velocities: &[Velocity], k: f64) {
    for (j, velocity) in velocities.iter().enumerate() {
        let weight = tableau.weight(j) * k;
        if weight != 0.0 {
            add_scaled(&mut state.displacement, weight, &velocity.body);
            add_scaled(&mut state.slip, weight, &velocity.contact);
            add_scaled(&mut state.accumulated_slip, weight, &velocity.magnitude);
            add_scaled(&mut state.output_displacement, weight, &velocity.outputs);
        }
    }
}

/// Energies of the step from the means (weights b_j) of loads, velocities and contact forces.
fn add_energies(model: &Model, state: &mut State, ws: &mut Workspace, k: f64) {
    let tableau = model.tableau();
    let Workspace {
        velocities, mean, ..
    } = ws;
    mean.set_mean(tableau, velocities);
    let (viscous, _) = model.body().products(&mean.body);
    let (_, elastic) = model.body().products(&state.displacement);
    state.energy[energy::EXTERNAL_WORK] += k * dot(&mean.load, &mean.outputs);
    state.energy[energy::VISCOUS] += k * viscous;
    state.energy[energy::FRICTION] += k * dot(&mean.force, &mean.contact);
    state.energy[energy::ELASTIC] = 0.5 * elastic;
}

/// Appends the instant to the ring of the past.
pub(crate) fn record(model: &Model, state: &mut State) {
    let capacity = model.history_capacity() as u64;
    if capacity == 0 {
        return;
    }
    let m = state.slip.len();
    let row_len = state.history.len() / capacity as usize;
    let at = (state.recorded % capacity) as usize * row_len;
    let row = &mut state.history[at..at + row_len];
    let contact = model.contact();
    row[0] = state.time;
    row[1..=m].copy_from_slice(&state.slip_rate);
    row[1 + m..=2 * m].copy_from_slice(&state.slip);
    for (i, stress) in row[1 + 2 * m..].iter_mut().enumerate() {
        *stress = contact.stress(i, state.force[i]);
    }
    state.recorded += 1;
}

fn add_scaled(to: &mut [f64], factor: f64, from: &[f64]) {
    to.iter_mut().zip(from).for_each(|(t, f)| *t += factor * f);
}

/// Over the shorter of the two: the outputs begin with the loads.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
