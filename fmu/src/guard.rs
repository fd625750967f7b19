//! The one place where pointers of an importer become references: instances, arrays, strings, paths.
//!
//! NULL is allowed for an array exactly when its length is 0. An instance is looked up among the live ones before it is
//! touched, and is taken by one call at a time. A panic is caught here: it poisons the instance, which can then only be
//! freed, and never reaches the importer.
#![allow(unsafe_code)]

use crate::component::Component;
use crate::fault::{Fault, Outcome};
use crate::lifecycle::Instance;
use crate::log::{Category, Log};
use crate::registry;
use std::cell::UnsafeCell;
use std::ffi::{CStr, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Status values, the same in FMI 2 and FMI 3.
pub const OK: i32 = 0;
pub const DISCARD: i32 = 2;
pub const ERROR: i32 = 3;

struct Slot {
    is_busy: AtomicBool,
    is_poisoned: AtomicBool,
    instance: UnsafeCell<Instance>,
}

/// Makes an instance; NULL and a message when that is refused.
pub fn create(
    name: *const c_char,
    token: *const c_char,
    resources: impl FnOnce() -> Outcome<PathBuf>,
    refusal: Option<&str>,
    log: Log,
) -> *mut c_void {
    let log = std::cell::Cell::new(Some(log));
    let make = || -> Outcome<*mut c_void> {
        if let Some(refusal) = refusal {
            return Err(Fault::error(refusal));
        }
        if text(name, "the instance name")?
            .to_bytes()
            .trim_ascii()
            .is_empty()
        {
            return Err(Fault::error("the instance name is blank"));
        }
        let token = text(token, "the token of the FMU")?;
        let component = Component::load(&resources()?, &token.to_string_lossy())?;
        let Some(log) = log.take() else {
            return Err(Fault::error("made twice"));
        };
        let slot = Box::new(Slot {
            is_busy: AtomicBool::new(false),
            is_poisoned: AtomicBool::new(false),
            instance: UnsafeCell::new(Instance::new(component, log, registry::serial())),
        });
        let pointer = Box::into_raw(slot);
        registry::enter(pointer as usize);
        Ok(pointer.cast())
    };
    let message = match catch_unwind(AssertUnwindSafe(make)) {
        Ok(Ok(pointer)) => return pointer,
        Ok(Err(fault)) => fault.message,
        Err(_) => "the library panicked".to_owned(),
    };
    let _ = catch_unwind(AssertUnwindSafe(|| {
        if let Some(log) = log.take() {
            log.write_always(ERROR, &format!("no instance: {message}"));
        }
    }));
    std::ptr::null_mut()
}

/// Frees an instance; NULL and pointers that are none are ignored.
pub fn free(pointer: *mut c_void) {
    let _ = catch_unwind(|| {
        if !pointer.is_null() && registry::leave(pointer as usize) {
            // SAFETY: the pointer was made by `create` and was live until this line, which struck it out.
            drop(unsafe { Box::from_raw(pointer.cast::<Slot>()) });
            registry::sweep();
        }
    });
}

/// Runs a call on an instance and logs its refusal; the status, where `discard` is what a discard is called.
pub fn call(pointer: *mut c_void, discard: i32, run: impl FnOnce(&mut Instance) -> Outcome) -> i32 {
    if pointer.is_null() || !registry::is_live(pointer as usize) {
        return ERROR;
    }
    // SAFETY: the registry says that a slot made by `create` lives here; slots are only read through shared references.
    let slot = unsafe { &*pointer.cast::<Slot>() };
    if slot.is_busy.swap(true, Ordering::Acquire) {
        // a second thread, or the importer's logger calling back: refused, as FMI does
        return ERROR;
    }
    let status = if slot.is_poisoned.load(Ordering::Relaxed) {
        ERROR
    } else {
        // SAFETY: `is_busy` was false and is true now, so that no other reference to the instance exists.
        let instance = unsafe { &mut *slot.instance.get() };
        run_guarded(instance, discard, run).unwrap_or_else(|| {
            slot.is_poisoned.store(true, Ordering::Relaxed);
            ERROR
        })
    };
    slot.is_busy.store(false, Ordering::Release);
    status
}

/// None after a panic.
fn run_guarded(
    instance: &mut Instance,
    discard: i32,
    run: impl FnOnce(&mut Instance) -> Outcome,
) -> Option<i32> {
    let guarded = catch_unwind(AssertUnwindSafe(|| {
        let outcome = run(&mut *instance);
        match outcome {
            Ok(()) => OK,
            Err(fault) => {
                let is_discard = fault.is_discard && discard == DISCARD;
                let category = if is_discard {
                    Category::Discard
                } else {
                    Category::Error
                };
                let status = if is_discard { DISCARD } else { ERROR };
                instance.log.write(status, category, &fault.message);
                status
            }
        }
    }));
    if guarded.is_err() {
        let message = "the library panicked: this instance can only be freed";
        let _ = catch_unwind(AssertUnwindSafe(|| {
            instance.log.write(ERROR, Category::Error, message)
        }));
    }
    guarded.ok()
}

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

/// A path of the importer, as the operating system writes it.
pub fn native_path(bytes: &[u8]) -> Outcome<PathBuf> {
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        Ok(Path::new(std::ffi::OsStr::from_bytes(bytes)).to_path_buf())
    }
    #[cfg(not(unix))]
    {
        let text = std::str::from_utf8(bytes);
        text.map(PathBuf::from)
            .map_err(|_| Fault::error("the path of the resources is not UTF-8"))
    }
}

