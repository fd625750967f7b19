//! FMI 3.0: saved states.
#![allow(unsafe_code, clippy::missing_safety_doc)]

use super::{Instance, run};
use crate::guard::states::{self, State};
use std::ffi::c_int;

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(instance: Instance, state: *mut State) -> c_int {
    run(instance, |instance| states::get(instance, state))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(instance: Instance, state: State) -> c_int {
    run(instance, |instance| states::set(instance, state))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(instance: Instance, state: *mut State) -> c_int {
    run(instance, |instance| states::free(instance, state))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: Instance,
    state: State,
    size: *mut usize,
) -> c_int {
    run(instance, |instance| {
        states::serialized_size(instance, state, size)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    instance: Instance,
    state: State,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    run(instance, |instance| {
        states::serialize(instance, state, bytes, size)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: Instance,
    bytes: *const u8,
    size: usize,
    state: *mut State,
) -> c_int {
    run(instance, |instance| {
        states::deserialize(instance, bytes, size, state)
    })
}
