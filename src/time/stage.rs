//! Implicit stages: those of an internal step one after the other, and the one with step size 0 that makes a start consistent.
//! Each predicts the free motion, solves friction on the contact and corrects the body.

use super::companion::{Companion, StagePlace};
use super::memory::{self, Span, remembering};
use super::pressed::{Level, PressedStage};
use super::record::{add_drives, explicit_part};
use super::workspace::Workspace;
use crate::contact::law::PressedLaw;
use crate::contact::problem::norm;
use crate::contact::solve::newton::linearisation::Linearisation;
use crate::contact::solve::{fixed_point, multiplicity, newton};
use crate::contact::{ContactProblem, SlipPath};
use crate::error::{Error, Result};
use crate::linalg::multiply;
use crate::model::{Model, SolverSettings};
use crate::scene::{Condition, Start};
use crate::state::{Instant, State, report};

/// Makes velocity and contact forces consistent with the inputs of this instant: the inequality at fixed displacement.
/// `approach` is the velocity of the foundation towards the body.
///
/// # Errors
/// [`crate::Error::NotConverged`].
pub(crate) fn settle(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    approach: f64,
) -> Result<()> {
    if model.start() == Start::Zero {
        return Ok(());
    }
    ws.load.copy_from_slice(&state.loads);
    settle_at(model, state, ws, approach)
}

/// The same for the inputs in `ws.load`.
fn settle_at(model: &Model, state: &mut State, ws: &mut Workspace, approach: f64) -> Result<()> {
    ws.explicit.follow(state);
    ws.velocities[0].load_from(state);
    let level = Level::Velocity {
        approach: model.motions().approach(&ws.load),
        velocity: approach,
    };
    solve_stage(model, state, ws, (0.0, level, Span::NOTHING), 0)?;
    ws.velocities[0].store_into(state);
    Ok(())
}

/// The stages of an internal step, into `ws.velocities` after the velocity at its start.
///
/// # Errors
/// [`crate::Error::NotConverged`].
pub(crate) fn solve_stages(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    k: f64,
    at: impl Fn(f64) -> f64,
    companion: &mut impl Companion,
) -> Result<()> {
    let motions = model.motions();
    ws.velocities[0].load_from(state);
    if !motions.foundation.is_empty() {
        ws.course.at(at(1.0), &mut ws.load);
        ws.approach[1] = motions.approach(&ws.load);
    }
    ws.course.at(at(0.0), &mut ws.load);
    ws.approach[0] = motions.approach(&ws.load);
    ws.velocities[0].load.copy_from_slice(&ws.load);
    companion.begin(at(0.0));
    let is_at_end = !model.tableau().ends_with_stage()
        && !matches!(model.condition(), Condition::Compliance { .. });
    let mut before = 0.0;
    for (i, stage) in model.tableau().stages().iter().enumerate() {
        let (index, fraction) = (i + 1, at(stage.instant));
        let length = (stage.instant - before) * k;
        before = stage.instant;
        let span = Span {
            length,
            step: if model.tableau().ends_with_stage() {
                length
            } else {
                k
            },
        };
        let known = &ws.velocities[..index];
        explicit_part(motions, state, known, stage, k, &mut ws.explicit);
        ws.course.at(fraction, &mut ws.load);
        ws.velocities[index].copy_warm_start(state);
        let level = match is_at_end {
            true => Level::Position {
                rate: k,
                approach: ws.approach[1],
            },
            false => Level::Position {
                rate: stage.theta * k,
                approach: motions.approach(&ws.load),
            },
        };
        solve_stage(model, state, ws, (stage.theta * k, level, span), index)?;
        ws.velocities[index].store_contact(state);
        let place = StagePlace {
            stage,
            index,
            fraction,
            end: at(1.0),
            level,
            span,
        };
        companion.stage(model, state, ws, k, place)?;
    }
    Ok(())
}

/// After a step whose stages have means only: what holds at its end, at the fraction `at` of the communication step.
///
/// # Errors
/// [`crate::Error::NotConverged`].
pub(crate) fn solve_end(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    k: f64,
    at: f64,
) -> Result<()> {
    if model.tableau().ends_with_stage() {
        return Ok(());
    }
    ws.course.at(at, &mut ws.load);
    let approach = (ws.approach[1] - ws.approach[0]) / k;
    settle_at(model, state, ws, approach)
}