/// A `file:` URI (or a path from the root) as a path, percent signs decoded.
pub fn uri_path(uri: &[u8]) -> Outcome<PathBuf> {
    let shown = || String::from_utf8_lossy(uri).into_owned();
    if uri.starts_with(b"/") {
        return native_path(uri);
    }
    let is_file = uri.len() >= 5 && uri[..5].eq_ignore_ascii_case(b"file:");
    let Some(rest) = uri.get(5..).filter(|_| is_file) else {
        return Err(Fault::error(format!(
            "the resource location {:?} is no file: URI",
            shown()
        )));
    };
    let path = match rest.strip_prefix(b"//") {
        Some(after) => {
            let start = after.iter().position(|b| *b == b'/').unwrap_or(after.len());
            if start > 0 && !after[..start].eq_ignore_ascii_case(b"localhost") {
                return Err(Fault::error(format!(
                    "the resource location {:?} is on another host",
                    shown()
                )));
            }
            &after[start..]
        }
        None => rest,
    };
    let mut out = Vec::with_capacity(path.len());
    let mut bytes = path.iter().copied();
    while let Some(byte) = bytes.next() {
        if byte != b'%' {
            out.push(byte);
            continue;
        }
        let mut digit = || bytes.next().and_then(|b| (b as char).to_digit(16));
        match (digit(), digit()) {
            (Some(high), Some(low)) => out.push((16 * high + low) as u8),
            _ => {
                return Err(Fault::error(format!(
                    "the resource location {:?} has a broken % escape",
                    shown()
                )));
            }
        }
    }
    // file:///C:/x names C:/x
    let is_drive = cfg!(windows) && out.len() > 2 && out[0] == b'/' && out[2] == b':';
    native_path(&out[usize::from(is_drive)..])
}

/// The resources of the FMU that this library was unpacked with: `../../resources` from the library.
pub fn resources_beside_library() -> Outcome<PathBuf> {
    let refuse = || {
        Fault::error("no path of the resources was given, and there are none beside the library")
    };
    let library = library_path().ok_or_else(refuse)?;
    let root = library
        .parent()
        .and_then(Path::parent)
        .and_then(Path::parent)
        .ok_or_else(refuse)?;
    let resources = root.join("resources");
    if resources.is_dir() {
        Ok(resources)
    } else {
        Err(refuse())
    }
}

#[cfg(unix)]
fn library_path() -> Option<PathBuf> {
    #[repr(C)]
    struct Info {
        file: *const c_char,
        base: *mut c_void,
        symbol: *const c_char,
        address: *mut c_void,
    }
    unsafe extern "C" {
        fn dladdr(address: *const c_void, info: *mut Info) -> i32;
    }
    let mut info = Info {
        file: std::ptr::null(),
        base: std::ptr::null_mut(),
        symbol: std::ptr::null(),
        address: std::ptr::null_mut(),
    };
    // SAFETY: the address is one of this library; `info` has the layout that POSIX gives Dl_info.
    if unsafe { dladdr(free as *const c_void, &raw mut info) } == 0 {
        return None;
    }
    let file = text(info.file, "the file").ok()?;
    native_path(file.to_bytes()).ok()?.canonicalize().ok()
}

#[cfg(not(unix))]
fn library_path() -> Option<PathBuf> {
    None
}

#[cfg(test)]
mod tests {
    use super::uri_path;
    use std::path::PathBuf;

    #[test]
    fn uris_are_decoded_or_refused() {
        for (uri, path) in [
            ("file:///a%20b/c", "/a b/c"),
            ("file:/a/c", "/a/c"),
            ("FILE://localhost/a", "/a"),
            ("/plain/path", "/plain/path"),
        ] {
            assert_eq!(uri_path(uri.as_bytes()), Ok(PathBuf::from(path)), "{uri}");
        }
        for uri in [
            "http://a/b",
            "file:///a%2",
            "file:///a%zz",
            "file://elsewhere/a",
            "",
            "relative",
        ] {
            assert!(uri_path(uri.as_bytes()).is_err(), "{uri}");
        }
    }
}
