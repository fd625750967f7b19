//! The course of the loads within a communication step of size `h` that begins at `t`.
//!
//! Between its ends a load `f` is linear. With `u` for the input as set, `f_n` for the load at the end of the last step:
//!
//! ```text
//! end_of_step   f(t) = f_n   f(t+h) = u             u is the load at the end of the step
//! hold          f(t) = u     f(t+h) = u             u is the load at its beginning
//! continue      f(t) = u     f(t+h) = u + s h       the same, continued with the slope s of the last steps
//! given slope   f(t) = u     f(t+h) = u + d h       whatever the meaning of u is otherwise
//! ```
//!
//! `s` is the slope of the input between the last two communication points, limited by the slope `s'` before it:
//! `s = sign(s) min(|s|, 2 |s'|)`, and 0 where they differ in sign. It is of first order where the input is smooth, so that
//! the load has an error of second order, and 0 after a jump, where the slope itself would overshoot by the height of the
//! jump. The first slope has none before it and is taken as it is.
//!
//! A driven part whose displacement is given moves with the velocity that takes it where the input has it at the end of the step:
//! its course is that constant velocity.
//!
//! Where `f(t)` is not `f_n` the load jumps at the beginning of the step, and the velocity follows before the step is taken.

use super::workspace::LoadCourse;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::motions::{Approach, Drive};
use crate::scene::{Inputs, Interpolation};
use crate::state::{State, input_memory as memory};

/// Relative difference of loads that is rounding of a continued slope and no jump.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// How many times the slope before it a continued slope may be.
const STEEPEST: f64 = 2.0;

/// Writes the course of the loads over a step of `h` into `course`; whether a load jumps at its beginning.
///
/// # Errors
/// [`Error::Value`] for a slope that leads out of the numbers.
pub(crate) fn begin(model: &Model, state: &State, h: f64, course: &mut LoadCourse) -> Result<bool> {
    let mut has_jump = false;
    course.size = h;
    for (i, kind) in model.interpolations().iter().enumerate() {
        let (applied, value) = (state.loads[i], state.inputs[i]);
        if let Some(drive) = displaced(model, i) {
            has_jump |= begin_displaced(model, state, h, course, (i, drive))?;
            continue;
        }
        let (start, slope, slope_by_input) = match (given_slope(state, i), kind, state.meaning()) {
            (Some(slope), ..) => (value, slope, 0.0),
            (None, Interpolation::Hold, _) | (None, _, Inputs::Hold) => (value, 0.0, 0.0),
            (None, Interpolation::Linear, Inputs::Continue) => {
                let (slope, by_input) = continued(state, i);
                (value, slope, by_input)
            }
            (None, Interpolation::Linear, Inputs::EndOfStep) => {
                set(course, i, [applied, value], [0.0, 1.0]);
                continue;
            }
        };
        let end = value + slope * h;
        check_end(model, i, end)?;
        has_jump |= (start - applied).abs() > ROUNDING * (start.abs() + applied.abs());
        set(course, i, [start, end], [1.0, 1.0 + slope_by_input * h]);
    }
    Ok(has_jump)
}

fn check_end(model: &Model, input: usize, end: f64) -> Result<()> {
    if end.is_finite() {
        return Ok(());
    }
    Err(Error::Value {
        what: format!(
            "input {} at the end of the step",
            model.ports().all()[input].name
        ),
        found: end,
        allowed: "a finite number; its slope leads out of the numbers",
    })
}

/// The drive whose displacement an input is.
fn displaced(model: &Model, input: usize) -> Option<usize> {
    let motions = model.motions();
    let drive = input.checked_sub(motions.loads())?;
    let is_displacement = |drive: &Drive| drive.is_displacement;
    motions
        .drives
        .get(drive)
        .is_some_and(is_displacement)
        .then_some(drive)
}

/// Whether an input is the displacement of a driven part.
pub(crate) fn is_displaced(model: &Model, input: usize) -> bool {
    displaced(model, input).is_some()
}

/// The constant velocity that leads to a given displacement.
fn begin_displaced(
    model: &Model,
    state: &State,
    h: f64,
    course: &mut LoadCourse,
    (i, drive): (usize, usize),
) -> Result<bool> {
    let (slope, slope_by_input) = match (given_slope(state, i), state.meaning()) {
        (Some(slope), _) => (slope, 0.0),
        (None, Inputs::Continue) => continued(state, i),
        (None, Inputs::Hold | Inputs::EndOfStep) => (0.0, 0.0),
    };
    let (end, from) = (state.inputs[i] + slope * h, state.drive_displacement[drive]);
    check_end(model, i, end)?;
    let velocity = (end - from) / h;
    check_end(model, i, velocity)?;
    let by_input = (1.0 + slope_by_input * h) / h;
    set(course, i, [velocity; 2], [by_input; 2]);
    let rounding =
        ROUNDING * (velocity.abs() + state.loads[i].abs() + (end.abs() + from.abs()) / h);
    Ok((velocity - state.loads[i]).abs() > rounding)
}

