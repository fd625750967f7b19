//! Arrays, values and strings of an importer as references. NULL is allowed for an array exactly when its length is 0.
#![allow(unsafe_code)]

use crate::fault::{Fault, Outcome};
use std::ffi::{CStr, c_char};

/// An array of the importer.
pub fn slice<'a, T>(pointer: *const T, len: usize) -> Outcome<&'a [T]> {
    if len == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() {
        return Err(Fault::error(format!("an array of {len} values is NULL")));
    }
    // SAFETY: FMI has the importer pass an array of this length, which outlives the call.
    Ok(unsafe { std::slice::from_raw_parts(pointer, len) })
}

/// An array of the importer to write to.
pub fn slice_mut<'a, T>(pointer: *mut T, len: usize) -> Outcome<&'a mut [T]> {
    if len == 0 {
        return Ok(&mut []);
    }
    if pointer.is_null() {
        return Err(Fault::error(format!("an array of {len} values is NULL")));
    }
    // SAFETY: FMI has the importer pass a writable array of this length, which outlives the call and overlaps no other.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, len) })
}

/// Writes one value of the importer.
pub fn write<T>(pointer: *mut T, value: T, what: &str) -> Outcome {
    if pointer.is_null() {
        return Err(Fault::error(format!("{what} is NULL")));
    }
    // SAFETY: FMI has the importer pass a pointer to a writable value.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Reads one value of the importer.
pub fn read<T: Copy>(pointer: *const T, what: &str) -> Outcome<T> {
    if pointer.is_null() {
        return Err(Fault::error(format!("{what} is NULL")));
    }
    // SAFETY: FMI has the importer pass a pointer to a value.
    Ok(unsafe { *pointer })
}

/// A string of the importer.
pub fn text<'a>(pointer: *const c_char, what: &str) -> Outcome<&'a CStr> {
    if pointer.is_null() {
        return Err(Fault::error(format!("{what} is NULL")));
    }
    // SAFETY: FMI has the importer pass a string that ends with a zero byte and outlives the call.
    Ok(unsafe { CStr::from_ptr(pointer) })
}
