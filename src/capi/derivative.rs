//! Derivatives of a step, and the recorded past.

use super::STICKSLIP_OK;
use super::guard::{place, values, values_mut};
use super::simulator::{stickslip_simulator, with};
use crate::error::Error;
use crate::simulator::Simulator;

/// Writes the derivative of all outputs at the end of the last step by its inputs, whatever
/// they mean (`stickslip_set_inputs_meaning`), along `seed`:
/// `derivative = (d outputs / d inputs) seed`, from the consistent tangent. `seed` has one value per input, `derivative` is
/// ordered as `stickslip_get_outputs`; units are those of the output per unit of the input. Where a node is just about to
/// change between stick and slip, the derivative is that of the branch the step ended on; counts and indicators have the
/// derivative 0. Costs about one step, allocates, changes no state. Errors: `CALL_ORDER` when the state is not the end of a
/// step (after init, reset, restore, deserialize), `LENGTH`, `VALUE`, `OVERFLOW`, `NULL`.
///
/// # Safety
/// `simulator` is NULL or live, `seed` NULL or `inputs` values, `derivative` NULL or `outputs` writable values; the two do not
/// overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_directional_derivative(
    simulator: *mut stickslip_simulator,
    seed: *const f64,
    inputs: usize,
    derivative: *mut f64,
    outputs: usize,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        let (expected, len) = (simulator.model().input_count(), simulator.output_len());
        // SAFETY: as promised by the caller
        let seed = unsafe { values(seed, inputs, expected, "seed of the inputs") }?;
        let out = unsafe { values_mut(derivative, outputs, len, "derivative of the outputs") }?;
        simulator.directional_derivative(seed, out)?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Writes the transposed derivative of the last step: `derivative = (d outputs / d inputs)^T seed`, `seed` one value per output
/// in the order of `stickslip_get_outputs`, `derivative` one per input: the gradient by the inputs of a sum of outputs weighed
/// by `seed`. Made from the tangents of all inputs in one repetition of the step. Errors and cost as
/// `stickslip_directional_derivative`.
///
/// # Safety
/// `simulator` is NULL or live, `seed` NULL or `outputs` values, `derivative` NULL or `inputs` writable values; the two do not
/// overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_adjoint_derivative(
    simulator: *mut stickslip_simulator,
    seed: *const f64,
    outputs: usize,
    derivative: *mut f64,
    inputs: usize,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        let (expected, len) = (simulator.model().input_count(), simulator.output_len());
        // SAFETY: as promised by the caller
        let seed = unsafe { values(seed, outputs, len, "seed of the outputs") }?;
        let out = unsafe { values_mut(derivative, inputs, expected, "derivative by the inputs") }?;
        simulator.adjoint_derivative(seed, out)?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Writes the recorded past of one contact node (0, 1, ...), oldest first, one row per internal step, and the number of rows
/// into `*rows`; the scene's `history.capacity` limits it. `time` (s) has one value per row; `slip_rate` (m/s), `slip` (m) and
/// `tangential_stress` (Pa, on the body) have one per row and component. An array that is NULL is left out; with `capacity` 0
/// only the number of rows is written. Errors: `UNKNOWN` for the node, `LENGTH` when `capacity` (in rows) is too small, `NULL`.
///
/// # Safety
/// `simulator` is NULL or live; `time` is NULL or `capacity` writable values, the other arrays are NULL or `capacity` times
/// the number of components; `rows` is NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_slip_history(
    simulator: *const stickslip_simulator,
    node: usize,
    time: *mut f64,
    slip_rate: *mut f64,
    slip: *mut f64,
    tangential_stress: *mut f64,
    capacity: usize,
    rows: *mut usize,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        place(rows, "rows")?;
        let needed = simulator.slip_history(node)?.count();
        if capacity != 0 && capacity < needed {
            return Err(Error::Length {
                what: "rows of the slip history",
                expected: needed,
                found: capacity,
            });
        }
        let c = simulator.model().contact().components;
        let written = if capacity == 0 { 0 } else { needed };
        // SAFETY: as promised by the caller; an array that is left out has no values
        let array = |pointer: *mut f64, what| unsafe {
            let len = if pointer.is_null() { 0 } else { written * c };
            values_mut(pointer, len, len, what)
        };
        let arrays = [
            array(slip_rate, "slip_rate")?,
            array(slip, "slip")?,
            array(tangential_stress, "tangential_stress")?,
        ];
        let len = if time.is_null() { 0 } else { written };
        // SAFETY: as promised by the caller
        let times = unsafe { values_mut(time, len, len, "time") }?;
        let [rates, slips, stresses] = arrays;
        for (row, past) in simulator.slip_history(node)?.take(written).enumerate() {
            if let Some(time) = times.get_mut(row) {
                *time = past.time;
            }
            let fields = [
                (&mut *rates, past.slip_rate),
                (&mut *slips, past.slip),
                (&mut *stresses, past.tangential_stress),
            ];
            for (out, values) in fields {
                if let Some(out) = out.get_mut(row * c..(row + 1) * c) {
                    out.copy_from_slice(values);
                }
            }
        }
        // SAFETY: as promised by the caller
        unsafe { rows.write(needed) };
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}
