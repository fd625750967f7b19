//! How many digits of displacement and slip a step far beyond the relaxation times loses.
//!
//! After a jump of the loads the velocity is that of the viscosity alone, up to `r` times the displacement that is to come, `r`
//! the fastest relaxation rate. It enters the displacement times the step and is taken out again by the stages,
//!
//! ```text
//! u_{n+1} = u_n + k sum_j b_j w_j
//! ```
//!
//! so that of the displacement, and of what follows from it, a relative
//!
//! ```text
//! eps k sum_j b_j |w_j| / max(|u_n|, |u_{n+1}|)     at most some eps k r
//! ```
//!
//! is rounding. Where the velocity itself is what friction leaves of a free motion, the free motion counts. The body is measured in the norm of its elasticity, `|u|^2 = u.B u`, which the stiffest shapes rule, and the slip
//! in the discrete L2 norm over the contact; the larger loss counts. Nothing is computed where `eps k r` is far below the
//! tolerance: in all scenes but those of steps some millions of relaxation times long.

use super::velocity::Velocity;
use crate::body::digits::ALLOWED_LOSS;
use crate::model::Model;
use crate::state::{State, energy, report};

/// The sizes at the beginning of an internal step.
pub(crate) struct Before {
    body: f64,
    slip: f64,
}

/// The sizes at the beginning of an internal step of `k`; `None` where it can lose nothing.
pub(crate) fn before(model: &Model, state: &State, k: f64) -> Option<Before> {
    model.can_lose_digits(k).then(|| Before {
        body: elastic_norm(state),
        slip: model.contact_norm(|i| state.slip[i]),
    })
}

impl Before {
    /// Takes note of what the step to here has lost; its energies have been added.
    pub fn note(self, model: &Model, state: &mut State, velocities: &[Velocity], k: f64) {
        let (mut body, mut slip) = (0.0, 0.0);
        for (j, velocity) in velocities.iter().enumerate() {
            let weight = k * model.tableau().weight(j);
            let instant = &velocity.instant;
            let left = model.body().products(&instant.velocity).1.sqrt();
            let cancelled = instant.cancelled.first().copied().unwrap_or(0.0);
            body += weight * left.max(cancelled);
            slip += weight * model.contact_norm(|i| instant.slip_rate[i]);
        }
        let of_body = lost(body, self.body.max(elastic_norm(state)));
        let of_slip = lost(slip, self.slip.max(model.contact_norm(|i| state.slip[i])));
        let entry = &mut state.report[report::LOST_DIGITS];
        *entry = entry.max(of_body).max(of_slip);
    }
}

/// `(u.B u)^1/2` of the displacement.
fn elastic_norm(state: &State) -> f64 {
    (2.0 * state.energy[energy::ELASTIC]).sqrt()
}

/// Share of `size` that is rounding after a motion to and fro; at most 1.
fn lost(motion: f64, size: f64) -> f64 {
    if motion == 0.0 {
        return 0.0;
    }
    // nothing of nothing is left: 1 where this is not a number
    (f64::EPSILON * motion / size).min(1.0)
}

/// The loss in a communication step where it is beyond what a tolerance of the body allows.
pub(crate) fn beyond_tolerance(model: &Model, state: &State) -> Option<f64> {
    let lost = state.report[report::LOST_DIGITS];
    (lost > ALLOWED_LOSS * model.scene().fidelity.tolerance).then_some(lost)
}
