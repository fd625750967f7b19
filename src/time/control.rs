//! Whether a pair of internal steps is accurate enough, and how large the next one shall be.
//!
//! The error of a pair is what its displacement gained, less Simpson's rule on the velocities at its start, middle and end
//! (Milne's device; of fourth order where the velocity is smooth, whatever the scheme):
//!
//! ```text
//! d = u_2 - u_0 - k/3 (w_0 + 4 w_1 + w_2)
//! ```
//!
//! `A w + B u + E Lambda = F f` turns an error `d` in displacement that is made once into at most `r d` in velocity, which
//! dies out at the relaxation rates r; made in every pair it leaves `d / 2k`. So a pair is accepted when
//!
//! ```text
//! |d| <= tolerance * 2k * max |w|
//! ```
//!
//! for the body in the norm of the viscosity and for the contact in the discrete L2 norm (weights omega), the largest over the
//! time so far and the pairs tried. Then the accumulated error is of the size of the tolerance. Larger errors are allowed in two
//! cases:
//!
//! * Where a contact node changes between stick and slip the velocity has a kink (or a jump, where a step has several
//!   solutions), and `d` falls with one order less (two). A pair with such a change may spend [`BURST`] / r beyond its own 2k:
//!   its error is made once.
//! * A slip rate below a share of what the velocity of the body could mean at the contact is not resolved relative to itself.
//!
//! The size proposed for the next pair belongs to the state. After a refusal the pair is halved as often as the order of the
//! scheme predicts; otherwise it may double, where the error predicted for twice the size is allowed. Sizes are
//! powers of two apart, so a smoother controller would have no effect. `sizes` does not let a pair reach beyond the end of the
//! half of the panel that it is in, which keeps sizes from alternating around a kink.
//!
//! The pair of Hosea and Shampine for TR-BDF2 would give an error for every single step; Simpson's rule is of the same order,
//! and the same for all schemes.
//!
//! A pair whose friction does not converge counts as one with too large an error.

use super::sizes::Part;
use super::velocity::Velocity;
use super::workspace::{ControlWorkspace, Workspace};
use crate::error::{Error, Result};
use crate::fem::ContactPatch;
use crate::linalg::dot;
use crate::model::Model;
use crate::state::{Instant, State, control, report};

/// Share of the memory of the body (1 / fastest relaxation rate) that may be spent on one change between stick and slip.
const BURST: f64 = 0.02;
/// Share of the largest possible slip rate below which the slip rate is not resolved relative to itself.
const CONTACT_FLOOR: f64 = 0.1;
/// Size of a pair, as a share of what one change may take, below which an error can only be that of a velocity that jumps: where
/// contact opens and closes, also between the ends of a step.
const SUDDEN: f64 = 1e-3;
/// Share of the slip rate below which a jump of the normal velocity of a closed node is not noticed, and share of that velocity.
const NOTICEABLE: f64 = 1e-6;
const JUMP: f64 = 0.1;
/// Share of the velocity that the slip rate asks of the body at least below which its own is not resolved relative to itself.
const BODY_FLOOR: f64 = 1e-6;
/// Predicted error, relative to the allowed one, up to which a pair is enlarged.
const SAFETY: f64 = 0.9;
/// Most halvings after one refusal.
const MOST_HALVINGS: f64 = 5.0;
/// Halvings of a pair whose friction did not converge.
const HALVINGS_UNKNOWN: f64 = 2.0;
/// Smallest internal step, relative to `time.step`.
const SMALLEST: f64 = 1.0 / (1 << 30) as f64;

/// What is decided about a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    Accepted,
    Refused,
}

/// The simulation starts: the first pair tried is the largest.
pub(crate) fn start(model: &Model, state: &mut State) {
    state.control[control::PROPOSED] = 2.0 * model.largest_step();
    watch(model, state);
}

/// Takes note of the slip rate, for the figures that are relative to the largest one.
pub(crate) fn watch(model: &Model, state: &mut State) {
    let norm = model.contact_norm(|i| state.main.instant.slip_rate[i]);
    let largest = &mut state.control[control::LARGEST_SLIP_RATE];
    *largest = largest.max(norm);
}

/// Size proposed for the next part; `None` when all are equal.
pub(crate) fn proposed(model: &Model, state: &State) -> Option<f64> {
    model.tolerance().map(|_| state.control[control::PROPOSED])
}

