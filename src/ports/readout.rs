//! The values of a port in a state.

use crate::contact::problem::norm;
use crate::model::Model;
use crate::ports::{Port, Quantity};
use crate::state::{State, energy, report};
use crate::time::estimate;

/// Writes the values of `port` into `out`, which has its length.
pub(crate) fn read(model: &Model, state: &State, port: &Port, out: &mut [f64]) {
    let contact = model.contact();
    let c = contact.components;
    let is_stuck = |node: usize| {
        state.main.instant.slip_rate[node * c..(node + 1) * c]
            .iter()
            .all(|w| *w == 0.0)
    };
    let loads = model.input_count();
    let dimension = model.summary().dimension;
    let probe = |i: usize| loads + i * dimension..loads + (i + 1) * dimension;
    let value = match port.quantity {
        Quantity::TangentialStress => {
            for (i, out) in out.iter_mut().enumerate() {
                *out = contact.stress(i, state.main.instant.force[i]);
            }
            return;
        }
        Quantity::ContactForce => {
            for (p, out) in out.iter_mut().enumerate() {
                *out = 0.0
                    - state
                        .main
                        .instant
                        .force
                        .iter()
                        .skip(p)
                        .step_by(c)
                        .sum::<f64>();
            }
            return;
        }
        Quantity::Stick => {
            for (node, out) in out.iter_mut().enumerate() {
                *out = f64::from(u8::from(is_stuck(node)));
            }
            return;
        }
        Quantity::Coefficient(i) => {
            let place = &model.friction().places()[i];
            return out.copy_from_slice(&state.coefficients[place.range()]);
        }
        Quantity::SlipRate => return out.copy_from_slice(&state.main.instant.slip_rate),
        Quantity::Slip => return out.copy_from_slice(&state.slip),
        Quantity::AccumulatedSlip => return out.copy_from_slice(&state.main.accumulated_slip),
        Quantity::ProbeDisplacement(i) => {
            return out.copy_from_slice(&state.output_displacement[probe(i)]);
        }
        Quantity::ProbeVelocity(i) => {
            return out.copy_from_slice(&state.main.instant.output_velocity[probe(i)]);
        }
        Quantity::LoadDisplacement(i) => state.output_displacement[i] / model.load_measure(i),
        Quantity::LoadVelocity(i) => state.main.instant.output_velocity[i] / model.load_measure(i),
        Quantity::Load(i) => state.inputs[i],
        Quantity::MaxSlipRate => state
            .main
            .instant
            .slip_rate
            .chunks_exact(c)
            .map(norm)
            .fold(0.0, f64::max),
        Quantity::StickFraction => {
            let total: f64 = contact.weights.iter().sum();
            let stuck: f64 = (0..contact.node_count())
                .filter(|&node| is_stuck(node))
                .map(|node| contact.weights[node])
                .sum();
            stuck / total
        }
        Quantity::ExternalWork => state.energy[energy::EXTERNAL_WORK],
        Quantity::ElasticEnergy => state.energy[energy::ELASTIC],
        Quantity::ViscousDissipation => state.energy[energy::VISCOUS],
        Quantity::FrictionDissipation => state.energy[energy::FRICTION],
        Quantity::BalanceError => {
            state.energy[energy::EXTERNAL_WORK]
                - state.energy[energy::ELASTIC]
                - state.energy[energy::VISCOUS]
                - state.energy[energy::FRICTION]
        }
        Quantity::Iterations => state.report[report::ITERATIONS],
        Quantity::Residual => state.report[report::RESIDUAL],
        Quantity::Solutions => state.report[report::SOLUTIONS],
        Quantity::SolutionGap => state.report[report::SOLUTION_GAP],
        Quantity::LostDigits => state.report[report::LOST_DIGITS],
        Quantity::ErrorEstimate => estimate::estimate(model, state),
    };
    out[0] = value;
}
