//! FMI 3.0: the functions of Co-Simulation over the lifecycle; the rest of the 75 stands in [`unsupported`].
//!
//! Values that are not finite, and a step whose friction does not converge, are discarded: the state is what it was, and
//! other values or a smaller step may succeed.
//!
//! # Safety
//! Every function takes the pointers the standard says: arrays of the stated lengths, strings that end with a zero byte.
//! NULL where the standard forbids it, and instances or states that are none, are answered with an error.
#![allow(unsafe_code, clippy::missing_safety_doc, clippy::too_many_arguments)]

pub mod unsupported;

use crate::fault::{Fault, Outcome};
use crate::guard::{self, DISCARD, call, native_path, slice, slice_mut, text, write};
use crate::lifecycle::Call;
use crate::log::{Category, Log};
use std::ffi::{CStr, CString, c_char, c_int, c_void};

pub(crate) type Instance = *mut c_void;
type FmuState = *mut c_void;
/// A callback of the importer for what this FMU does not do; never called.
pub(crate) type Callback = Option<unsafe extern "C" fn()>;
/// `fmi3Boolean` (C `bool`), taken as a byte: an importer may pass any.
pub(crate) type Boolean = u8;
pub(crate) type LogMessage =
    Option<unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char)>;

/// What the logger needs; the importer keeps it valid, and usable from the thread of the call, while the instance lives.
struct Target {
    log_message: LogMessage,
    environment: *mut c_void,
}

// SAFETY: FMI has the importer accept log messages on the thread that calls the instance.
unsafe impl Send for Target {}

impl Target {
    fn send(&self, status: i32, category: Category, message: &str) {
        let (Some(log_message), Ok(message)) =
            (self.log_message, CString::new(message.replace('\0', " ")))
        else {
            return;
        };
        // SAFETY: the callback is the importer's, of the type of the standard.
        unsafe {
            log_message(
                self.environment,
                status,
                category.name().as_ptr(),
                message.as_ptr(),
            )
        };
    }
}

pub(crate) fn logger(
    log_message: LogMessage,
    environment: *mut c_void,
    logging_on: Boolean,
) -> Log {
    let target = Target {
        log_message,
        environment,
    };
    let sink =
        Box::new(move |status, category, message: &str| target.send(status, category, message));
    Log::new(sink, logging_on != 0)
}

pub(crate) fn run(
    instance: Instance,
    f: impl FnOnce(&mut crate::lifecycle::Instance) -> Outcome,
) -> c_int {
    call(instance, DISCARD, f)
}