/// Keeps the state before a part that may be refused.
pub(crate) fn keep(state: &State, ws: &mut Workspace) {
    if let Some(control) = &mut ws.control {
        control.kept.copy_steps_from(state);
        // a part that is undone has lost nothing
        control.kept.report[report::LOST_DIGITS] = state.report[report::LOST_DIGITS];
    }
}

/// The second step of a pair begins.
pub(crate) fn note_middle(state: &State, ws: &mut Workspace) {
    let control = ws.control.as_mut();
    if let Some(middle) = control.and_then(|control| control.middle.as_mut()) {
        middle.load_from(state);
    }
}

/// Judges a part that was taken from the kept state, and proposes the size of the next one; a refused part is undone.
///
/// # Errors
/// That of the part when there is no control; [`Error::ToleranceOutOfReach`], or [`Error::NotConverged`] of the part, when the
/// smallest step is refused.
pub(crate) fn judge(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    part: &Part,
    taken: Result<()>,
) -> Result<Verdict> {
    let (Some(tolerance), Some(control)) = (model.tolerance(), &mut ws.control) else {
        return taken.map(|()| Verdict::Accepted);
    };
    if taken.is_err() {
        return refuse(model, state, control, part, taken);
    }
    let own = control.middle.take();
    // what the second step of the pair started from
    let middle = own.as_ref().unwrap_or(&ws.velocities[0]);
    let excess = error_of(model, state, control, middle, part) / tolerance;
    control.middle = own;
    if excess <= 1.0 {
        let order = f64::from(model.tableau().order() + 1);
        let doublings = ((SAFETY / excess).log2() / order).floor();
        let predicted = part.size() * doublings.clamp(0.0, 60.0).exp2();
        let proposed = &mut state.control[control::PROPOSED];
        // a communication step of next to nothing does not make the next one begin there
        *proposed = predicted
            .min(2.0 * *proposed)
            .clamp(smallest(model), 2.0 * model.largest_step());
        return Ok(Verdict::Accepted);
    }
    if excess.is_nan() {
        return Err(Error::Overflow {
            what: "the error of a pair of internal steps".into(),
            time: control.kept.time,
        });
    }
    let error = Error::ToleranceOutOfReach {
        time: control.kept.time,
        step: part.k,
        excess,
        tolerance,
    };
    refuse(model, state, control, part, Err(error))
}

/// Judges what went along with an accepted part: where the second solution did not converge, the part is undone after all.
///
/// # Errors
/// Those of [`judge`].
pub(crate) fn judge_second(
    model: &Model,
    state: &mut State,
    ws: &mut Workspace,
    part: &Part,
    followed: Result<()>,
) -> Result<Verdict> {
    match (followed, &mut ws.control) {
        (Ok(()), _) => Ok(Verdict::Accepted),
        (failed, None) => failed.map(|()| Verdict::Accepted),
        (failed, Some(control)) => refuse(model, state, control, part, failed),
    }
}

/// Undoes a pair for a reason and proposes a smaller one.
///
/// # Errors
/// The reason, when it is not the size or nothing smaller is left.
fn refuse(
    model: &Model,
    state: &mut State,
    control: &mut ControlWorkspace,
    part: &Part,
    reason: Result<()>,
) -> Result<Verdict> {
    let halvings = match reason {
        Err(Error::ToleranceOutOfReach { excess, .. }) if excess.is_finite() => {
            let order = f64::from(model.tableau().order());
            (excess.log2() / order).ceil().clamp(1.0, MOST_HALVINGS)
        }
        Err(Error::ToleranceOutOfReach { .. }) => MOST_HALVINGS,
        Err(Error::NotConverged { .. } | Error::BodyNotConverged { .. }) => HALVINGS_UNKNOWN,
        _ => return reason.map(|()| Verdict::Accepted),
    };
    let smallest = smallest(model);
    if 0.5 * part.size() < smallest {
        return reason.map(|()| Verdict::Refused);
    }
    control.refused += 1;
    state.copy_steps_from(&control.kept);
    state.report[report::LOST_DIGITS] = control.kept.report[report::LOST_DIGITS];
    state.control[control::PROPOSED] = (part.size() * (-halvings).exp2()).max(smallest);
    Ok(Verdict::Refused)
}

/// Size of the smallest pair, s.
fn smallest(model: &Model) -> f64 {
    2.0 * SMALLEST * model.largest_step()
}

