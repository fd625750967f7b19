//! The second solution of the error estimate follows the main one: at the start, through jumps, and through every part of a
//! communication step (see `estimate`).

use super::companion::Alone;
use super::control::watch;
use super::record::integrate_solution;
use super::sizes::Part;
use super::stage::{settle, solve_end, solve_stages};
use super::workspace::Workspace;
use crate::error::Result;
use crate::model::Model;
use crate::model::motions::Approach;
use crate::state::State;

/// The second solution starts at the main one.
pub(crate) fn start(model: &Model, state: &mut State) {
    if model.has_error_estimate() {
        state.copy_to_second();
    }
}

/// The velocity of the second solution follows a jump of loads or coefficients.
///
/// # Errors
/// [`crate::Error::NotConverged`].
pub(crate) fn follow_jump(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    approach: Approach,
) -> Result<()> {
    follow_with(model, state, |state| settle(model, state, ws, approach))
}

/// The second solution takes a part that the main one has taken.
///
/// # Errors
/// [`crate::Error::NotConverged`].
pub(crate) fn follow(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    part: &Part,
) -> Result<()> {
    let steps = if part.steps == 1 { 2 } else { 1 };
    let k = part.size() / f64::from(steps);
    follow_with(model, state, |state| {
        for i in 0..steps {
            let at = |instant: f64| part.at((f64::from(i) + instant) / f64::from(steps));
            solve_stages(model, state, ws, k, at, &mut Alone)?;
            let last = model.tableau().stages().len();
            ws.velocities[last].store_into(state);
            integrate_solution(model.tableau(), state, &ws.velocities[..=last], k);
            solve_end(model, state, ws, k, at(1.0))?;
        }
        Ok(())
    })
}

/// Runs `change` with the second solution swapped for the main one, which has just moved.
fn follow_with(
    model: &Model,
    state: &mut State,
    change: impl FnOnce(&mut State) -> Result<()>,
) -> Result<()> {
    if !model.has_error_estimate() {
        return Ok(());
    }
    watch(model, state);
    state.swap_second();
    let outcome = change(state);
    state.swap_second();
    outcome
}
