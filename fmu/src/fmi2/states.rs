//! FMI 2.0: saved states.
#![allow(unsafe_code, clippy::missing_safety_doc)]

use super::{Component, run};
use crate::guard::states::{self, State};
use std::ffi::c_int;

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(component: Component, state: *mut State) -> c_int {
    run(component, |instance| states::get(instance, state))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(component: Component, state: State) -> c_int {
    run(component, |instance| states::set(instance, state))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(component: Component, state: *mut State) -> c_int {
    run(component, |instance| states::free(instance, state))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    component: Component,
    state: State,
    size: *mut usize,
) -> c_int {
    run(component, |instance| {
        states::serialized_size(instance, state, size)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    component: Component,
    state: State,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    run(component, |instance| {
        states::serialize(instance, state, bytes, size)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    component: Component,
    bytes: *const u8,
    size: usize,
    state: *mut State,
) -> c_int {
    run(component, |instance| {
        states::deserialize(instance, bytes, size, state)
    })
}
