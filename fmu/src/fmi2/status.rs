//! FMI 2.0: status of steps. They are finished when they return, so that there is little to ask.
#![allow(unsafe_code, clippy::missing_safety_doc)]

use super::{Component, run, unsupported};
use crate::fault::Fault;
use crate::guard::{OK, write};
use std::ffi::{c_char, c_int};

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
