//! What the inputs of a simulator mean in time, and their slopes.

use super::STICKSLIP_OK;
use super::simulator::{stickslip_simulator, with};
use crate::error::Error;
use crate::scene::Inputs;
use crate::simulator::Simulator;

/// Inputs set before a step are the loads at its end; within it loads go linearly from where they are (or jump at its beginning,
/// with `interpolation` `hold`). The default. Exact where loads are linear over the step.
pub const STICKSLIP_INPUTS_END_OF_STEP: i32 = 0;
/// Inputs set before a step are the loads at its beginning, held over it: first order in the communication step, exact for loads
/// that jump at communication points. Every change costs one more solution of the friction problem.
pub const STICKSLIP_INPUTS_HOLD: i32 = 1;
/// Inputs set before a step are the loads at its beginning, continued with the slope of the last steps (at most twice the
/// slope before it, none where the two differ in sign): second order where loads are smooth, and a jump is held. Costs what
/// `STICKSLIP_INPUTS_HOLD` costs.
pub const STICKSLIP_INPUTS_CONTINUE: i32 = 2;

/// Says what inputs mean, by one of the numbers `STICKSLIP_INPUTS_...`; before `stickslip_init`, and again after
/// `stickslip_reset`. Without it: what `time.inputs` of the scene says, else the end of the step. Errors: `CALL_ORDER` after
/// initialization, `VALUE` for another number.
///
/// # Safety
/// `simulator` is NULL or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_set_inputs_meaning(
    simulator: *mut stickslip_simulator,
    meaning: i32,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        let meaning = match meaning {
            STICKSLIP_INPUTS_END_OF_STEP => Inputs::EndOfStep,
            STICKSLIP_INPUTS_HOLD => Inputs::Hold,
            STICKSLIP_INPUTS_CONTINUE => Inputs::Continue,
            other => {
                return Err(Error::Value {
                    what: "the meaning of inputs".into(),
                    found: f64::from(other),
                    allowed: "0 (end of step), 1 (hold) or 2 (continue)",
                });
            }
        };
        simulator.set_inputs_meaning(meaning)?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Gives an input, by its reference, its slope in time (its unit per second): in the steps that follow the load is the input at
/// their beginning plus slope times time, whatever inputs mean otherwise, until another slope is given or this one is cleared.
/// Allocates nothing. Errors: `UNKNOWN`, `CALL_ORDER` for a port that is no input, `VALUE` for a number that is not finite; the step
/// then returns `VALUE` where the slope leads out of the numbers.
///
/// # Safety
/// `simulator` is NULL or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_set_input_slope(
    simulator: *mut stickslip_simulator,
    reference: u32,
    slope: f64,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        simulator.set_input_slope(reference, Some(slope))?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Takes the slope of an input away again. Errors: `UNKNOWN`, `CALL_ORDER` for a port that is no input.
///
/// # Safety
/// `simulator` is NULL or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_clear_input_slope(
    simulator: *mut stickslip_simulator,
    reference: u32,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        simulator.set_input_slope(reference, None)?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}
