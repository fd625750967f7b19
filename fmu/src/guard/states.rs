//! Saved states in the hands of an importer, the same for FMI 2 and FMI 3: a pointer that it gives back and never follows.

use super::{read, slice, slice_mut, write};
use crate::fault::Outcome;
use crate::lifecycle::Instance;
use std::ffi::c_void;

/// `fmi2FMUstate`, `fmi3FMUState`: a handle of the lifecycle, written as a pointer.
pub type State = *mut c_void;

const POINTER: &str = "the pointer to the state";

fn handle(state: State) -> u64 {
    state as usize as u64
}

fn put(state: *mut State, handle: u64) -> Outcome {
    write(
        state,
        std::ptr::without_provenance_mut(handle as usize),
        POINTER,
    )
}

/// Saves the state, into the one that `state` holds unless that is NULL.
pub fn get(instance: &mut Instance, state: *mut State) -> Outcome {
    let old = read(state, POINTER)?;
    let new = instance.save((!old.is_null()).then(|| handle(old)))?;
    put(state, new)
}

pub fn set(instance: &mut Instance, state: State) -> Outcome {
    instance.restore(handle(state))
}

/// Frees a state and makes its pointer NULL; NULL is ignored.
pub fn free(instance: &mut Instance, state: *mut State) -> Outcome {
    if state.is_null() {
        return Ok(());
    }
    let old = read(state, POINTER)?;
    if old.is_null() {
        return Ok(());
    }
    instance.free_saved(handle(old))?;
    write(state, std::ptr::null_mut(), POINTER)
}

pub fn serialized_size(instance: &mut Instance, state: State, size: *mut usize) -> Outcome {
    write(size, instance.serialized_len(handle(state))?, "the size")
}

pub fn serialize(instance: &mut Instance, state: State, bytes: *mut u8, size: usize) -> Outcome {
    instance.serialize(handle(state), slice_mut(bytes, size)?)
}

pub fn deserialize(
    instance: &mut Instance,
    bytes: *const u8,
    size: usize,
    state: *mut State,
) -> Outcome {
    read(state, POINTER)?;
    let new = instance.deserialize(slice(bytes, size)?)?;
    put(state, new)
}