/// Solves one stage with implicit weight `theta_k` for the explicit part and inputs in `ws`, into `ws.velocities[index]`,
/// whose contact velocity is the warm start.
fn solve_stage(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    (theta_k, level, span): (f64, Level, Span),
    index: usize,
) -> Result<()> {
    predict(model, ws, theta_k)?;
    if let [cancelled] = &mut ws.velocities[index].instant.cancelled[..] {
        *cancelled = model.body().cancelled_norm(&ws.scratch);
    }
    let solved = match ws.pressed {
        Some(_) => solve_with_pressure(model, state, ws, (theta_k, level, span), index),
        None => solve_without_pressure(model, state, ws, theta_k, index),
    };
    let settings = model.solver();
    if !solved.converged && !solved.residual.is_finite() {
        return Err(Error::Overflow {
            what: "the residual of the friction law".into(),
            time: state.time,
        });
    }
    if !solved.converged {
        return Err(Error::NotConverged {
            time: state.time,
            residual: solved.residual,
            tolerance: settings.tolerance(),
            iterations: solved.iterations,
            node: solved.node,
        });
    }
    if let Some(fault) = solved.fault {
        return Err(fault);
    }
    if model.has_multiplicity_test() && ws.pressed.is_none() {
        test_multiplicity(model, state, ws, theta_k, index);
    }
    let entry = &mut state.report;
    entry[report::ITERATIONS] += solved.iterations as f64;
    entry[report::RESIDUAL] = entry[report::RESIDUAL].max(solved.residual);
    if solved.is_at_rounding {
        entry[report::AT_ROUNDING] = 1.0;
    }
    correct(model, ws, theta_k, index);
    if index > 0 {
        memory::advance(model, state, &ws.before, span, &mut ws.velocities[index]);
    }
    Ok(())
}

/// The condensed load of the free motion, relative to what moves, for the explicit part and the inputs in `ws`.
pub(crate) fn predict(model: &Model, ws: &mut Workspace, theta_k: f64) -> Result<()> {
    let (body, motions) = (model.body(), model.motions());
    let stage = ws.stages.get(body, theta_k, &mut ws.scratch)?;
    motions.forces(&ws.load, &mut ws.forces);
    body.predict(
        stage,
        &ws.explicit.displacement,
        &ws.forces,
        &mut ws.condensed_load,
        &mut ws.scratch,
    );
    if !ws.shift.is_empty() {
        motions.shift(&ws.load, &mut ws.shift);
        multiply(stage.s.as_ref(), &ws.shift, &mut ws.shifted);
        for (load, shifted) in ws.condensed_load.iter_mut().zip(&ws.shifted) {
            *load -= shifted;
        }
    }
    Ok(())
}

/// What a friction solver says of a stage.
struct Solved {
    iterations: usize,
    residual: f64,
    node: usize,
    converged: bool,
    is_at_rounding: bool,
    /// Why the solution is none.
    fault: Option<Error>,
}

impl Solved {
    const NOTHING: Solved = Solved {
        iterations: 0,
        residual: f64::NAN,
        node: 0,
        converged: false,
        is_at_rounding: false,
        fault: None,
    };
}

fn solve_with_pressure(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    (theta_k, level, span): (f64, Level, Span),
    index: usize,
) -> Solved {
    let settings = model.solver();
    let weights = &model.contact().weights;
    // at a start the state is the one there
    ws.before.take(&ws.velocities[index.saturating_sub(1)]);
    let law = model
        .friction()
        .pressed(&state.coefficients, weights, theta_k);
    let bounds = remembering(law, ws.before.memory(model, span.length));
    let at = PressedStage {
        model,
        stage: ws.stages.current(),
        load: &ws.condensed_load,
        bounds: &bounds,
        theta_k,
        level,
        slip: &ws.explicit.accumulated_slip,
        displacement: &ws.explicit.normal_displacement,
    };
    let (velocity, points) = (&mut ws.velocities[index], &mut state.main.pressed_point);
    let limits = (settings.tolerance(), settings.max_iterations());
    let pressed = ws.pressed.as_mut();
    let found = pressed.map(|pressed| pressed.solve(&at, velocity, points, limits));
    let fault = match model.friction().has_formula() {
        true => fault_of_formula(&at, &bounds, &velocity.instant),
        false => None,
    };
    found.map_or(Solved::NOTHING, |found| Solved {
        iterations: found.iterations,
        residual: found.residual,
        node: found.node,
        converged: found.converged,
        is_at_rounding: found.is_at_rounding,
        fault,
    })
}

/// The first node of a solution where a formula gives no value that friction can have.
fn fault_of_formula(at: &PressedStage, bounds: &PressedLaw, solution: &Instant) -> Option<Error> {
    let components = at.model.contact().components;
    let mut rates = solution.slip_rate.chunks_exact(components).map(norm);
    let (node, found) = (0..at.slip.len()).find_map(|node| {
        let slip = SlipPath {
            base: at.slip[node],
            per_rate: at.theta_k,
        };
        let found = bounds.fault(node, rates.next()?, solution.normal_force[node], slip);
        found.map(|found| (node, found))
    })?;
    let path = at.model.friction().law().path(0);
    Some(Error::Value {
        what: format!("the value of {path} at contact node {node}"),
        found,
        allowed: "a finite number >= 0",
    })
}

