//! FMI 3.0: the functions of Co-Simulation over the lifecycle, here an instance and its steps; values and saved states have
//! their own files, and the rest of the 75 stands in [`unsupported`].
//!
//! Values that are not finite, and a step whose friction does not converge, are discarded: the state is what it was, and
//! other values or a smaller step may succeed.
//!
//! # Safety
//! Every function takes the pointers the standard says: arrays of the stated lengths, strings that end with a zero byte.
//! NULL where the standard forbids it, and invalid instance or state pointers, are answered with an error.
#![allow(unsafe_code, clippy::missing_safety_doc, clippy::too_many_arguments)]

mod events;
mod states;
pub mod unsupported;
mod values;

use crate::fault::{Fault, Outcome};
use crate::guard::{self, DISCARD, call, native_path, text, write};
use crate::lifecycle::Experiment;
use crate::log::{Category, Log};
use std::ffi::{CString, c_char, c_int, c_void};

pub(crate) type Instance = *mut c_void;
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
        guard::set_logging(instance, logging_on != 0, count, categories)
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
    early_return_allowed: Boolean,
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
    let log = logger(log_message, environment, logging_on);
    let instance = guard::create(name, token, location, None, log);
    if event_mode_used != 0 && !instance.is_null() {
        run(instance, |instance| {
            instance.use_events(early_return_allowed != 0)
        });
    }
    instance
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: Instance) {
    guard::free(instance);
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: Instance,
    tolerance_defined: Boolean,
    tolerance: f64,
    start_time: f64,
    stop_time_defined: Boolean,
    stop_time: f64,
) -> c_int {
    let experiment = Experiment {
        start_time,
        stop_time: (stop_time_defined != 0).then_some(stop_time),
        tolerance: (tolerance_defined != 0).then_some(tolerance),
    };
    run(instance, |instance| {
        instance.enter_initialization(Some(experiment))
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
        let outcome = instance.do_step_to_event(time, step);
        write(last_time, instance.time(), "the last successful time")?;
        let end = outcome?;
        write(event_needed, end.has_event.into(), "a flag")?;
        write(early_return, end.is_early.into(), "a flag")
    })
}
