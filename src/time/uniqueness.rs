//! Whether a stage that was solved has one solution, where a scene asks (`fidelity.uniqueness`).
//!
//! With the constants of [`crate::model::certificate`] at the size of the stage and the forces that were found, one solution is
//! proved where the load `max(P L_mu + L) / m + mu_max c` is below 1. At other sizes than the largest, only m is known: it grows
//! with the step, and is at least that of the viscosity alone.

use crate::contact::pressed::PressedBounds;
use crate::model::Model;
use crate::state::{Instant, State, report};

/// Two stages are of one size when they differ by no more than this share.
const SAME: f64 = 1e-9;
/// The load where nothing is proved: its margin is -1.
const UNPROVED: f64 = 2.0;

/// m and c of a stage.
fn constants(model: &Model, theta_k: f64) -> [f64; 2] {
    let certificate = model.certificate();
    let largest = model.tableau().theta() * model.largest_step();
    match (theta_k - largest).abs() <= SAME * largest {
        true => [
            certificate.sharp_step,
            certificate.coulomb.map_or(0.0, |c| c.coupling),
        ],
        // nothing is proved at any size where it is not at the largest
        false => [
            certificate.sharp_instant.min(certificate.sharp_step),
            f64::INFINITY,
        ],
    }
}

/// The load from the largest rate at which a bound falls, Pa s/m, and the largest coefficient of friction.
fn load(model: &Model, theta_k: f64, falls: f64, coefficient: f64) -> f64 {
    let [m, c] = constants(model, theta_k);
    let share = |value: f64, of: f64| if value == 0.0 { 0.0 } else { value * of };
    let load = share(falls, 1.0 / m) + share(coefficient, c);
    // the fall of a formula is sampled, which proves nothing; nor does what is not a number
    if model.friction().has_formula() || !(0.0..UNPROVED).contains(&load) {
        return UNPROVED;
    }
    load
}

/// The load of a stage with pressure.
pub(super) fn load_with_pressure(
    model: &Model,
    coefficients: &[f64],
    theta_k: f64,
    bounds: &dyn PressedBounds,
    found: &Instant,
) -> f64 {
    let weights = model.contact().weights.iter().zip(&found.normal_force);
    let falls = weights.enumerate().map(|(node, (weight, force))| {
        let falls = bounds.weakening(node, *force);
        falls / weight
    });
    let falls = falls.fold(0.0, f64::max);
    let all = model.friction().with(coefficients);
    let parts = model.friction().parts().iter();
    let pressed = parts.filter(|part| part.law.is_coulomb());
    let nodes = pressed.flat_map(|part| part.nodes.clone());
    let coefficient = nodes.map(|node| all.extremes(node)[0]).fold(0.0, f64::max);
    load(model, theta_k, falls, coefficient)
}

/// The load of a stage without.
pub(super) fn load_without_pressure(model: &Model, coefficients: &[f64], theta_k: f64) -> f64 {
    let falls = model.friction().parts().iter().map(|part| {
        let per_rate = part.law.kernel().largest_per_rate(theta_k);
        let own = &coefficients[part.numbers.clone()];
        part.law.with(own).weakening(per_rate)
    });
    load(model, theta_k, falls.fold(0.0, f64::max), 0.0)
}

/// Takes note of the load of a stage; whether other solutions are to be looked for.
pub(super) fn note(model: &Model, entry: &mut [f64], load: f64) -> bool {
    entry[report::UNIQUENESS_LOAD] = entry[report::UNIQUENESS_LOAD].max(load);
    let is_proved = load < 1.0;
    if is_proved {
        entry[report::SOLUTIONS] = entry[report::SOLUTIONS].max(1.0);
    }
    model.has_multiplicity_test() || !is_proved
}

/// 1: every stage of the last step has one solution, -1: one has more, 0: not decided; and by what the load stays below 1.
pub(crate) fn answer(state: &State) -> [f64; 2] {
    let solutions = state.report[report::SOLUTIONS];
    let margin = 1.0 - state.report[report::UNIQUENESS_LOAD];
    match solutions {
        0.0 => [0.0, 1.0 - UNPROVED],
        _ if solutions > 1.0 => [-1.0, margin],
        _ => [f64::from(u8::from(margin > 0.0)), margin],
    }
}