/// Error of a pair relative to the largest velocities and to the time that it counts for; the tolerance is its bound.
fn error_of(
    model: &Model,
    state: &mut State,
    control: &mut ControlWorkspace,
    middle: &Velocity,
    part: &Part,
) -> f64 {
    let ControlWorkspace {
        kept,
        body,
        contact,
        ..
    } = control;
    simpson_error(
        body,
        [&kept.main.displacement, &state.main.displacement],
        [
            &kept.main.instant.velocity,
            &middle.instant.velocity,
            &state.main.instant.velocity,
        ],
        part.k,
    );
    simpson_error(
        contact,
        [&kept.slip, &state.slip],
        [
            &kept.main.instant.slip_rate,
            &middle.instant.slip_rate,
            &state.main.instant.slip_rate,
        ],
        part.k,
    );
    let size = viscous_norm(model, &state.main.instant.velocity);
    let largest = &mut state.control[control::BODY_SCALE];
    *largest = largest.max(size);
    let body_scale = *largest;
    let resistance = model.certificate().sharp_instant.sqrt();
    // |w_c| <= |w| / sqrt(smallest eigenvalue of the condensed viscosity)
    let possible = body_scale / resistance;
    let slip_rate = model.contact_norm(|i| state.main.instant.slip_rate[i]);
    let largest = &mut state.control[control::CONTACT_SCALE];
    *largest = largest.max(slip_rate);
    let contact_scale = largest.max(CONTACT_FLOOR * possible);
    // a body that is only carried along has no velocity of its own but rounding
    let body_scale = body_scale.max(BODY_FLOOR * contact_scale * resistance);

    let components = model.contact().components;
    let is_kinked = has_changed(
        &kept.main.instant.slip_rate,
        &middle.instant.slip_rate,
        components,
    ) || has_changed(
        &middle.instant.slip_rate,
        &state.main.instant.slip_rate,
        components,
    );
    let burst = BURST / model.summary().rates[1];
    let meets = !model.contact().gaps.is_empty()
        && (part.size() < SUDDEN * burst
            || opens_or_meets(
                model.contact(),
                [&kept.main, &state.main].map(|solution| &solution.instant),
                &middle.instant,
                NOTICEABLE * contact_scale,
            ));
    let burst = f64::from(u8::from(is_kinked || meets)) * burst;
    let share = |error: f64, scale: f64| match error {
        0.0 => 0.0,
        _ => error / (scale * (part.size() + burst)),
    };
    share(viscous_norm(model, body), body_scale)
        .max(share(model.contact_norm(|i| contact[i]), contact_scale))
}

/// `d = u_2 - u_0 - k/3 (w_0 + 4 w_1 + w_2)`.
fn simpson_error(d: &mut [f64], gained: [&[f64]; 2], velocities: [&[f64]; 3], k: f64) {
    let ([before, after], [start, middle, end]) = (gained, velocities);
    for (i, d) in d.iter_mut().enumerate() {
        let simpson = start[i] + 4.0 * middle[i] + end[i];
        *d = after[i] - before[i] - k / 3.0 * simpson;
    }
}

/// Whether a contact node is at rest in one and not in the other, or has reversed.
fn has_changed(before: &[f64], after: &[f64], components: usize) -> bool {
    let is_at_rest = |w: &[f64]| w.iter().all(|v| *v == 0.0);
    let mut nodes = before
        .chunks_exact(components)
        .zip(after.chunks_exact(components));
    nodes.any(|(a, b)| is_at_rest(a) != is_at_rest(b) || dot(a, b) < 0.0)
}

/// Whether a contact node opens, closes, or has closed just before: its normal velocity, more than `least`, then still jumps.
fn opens_or_meets(
    contact: &ContactPatch,
    [before, after]: [&Instant; 2],
    middle: &Instant,
    least: f64,
) -> bool {
    let is_closed = |instant: &Instant, node: usize| instant.normal_force[node] > 0.0;
    let changes = |node: usize| {
        let [start, middle_velocity] = [before, middle].map(|i| i.normal_velocity[node]);
        let jump = (start - middle_velocity).abs();
        let size = start.abs().max(middle_velocity.abs());
        is_closed(before, node) != is_closed(middle, node)
            || is_closed(middle, node) != is_closed(after, node)
            || (is_closed(before, node) && jump > least.max(JUMP * size))
    };
    let opening = contact.parts.iter().filter(|part| part.can_open);
    opening.flat_map(|part| part.nodes.clone()).any(changes)
}

/// `(x.A x)^1/2`.
fn viscous_norm(model: &Model, x: &[f64]) -> f64 {
    model.body().products(x).0.max(0.0).sqrt()
}
