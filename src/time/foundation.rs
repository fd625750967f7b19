//! What a foundation that gives way stores: `E = sum_i omega_i c d_i^(m+1) / (m + 1)`, d the penetration of node i.

use crate::model::Model;
use crate::scene::Condition;
use crate::state::State;

/// The energy, J; `approach` is the displacement of the foundation towards the body, m. 0 for one that is rigid.
pub(crate) fn energy(model: &Model, state: &State, approach: f64) -> f64 {
    sum(model, state, approach, |_, depth, exponent| {
        depth.powf(exponent + 1.0) / (exponent + 1.0)
    })
}

/// Its derivative along those of the normal displacements of the nodes and of the approach.
pub(crate) fn energy_slope(
    model: &Model,
    state: &State,
    approach: f64,
    (moves, approaches): (&[f64], f64),
) -> f64 {
    sum(model, state, approach, |node, depth, exponent| {
        depth.powf(exponent) * (approaches - moves[node])
    })
}

/// Sum over the nodes of weight times stiffness times a function of node, penetration and exponent.
fn sum(model: &Model, state: &State, approach: f64, of: impl Fn(usize, f64, f64) -> f64) -> f64 {
    let Condition::Compliance {
        stiffness,
        exponent,
        ..
    } = model.condition()
    else {
        return 0.0;
    };
    let contact = model.contact();
    let nodes = contact.gaps.iter().zip(&state.main.normal_displacement);
    let nodes = nodes.zip(&contact.weights).enumerate();
    let terms = nodes.map(|(node, ((gap, moved), weight))| {
        let depth = (approach - gap - moved).max(0.0);
        weight * stiffness * of(node, depth, *exponent)
    });
    terms.sum()
}
