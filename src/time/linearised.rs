//! A stage of a body that is linear, or linearised: predicts the free motion, solves the contact, corrects the body.

use super::contact;
use super::memory::Span;
use super::pressed::Level;
use super::slip_memory;
use super::velocity::Velocity;
use super::workspace::Workspace;
use crate::error::{Error, Result};
use crate::fem::Pin;
use crate::model::Model;
use crate::state::{State, report};

/// Solves the stage for the explicit part and inputs in `ws` with the factorization that was asked for last, into
/// `ws.velocities[index]`.
///
/// # Errors
/// [`Error::NotConverged`] and [`Error::Overflow`] of the friction solver, and what is wrong with the value of a formula.
pub(super) fn solve(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    (theta_k, level, span): (f64, Level, Span),
    index: usize,
) -> Result<()> {
    ws.relative.predict(
        model,
        ws.stages.current(),
        &ws.explicit.displacement,
        &ws.load,
        &mut ws.condensed_load,
        &mut ws.scratch,
    );
    if let [cancelled] = &mut ws.velocities[index].instant.cancelled[..] {
        *cancelled = model.body().cancelled_norm(&ws.scratch);
    }
    let before = &ws.velocities[index.saturating_sub(1)];
    let slip = &mut ws.explicit.accumulated_slip;
    slip_memory::set_base(model, before, (span.length, theta_k), slip);
    let solved = contact::solve(model, state, ws, (theta_k, level, span), index);
    let settings = model.solver();
    if !solved.converged && !solved.residual.is_finite() {
        return Err(Error::Overflow {
            what: "the residual of the friction law".into(),
            time: state.time,
        });
    }
    if !solved.converged && !solved.is_truncated {
        refuse_open(model, state.time, &ws.velocities[index])?;
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
    contact::test_uniqueness(model, state, ws, (theta_k, span), index);
    let entry = &mut state.report;
    entry[report::ITERATIONS] += solved.iterations as f64;
    entry[report::RESIDUAL] = entry[report::RESIDUAL].max(solved.residual);
    let ending = match (solved.is_truncated, solved.is_at_rounding) {
        (true, _) => report::TRUNCATED,
        (_, true) => report::AT_ROUNDING,
        _ => 0.0,
    };
    entry[report::ENDING] = entry[report::ENDING].max(ending);
    correct(model, ws, theta_k, index);
    Ok(())
}

/// A body that contact alone holds, where that is open at too many nodes.
fn refuse_open(model: &Model, time: f64, found: &Velocity) -> Result<()> {
    let contact = model.contact();
    let forces = &found.instant.normal_force;
    let node = |pin: &Pin| pin.component / contact.stride();
    let closed = forces.iter().filter(|force| **force != 0.0).count();
    let needed = contact.pins.len();
    let open = contact.pins.iter().map(node).find(|at| forces[*at] == 0.0);
    match open.filter(|_| closed < needed) {
        None => Ok(()),
        Some(node) => Err(Error::NotHeld {
            time,
            closed,
            needed,
            normal: contact.normals[node],
            node,
        }),
    }
}

/// The velocity of the whole body from the contact that was solved.
fn correct(model: &Model, ws: &mut Workspace, theta_k: f64, index: usize) {
    let velocity = &mut ws.velocities[index];
    velocity.set_magnitudes();
    let pressed = ws.pressed.as_ref();
    let solved = pressed.map(|pressed| [pressed.velocity(), &pressed.reaction[..]]);
    ws.relative.correct(
        model,
        (ws.stages.current(), theta_k),
        solved,
        (&ws.load, &mut ws.explicit.drive_displacement),
        velocity,
        &mut ws.scratch,
    );
}
