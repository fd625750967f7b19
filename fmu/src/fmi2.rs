//! FMI 2.0 Co-Simulation: the 34 functions of the standard, each a few lines over the lifecycle. Here an instance and its
//! steps; values, saved states and status calls have their own files.
//!
//! FMI 2 lets a slave discard a step only together with status calls that few importers make (some then repeat the step
//! for ever), so that a step that does not converge is an error here; the state is what it was before the step.
//!
//! # Safety
//! Every function takes the pointers the standard says: arrays of the stated lengths, strings that end with a zero byte.
//! NULL where the standard forbids it, and invalid instance or state pointers, are answered with an error.
#![allow(unsafe_code, clippy::missing_safety_doc)]

mod states;
mod status;
mod values;

use crate::fault::{Fault, Outcome};
use crate::guard::{self, ERROR, call, text, uri_path};
use crate::lifecycle::Experiment;
use crate::log::{Category, Log};
use std::ffi::{CStr, CString, c_char, c_int, c_void};

type Component = *mut c_void;
type Logger = Option<
    unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...),
>;

/// `fmi2CallbackFunctions`.
#[repr(C)]
pub struct Callbacks {
    logger: Logger,
    allocate_memory: *const c_void,
    free_memory: *const c_void,
    step_finished: *const c_void,
    environment: *mut c_void,
}

/// What the logger needs; the importer keeps it valid, and usable from the thread of the call, while the instance lives.
struct Target {
    logger: Logger,
    environment: *mut c_void,
    name: CString,
}

// SAFETY: FMI has the importer accept log messages on the thread that calls the instance.
unsafe impl Send for Target {}

impl Target {
    fn send(&self, status: i32, category: Category, message: &str) {
        let (Some(logger), Ok(message)) = (self.logger, CString::new(message.replace('\0', " ")))
        else {
            return;
        };
        let (name, category) = (self.name.as_ptr(), category.name().as_ptr());
        // SAFETY: the logger is the importer's, of the type of the standard; the message is data for its "%s".
        unsafe {
            logger(
                self.environment,
                name,
                status,
                category,
                c"%s".as_ptr(),
                message.as_ptr(),
            )
        };
    }
}

fn run(component: Component, f: impl FnOnce(&mut crate::lifecycle::Instance) -> Outcome) -> i32 {
    call(component, ERROR, f)
}

fn unsupported(component: Component, name: &str) -> i32 {
    run(component, |_| {
        Err(Fault::error(format!(
            "{name} is not supported, as the model description says"
        )))
    })
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    component: Component,
    logging_on: c_int,
    count: usize,
    categories: *const *const c_char,
) -> c_int {
    run(component, |instance| {
        guard::set_logging(instance, logging_on != 0, count, categories)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    guid: *const c_char,
    resources: *const c_char,
    callbacks: *const Callbacks,
    _visible: c_int,
    logging_on: c_int,
) -> Component {
    // SAFETY: FMI has the importer pass NULL or a pointer to its callbacks.
    let callbacks = unsafe { callbacks.as_ref() };
    let target = Target {
        logger: callbacks.and_then(|c| c.logger),
        environment: callbacks.map_or(std::ptr::null_mut(), |c| c.environment),
        name: text(name, "the instance name")
            .map(CStr::to_owned)
            .unwrap_or_default(),
    };
    let sink =
        Box::new(move |status, category, message: &str| target.send(status, category, message));
    let refusal = match (kind, callbacks) {
        (1, Some(_)) => None,
        (1, None) => Some("the callbacks are NULL"),
        _ => Some("this FMU is for Co-Simulation"),
    };
    let location = || match resources.is_null() {
        true => guard::resources_beside_library(),
        false => uri_path(text(resources, "the resource location")?.to_bytes()),
    };
    guard::create(
        name,
        guid,
        location,
        refusal,
        Log::new(sink, logging_on != 0),
    )
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(component: Component) {
    guard::free(component);
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    component: Component,
    tolerance_defined: c_int,
    tolerance: f64,
    start_time: f64,
    stop_time_defined: c_int,
    stop_time: f64,
) -> c_int {
    let experiment = Experiment {
        start_time,
        stop_time: (stop_time_defined != 0).then_some(stop_time),
        tolerance: (tolerance_defined != 0).then_some(tolerance),
    };
    run(component, |instance| instance.setup(experiment))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(component: Component) -> c_int {
    run(component, |instance| instance.enter_initialization(None))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(component: Component) -> c_int {
    run(component, |instance| instance.exit_initialization())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(component: Component) -> c_int {
    run(component, |instance| instance.terminate())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(component: Component) -> c_int {
    run(component, |instance| instance.reset())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(
    component: Component,
    time: f64,
    step: f64,
    _no_set_state_before: c_int,
) -> c_int {
    run(component, |instance| instance.do_step(time, step))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(component: Component) -> c_int {
    unsupported(component, "fmi2CancelStep")
}
