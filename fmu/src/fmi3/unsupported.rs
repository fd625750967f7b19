//! The functions of FMI 3.0 for what this FMU does not declare: other types, clocks, Model Exchange, Scheduled
//! Execution, configuration. They answer with an error and say so in the log; none pretends.
#![allow(unsafe_code, clippy::missing_safety_doc, clippy::too_many_arguments)]

use super::{Boolean, Callback, Instance, LogMessage, logger, run};
use crate::fault::Fault;
use crate::guard;
use std::ffi::{c_char, c_int, c_void};

fn refuse(instance: Instance, name: &str) -> c_int {
    let message = format!("{name} is not supported, as the model description says");
    run(instance, |_| Err(Fault::error(message)))
}

/// Getters and setters of types that no variable has: right for no reference, wrong for every one.
macro_rules! without_variables {
    ($($name:ident($value:ty);)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            instance: Instance,
            _references: *const u32,
            count: usize,
            _values: $value,
            value_count: usize,
        ) -> c_int {
            run(instance, |_| match (count, value_count) {
                (0, 0) => Ok(()),
                _ => Err(Fault::error(concat!(stringify!($name), ": no variable has this type"))),
            })
        }
    )*};
}

without_variables! {
    fmi3GetFloat32(*mut f32);
    fmi3GetInt8(*mut i8);
    fmi3GetUInt8(*mut u8);
    fmi3GetInt16(*mut i16);
    fmi3GetUInt16(*mut u16);
    fmi3GetInt32(*mut i32);
    fmi3GetUInt32(*mut u32);
    fmi3GetUInt64(*mut u64);
    fmi3GetBoolean(*mut Boolean);
    fmi3GetString(*mut *const c_char);
    fmi3SetFloat32(*const f32);
    fmi3SetInt8(*const i8);
    fmi3SetUInt8(*const u8);
    fmi3SetInt16(*const i16);
    fmi3SetUInt16(*const u16);
    fmi3SetInt32(*const i32);
    fmi3SetUInt32(*const u32);
    fmi3SetUInt64(*const u64);
    fmi3SetBoolean(*const Boolean);
    fmi3SetString(*const *const c_char);
}

/// Functions that answer with an error.
macro_rules! refused {
    ($($name:ident($($argument:ident: $kind:ty),*);)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: Instance $(, $argument: $kind)*) -> c_int {
            let _ = ($($argument,)*);
            refuse(instance, stringify!($name))
        }
    )*};
}

refused! {
    fmi3GetBinary(r: *const u32, n: usize, sizes: *mut usize, values: *mut *const u8, m: usize);
    fmi3SetBinary(r: *const u32, n: usize, sizes: *const usize, values: *const *const u8, m: usize);
    fmi3GetClock(r: *const u32, n: usize, values: *mut Boolean);
    fmi3SetClock(r: *const u32, n: usize, values: *const Boolean);
    fmi3GetNumberOfVariableDependencies(r: u32, n: *mut usize);
    fmi3GetVariableDependencies(r: u32, e: *mut usize, i: *mut u32, f: *mut usize, k: *mut c_int, n: usize);
    fmi3EnterConfigurationMode();
    fmi3ExitConfigurationMode();
    fmi3GetIntervalDecimal(r: *const u32, n: usize, intervals: *mut f64, qualifiers: *mut c_int);
    fmi3GetIntervalFraction(r: *const u32, n: usize, counters: *mut u64, resolutions: *mut u64, q: *mut c_int);
    fmi3GetShiftDecimal(r: *const u32, n: usize, shifts: *mut f64);
    fmi3GetShiftFraction(r: *const u32, n: usize, counters: *mut u64, resolutions: *mut u64);
    fmi3SetIntervalDecimal(r: *const u32, n: usize, intervals: *const f64);
    fmi3SetIntervalFraction(r: *const u32, n: usize, counters: *const u64, resolutions: *const u64);
    fmi3SetShiftDecimal(r: *const u32, n: usize, shifts: *const f64);
    fmi3SetShiftFraction(r: *const u32, n: usize, counters: *const u64, resolutions: *const u64);
    fmi3EvaluateDiscreteStates();
    fmi3EnterContinuousTimeMode();
    fmi3CompletedIntegratorStep(no_set: Boolean, enter_event_mode: *mut Boolean, terminate: *mut Boolean);
    fmi3SetTime(time: f64);
    fmi3SetContinuousStates(states: *const f64, n: usize);
    fmi3GetContinuousStateDerivatives(derivatives: *mut f64, n: usize);
    fmi3GetEventIndicators(indicators: *mut f64, n: usize);
    fmi3GetContinuousStates(states: *mut f64, n: usize);
    fmi3GetNominalsOfContinuousStates(nominals: *mut f64, n: usize);
    fmi3GetNumberOfEventIndicators(n: *mut usize);
    fmi3GetNumberOfContinuousStates(n: *mut usize);
    fmi3ActivateModelPartition(clock: u32, time: f64);
}

fn no_instance(what: &str, environment: *mut c_void, log_message: LogMessage) -> Instance {
    let refusal = format!("this FMU is for Co-Simulation, not for {what}");
    let log = logger(log_message, environment, 0);
    guard::create(
        std::ptr::null(),
        std::ptr::null(),
        guard::resources_beside_library,
        Some(&refusal),
        log,
    )
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: Boolean,
    _logging_on: Boolean,
    environment: *mut c_void,
    log_message: LogMessage,
) -> Instance {
    no_instance("Model Exchange", environment, log_message)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: Boolean,
    _logging_on: Boolean,
    environment: *mut c_void,
    log_message: LogMessage,
    _clock_update: Callback,
    _lock_preemption: Callback,
    _unlock_preemption: Callback,
) -> Instance {
    no_instance("Scheduled Execution", environment, log_message)
}
