//! The fading memory of slip in a stage, where the friction law has a kernel (`contact::law::SlipKernel`).
//!
//! It is moved by the mean of the slip rate before the stage and that of it, by that of the stage alone in backward Euler and midpoint stages,
//! and by the one before it in explicit stages. Contact problems take the slip of a law as `base + theta_k rate`. H grows by another
//! factor, so it is given in units in which that is right, and the law scales it back.
//!
//! Everything is linear in the numbers of the memory and in slip rates: tangents take the same functions.

use super::velocity::Velocity;
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

/// What the slip of a contact problem is to be multiplied by in the law; 1 for a law without a kernel.
pub(super) fn scale(model: &Model, length: f64, theta_k: f64) -> f64 {
    let kernel = model.friction().kernel();
    if kernel.is_empty() || theta_k == 0.0 {
        return 1.0;
    }
    kernel.per_rate(length, share(model)) / theta_k
}

/// Slip at the slip rate 0 at the end of a stage, divided by the scale, into `out`; of a law without a kernel it stays what it is.
pub(super) fn set_base(
    model: &Model,
    before: &Velocity,
    (length, theta_k): (f64, f64),
    out: &mut [f64],
) {
    let kernel = model.friction().kernel();
    if kernel.is_empty() {
        return;
    }
    let scale = scale(model, length, theta_k);
    let known = 1.0 - share(model);
    let states = before.slip_memory.chunks_exact(kernel.terms().len());
    for ((out, states), rate) in out.iter_mut().zip(states).zip(&before.magnitude) {
        *out = kernel.base(states, length, known * rate) / scale;
    }
}

/// The memory after a stage that moves it for `length`, s.
pub(super) fn advance(model: &Model, before: &Velocity, length: f64, velocity: &mut Velocity) {
    let kernel = model.friction().kernel();
    if kernel.is_empty() {
        return;
    }
    let (share, terms) = (share(model), kernel.terms().len());
    let Velocity {
        slip_memory,
        magnitude,
        ..
    } = velocity;
    for (node, after) in slip_memory.chunks_exact_mut(terms).enumerate() {
        let states = &before.slip_memory[node * terms..(node + 1) * terms];
        let mean = (1.0 - share) * before.magnitude[node] + share * magnitude[node];
        kernel.advance(states, length, mean, after);
    }
}
