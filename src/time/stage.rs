//! Implicit stages: those of an internal step one after the other, and the one with step size 0 that makes a start consistent.
//! Each predicts the free motion, solves friction on the contact and corrects the body.

use super::companion::{Companion, StagePlace};
use super::record::explicit_part;
use super::workspace::Workspace;
use crate::contact::solve::newton::linearisation::Linearisation;
use crate::contact::solve::{fixed_point, multiplicity, newton};
use crate::contact::{ContactProblem, problem::norm};
use crate::error::{Error, Result};
use crate::model::{Model, SolverSettings};
use crate::scene::Start;
use crate::state::{State, report};

/// Makes velocity and contact forces consistent with the loads of this instant: the inequality at fixed displacement.
///
/// # Errors
/// [`crate::Error::NotConverged`].
pub(crate) fn settle(model: &Model, state: &mut State, ws: &mut Workspace) -> Result<()> {
    if model.start() == Start::Zero {
        return Ok(());
    }
    ws.explicit
        .displacement
        .copy_from_slice(&state.main.displacement);
    ws.explicit
        .accumulated_slip
        .copy_from_slice(&state.main.accumulated_slip);
    ws.load.copy_from_slice(&state.loads);
    ws.velocities[0].load_from(state);
    solve_stage(model, state, ws, 0.0, 0)?;
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
    ws.velocities[0].load_from(state);
    ws.course.at(at(0.0), &mut ws.load);
    ws.velocities[0].load.copy_from_slice(&ws.load);
    companion.begin(at(0.0));
    for (i, stage) in model.tableau().stages().iter().enumerate() {
        let (index, fraction) = (i + 1, at(stage.instant));
        explicit_part(state, &ws.velocities[..index], stage, k, &mut ws.explicit);
        ws.course.at(fraction, &mut ws.load);
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
    Ok(())
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
    let stage = ws.stages.get(body, theta_k, &mut ws.scratch)?;
    body.predict(
        stage,
        &ws.explicit.displacement,
        &ws.load,
        &mut ws.condensed_load,
        &mut ws.scratch,
    );
    let bounds = model.friction().with(&state.coefficients);
    if let [cancelled] = &mut ws.velocities[index].instant.cancelled[..] {
        *cancelled = body.cancelled_norm(&ws.scratch);
    }
    let contact = ContactProblem {
        s: stage.s.as_ref(),
        r: &ws.condensed_load,
        components: model.contact().components,
        weights: &model.contact().weights,
        law: &bounds,
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
            &mut velocity.instant.slip_rate,
            &mut Linearisation::of(&mut state.main.linearisation, theta_k),
            &mut ws.newton,
        ),
        SolverSettings::FixedPoint(settings) => {
            let (trial, scratch) = (&mut velocity.instant.velocity, &mut ws.scratch);
            let (last, explicit) = (&mut ws.last_iterate, &ws.explicit.displacement);
            last.copy_from_slice(&state.main.displacement);
            fixed_point::solve(
                &contact,
                *settings,
                &state.main.instant.force,
                &mut velocity.instant.slip_rate,
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
    if !solution.converged && !solution.residual.is_finite() {
        return Err(Error::Overflow {
            what: "the residual of the friction law".into(),
            time: state.time,
        });
    }
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
        let found = multiplicity::test(
            &contact,
            &bounds,
            settings.tolerance(),
            settings.max_iterations(),
            &velocity.instant.slip_rate,
            &mut ws.multiplicity,
        );
        let entry = &mut state.report;
        entry[report::SOLUTIONS] = entry[report::SOLUTIONS].max(found.solutions as f64);
        entry[report::SOLUTION_GAP] = entry[report::SOLUTION_GAP].max(found.gap);
    }
    let entry = &mut state.report;
    entry[report::ITERATIONS] += solution.iterations as f64;
    entry[report::RESIDUAL] = entry[report::RESIDUAL].max(solution.residual);

    if solution.is_at_rounding {
        entry[report::AT_ROUNDING] = 1.0;
    }
    let accepted = ws.newton.accepted();
    contact.forces(accepted, &mut velocity.instant.force);
    for (reaction, y) in velocity.instant.reaction.iter_mut().zip(&accepted.y) {
        *reaction = -y;
    }
    let components = model.contact().components;
    for (magnitude, w) in velocity
        .magnitude
        .iter_mut()
        .zip(velocity.instant.slip_rate.chunks_exact(components))
    {
        *magnitude = norm(w);
    }
    body.correct(
        stage,
        &velocity.instant.slip_rate,
        &velocity.instant.reaction,
        &mut velocity.instant.velocity,
        &mut ws.scratch,
    );
    body.outputs(
        &velocity.instant.velocity,
        &mut velocity.instant.output_velocity,
    );
    velocity.load.copy_from_slice(&ws.load);
    Ok(())
}
