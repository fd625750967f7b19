//! Handles of simulators: stepping.

use super::guard::{
    self, Handle, free, give, guarded, handle, last_message, place, remember, values_mut,
};
use super::model::stickslip_model;
use super::{
    STICKSLIP_AT_ROUNDING, STICKSLIP_DIGITS_LOST, STICKSLIP_NOT_UNIQUE, STICKSLIP_OK,
    STICKSLIP_TRUNCATED,
};
use crate::error::{Error, Result};
use crate::message::number;
use crate::model::ensure_available;
use crate::simulator::Simulator;
use std::cell::UnsafeCell;
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU8, Ordering};

/// One simulation of a model; used by one thread at a time.
pub struct stickslip_simulator {
    tag: u64,
    /// `IDLE`, `BUSY` or `POISONED`; whoever makes it busy owns the simulator until the call ends.
    condition: AtomicU8,
    simulator: UnsafeCell<Simulator>,
    /// Why it is poisoned.
    cause: Mutex<String>,
}

const IDLE: u8 = 0;
const BUSY: u8 = 1;
const POISONED: u8 = 2;

impl Handle for stickslip_simulator {
    const WHAT: &'static str = "simulator";
    const TAG: u64 = u64::from_le_bytes(*b"slipsimu");
    fn tag(&self) -> u64 {
        self.tag
    }
}

impl stickslip_simulator {
    fn new(simulator: Simulator) -> stickslip_simulator {
        stickslip_simulator {
            tag: stickslip_simulator::TAG,
            condition: AtomicU8::new(IDLE),
            simulator: UnsafeCell::new(simulator),
            cause: Mutex::new(String::new()),
        }
    }

    fn refusal(&self, condition: u8) -> Error {
        if condition == POISONED {
            let cause = self.cause.lock().map(|c| c.clone()).unwrap_or_default();
            return Error::Poisoned { what: cause };
        }
        Error::CallOrder {
            call: "a second call with one simulator at the same time",
            expected: "one thread at a time",
        }
    }

    fn poison(&self) {
        if let Ok(mut cause) = self.cause.lock() {
            *cause = last_message();
        }
        self.condition.store(POISONED, Ordering::Release);
    }
}

/// Runs a call that owns the simulator for its time; a panic poisons it.
///
/// # Safety
/// `simulator` is NULL or live.
pub(super) unsafe fn with(
    simulator: *const stickslip_simulator,
    call: impl FnOnce(&mut Simulator) -> Result<i32>,
) -> i32 {
    // only what has been made busy is poisoned by a panic
    let mut owned: Option<&stickslip_simulator> = None;
    let owner = &mut owned;
    let guarded_call = || {
        // SAFETY: as promised by the caller
        let handle = unsafe { handle(simulator) }?;
        handle
            .condition
            .compare_exchange(IDLE, BUSY, Ordering::Acquire, Ordering::Relaxed)
            .map_err(|found| handle.refusal(found))?;
        *owner = Some(handle);
        // SAFETY: busy, so no other reference to the simulator exists until the call ends
        let result = call(unsafe { &mut *handle.simulator.get() });
        handle.condition.store(IDLE, Ordering::Release);
        result
    };
    let mut has_panicked = false;
    let code = guarded(guarded_call, || has_panicked = true);
    if has_panicked && let Some(handle) = owned {
        handle.poison();
    }
    code
}

/// Creates a simulator of `model` in `*simulator`, before its initialization; the caller frees it. It keeps what it needs
/// of the model alive. Errors: `NULL`, `BODY` when there is not enough memory. Any thread.
///
/// # Safety
/// `model` is NULL or live, `simulator` NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_new(
    model: *const stickslip_model,
    simulator: *mut *mut stickslip_simulator,
) -> i32 {
    let call = || {
        place(simulator, "simulator")?;
        // SAFETY: as promised by the caller
        let model = unsafe { handle(model) }?;
        ensure_available("a simulator", model.model.simulator_bytes())?;
        let new = stickslip_simulator::new(Simulator::new(Arc::clone(&model.model)));
        unsafe { give(simulator, new) };
        Ok(STICKSLIP_OK)
    };
    guarded(call, || {})
}

