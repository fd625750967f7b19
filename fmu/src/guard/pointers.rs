//! Arrays, values and strings of an importer as references. NULL is allowed for an array exactly when its length is 0.
#![allow(unsafe_code)]

use crate::fault::{Fault, Outcome};
use std::ffi::{CStr, c_char};

/// Whether `len` values can stand at the pointer: it is neither NULL nor out of line, and they fit into an address space.
fn check<T>(pointer: *const T, len: usize, what: impl std::fmt::Display) -> Outcome {
    if pointer.is_null() {
        return Err(Fault::error(format!("{what} is NULL")));
    }
    if !pointer.is_aligned() {
        return Err(Fault::error(format!(
            "{what} is at {pointer:p}, which is not aligned for its type"
        )));
    }
    if len
        .checked_mul(size_of::<T>())
        .is_none_or(|bytes| isize::try_from(bytes).is_err())
    {
        return Err(Fault::error(format!("{what} cannot be that long")));
    }
    Ok(())
}

/// An array of the importer.
pub fn slice<'a, T>(pointer: *const T, len: usize) -> Outcome<&'a [T]> {
    if len == 0 {
        return Ok(&[]);
    }
    check(pointer, len, format_args!("an array of {len} values"))?;
    // SAFETY: checked above; FMI has the importer pass an array of this length, which outlives the call.
    Ok(unsafe { std::slice::from_raw_parts(pointer, len) })
}

/// An array of the importer to write to.
pub fn slice_mut<'a, T>(pointer: *mut T, len: usize) -> Outcome<&'a mut [T]> {
    if len == 0 {
        return Ok(&mut []);
    }
    check(pointer, len, format_args!("an array of {len} values"))?;
    // SAFETY: checked above; FMI has the importer pass a writable array of this length, which outlives the call and overlaps no
    // other.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, len) })
}

/// Writes one value of the importer.
pub fn write<T>(pointer: *mut T, value: T, what: &str) -> Outcome {
    check(pointer, 1, what)?;
    // SAFETY: checked above; FMI has the importer pass a pointer to a writable value.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Reads one value of the importer.
pub fn read<T: Copy>(pointer: *const T, what: &str) -> Outcome<T> {
    check(pointer, 1, what)?;
    // SAFETY: checked above; FMI has the importer pass a pointer to a value.
    Ok(unsafe { *pointer })
}

/// A string of the importer.
pub fn text<'a>(pointer: *const c_char, what: &str) -> Outcome<&'a CStr> {
    check(pointer, 1, what)?;
    // SAFETY: checked above; FMI has the importer pass a string that ends with a zero byte and outlives the call.
    Ok(unsafe { CStr::from_ptr(pointer) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_an_array_is_refused() {
        let values = [1.0_f64, 2.0];
        assert_eq!(slice(values.as_ptr(), 2), Ok(&values[..]));
        assert_eq!(slice::<f64>(std::ptr::null(), 0), Ok(&[][..]));
        let askew = values.as_ptr().wrapping_byte_add(1);
        for (pointer, len, told) in [
            (std::ptr::null(), 1, "NULL"),
            (askew, 1, "aligned"),
            (values.as_ptr(), usize::MAX / 4, "that long"),
            (values.as_ptr(), usize::MAX, "that long"),
        ] {
            let read = slice(pointer, len).unwrap_err().message;
            let written = slice_mut(pointer.cast_mut(), len).unwrap_err().message;
            assert!(read.contains(told) && written.contains(told), "{read}");
        }
        assert!(
            read(askew, "a value")
                .unwrap_err()
                .message
                .contains("a value")
        );
        assert!(write(askew.cast_mut(), 1.0, "a value").is_err());
    }
}