/// The contact problem without pressure of the stage that was predicted last.
macro_rules! contact_problem {
    ($model:expr, $ws:expr, $theta_k:expr, $bounds:expr) => {
        ContactProblem {
            s: $ws.stages.current().s.as_ref(),
            r: &$ws.condensed_load,
            components: $model.contact().components,
            weights: &$model.contact().weights,
            law: $bounds,
            slip_base: &$ws.explicit.accumulated_slip,
            theta_k: $theta_k,
        }
    };
}

fn solve_without_pressure(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    theta_k: f64,
    index: usize,
) -> Solved {
    let body = model.body();
    let bounds = model.friction().with(&state.coefficients);
    let contact = contact_problem!(model, ws, theta_k, &bounds);
    let stage = ws.stages.current();
    let velocity = &mut ws.velocities[index];
    let solution = match model.solver() {
        SolverSettings::Newton {
            tolerance,
            max_iterations,
        } => newton::solve(
            &contact,
            *tolerance,
            *max_iterations,
            &mut velocity.instant.slip_rate,
            &mut Linearisation::of(&mut state.main.linearisation, theta_k),
            &mut ws.newton,
        ),
        SolverSettings::FixedPoint(settings) => {
            let (trial, scratch) = (&mut velocity.instant.velocity, &mut ws.scratch);
            let (last, explicit) = (&mut ws.last_iterate, &ws.explicit.displacement);
            let (shift, shifted) = (&ws.shift, &mut ws.shifted);
            last.copy_from_slice(&state.main.displacement);
            fixed_point::solve(
                &contact,
                *settings,
                &state.main.instant.force,
                &mut velocity.instant.slip_rate,
                &mut ws.newton,
                &mut ws.fixed_point,
                |w, force| {
                    body.correct(stage, add_shift(w, shift, shifted), force, trial, scratch);
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
    if solution.converged {
        let accepted = ws.newton.accepted();
        contact.forces(accepted, &mut velocity.instant.force);
        for (reaction, y) in velocity.instant.reaction.iter_mut().zip(&accepted.y) {
            *reaction = -y;
        }
    }
    Solved {
        iterations: solution.iterations,
        residual: solution.residual,
        node: solution.node,
        converged: solution.converged,
        is_at_rounding: solution.is_at_rounding,
        fault: None,
    }
}

fn test_multiplicity(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    theta_k: f64,
    index: usize,
) {
    let settings = model.solver();
    let bounds = model.friction().with(&state.coefficients);
    let found = multiplicity::test(
        &contact_problem!(model, ws, theta_k, &bounds),
        &bounds,
        settings.tolerance(),
        settings.max_iterations(),
        &ws.velocities[index].instant.slip_rate,
        &mut ws.multiplicity,
    );
    let entry = &mut state.report;
    entry[report::SOLUTIONS] = entry[report::SOLUTIONS].max(found.solutions as f64);
    entry[report::SOLUTION_GAP] = entry[report::SOLUTION_GAP].max(found.gap);
}

/// Velocities of the contact, `relative` to what moves, of the body without its drives.
fn add_shift<'a>(relative: &'a [f64], shift: &[f64], out: &'a mut [f64]) -> &'a [f64] {
    if shift.is_empty() {
        return relative;
    }
    for (out, (relative, shift)) in out.iter_mut().zip(relative.iter().zip(shift)) {
        *out = relative + shift;
    }
    out
}

/// The velocity of the whole body from the contact that was solved, what is seen of it, and what drives it.
fn correct(model: &Model, ws: &mut Workspace, theta_k: f64, index: usize) {
    let (body, motions) = (model.body(), model.motions());
    let velocity = &mut ws.velocities[index];
    velocity.set_magnitudes();
    let instant = &mut velocity.instant;
    let (relative, reaction): (&[f64], &[f64]) = match &ws.pressed {
        Some(pressed) => (pressed.velocity(), &pressed.reaction),
        None => (&instant.slip_rate, &instant.reaction),
    };
    body.correct(
        ws.stages.current(),
        add_shift(relative, &ws.shift, &mut ws.shifted),
        reaction,
        &mut instant.velocity,
        &mut ws.scratch,
    );
    body.outputs(&instant.velocity, &mut instant.output_velocity);
    velocity.load.copy_from_slice(&ws.load);
    if motions.is_empty() {
        return;
    }
    let displacement = &mut ws.explicit.drive_displacement;
    add_drives(motions, displacement, theta_k, &ws.load);
    motions.drive_forces(
        &ws.load,
        displacement,
        &instant.output_velocity,
        reaction,
        &mut instant.drive_force,
    );
    motions.foundation_forces(reaction, &mut instant.foundation_force);
    let drive = |drive: usize| ws.load[motions.drive_input(drive)];
    motions.add_outputs(drive, &mut instant.output_velocity);
}
