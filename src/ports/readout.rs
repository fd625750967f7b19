//! The values of a port in a state.

use crate::contact::problem::norm;
use crate::fem::ContactPatch;
use crate::model::Model;
use crate::ports::{Port, Quantity};
use crate::state::{State, energy, report};
use crate::time::{estimate, uniqueness};
use std::ops::Range;

/// Writes the values of `port` into `out`, which has its length.
pub(crate) fn read(model: &Model, state: &State, port: &Port, out: &mut [f64]) {
    let contact = model.contact();
    let c = contact.components;
    let is_stuck = |node: usize| {
        state.main.instant.slip_rate[node * c..(node + 1) * c]
            .iter()
            .all(|w| *w == 0.0)
    };
    let motions = model.motions();
    let loads = motions.force_count();
    let nodes = port.nodes(contact);
    let own = nodes.start * c..nodes.end * c;
    let weights = &contact.weights[nodes.clone()];
    let is_open =
        |node: usize| contact.can_open_at(node) && state.main.instant.normal_force[node] <= 0.0;
    let pressures = |forces: &[f64], out: &mut [f64]| {
        let forces = forces[nodes.clone()].iter().zip(weights);
        for (out, (force, weight)) in out.iter_mut().zip(forces) {
            *out = force / weight;
        }
    };
    let stresses = |forces: &[f64], out: &mut [f64]| {
        for (i, out) in own.clone().zip(out) {
            *out = contact.stress(i, forces[i]);
        }
    };
    let dimension = model.summary().dimension;
    let probe = |i: usize| loads + i * dimension..loads + (i + 1) * dimension;
    let value = match port.quantity {
        Quantity::TangentialStress => {
            return stresses(&state.main.instant.force, out);
        }
        Quantity::ContactForce => {
            for (p, out) in out.iter_mut().enumerate() {
                let forces = state.main.instant.force[own.clone()].iter();
                *out = 0.0 - forces.skip(p).step_by(c).sum::<f64>();
            }
            return;
        }
        Quantity::Stick => {
            for (node, out) in nodes.zip(out) {
                *out = f64::from(u8::from(is_stuck(node) && !is_open(node)));
            }
            return;
        }
        Quantity::Status => {
            for (node, out) in nodes.zip(out) {
                *out = match (is_open(node), is_stuck(node)) {
                    (true, _) => 0.0,
                    (false, true) => 1.0,
                    (false, false) => 2.0,
                };
            }
            return;
        }
        Quantity::Pressure => return pressures(&state.main.instant.normal_force, out),
        Quantity::MeanPressure => return pressures(&state.mean_normal_force, out),
        Quantity::FrictionState => {
            return out.copy_from_slice(&state.main.friction_state[nodes]);
        }
        Quantity::MeanSlipRate => return out.copy_from_slice(&state.mean_slip_rate[own]),
        Quantity::MeanTangentialStress => {
            return stresses(&state.mean_force, out);
        }
        Quantity::Gap => {
            for (node, out) in nodes.zip(out) {
                let approach = state.main.instant.approach[contact.part_of(node)];
                *out = contact.gaps[node] + state.main.normal_displacement[node] - approach;
            }
            return;
        }
        Quantity::Coefficient(i) => {
            let place = &model.friction().places()[i];
            return out.copy_from_slice(&state.coefficients[place.range()]);
        }
        Quantity::SlipRate => return out.copy_from_slice(&state.main.instant.slip_rate[own]),
        Quantity::Slip => return out.copy_from_slice(&state.slip[own]),
        Quantity::SlipMemory => {
            let part = &model.friction().parts()[contact.part_of(nodes.start)];
            let kernel = part.law.kernel();
            let states = &state.main.slip_memory[part.slip_memory.clone()];
            let states = states.chunks_exact(kernel.terms().len());
            for (out, states) in out.iter_mut().zip(states) {
                *out = kernel.value(states);
            }
            return;
        }
        Quantity::AccumulatedSlip => {
            return out.copy_from_slice(&state.main.accumulated_slip[nodes]);
        }
        Quantity::ProbeDisplacement(i) => {
            return out.copy_from_slice(&state.output_displacement[probe(i)]);
        }
        Quantity::ProbeVelocity(i) => {
            return out.copy_from_slice(&state.main.instant.output_velocity[probe(i)]);
        }
        Quantity::LoadDisplacement(i) => state.output_displacement[i] / model.load_measure(i),
        Quantity::LoadVelocity(i) => state.main.instant.output_velocity[i] / model.load_measure(i),
        Quantity::Input(i) => state.inputs[i],
        Quantity::Material(i) => state.material[i],
        Quantity::DriveDisplacement(i) => state.drive_displacement[i],
        Quantity::DriveVelocity(i) => state.main.instant.drive_velocity[i],
        Quantity::DriveForce(i) => state.main.instant.drive_force[i],
        Quantity::FoundationForce(i) => state.main.instant.foundation_force[i],
        Quantity::NormalForce => 0.0 + state.main.instant.normal_force[nodes].iter().sum::<f64>(),
        Quantity::MaxSlipRate => state.main.instant.slip_rate[own]
            .chunks_exact(c)
            .map(norm)
            .fold(0.0, f64::max),
        Quantity::StickFraction => share(contact, nodes, |node| is_stuck(node) && !is_open(node)),
        Quantity::OpenFraction => share(contact, nodes, is_open),
        Quantity::ExternalWork => state.energy[energy::EXTERNAL_WORK],
        Quantity::ElasticEnergy => state.energy[energy::ELASTIC],
        Quantity::ViscousDissipation => state.energy[energy::VISCOUS],
        Quantity::FrictionDissipation => state.energy[energy::FRICTION],
        Quantity::BalanceError => {
            let start = model.initial().map_or(0.0, |initial| initial.energy);
            state.energy[energy::EXTERNAL_WORK]
                - (state.energy[energy::ELASTIC] - start)
                - state.energy[energy::VISCOUS]
                - state.energy[energy::FRICTION]
        }
        Quantity::Iterations => state.report[report::ITERATIONS],
        Quantity::Residual => state.report[report::RESIDUAL],
        Quantity::Solutions => state.report[report::SOLUTIONS],
        Quantity::SolutionGap => state.report[report::SOLUTION_GAP],
        Quantity::Uniqueness => uniqueness::answer(state)[0],
        Quantity::UniquenessMargin => uniqueness::answer(state)[1],
        Quantity::LostDigits => state.report[report::LOST_DIGITS],
        Quantity::ErrorEstimate => estimate::estimate(model, state),
    };
    out[0] = value;
}

/// Share of the area of some nodes that those have which are counted.
fn share(contact: &ContactPatch, nodes: Range<usize>, is_counted: impl Fn(usize) -> bool) -> f64 {
    let weights = &contact.weights;
    let total: f64 = weights[nodes.clone()].iter().sum();
    let counted: f64 = nodes
        .filter(|&node| is_counted(node))
        .map(|node| weights[node])
        .sum();
    // the sum of nothing is -0
    (0.0 + counted) / total
}