/// Inputs at the start of a simulation: displacements of driven parts begin where they are, at rest unless a slope is given.
pub(crate) fn start(model: &Model, state: &mut State) {
    for i in 0..state.inputs.len() {
        match displaced(model, i) {
            Some(drive) => {
                state.drive_displacement[drive] = state.inputs[i];
                state.loads[i] = given_slope(state, i).unwrap_or(0.0);
            }
            None => state.loads[i] = state.inputs[i],
        }
    }
    let approach = model.motions().approach(&state.loads);
    approach.copy_to(&mut state.main.instant.approach);
    let velocities = &mut state.main.instant.drive_velocity;
    model.motions().drive_velocities(&state.loads, velocities);
}

/// Velocities of the foundations towards the body at the start: those of the slopes given.
pub(crate) fn start_approach(model: &Model, state: &State) -> Approach {
    let motions = model.motions();
    motions
        .approach_by(|motion| given_slope(state, motions.foundation_input(motion)).unwrap_or(0.0))
}

/// The inputs as set jump now; whether any of them does. Displacements cannot.
pub(crate) fn jump(model: &Model, state: &mut State) -> bool {
    let mut has_jump = false;
    for i in 0..state.inputs.len() {
        if displaced(model, i).is_none() && state.loads[i] != state.inputs[i] {
            state.loads[i] = state.inputs[i];
            has_jump = true;
        }
    }
    has_jump
}

fn set(course: &mut LoadCourse, i: usize, [start, end]: [f64; 2], [start_by, end_by]: [f64; 2]) {
    course.start[i] = start;
    course.end[i] = end;
    course.start_by_input[i] = start_by;
    course.end_by_input[i] = end_by;
}

/// Remembers the inputs of a step of `h` that has been taken.
pub(crate) fn finish(state: &mut State, h: f64) {
    if state.meaning() != Inputs::Continue {
        return;
    }
    for i in 0..state.inputs.len() {
        let slope = last_slope(state, i);
        let at = memory::of_load(i);
        state.input_memory[at + memory::SLOPE] = slope;
        state.input_memory[at + memory::VALUE] = state.inputs[i];
    }
    state.input_memory[memory::STEP] = h;
    let points = &mut state.input_memory[memory::POINTS];
    *points = (*points + 1.0).min(2.0);
}

/// The slope that a host gave for a load.
pub(crate) fn given_slope(state: &State, load: usize) -> Option<f64> {
    let at = memory::of_load(load);
    let is_given = state.input_memory[at + memory::IS_GIVEN] != 0.0;
    is_given.then(|| state.input_memory[at + memory::GIVEN])
}

/// Gives a load its slope, or takes it away.
pub(crate) fn give_slope(state: &mut State, load: usize, slope: Option<f64>) {
    let at = memory::of_load(load);
    state.input_memory[at + memory::GIVEN] = slope.unwrap_or(0.0);
    state.input_memory[at + memory::IS_GIVEN] = f64::from(u8::from(slope.is_some()));
}

/// Slope of an input between the last communication point and this one; 0 at the first.
fn last_slope(state: &State, load: usize) -> f64 {
    let memory = &state.input_memory;
    if memory[memory::POINTS] == 0.0 {
        return 0.0;
    }
    let before = memory[memory::of_load(load) + memory::VALUE];
    (state.inputs[load] - before) / memory[memory::STEP]
}

/// The slope that a load is continued with, and its derivative by the input.
fn continued(state: &State, load: usize) -> (f64, f64) {
    let memory = &state.input_memory;
    let slope = last_slope(state, load);
    if memory[memory::POINTS] == 0.0 {
        return (0.0, 0.0);
    }
    let by_input = 1.0 / memory[memory::STEP];
    if memory[memory::POINTS] == 1.0 {
        return (slope, by_input);
    }
    let limit = STEEPEST * memory[memory::of_load(load) + memory::SLOPE];
    if slope * limit <= 0.0 {
        (0.0, 0.0)
    } else if slope.abs() <= limit.abs() {
        (slope, by_input)
    } else {
        (limit, 0.0)
    }
}
