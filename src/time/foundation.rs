//! What a foundation that gives way stores: `E = sum_i omega_i c d_i^(m+1) / (m + 1)`, d the penetration of node i; one that
//! relaxes stores in its branches too (`contact::relaxing`).

use crate::contact::relaxing::RelaxingFoundation;
use crate::model::Model;
use crate::model::motions::Approach;
use crate::scene::Condition;
use crate::state::State;
use std::ops::Range;

/// The energy, J; `approach` are the displacements of the foundations towards the body. 0 for one that is rigid.
pub(crate) fn energy(model: &Model, state: &State, approach: Approach) -> f64 {
    let elastic = sum(model, state, approach, |_, _, depth, exponent| {
        depth.powf(exponent + 1.0) / (exponent + 1.0)
    });
    elastic
        + of_relaxing(model, |foundation, numbers| {
            foundation.stored(&state.main.penetration[numbers])
        })
}

/// Its derivative along those of the normal displacements of the nodes and of the approach.
pub(crate) fn energy_slope(
    model: &Model,
    state: &State,
    approach: Approach,
    (moves, approaches): (&[f64], Approach),
) -> f64 {
    sum(model, state, approach, |contact, node, depth, exponent| {
        depth.powf(exponent) * (approaches.of(contact) - moves[node])
    })
}

/// The derivative of what foundations that relax store, along that of their numbers.
pub(crate) fn relaxing_slope(model: &Model, numbers: &[f64], along: &[f64]) -> f64 {
    of_relaxing(model, |foundation, own| {
        foundation.stored_slope(&numbers[own.clone()], &along[own])
    })
}

/// Sum over the nodes of foundations that relax.
fn of_relaxing(model: &Model, of: impl Fn(&RelaxingFoundation, Range<usize>) -> f64) -> f64 {
    let weights = &model.contact().weights;
    let mut sum = 0.0;
    for part in model.relaxing() {
        for (node, numbers) in part.nodes() {
            sum += weights[node] * of(&part.foundation, numbers);
        }
    }
    sum
}

/// Sum over the nodes of foundations without memory of weight times stiffness times a function of contact, node, penetration and exponent.
fn sum(
    model: &Model,
    state: &State,
    approach: Approach,
    of: impl Fn(usize, usize, f64, f64) -> f64,
) -> f64 {
    let contact = model.contact();
    let parts = contact.parts.iter().zip(model.conditions()).enumerate();
    let sums = parts.map(|(index, (part, condition))| {
        let Condition::Compliance {
            stiffness,
            exponent,
            memory: None,
            ..
        } = condition
        else {
            return 0.0;
        };
        let terms = part.nodes.clone().map(|node| {
            let moved = state.main.normal_displacement[node];
            let depth = (approach.of(index) - contact.gaps[node] - moved).max(0.0);
            contact.weights[node] * stiffness * of(index, node, depth, *exponent)
        });
        terms.sum::<f64>()
    });
    sums.fold(0.0, |sum, of| sum + of)
}
