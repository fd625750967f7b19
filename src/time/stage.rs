//! Implicit stages: those of an internal step one after the other, and the one with step size 0 that makes a start consistent.
//! Each predicts the free motion, solves friction on the contact and corrects the body.

use super::companion::{Companion, StagePlace};
use super::linearised;
use super::memory::{self, Span};
use super::nonlinear;
use super::pressed::Level;
use super::record::explicit_part;
use super::workspace::Workspace;
use super::{penetration, slip_memory};
use crate::error::Result;
use crate::model::Model;
use crate::model::motions::Approach;
use crate::scene::{Condition, Start};
use crate::state::State;

/// Makes velocity and contact forces consistent with the inputs of this instant: the inequality at fixed displacement.
/// `approach` is the velocity of the foundation towards the body.
///
/// # Errors
/// [`crate::Error::NotConverged`].
pub(crate) fn settle(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    approach: Approach,
) -> Result<()> {
    if model.start() == Start::Zero {
        return Ok(());
    }
    ws.load.copy_from_slice(&state.loads);
    settle_at(model, state, ws, approach)
}

/// The same for the inputs in `ws.load`.
fn settle_at(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    approach: Approach,
) -> Result<()> {
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
    // where one contact gives way all do, with a rule whose stages have means only
    let gives_way = matches!(model.conditions()[0], Condition::Compliance { .. });
    let is_at_end = !model.tableau().ends_with_stage() && !gives_way;
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
    let approach = Approach::rate(ws.approach[0], ws.approach[1], k);
    settle_at(model, state, ws, approach)
}

/// Solves one stage with implicit weight `theta_k` for the explicit part and inputs in `ws`, into `ws.velocities[index]`,
/// whose contact velocity is the warm start.
fn solve_stage(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    at: (f64, Level, Span),
    index: usize,
) -> Result<()> {
    match model.body().nonlinear() {
        None => {
            ws.stages.get(model.body(), at.0, &mut ws.scratch)?;
            linearised::solve(model, state, ws, at, index)?;
        }
        Some(cells) => nonlinear::solve(model, cells, state, ws, at, index)?,
    }
    let span = at.2;
    penetration::advance(model, ws, at, index);
    if index > 0 {
        memory::advance(model, state, &ws.before, span, &mut ws.velocities[index]);
        let (known, rest) = ws.velocities.split_at_mut(index);
        slip_memory::advance(model, &known[index - 1], span.step, &mut rest[0]);
    }
    Ok(())
}
