//! The one place where pointers of an importer become references: instances here, arrays and strings in [`pointers`], paths in
//! [`resources`], saved states in [`states`].
//!
//! An instance is looked up among the live ones before it is touched, and is taken by one call at a time. A panic is caught
//! here: it poisons the instance, which can then only be freed, and never reaches the importer. Every call computes in the
//! default floating-point environment, whatever the importer traps; afterwards the importer has its own again.
#![allow(unsafe_code)]

mod pointers;
mod resources;
pub mod states;

pub use pointers::{read, slice, slice_mut, text, write};
pub use resources::{native_path, resources_beside_library, uri_path};

use crate::component::Component;
pub use crate::fault::{DISCARD, ERROR, OK};
use crate::fault::{Fault, Outcome};
use crate::lifecycle::{Call, Instance};
use crate::log::{Category, Log};
use crate::registry;
use std::cell::UnsafeCell;
use std::ffi::{CStr, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use stickslip::float_environment::DefaultEnvironment;

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
    let _environment = DefaultEnvironment::enter();
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
        let component = Component::load(&resources()?, &token.to_string_lossy(), registry::shared)?;
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

/// Frees an instance; NULL, invalid pointers and an instance in the middle of a call (its own logger, or another thread)
/// are left alone.
pub fn free(pointer: *mut c_void) {
    let _environment = DefaultEnvironment::enter();
    let _ = catch_unwind(|| {
        if pointer.is_null() || !registry::leave(pointer as usize) {
            return;
        }
        let slot = pointer.cast::<Slot>();
        // SAFETY: the slot was made by `create` and was live until the line above, which struck it out for this call alone.
        if unsafe { &*slot }.is_busy.swap(true, Ordering::Acquire) {
            registry::enter(pointer as usize);
            return;
        }
        // SAFETY: struck out, and no call is under way that could still look at it.
        drop(unsafe { Box::from_raw(slot) });
        registry::sweep();
    });
}

/// Runs a call on an instance and logs its refusal; the status, where `discard` is what a discard is called.
pub fn call(pointer: *mut c_void, discard: i32, run: impl FnOnce(&mut Instance) -> Outcome) -> i32 {
    let _environment = DefaultEnvironment::enter();
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

/// Switches categories of the log of an instance on or off.
pub fn set_logging(
    instance: &mut Instance,
    is_on: bool,
    count: usize,
    categories: *const *const c_char,
) -> Outcome {
    instance.permit(Call::SetDebugLogging)?;
    let names = slice(categories, count)?
        .iter()
        .map(|c| text(*c, "a log category"));
    instance
        .log
        .switch(is_on, &names.collect::<Outcome<Vec<&CStr>>>()?)
}
