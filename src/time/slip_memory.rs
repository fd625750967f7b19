//! The fading memory of slip in a stage, where the friction law has a kernel (`contact::law::SlipKernel`).
//!
//! It is moved by the mean of the slip rate before the stage and that of it, by that of the stage alone in backward Euler and midpoint stages,
//! and by the one before it in explicit stages. Contact problems take the slip of a law as `base + theta_k rate`. H grows by another
//! factor, so it is given in units in which that is right, and the law scales it back
//! ([`SlipStage::scale`]).
//!
//! Everything is linear in the numbers of the memory and in slip rates: tangents take the same functions.

use super::velocity::Velocity;
use crate::contact::law::SlipStage;
use crate::model::Model;

/// Share of the mean slip rate that the one of the stage has.
fn share(model: &Model) -> f64 {
    let tableau = model.tableau();
    if tableau.theta() == 0.0 {
        0.0
    } else if tableau.uses_start_velocity() {
        0.5
    } else {
        1.0
    }
}

/// A stage as the laws of the model see it.
pub(super) fn stage(model: &Model, length: f64, theta_k: f64) -> SlipStage {
    SlipStage {
        length,
        share: share(model),
        theta_k,
    }
}

/// Slip at the slip rate 0 at the end of a stage, divided by the scale, into `out`; of a law without a kernel it stays what it is.
pub(super) fn set_base(
    model: &Model,
    before: &Velocity,
    (length, theta_k): (f64, f64),
    out: &mut [f64],
) {
    let stage = stage(model, length, theta_k);
    let known = 1.0 - stage.share;
    for part in model.friction().with_kernels() {
        let kernel = part.law.kernel();
        let scale = stage.scale(kernel);
        let states =
            before.slip_memory[part.slip_memory.clone()].chunks_exact(kernel.terms().len());
        let rates = &before.magnitude[part.nodes.clone()];
        let out = out[part.nodes.clone()].iter_mut();
        for ((out, states), rate) in out.zip(states).zip(rates) {
            *out = kernel.base(states, length, known * rate) / scale;
        }
    }
}

/// The memory after a stage that moves it for `length`, s.
pub(super) fn advance(model: &Model, before: &Velocity, length: f64, velocity: &mut Velocity) {
    let share = share(model);
    let Velocity {
        slip_memory,
        magnitude,
        ..
    } = velocity;
    for part in model.friction().with_kernels() {
        let kernel = part.law.kernel();
        let (own, terms) = (part.slip_memory.clone(), kernel.terms().len());
        let states = before.slip_memory[own.clone()].chunks_exact(terms);
        let after = slip_memory[own].chunks_exact_mut(terms);
        for ((node, states), after) in part.nodes.clone().zip(states).zip(after) {
            let mean = (1.0 - share) * before.magnitude[node] + share * magnitude[node];
            kernel.advance(states, length, mean, after);
        }
    }
}
