//! FMI 2.0 Co-Simulation: the 34 functions of the standard, each a few lines over the lifecycle.
//!
//! FMI 2 lets a slave discard a step only together with status calls that few importers make (some then repeat the step
//! for ever), so that a step that does not converge is an error here; the state is what it was before the step.
//!
//! # Safety
//! Every function takes the pointers the standard says: arrays of the stated lengths, strings that end with a zero byte.
//! NULL where the standard forbids it, and instances or states that are none, are answered with an error.
#![allow(unsafe_code, clippy::missing_safety_doc, clippy::too_many_arguments)]

use crate::fault::{Fault, Outcome};
use crate::guard::{self, ERROR, OK, call, slice, slice_mut, text, uri_path, write};
use crate::lifecycle::Call;
use crate::log::{Category, Log};
use std::ffi::{CStr, CString, c_char, c_int, c_void};

type Component = *mut c_void;
type FmuState = *mut c_void;
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

fn handle(state: FmuState) -> u64 {
    state as usize as u64
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
    _tolerance_defined: c_int,
    _tolerance: f64,
    start_time: f64,
    _stop_time_defined: c_int,
    _stop_time: f64,
) -> c_int {
    run(component, |instance| instance.setup(start_time))
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
pub unsafe extern "C" fn fmi2GetReal(
    component: Component,
    references: *const u32,
    count: usize,
    values: *mut f64,
) -> c_int {
    run(component, |instance| {
        instance.get(slice(references, count)?, slice_mut(values, count)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(
    component: Component,
    references: *const u32,
    count: usize,
    values: *mut c_int,
) -> c_int {
    run(component, |instance| {
        instance.get(slice(references, count)?, slice_mut(values, count)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    component: Component,
    references: *const u32,
    count: usize,
    values: *const f64,
) -> c_int {
    run(component, |instance| {
        instance.set(slice(references, count)?, slice(values, count)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    component: Component,
    references: *const u32,
    count: usize,
    values: *const c_int,
) -> c_int {
    run(component, |instance| {
        instance.set(slice(references, count)?, slice(values, count)?)
    })
}

/// Getters and setters of types that no variable has: right for no reference, wrong for every one.
macro_rules! without_variables {
    ($($name:ident($value:ty);)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            component: Component,
            _references: *const u32,
            count: usize,
            _values: $value,
        ) -> c_int {
            run(component, |instance| {
                instance.permit(Call::Get)?;
                match count {
                    0 => Ok(()),
                    _ => Err(Fault::error(concat!(stringify!($name), ": no variable has this type"))),
                }
            })
        }
    )*};
}

without_variables! {
    fmi2GetBoolean(*mut c_int);
    fmi2GetString(*mut *const c_char);
    fmi2SetBoolean(*const c_int);
    fmi2SetString(*const *const c_char);
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(component: Component, state: *mut FmuState) -> c_int {
    run(component, |instance| {
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
pub unsafe extern "C" fn fmi2SetFMUstate(component: Component, state: FmuState) -> c_int {
    run(component, |instance| instance.restore(handle(state)))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(component: Component, state: *mut FmuState) -> c_int {
    run(component, |instance| {
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
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    component: Component,
    state: FmuState,
    size: *mut usize,
) -> c_int {
    run(component, |instance| {
        write(size, instance.serialized_len(handle(state))?, "the size")
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    component: Component,
    state: FmuState,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    run(component, |instance| {
        instance.serialize(handle(state), slice_mut(bytes, size)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    component: Component,
    bytes: *const u8,
    size: usize,
    state: *mut FmuState,
) -> c_int {
    run(component, |instance| {
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
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    component: Component,
    unknowns: *const u32,
    unknown_count: usize,
    knowns: *const u32,
    known_count: usize,
    seed: *const f64,
    sensitivity: *mut f64,
) -> c_int {
    run(component, |instance| {
        let (unknowns, knowns) = (slice(unknowns, unknown_count)?, slice(knowns, known_count)?);
        let out = slice_mut(sensitivity, unknown_count)?;
        instance.directional(unknowns, knowns, slice(seed, known_count)?, out)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    component: Component,
    references: *const u32,
    count: usize,
    orders: *const c_int,
    values: *const f64,
) -> c_int {
    run(component, |instance| {
        instance.set_slopes(
            slice(references, count)?,
            slice(orders, count)?,
            slice(values, count)?,
        )
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    component: Component,
    references: *const u32,
    count: usize,
    orders: *const c_int,
    values: *mut f64,
) -> c_int {
    run(component, |instance| {
        instance.get_slopes(
            slice(references, count)?,
            slice(orders, count)?,
            slice_mut(values, count)?,
        )
    })
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

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(
    component: Component,
    _kind: c_int,
    value: *mut c_int,
) -> c_int {
    // steps are finished when they return: there is nothing pending to ask about
    run(component, |_| write(value, OK, "the status"))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(
    component: Component,
    kind: c_int,
    value: *mut f64,
) -> c_int {
    run(component, |instance| match kind {
        2 => write(value, instance.time(), "the last successful time"),
        _ => Err(Fault::error(format!(
            "there is no real status of kind {kind}"
        ))),
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(
    component: Component,
    _kind: c_int,
    _value: *mut c_int,
) -> c_int {
    unsupported(component, "fmi2GetIntegerStatus")
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    component: Component,
    kind: c_int,
    value: *mut c_int,
) -> c_int {
    run(component, |_| match kind {
        3 => write(value, 0, "whether the slave wants to terminate"),
        _ => Err(Fault::error(format!(
            "there is no boolean status of kind {kind}"
        ))),
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(
    component: Component,
    _kind: c_int,
    _value: *mut *const c_char,
) -> c_int {
    unsupported(component, "fmi2GetStringStatus")
}
