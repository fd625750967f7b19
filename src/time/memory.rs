//! The memory of a friction law in a stage, and its tangent.
//!
//! A state of the law (theta of rate-and-state friction) is moved over a stage by a constant slip rate: the mean of the one before
//! and that of the stage in trapezoidal and BDF2 stages, that of the stage in backward Euler ones. The midpoint rule moves it half
//! a step for the bound, and the whole step for good. A node that is open ages at rest.

use super::velocity::Velocity;
use crate::contact::SlipPath;
use crate::contact::law::{Memory, MemoryPath, PressedBoundsOf};
use crate::model::Model;
use crate::state::State;

/// Relative change of state and slip rate by which laws are differentiated along a direction.
const CHANGE: f64 = 1e-5;

/// How long a stage moves the state of a friction law.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    /// For the bound of the stage, s.
    pub length: f64,
    /// For good, s.
    pub step: f64,
}

impl Span {
    /// Of a stage of no length.
    pub const NOTHING: Span = Span {
        length: 0.0,
        step: 0.0,
    };
}

/// States and slip rates of all nodes before a stage; empty for a law without memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Before {
    states: Vec<f64>,
    rates: Vec<f64>,
}

impl Before {
    pub fn new(model: &Model) -> Before {
        let nodes = match model.friction().has_memory() {
            true => model.contact().node_count(),
            false => 0,
        };
        Before {
            states: vec![0.0; nodes],
            rates: vec![0.0; nodes],
        }
    }

    /// Takes them from the instant before.
    pub fn take(&mut self, velocity: &Velocity) {
        if !self.states.is_empty() {
            self.states.copy_from_slice(&velocity.friction_state);
            self.rates.copy_from_slice(&velocity.magnitude);
        }
    }

    /// The memory in a stage that moves it for `length`; `None` for a law without.
    pub fn memory(&self, model: &Model, length: f64) -> Option<Memory<'_>> {
        (!self.states.is_empty()).then(|| Memory {
            states: &self.states,
            rates: &self.rates,
            length,
            is_averaged: length > 0.0 && model.tableau().uses_start_velocity(),
        })
    }
}

/// The law of a stage with its memory, where it has one.
pub(crate) fn remembering<'a>(
    law: PressedBoundsOf<'a>,
    memory: Option<Memory<'a>>,
) -> PressedBoundsOf<'a> {
    match memory {
        Some(memory) => law.remembering(memory),
        None => law,
    }
}

/// States after a stage, from those before it and the slip rates of it.
pub(crate) fn advance(
    model: &Model,
    state: &State,
    before: &Before,
    span: Span,
    velocity: &mut Velocity,
) {
    let Some(memory) = before.memory(model, span.step) else {
        return;
    };
    let nodes = velocity.friction_state.iter_mut().zip(&velocity.magnitude);
    for (node, (moved, rate)) in nodes.enumerate() {
        let path = memory.path(node);
        *moved = model
            .friction()
            .advance(&state.coefficients, node, path, *rate);
    }
}

/// Derivative along a direction of what a function of the memory of a node and its slip rate says, by a central difference:
/// `[state before, slip rate before, slip rate]` and their derivatives.
fn along(
    memory: &Memory,
    node: usize,
    rate: f64,
    [ds, dr, d]: [f64; 3],
    of: impl Fn(MemoryPath, f64) -> f64,
) -> f64 {
    let rates = memory.rates[node].max(rate);
    let share = |d: f64, size: f64| if d == 0.0 { 0.0 } else { d.abs() / size };
    let fastest = share(ds, memory.states[node])
        .max(share(dr, rates))
        .max(share(d, rates));
    if fastest == 0.0 {
        return 0.0;
    }
    let change = CHANGE / fastest;
    let at = |by: f64| {
        let states = memory.states[node] + by * ds;
        let moved = Memory {
            states: std::slice::from_ref(&states),
            rates: &[memory.rates[node] + by * dr],
            ..*memory
        };
        of(moved.path(0), rate + by * d)
    };
    (at(change) - at(-change)) / (2.0 * change)
}

/// Derivatives of the bounds at fixed slip rate and force by what the memory of the stage began with, N.
pub(crate) fn bound_slopes(
    (law, memory): (PressedBoundsOf, &Memory),
    velocity: &Velocity,
    slip_base: &[f64],
    theta_k: f64,
    before: &Velocity,
    out: &mut [f64],
) {
    for (node, out) in out.iter_mut().enumerate() {
        let rate = velocity.magnitude[node];
        let force = velocity.instant.normal_force[node];
        let slip = SlipPath {
            base: slip_base[node],
            per_rate: theta_k,
        };
        let d = [before.friction_state[node], before.magnitude[node], 0.0];
        *out = along(memory, node, rate, d, |path, rate| {
            law.evaluate_with(path, node, rate, force, slip).bound
        });
    }
}

/// Derivatives of the states after a stage.
pub(crate) fn state_slopes(
    model: &Model,
    state: &State,
    memory: &Memory,
    rates: &[f64],
    before: &Velocity,
    tangent: &mut Velocity,
) {
    let nodes = tangent.friction_state.iter_mut().zip(&tangent.magnitude);
    for (node, (out, d)) in nodes.enumerate() {
        let d = [before.friction_state[node], before.magnitude[node], *d];
        *out = along(memory, node, rates[node], d, |path, rate| {
            model
                .friction()
                .advance(&state.coefficients, node, path, rate)
        });
    }
}