fn handle(state: FmuState) -> u64 {
    state as usize as u64
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: Instance,
    logging_on: Boolean,
    count: usize,
    categories: *const *const c_char,
) -> c_int {
    run(instance, |instance| {
        instance.permit(Call::SetDebugLogging)?;
        let names = slice(categories, count)?
            .iter()
            .map(|c| text(*c, "a log category"));
        instance
            .log
            .switch(logging_on != 0, &names.collect::<Outcome<Vec<&CStr>>>()?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: Boolean,
    logging_on: Boolean,
    event_mode_used: Boolean,
    _early_return_allowed: Boolean,
    _intermediate_variables: *const u32,
    _intermediate_count: usize,
    environment: *mut c_void,
    log_message: LogMessage,
    _intermediate_update: Callback,
) -> Instance {
    let location = || match resources.is_null() {
        true => guard::resources_beside_library(),
        false => native_path(text(resources, "the path of the resources")?.to_bytes()),
    };
    let refusal = (event_mode_used != 0).then_some("this FMU has no event mode");
    let log = logger(log_message, environment, logging_on);
    guard::create(name, token, location, refusal, log)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: Instance) {
    guard::free(instance);
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: Instance,
    _tolerance_defined: Boolean,
    _tolerance: f64,
    start_time: f64,
    _stop_time_defined: Boolean,
    _stop_time: f64,
) -> c_int {
    run(instance, |instance| {
        instance.enter_initialization(Some(start_time))
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(instance: Instance) -> c_int {
    run(instance, |instance| instance.exit_initialization())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Terminate(instance: Instance) -> c_int {
    run(instance, |instance| instance.terminate())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(instance: Instance) -> c_int {
    run(instance, |instance| instance.reset())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    instance: Instance,
    references: *const u32,
    count: usize,
    values: *mut f64,
    value_count: usize,
) -> c_int {
    run(instance, |instance| {
        instance.get(slice(references, count)?, slice_mut(values, value_count)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    instance: Instance,
    references: *const u32,
    count: usize,
    values: *const f64,
    value_count: usize,
) -> c_int {
    run(instance, |instance| {
        instance.set(slice(references, count)?, slice(values, value_count)?)
    })
}

/// Enumerations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt64(
    instance: Instance,
    references: *const u32,
    count: usize,
    values: *mut i64,
    value_count: usize,
) -> c_int {
    run(instance, |instance| {
        instance.get(slice(references, count)?, slice_mut(values, value_count)?)
    })
}

/// Enumerations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetInt64(
    instance: Instance,
    references: *const u32,
    count: usize,
    values: *const i64,
    value_count: usize,
) -> c_int {
    run(instance, |instance| {
        instance.set(slice(references, count)?, slice(values, value_count)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(instance: Instance, state: *mut FmuState) -> c_int {
    run(instance, |instance| {
        let old = guard::read(state, "the pointer to the state")?;
        let new = instance.save((!old.is_null()).then(|| handle(old)))?;
        write(
            state,
            std::ptr::without_provenance_mut(new as usize),
            "the pointer to the state",
        )
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(instance: Instance, state: FmuState) -> c_int {
    run(instance, |instance| instance.restore(handle(state)))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(instance: Instance, state: *mut FmuState) -> c_int {
    run(instance, |instance| {
        if state.is_null() {
            return Ok(());
        }
        let old = guard::read(state, "the pointer to the state")?;
        if old.is_null() {
            return Ok(());
        }
        instance.free_saved(handle(old))?;
        write(state, std::ptr::null_mut(), "the pointer to the state")
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: Instance,
    state: FmuState,
    size: *mut usize,
) -> c_int {
    run(instance, |instance| {
        write(size, instance.serialized_len(handle(state))?, "the size")
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    instance: Instance,
    state: FmuState,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    run(instance, |instance| {
        instance.serialize(handle(state), slice_mut(bytes, size)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: Instance,
    bytes: *const u8,
    size: usize,
    state: *mut FmuState,
) -> c_int {
    run(instance, |instance| {
        guard::read(state, "the pointer to the state")?;
        let new = instance.deserialize(slice(bytes, size)?)?;
        write(
            state,
            std::ptr::without_provenance_mut(new as usize),
            "the pointer to the state",
        )
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetDirectionalDerivative(
    instance: Instance,
    unknowns: *const u32,
    unknown_count: usize,
    knowns: *const u32,
    known_count: usize,
    seed: *const f64,
    seed_count: usize,
    sensitivity: *mut f64,
    sensitivity_count: usize,
) -> c_int {
    run(instance, |instance| {
        let (unknowns, knowns) = (slice(unknowns, unknown_count)?, slice(knowns, known_count)?);
        let (seed, out) = (
            slice(seed, seed_count)?,
            slice_mut(sensitivity, sensitivity_count)?,
        );
        instance.directional(unknowns, knowns, seed, out)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetAdjointDerivative(
    instance: Instance,
    unknowns: *const u32,
    unknown_count: usize,
    knowns: *const u32,
    known_count: usize,
    seed: *const f64,
    seed_count: usize,
    sensitivity: *mut f64,
    sensitivity_count: usize,
) -> c_int {
    run(instance, |instance| {
        let (unknowns, knowns) = (slice(unknowns, unknown_count)?, slice(knowns, known_count)?);
        let (seed, out) = (
            slice(seed, seed_count)?,
            slice_mut(sensitivity, sensitivity_count)?,
        );
        instance.adjoint(unknowns, knowns, seed, out)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetOutputDerivatives(
    instance: Instance,
    references: *const u32,
    count: usize,
    orders: *const i32,
    values: *mut f64,
    value_count: usize,
) -> c_int {
    run(instance, |instance| {
        let (references, orders) = (slice(references, count)?, slice(orders, count)?);
        instance.get_slopes(references, orders, slice_mut(values, value_count)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: Instance,
    time: f64,
    step: f64,
    _no_set_state_before: Boolean,
    event_needed: *mut Boolean,
    terminate: *mut Boolean,
    early_return: *mut Boolean,
    last_time: *mut f64,
) -> c_int {
    run(instance, |instance| {
        let flags = [event_needed, terminate, early_return];
        if flags.iter().any(|flag| flag.is_null()) || last_time.is_null() {
            return Err(Fault::error("fmi3DoStep: a pointer to a result is NULL"));
        }
        for flag in flags {
            write(flag, 0, "a flag")?;
        }
        let outcome = instance.do_step(time, step);
        write(last_time, instance.time(), "the last successful time")?;
        outcome
    })
}
