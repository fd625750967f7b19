//! The course of a scene's own run: its communication points, and its loads there.

use crate::error::Result;
use crate::scene::{Inputs, Scene};
use crate::simulator::Simulator;

/// The communication points of a scene: every `run.step` (default `time.step`) up to `run.until`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Points {
    /// Communication step, s.
    pub step: f64,
    /// End of the run, s.
    pub until: f64,
    /// Number of communication steps; the last one may be shorter.
    pub count: u64,
}

impl Points {
    pub fn of(scene: &Scene) -> Points {
        let step = scene.run.step.unwrap_or(scene.time.step);
        let until = scene.run.until;
        // a step that divides the interval must not leave a rounding error behind as a step of its own
        let count = (until / step * (1.0 - 1e-9)).ceil().max(1.0) as u64;
        Points { step, until, count }
    }

    /// Time of point `n`, s; the start is point 0 at time 0.
    pub fn at(&self, n: u64) -> f64 {
        if n >= self.count {
            self.until
        } else {
            n as f64 * self.step
        }
    }
}

/// Sets every input for the step between two communication points: to its load at the end, or at the beginning where that is
/// what inputs mean.
///
/// # Errors
/// Those of [`set_loads`].
pub fn set_loads_of_step(
    scene: &Scene,
    simulator: &mut Simulator,
    from: f64,
    to: f64,
) -> Result<()> {
    let time = match simulator.inputs_meaning() {
        Inputs::EndOfStep => to,
        Inputs::Hold | Inputs::Continue => from,
    };
    set_loads(scene, simulator, time)
}

/// Sets every input to its signal at `time`, or to its start value where the scene gives none.
///
/// # Errors
/// [`crate::Error::Value`] for a signal that is not finite; not for a validated scene.
pub fn set_loads(scene: &Scene, simulator: &mut Simulator, time: f64) -> Result<()> {
    let values: Vec<f64> = scene
        .loads
        .iter()
        .map(|load| match scene.run.signals.get(&load.name) {
            Some(signal) => signal.at(time),
            None => load.start,
        })
        .collect();
    simulator.set_inputs(&values)
}
