//! The error in time, from a second solution with another step.
//!
//! The second solution `(u~, w~)` starts where the main one does and never looks at it again: it has the same loads, law and
//! scheme, and goes through every part of the communication step in twice as many internal steps of half the size, or, where
//! `time.tolerance` chooses the sizes in pairs, through every pair in one. In the asymptotic range of a scheme of order p
//!
//! ```text
//! |w - w(exact)| = |w - w~| 2^p / (2^p - 1)     half the step
//!                = |w - w~|     / (2^p - 1)     twice the step
//! ```
//!
//! whatever the sequence of step sizes (Richardson). The difference is the accumulated error and not that of one step: what
//! the body has forgotten is gone from both solutions, what happened at a change between stick and slip is in both. The
//! output is this error of the slip rate in the discrete L2 norm over the contact, `|x|^2 = sum_i omega_i |x_i|^2`, relative to
//! the largest such norm of `w` at the ends of internal steps since the start; p is the order of the scheme, or 1 where
//! equal steps start from zero velocity.
//!
//! The error that a change between stick and slip leaves depends on where in a step it falls. With half the step a lone change
//! is estimated within 2/3 and 4/3 of its error. Twice the step costs half a step more instead of two, but is within 1/3 and
//! infinity there; it serves where the step control makes the errors of such changes small beside the rest.
//! The estimate is no bound, and where a step has several solutions the two may follow different ones.

use crate::model::Model;
use crate::state::{State, control};

/// The estimate at the instant of the state; 0 as long as the contact has never moved.
pub(crate) fn estimate(model: &Model, state: &State) -> f64 {
    let Some(second) = &state.second else {
        return 0.0;
    };
    let (main, second) = (&state.main.instant.slip_rate, &second.instant.slip_rate);
    let difference = model.contact_norm(|i| main[i] - second[i]);
    if difference == 0.0 {
        return 0.0;
    }
    let factor = match model.tolerance() {
        None => 1.0 / (1.0 - 0.5_f64.powi(model.order() as i32)),
        Some(_) => 1.0 / (2.0_f64.powi(model.tableau().order() as i32) - 1.0),
    };
    // a contact that only the second solution moves has an error of the size of its motion
    let largest = state.control[control::LARGEST_SLIP_RATE];
    let relative = if largest > 0.0 {
        difference / largest
    } else {
        1.0
    };
    (relative * factor).min(f64::MAX)
}
