//! The algorithm of a step: predict, solve friction, correct, record.
//!
//! ```text
//! loads at the two ends of the communication step; where they jump, the velocity follows   (input_course)
//! for every part of the communication step                                     (sizes)
//!     for every internal step of size k in it
//!         for every stage i of the scheme                                      (scheme)
//!             p   = u_n + k sum_{j<i} a_ij w_j                                 explicit part of the history
//!             r   = S E^T M^-1 (F f_i - B p),   M = A + theta k B              predict
//!             S w_c + Lambda = r,  Lambda in omega g(|w_c|) d|w_c|             friction
//!             w_i = M^-1 (F f_i - B p - E Lambda)                              correct
//!         u_{n+1} = p + theta k w,  slip and accumulated slip alike            record
//!     accept the part, or undo it and take a smaller one                       (control)
//!     the second solution follows                                              (estimate)
//! ```
//!
//! Without `time.tolerance` a part is one internal step, all are equal, and none is refused.
//!
//! The step works on a trial state; the caller keeps the old one until the last internal step has succeeded.

use super::companion::Companion;
use super::control::{self, Verdict};
use super::input_course;
use super::limit::WorkLimit;
use super::lost_digits;
use super::record::{add_energies, integrate, record};
use super::second;
use super::sizes::{Part, Parts};
use super::stage::{settle, solve_end, solve_stages};
use super::workspace::Workspace;
use crate::error::Result;
use crate::model::Model;
use crate::model::motions::Approach;
use crate::state::State;

/// Advances `state` by one communication step of `h`; what its inputs mean is part of it.
///
/// # Errors
/// [`crate::Error::NotConverged`], [`crate::Error::ToleranceOutOfReach`], [`crate::Error::Step`] for a million internal steps;
/// `state` is then spoilt.
pub(crate) fn advance(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    h: f64,
    companion: &mut impl Companion,
) -> Result<()> {
    let parts = Parts::of(state.time, h, model);
    ws.limit = WorkLimit::of_step(model, parts.internal_steps());
    let outcome = advance_by(model, state, ws, (h, parts), companion);
    ws.limit = WorkLimit::default();
    outcome
}

/// The communication step of `h` in these parts.
fn advance_by(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    (h, mut parts): (f64, Parts),
    companion: &mut impl Companion,
) -> Result<()> {
    state.report.fill(0.0);
    apply_jumps(model, state, ws, h)?;
    companion.start(model, state, ws)?;
    let start = state.time;
    while let Some(part) = parts.next(control::proposed(model, state)) {
        control::keep(state, ws);
        companion.keep();
        let taken = take(model, state, ws, &part, start, h, companion);
        let mut verdict = control::judge(model, state, ws, &part, taken)?;
        if verdict == Verdict::Accepted {
            let followed = second::follow(model, state, ws, &part);
            verdict = control::judge_second(model, state, ws, &part, followed)?;
        }
        match verdict {
            Verdict::Accepted => parts.pass()?,
            Verdict::Refused => companion.go_back(),
        }
    }
    state.loads.copy_from_slice(&ws.course.end);
    input_course::finish(state, h);
    Ok(())
}

/// The internal steps of a part.
fn take(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    part: &Part,
    start: f64,
    h: f64,
    companion: &mut impl Companion,
) -> Result<()> {
    for i in 0..part.steps {
        if i > 0 {
            control::note_middle(state, ws);
        }
        let at = |instant: f64| part.at((f64::from(i) + instant) / f64::from(part.steps));
        internal_step(model, state, ws, part.k, at, companion)?;
        state.time = start + h * at(1.0);
        record(model, state);
    }
    Ok(())
}

/// Loads may jump at the beginning of the step, coefficients may have changed since the last one: the velocity follows.
fn apply_jumps(model: &Model, state: &mut State, ws: &mut Workspace, h: f64) -> Result<()> {
    let has_jump = input_course::begin(model, state, h, &mut ws.course)?;
    state.loads.copy_from_slice(&ws.course.start);
    let is_settled = state.needs_settling == 0 && !has_jump;
    state.needs_settling = 0;
    ws.has_settled = !is_settled;
    if !is_settled && (model.tableau().uses_start_velocity() || model.tolerance().is_some()) {
        let ends = [&ws.course.start, &ws.course.end];
        let [from, to] = ends.map(|inputs| model.motions().approach(inputs));
        let rate = Approach::rate(from, to, h);
        ws.limit.expect(1 + u64::from(model.has_error_estimate()));
        settle(model, state, ws, rate)?;
        second::follow_jump(model, state, ws, rate)?;
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
    solve_stages(model, state, ws, k, &at, companion)?;
    let tableau = model.tableau();
    let last = tableau.stages().len();
    ws.velocities[last].store_into(state);
    let before = lost_digits::before(model, state, k);
    integrate(model, state, &ws.velocities[..=last], k);
    add_energies(model, state, ws, k);
    if let Some(before) = before {
        before.note(model, state, &ws.velocities[..=last], k);
    }
    companion.end(model, state, ws, k);
    if !tableau.ends_with_stage() {
        solve_end(model, state, ws, k, at(1.0))?;
        companion.settle_end(model, state, ws, k, at(1.0))?;
    }
    state.steps += 1;
    Ok(())
}
