//! What every function goes through: pointers are checked, errors become codes and a message of the thread, panics stop
//! here, and the floating-point environment of the host is put aside.

use crate::error::{Error, ErrorCode, Result};
use crate::float_environment::DefaultEnvironment;
use std::cell::{Cell, RefCell};
use std::ffi::{CStr, c_char};
use std::fmt::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

/// Longest message, bytes; the rest is cut off.
const CAPACITY: usize = 1023;

/// The last message of a thread, in place: reporting allocates nothing, and a thread that ends leaves nothing behind.
struct Message {
    bytes: [u8; CAPACITY],
    length: usize,
}

thread_local! {
    static LAST: RefCell<Message> = const { RefCell::new(Message { bytes: [0; CAPACITY], length: 0 }) };
    static IS_GUARDED: Cell<bool> = const { Cell::new(false) };
}

impl Write for Message {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let mut count = text.len().min(CAPACITY - self.length);
        while !text.is_char_boundary(count) {
            count -= 1;
        }
        self.bytes[self.length..][..count].copy_from_slice(&text.as_bytes()[..count]);
        self.length += count;
        Ok(())
    }
}

/// Makes `text` the last message of this thread.
pub(super) fn remember(text: fmt::Arguments) {
    LAST.with(|last| {
        if let Ok(mut last) = last.try_borrow_mut() {
            last.length = 0;
            // writing into the message cannot fail; a Display that fails leaves what it wrote
            let _ = last.write_fmt(text);
        }
    });
}

/// The last message of this thread, as a text of its own.
pub(super) fn last_message() -> String {
    LAST.with(|last| match last.try_borrow() {
        Ok(last) => String::from_utf8_lossy(&last.bytes[..last.length]).into_owned(),
        Err(_) => String::new(),
    })
}

/// Runs a call, turns its error into code and message, and stops a panic. `on_panic` marks what must not be used again.
pub(super) fn guarded(call: impl FnOnce() -> Result<i32>, on_panic: impl FnOnce()) -> i32 {
    let _environment = DefaultEnvironment::enter();
    silence_own_panics();
    let was_guarded = IS_GUARDED.replace(true);
    let outcome = catch_unwind(AssertUnwindSafe(call));
    IS_GUARDED.set(was_guarded);
    match outcome {
        Ok(Ok(code)) => code,
        Ok(Err(error)) => {
            remember(format_args!("{error}"));
            error.code() as i32
        }
        Err(_) => {
            on_panic();
            ErrorCode::Poisoned as i32
        }
    }
}

/// A library does not print: the message of a panic inside a guarded call goes to the last error, not to stderr. Panics
/// of other code in the same program keep the hook they had.
fn silence_own_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let others = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if IS_GUARDED.get() {
                remember(format_args!("the library panicked: {panic}"));
            } else {
                others(panic);
            }
        }));
    });
}

/// Something behind an opaque pointer: its first field tells its kind.
pub(super) trait Handle {
    const WHAT: &'static str;
    const TAG: u64;
    fn tag(&self) -> u64;
}

/// # Errors
/// [`Error::Null`], [`Error::Value`] for a pointer that is not aligned.
fn check<T>(pointer: *const T, what: &'static str) -> Result<()> {
    if pointer.is_null() {
        return Err(Error::Null { what });
    }
    if !pointer.is_aligned() {
        return Err(Error::Value {
            what: what.into(),
            found: pointer.addr() as f64,
            allowed: "an address aligned for its type",
        });
    }
    Ok(())
}

/// # Safety
/// `pointer` is NULL or points to a live handle of some kind.
///
/// # Errors
/// [`Error::Null`]; [`Error::Value`] for a handle of another kind.
pub(super) unsafe fn handle<'a, T: Handle>(pointer: *const T) -> Result<&'a T> {
    check(pointer, T::WHAT)?;
    // SAFETY: not NULL, aligned, and live by the contract of the function
    let handle = unsafe { &*pointer };
    if handle.tag() == T::TAG {
        Ok(handle)
    } else {
        Err(Error::Value {
            what: format!("the handle given as {}", T::WHAT),
            found: handle.tag() as f64,
            allowed: "a live handle of that kind",
        })
    }
}

/// # Safety
/// `pointer` is NULL or points to a live handle of that very type, which nothing else uses.
///
/// # Errors
/// As [`handle`].
pub(super) unsafe fn handle_mut<'a, T: Handle>(pointer: *mut T) -> Result<&'a mut T> {
    // SAFETY: as promised by the caller; the shared reference ends before the exclusive one begins
    unsafe { handle(pointer.cast_const()) }?;
    Ok(unsafe { &mut *pointer })
}

/// Frees a handle; NULL and what is not a live handle of that kind are left alone.
///
/// # Safety
/// `pointer` is NULL or came from [`give`] and has not been freed.
pub(super) unsafe fn free<T: Handle>(pointer: *mut T, bury: impl FnOnce(&mut T)) {
    // SAFETY: as promised by the caller
    if let Ok(dying) = unsafe { handle_mut(pointer) } {
        bury(dying);
        drop(unsafe { Box::from_raw(pointer) });
    }
}