/// Creates in `*copy` an independent simulator of the same model in the same state; the caller frees it. Errors: `NULL`,
/// `POISONED`, `BODY` when there is not enough memory.
///
/// # Safety
/// `simulator` is NULL or live, `copy` NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_clone(
    simulator: *const stickslip_simulator,
    copy: *mut *mut stickslip_simulator,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        place(copy, "copy")?;
        ensure_available("a simulator", simulator.model().simulator_bytes())?;
        let new = stickslip_simulator::new(simulator.clone());
        unsafe { give(copy, new) };
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Frees a simulator, also a poisoned one; NULL is allowed. Not while another call uses it.
///
/// # Safety
/// `simulator` is NULL or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_free(simulator: *mut stickslip_simulator) {
    let call = || {
        // SAFETY: as promised by the caller
        unsafe { free(simulator, |s| s.tag = 0) };
        Ok(STICKSLIP_OK)
    };
    guarded(call, || {});
}

/// Starts the simulation at `time` (s) with the body undeformed. Inputs set before are the loads at that instant; without
/// them the start values of the scene are. Errors: `CALL_ORDER` when already initialized, `VALUE` for a time that is not
/// finite or friction coefficients that do not fit each other, `NOT_CONVERGED`, `OVERFLOW`.
///
/// # Safety
/// `simulator` is NULL or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_init(simulator: *mut stickslip_simulator, time: f64) -> i32 {
    let call = |simulator: &mut Simulator| simulator.init(time).map(|()| STICKSLIP_OK);
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Back to before `stickslip_init`, with inputs and coefficients of the scene; allocates.
///
/// # Safety
/// `simulator` is NULL or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_reset(simulator: *mut stickslip_simulator) -> i32 {
    let call = |simulator: &mut Simulator| {
        simulator.reset();
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Sets all inputs, `count` values in the order of the loads of the scene: the intensities at the end of the next step, or
/// at its beginning where `stickslip_set_inputs_meaning` says so (before `stickslip_init`: at the start), Pa for a traction, N/m^3 for a body force. They stay until set again. Allocates
/// nothing. Errors: `LENGTH`, `VALUE` for a number that is not finite, `NULL`.
///
/// # Safety
/// `simulator` is NULL or live, `values` NULL or `count` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_set_inputs(
    simulator: *mut stickslip_simulator,
    values: *const f64,
    count: usize,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        let expected = simulator.model().input_count();
        // SAFETY: as promised by the caller
        let values = unsafe { guard::values(values, count, expected, "inputs") }?;
        simulator.set_inputs(values)?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Sets one input or parameter by its reference, in the unit of its port. Coefficients of the friction law may be set in any
/// order: each is checked against its own range here, and the set of them (a >= b) by `stickslip_init` and
/// `stickslip_do_step`. Outputs are those of the last step until the next one. Errors: `UNKNOWN`, `CALL_ORDER` for an output,
/// `VALUE`, `LENGTH` for an array, which `stickslip_set_values` sets.
///
/// # Safety
/// `simulator` is NULL or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_set(
    simulator: *mut stickslip_simulator,
    reference: u32,
    value: f64,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        simulator.set(reference, value)?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Sets `count` inputs and parameters together: `values[i]` to the port `references[i]`, in its unit; of a port named twice
/// the last value holds. The friction coefficients that result are checked as a set when the call ends. All is set or, on an
/// error, nothing. Allocates nothing. Errors: `UNKNOWN`, `CALL_ORDER` for an output, `VALUE`, `NULL`, `LENGTH` for an array,
/// which `stickslip_set_values` sets.
///
/// # Safety
/// `simulator` is NULL or live, `references` and `values` are NULL or point to `count` values each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_set_many(
    simulator: *mut stickslip_simulator,
    references: *const u32,
    values: *const f64,
    count: usize,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        // SAFETY: as promised by the caller
        let references = unsafe { guard::values(references, count, count, "references") }?;
        let values = unsafe { guard::values(values, count, count, "values to set") }?;
        simulator.set_many(references, values)?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Sets inputs and parameters together, arrays included: `values` holds all values of the port `references[0]`, then those of
/// `references[1]` and so on, in the units of the ports; of a port named twice the last values hold. A coefficient of friction
/// that the scene gives per contact node (`{"nodes": [...]}`), and the points of a table, are arrays. The friction coefficients
/// that result are checked as a set when the call ends. All is set or, on an error, nothing. Allocates nothing. Errors:
/// `UNKNOWN`, `CALL_ORDER` for an output, `VALUE`, `NULL`, `LENGTH` unless there are as many values as the ports have.
///
/// # Safety
/// `simulator` is NULL or live, `references` and `values` are NULL or point to `reference_count` and `value_count` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_set_values(
    simulator: *mut stickslip_simulator,
    references: *const u32,
    reference_count: usize,
    values: *const f64,
    value_count: usize,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        let count = reference_count;
        // SAFETY: as promised by the caller
        let references = unsafe { guard::values(references, count, count, "references") }?;
        let count = value_count;
        // SAFETY: as promised by the caller
        let values = unsafe { guard::values(values, count, count, "values to set") }?;
        simulator.set_many(references, values)?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Steps from `time` to `time + step` (s). `time` is where the simulation stands, up to rounding; a step of any size is cut
/// into internal steps. Allocates nothing once the step size is known. Returns a note (> 0) on a step that was taken, the first
/// that applies: `TRUNCATED` when `fidelity.work_limit` ended a friction problem at its best iterate, `NOT_UNIQUE` when the
/// multiplicity test found other solutions, `DIGITS_LOST` when rounding took more of
/// displacement and slip than the tolerance of the body allows, `AT_ROUNDING` when rounding kept the friction law from holding
/// to its tolerance. Errors, with the state bit for bit as before: `CALL_ORDER` before `stickslip_init`, `STEP`, `VALUE` for
/// friction coefficients that do not fit each other, `NOT_CONVERGED`, `TOLERANCE_OUT_OF_REACH`, `OVERFLOW` for results that
/// are too large for a number.
///
/// # Safety
/// `simulator` is NULL or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_do_step(
    simulator: *mut stickslip_simulator,
    time: f64,
    step: f64,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        simulator.do_step(time, step)?;
        if let Some(residual) = simulator.truncated_residual() {
            remember(format_args!(
                "the step at time {} ended at fidelity.work_limit: the friction law holds to {residual:.1e} of the bound at a node, \
                 not to the tolerance",
                number(time)
            ));
            return Ok(STICKSLIP_TRUNCATED);
        }
        let (solutions, gap) = simulator.solutions();
        if solutions > 1.0 {
            remember(format_args!(
                "the step at time {} has {solutions} solutions, up to {gap:.3e} m/s apart",
                number(time)
            ));
            return Ok(STICKSLIP_NOT_UNIQUE);
        }
        if let Some(lost) = simulator.lost_digits() {
            remember(format_args!(
                "of displacement and slip the step at time {} lost about {lost:.1e} to rounding, more than fidelity.tolerance \
                 allows: it is far beyond the relaxation times and follows a jump of the loads; time.scheme \"backward_euler\" \
                 keeps the digits",
                number(time)
            ));
            return Ok(STICKSLIP_DIGITS_LOST);
        }
        if let Some(residual) = simulator.residual_at_rounding() {
            remember(format_args!(
                "the friction law of the step at time {time} holds to {residual:.1e} of the forces that meet at a node, as well \
                 as rounding allows, not to the tolerance"
            ));
            return Ok(STICKSLIP_AT_ROUNDING);
        }
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Writes all outputs, `count` values, one port after the other in the order of their references (`offset` of a port tells
/// where it begins). Allocates nothing. Errors: `LENGTH`, `NULL`.
///
/// # Safety
/// `simulator` is NULL or live, `values` NULL or `count` writable values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_get_outputs(
    simulator: *const stickslip_simulator,
    values: *mut f64,
    count: usize,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        // SAFETY: as promised by the caller
        let out = unsafe { values_mut(values, count, simulator.output_len(), "outputs") }?;
        simulator.get_outputs(out)?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Writes the `count` values of one port (any causality) by its reference. Allocates nothing. Errors: `UNKNOWN`, `LENGTH`,
/// `NULL`.
///
/// # Safety
/// `simulator` is NULL or live, `values` NULL or `count` writable values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_get(
    simulator: *const stickslip_simulator,
    reference: u32,
    values: *mut f64,
    count: usize,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        let expected = simulator.model().ports().get(reference)?.len();
        // SAFETY: as promised by the caller
        let out = unsafe { values_mut(values, count, expected, "values of the port") }?;
        simulator.get(reference, out)?;
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Writes where the simulation stands into `*time`, s. Errors: `NULL`.
///
/// # Safety
/// `simulator` is NULL or live, `time` NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_get_time(
    simulator: *const stickslip_simulator,
    time: *mut f64,
) -> i32 {
    let call = |simulator: &mut Simulator| {
        place(time, "time")?;
        // SAFETY: as promised by the caller
        unsafe { time.write(simulator.time()) };
        Ok(STICKSLIP_OK)
    };
    // SAFETY: as promised by the caller
    unsafe { with(simulator, call) }
}

/// Panics inside a call with this simulator, for the test that the host survives; not in a normal build, not in the header.
///
/// # Safety
/// `simulator` is NULL or live.
///
/// cbindgen:ignore
#[cfg(feature = "panic-injection")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_inject_panic(simulator: *mut stickslip_simulator) -> i32 {
    // SAFETY: as promised by the caller
    unsafe { with(simulator, |_| panic!("injected")) }
}
