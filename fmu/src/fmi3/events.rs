//! FMI 3.0: event mode, for importers that asked for it when they made the instance.
#![allow(unsafe_code, clippy::missing_safety_doc)]

use super::{Boolean, Instance, run};
use crate::fault::Fault;
use crate::guard::write;
use std::ffi::c_int;

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterEventMode(instance: Instance) -> c_int {
    run(instance, |instance| instance.enter_event_mode())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterStepMode(instance: Instance) -> c_int {
    run(instance, |instance| instance.enter_step_mode())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3UpdateDiscreteStates(
    instance: Instance,
    needs_update: *mut Boolean,
    terminate: *mut Boolean,
    nominals_changed: *mut Boolean,
    values_changed: *mut Boolean,
    has_next_event: *mut Boolean,
    next_event: *mut f64,
) -> c_int {
    run(instance, |instance| {
        instance.update_discrete_states()?;
        let flags = [
            needs_update,
            terminate,
            nominals_changed,
            values_changed,
            has_next_event,
        ];
        if flags.iter().any(|flag| flag.is_null()) || next_event.is_null() {
            return Err(Fault::error(
                "fmi3UpdateDiscreteStates: a pointer to a result is NULL",
            ));
        }
        for flag in flags {
            write(flag, 0, "a flag")?;
        }
        write(next_event, 0.0, "the time of the next event")
    })
}
