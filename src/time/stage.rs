//! One implicit stage: predict the free motion, solve friction on the contact, correct the body.

use super::workspace::Workspace;
use crate::contact::solve::newton::linearisation::Linearisation;
use crate::contact::solve::{fixed_point, multiplicity, newton};
use crate::contact::{ContactProblem, Law, problem::norm};
use crate::error::{Error, Result};
use crate::model::{Model, SolverSettings};
use crate::state::{State, report};

/// Solves one stage with implicit weight `theta_k` for the explicit part and loads in `ws`, into `ws.velocities[index]`,
/// whose contact velocity is the warm start.
pub(crate) fn solve_stage(
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
    if let [cancelled] = &mut ws.velocities[index].instant.cancelled[..] {
        *cancelled = body.cancelled_norm(&ws.scratch);
    }
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
        test_multiplicity(
            &contact,
            &velocity.instant.slip_rate,
            &mut ws.multiplicity,
            settings,
            state,
        );
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
