//! Saved states: in memory for rollback, as bytes for checkpoints.

use super::STICKSLIP_OK;
use super::guard::{Handle, free, give, guarded, handle, handle_mut, place, room, values};
use super::simulator::{stickslip_simulator, with};
use crate::error::{Error, Result};
use crate::model::ensure_available;
use crate::simulator::Simulator;
use crate::state::State;

/// Room for one saved state of a model.
pub struct stickslip_state {
    tag: u64,
    state: State,
    /// Whether something has been saved into it.
    is_saved: bool,
}

impl Handle for stickslip_state {
    const WHAT: &'static str = "state";
    const TAG: u64 = u64::from_le_bytes(*b"slipstat");
    fn tag(&self) -> u64 {
        self.tag
    }
}

/// Creates in `*state` room for a saved state of this simulator and of all others of its model; the caller frees it. It
/// outlives simulator and model. Errors: `NULL`, `POISONED`, `BODY` when there is not enough memory.
///
/// # Safety
/// `simulator` is NULL or live, `state` NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_state_new(
    simulator: *const stickslip_simulator,
    state: *mut *mut stickslip_state,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        place(state, "state")?;
        ensure_available("a state", simulator.model().state_bytes())?;
        let new = stickslip_state {
            tag: stickslip_state::TAG,
            state: simulator.new_state(),
            is_saved: false,
        };
        // SAFETY: as promised by the caller
        unsafe { give(state, new) };
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Frees a saved state; NULL is allowed.
///
/// # Safety
/// `state` is NULL or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_state_free(state: *mut stickslip_state) {
    let call = || {
        // SAFETY: as promised by the caller
        unsafe { free(state, |s| s.tag = 0) };
        Ok(STICKSLIP_OK)
    };
    guarded(call, || {});
}

/// Saves all that future steps depend on (inputs, coefficients, history and warm start included) into `state`, over what
/// it held. Allocates nothing: cheap enough for every step. Errors: `FINGERPRINT` for the state of another model, `NULL`.
///
/// # Safety
/// `simulator` and `state` are NULL or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_save_state(
    simulator: *const stickslip_simulator,
    state: *mut stickslip_state,
) -> i32 {
    let call = |simulator: &mut Simulator| -> Result<i32> {
        // SAFETY: as promised by the caller
        let state = unsafe { handle_mut(state) }?;
        simulator.save(&mut state.state)?;
        state.is_saved = true;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Continues from a saved state, any number of times and in any order; the runs that follow are bit for bit those that
/// followed the save. Allocates nothing. There is no step to take derivatives of until the next one. Errors: `CALL_ORDER` when
/// nothing has been saved into `state`, `FINGERPRINT`, `NULL`.
///
/// # Safety
/// `simulator` and `state` are NULL or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_restore_state(
    simulator: *mut stickslip_simulator,
    state: *const stickslip_state,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        // SAFETY: as promised by the caller
        let state = unsafe { handle(state) }?;
        if !state.is_saved {
            return Err(Error::CallOrder {
                call: "stickslip_restore_state",
                expected: "stickslip_save_state into this state first",
            });
        }
        simulator.restore(&state.state)?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Writes the state as bytes (little-endian, versioned, checksummed, with the fingerprint of the model) and their number
/// into `*length`. With `bytes` NULL and `capacity` 0 only the number, which is the same for all states of a model. Allocates
/// nothing. Errors: `LENGTH` when `capacity` is too small, `NULL`.
///
/// # Safety
/// `simulator` is NULL or live, `bytes` NULL or `capacity` writable bytes, `length` NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_serialize(
    simulator: *const stickslip_simulator,
    bytes: *mut u8,
    capacity: usize,
    length: *mut usize,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        place(length, "length")?;
        let state = simulator.state();
        let needed = state.byte_len();
        // SAFETY: as promised by the caller
        if let Some(out) = unsafe { room(bytes, capacity, needed, "bytes of the state") }? {
            state.write_bytes(out);
        }
        unsafe { length.write(needed) };
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Continues from the bytes of `stickslip_serialize`, in this process or another, on this machine or another that holds the
/// same compiled model. Errors, with the state as before: `BYTES` (of another kind or version, truncated, damaged, or a state
/// that no simulation leaves behind: numbers that are not finite, counters out of range), `FINGERPRINT`, `NULL`.
///
/// # Safety
/// `simulator` is NULL or live, `bytes` NULL or `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_deserialize(
    simulator: *mut stickslip_simulator,
    bytes: *const u8,
    length: usize,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        // SAFETY: as promised by the caller
        let bytes = unsafe { values(bytes, length, length, "bytes of the state") }?;
        simulator.restore_bytes(bytes)?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}
