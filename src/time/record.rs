//! What a step leaves behind: displacement and slip from the velocities of its stages, energies, the recorded past.

use super::scheme::{Stage, Tableau};
use super::workspace::{Explicit, Velocity, Workspace};
use crate::linalg::{add_scaled, dot};
use crate::model::Model;
use crate::state::{State, energy};

/// `p = u_n + k sum_j a_j w_j`, for the displacement of the body and the accumulated slip.
pub(crate) fn explicit_part(
    state: &State,
    known: &[Velocity],
    stage: &Stage,
    k: f64,
    explicit: &mut Explicit,
) {
    explicit
        .displacement
        .copy_from_slice(&state.main.displacement);
    explicit
        .accumulated_slip
        .copy_from_slice(&state.main.accumulated_slip);
    for (a, velocity) in stage.explicit.iter().zip(known) {
        if *a != 0.0 {
            add_scaled(
                &mut explicit.displacement,
                a * k,
                &velocity.instant.velocity,
            );
            add_scaled(&mut explicit.accumulated_slip, a * k, &velocity.magnitude);
        }
    }
}

/// `u_{n+1} = u_n + k sum_j b_j w_j` for everything that is integrated.
pub(crate) fn integrate(tableau: &Tableau, state: &mut State, velocities: &[Velocity], k: f64) {
    integrate_solution(tableau, state, velocities, k);
    for (j, velocity) in velocities.iter().enumerate() {
        let weight = tableau.weight(j) * k;
        if weight != 0.0 {
            add_scaled(&mut state.slip, weight, &velocity.instant.slip_rate);
            add_scaled(
                &mut state.output_displacement,
                weight,
                &velocity.instant.output_velocity,
            );
        }
    }
}

/// The same for what the next step depends on: the displacement of the body and the accumulated slip.
pub(crate) fn integrate_solution(
    tableau: &Tableau,
    state: &mut State,
    velocities: &[Velocity],
    k: f64,
) {
    for (j, velocity) in velocities.iter().enumerate() {
        let weight = tableau.weight(j) * k;
        if weight != 0.0 {
            add_scaled(
                &mut state.main.displacement,
                weight,
                &velocity.instant.velocity,
            );
            add_scaled(
                &mut state.main.accumulated_slip,
                weight,
                &velocity.magnitude,
            );
        }
    }
}

/// Energies of the step from the means (weights b_j) of loads, velocities and contact forces: those of balance, so that
/// what the friction solver leaves does not show in the energies.
pub(crate) fn add_energies(model: &Model, state: &mut State, ws: &mut Workspace, k: f64) {
    let tableau = model.tableau();
    let Workspace {
        velocities, mean, ..
    } = ws;
    mean.set_mean(tableau, velocities);
    let (viscous, _) = model.body().products(&mean.instant.velocity);
    let (_, elastic) = model.body().products(&state.main.displacement);
    // the outputs begin with the loads
    state.energy[energy::EXTERNAL_WORK] += k * dot(&mean.load, &mean.instant.output_velocity);
    state.energy[energy::VISCOUS] += k * viscous;
    state.energy[energy::FRICTION] += k * dot(&mean.instant.reaction, &mean.instant.slip_rate);
    state.energy[energy::ELASTIC] = 0.5 * elastic;
}

/// Appends the instant to the ring of the past.
pub(crate) fn record(model: &Model, state: &mut State) {
    let capacity = model.history_capacity() as u64;
    if capacity == 0 {
        return;
    }
    let m = state.slip.len();
    let row_len = state.history.len() / capacity as usize;
    let at = (state.recorded % capacity) as usize * row_len;
    let row = &mut state.history[at..at + row_len];
    let contact = model.contact();
    row[0] = state.time;
    row[1..=m].copy_from_slice(&state.main.instant.slip_rate);
    row[1 + m..=2 * m].copy_from_slice(&state.slip);
    for (i, stress) in row[1 + 2 * m..].iter_mut().enumerate() {
        *stress = contact.stress(i, state.main.instant.force[i]);
    }
    state.recorded += 1;
}
