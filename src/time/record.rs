//! What a step leaves behind: displacement and slip from the velocities of its stages, energies, the recorded past.

use super::scheme::{Stage, Tableau};
use super::velocity::Velocity;
use super::workspace::{Explicit, Workspace};
use super::{foundation, penetration};
use crate::body::nonlinear::VISCOUS;
use crate::linalg::{add_scaled, dot};
use crate::model::Model;
use crate::model::motions::{Approach, Motions};
use crate::scene::MAX_CONTACTS;
use crate::state::{Instant, State, energy};

/// `p = u_n + k sum_j a_j w_j`, for the displacement of the body, that of its contact nodes along their normals, those of driven
/// parts, and the accumulated slip.
pub(crate) fn explicit_part(
    motions: &Motions,
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
    explicit
        .normal_displacement
        .copy_from_slice(&state.main.normal_displacement);
    explicit
        .drive_displacement
        .copy_from_slice(&state.drive_displacement);
    for (a, velocity) in stage.explicit.iter().zip(known) {
        if *a != 0.0 {
            add_scaled(
                &mut explicit.displacement,
                a * k,
                &velocity.instant.velocity,
            );
            add_scaled(&mut explicit.accumulated_slip, a * k, &velocity.magnitude);
            add_scaled(
                &mut explicit.normal_displacement,
                a * k,
                &velocity.instant.normal_velocity,
            );
            motions.integrate(&mut explicit.drive_displacement, a * k, &velocity.load);
        }
    }
}

/// `u_{n+1} = u_n + k sum_j b_j w_j` for everything that is integrated.
pub(crate) fn integrate(model: &Model, state: &mut State, velocities: &[Velocity], k: f64) {
    let tableau = model.tableau();
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
            let displacement = &mut state.drive_displacement;
            model
                .motions()
                .integrate(displacement, weight, &velocity.load);
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
            add_scaled(
                &mut state.main.normal_displacement,
                weight,
                &velocity.instant.normal_velocity,
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
    let (mut viscous, _) = model.body().products(&mean.instant.velocity);
    let (_, mut elastic) = model.body().products(&state.main.displacement);
    if let (Some(cells), Some(scratch)) = (model.body().nonlinear(), &mut ws.nonlinear) {
        let mean_rate = &mean.instant.velocity;
        elastic += 2.0 * cells.stored(&state.main.displacement);
        // the mean stress does the work, whatever law it comes from
        let known = &velocities[..=tableau.stages().len()];
        for (j, velocity) in known.iter().enumerate() {
            let weight = tableau.weight(j);
            if weight != 0.0 {
                scratch.force.fill(0.0);
                let rate = &velocity.instant.velocity;
                cells.add_forces(VISCOUS, rate, &mut scratch.force);
                viscous += weight * dot(&scratch.force, &mean_rate[..scratch.force.len()]);
            }
        }
    }
    viscous -= power_of_pins(model, &mean.instant, &mean.instant);
    let motions = model.motions();
    // both begin with the loads
    let loads = &mean.load[..motions.loads()];
    let mut external = dot(loads, &mean.instant.output_velocity);
    if !motions.is_empty() {
        let approach = Approach::rate(ws.approach[0], ws.approach[1], k);
        external += power_of_motions(motions, &mean.load, &mean.instant, approach);
        let own: [&[f64]; 2] = [&mean.load, &mean.instant.output_velocity];
        viscous += motions.viscous_product(own, own);
        let displacement = &state.drive_displacement;
        elastic += motions.elastic_product(displacement, displacement);
    }
    if let (Some(initial), Some(column)) = (model.initial(), motions.initial_column()) {
        elastic += 2.0 * (initial.energy - state.output_displacement[column]);
    }
    state.energy[energy::EXTERNAL_WORK] += k * external;
    let relaxed = penetration::dissipated(model, k, velocities, velocities);
    state.energy[energy::VISCOUS] += k * viscous + relaxed;
    state.energy[energy::FRICTION] += k * dot(&mean.instant.reaction, &mean.instant.slip_rate);
    state.energy[energy::ELASTIC] =
        0.5 * elastic + foundation::energy(model, state, ws.approach[1]);
    if !tableau.ends_with_stage() {
        state
            .mean_slip_rate
            .copy_from_slice(&mean.instant.slip_rate);
        state.mean_force.copy_from_slice(&mean.instant.force);
        state
            .mean_normal_force
            .copy_from_slice(&mean.instant.normal_force);
    }
}

/// Power of two velocities in the pins of the contact, which are no part of the body.
pub(crate) fn power_of_pins(model: &Model, x: &Instant, y: &Instant) -> f64 {
    let contact = model.contact();
    let pins = contact.pins.iter().map(|pin| {
        let node = pin.component / contact.stride();
        pin.resistance * x.normal_velocity[node] * y.normal_velocity[node]
    });
    pins.sum()
}

/// Power of what drives the driven parts and moves the foundations; `approach` are the velocities of the latter towards the body.
pub(crate) fn power_of_motions(
    motions: &Motions,
    inputs: &[f64],
    instant: &Instant,
    approach: Approach,
) -> f64 {
    let drives = instant.drive_force.iter().enumerate();
    let driven = drives.map(|(drive, force)| force * inputs[motions.drive_input(drive)]);
    let moves = instant.foundation_force.iter().zip(&motions.foundation);
    let (mut moved, mut approached) = (0.0, [0.0; MAX_CONTACTS]);
    for (at, (force, motion)) in moves.enumerate() {
        match motion.is_approach {
            // all those of a contact have the same force, and share the velocity
            true => approached[motion.contact] = force * approach.of(motion.contact),
            false => moved += force * inputs[motions.foundation_input(at)],
        }
    }
    driven.sum::<f64>() + moved + approached.iter().sum::<f64>()
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