/// Hands a new handle to the caller.
///
/// # Safety
/// `to` points to a writable pointer.
pub(super) unsafe fn give<T: Handle>(to: *mut *mut T, value: T) {
    // SAFETY: checked by `place` before the value was made
    unsafe { to.write(Box::into_raw(Box::new(value))) };
}

/// Checks that a result can be written to `to`.
///
/// # Errors
/// [`Error::Null`], [`Error::Value`].
pub(super) fn place<T>(to: *mut T, what: &'static str) -> Result<()> {
    check(to.cast_const(), what)
}

/// A NUL-terminated text, as bytes.
///
/// # Safety
/// `pointer` is NULL or points to a NUL-terminated text.
///
/// # Errors
/// [`Error::Null`].
pub(super) unsafe fn text<'a>(pointer: *const c_char, what: &'static str) -> Result<&'a [u8]> {
    check(pointer, what)?;
    // SAFETY: not NULL, terminated by the contract of the function
    Ok(unsafe { CStr::from_ptr(pointer) }.to_bytes())
}

fn check_length(what: &'static str, expected: usize, found: usize) -> Result<()> {
    if expected == found {
        Ok(())
    } else {
        Err(Error::Length {
            what,
            expected,
            found,
        })
    }
}

/// `count` values to read, which must be `expected`.
///
/// # Safety
/// `pointer` is NULL or points to `count` values.
///
/// # Errors
/// [`Error::Length`]; [`Error::Null`] unless the count is 0.
pub(super) unsafe fn values<'a, T>(
    pointer: *const T,
    count: usize,
    expected: usize,
    what: &'static str,
) -> Result<&'a [T]> {
    check_length(what, expected, count)?;
    if count == 0 {
        return Ok(&[]);
    }
    check(pointer, what)?;
    // SAFETY: not NULL, aligned, and as long as the caller and the library agree
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// `count` values to write, which must be `expected`.
///
/// # Safety
/// `pointer` is NULL or points to `count` writable values.
///
/// # Errors
/// As [`values`].
pub(super) unsafe fn values_mut<'a, T>(
    pointer: *mut T,
    count: usize,
    expected: usize,
    what: &'static str,
) -> Result<&'a mut [T]> {
    check_length(what, expected, count)?;
    if count == 0 {
        return Ok(&mut []);
    }
    check(pointer.cast_const(), what)?;
    // SAFETY: not NULL, aligned, and as long as the caller and the library agree
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

/// Where to write `needed` values: `None` when only their number is asked for (NULL and capacity 0).
///
/// # Safety
/// `pointer` is NULL or points to `capacity` writable values.
///
/// # Errors
/// [`Error::Length`] when the capacity is too small, [`Error::Null`].
pub(super) unsafe fn room<'a, T>(
    pointer: *mut T,
    capacity: usize,
    needed: usize,
    what: &'static str,
) -> Result<Option<&'a mut [T]>> {
    if pointer.is_null() && capacity == 0 {
        return Ok(None);
    }
    check(pointer.cast_const(), what)?;
    if capacity < needed {
        return Err(Error::Length {
            what,
            expected: needed,
            found: capacity,
        });
    }
    // SAFETY: not NULL, aligned, at least `needed` values by the contract of the function
    Ok(Some(unsafe {
        std::slice::from_raw_parts_mut(pointer, needed)
    }))
}

/// Copies the message of the last call on this thread that did not return `STICKSLIP_OK` into `buffer`, cut to
/// `capacity` bytes with its terminating NUL. Returns its whole length in bytes without the NUL; 0 when there was none.
/// NULL is allowed iff `capacity` is 0. A call that succeeds leaves the message alone. Any thread; never fails.
///
/// # Safety
/// `buffer` is NULL or points to `capacity` writable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_last_error(buffer: *mut c_char, capacity: usize) -> usize {
    LAST.with(|last| {
        let Ok(last) = last.try_borrow() else {
            return 0;
        };
        if !buffer.is_null() && capacity > 0 {
            let count = last.length.min(capacity - 1);
            // SAFETY: `count` + 1 bytes fit the buffer of the caller, which is not the message
            unsafe {
                std::ptr::copy_nonoverlapping(last.bytes.as_ptr(), buffer.cast(), count);
                buffer.add(count).write(0);
            }
        }
        last.length
    })
}

/// Name of a code, as in the header but for the prefix ("OK", "NOT_CONVERGED", ...); "UNKNOWN_CODE" for a number that is
/// none. A static string. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn stickslip_code_name(code: i32) -> *const c_char {
    let name = match code {
        super::STICKSLIP_OK => c"OK",
        super::STICKSLIP_NOT_UNIQUE => c"NOT_UNIQUE",
        super::STICKSLIP_AT_ROUNDING => c"AT_ROUNDING",
        super::STICKSLIP_DIGITS_LOST => c"DIGITS_LOST",
        super::STICKSLIP_TRUNCATED => c"TRUNCATED",
        _ => ErrorCode::ALL
            .iter()
            .find(|known| **known as i32 == code)
            .map_or(c"UNKNOWN_CODE", |known| known.name()),
    };
    name.as_ptr()
}
