//! The C interface: pointers, panics and the last error; no physics. Declared in `include/stickslip.h`, whose head is
//! the page of conventions; what each function does, its units, shapes and errors are its documentation here.
//!
//! This is the only module with unsafe code. A pointer becomes a reference in `guard` alone, after it has been
//! checked for NULL, alignment and, for a handle, its kind; a length is checked before a slice is made of it.
#![allow(unsafe_code, non_camel_case_types)]

#[cfg(panic = "abort")]
compile_error!("the C interface catches panics: build it with panic = \"unwind\"");

mod compile;
mod derivative;
mod guard;
mod inputs;
mod model;
mod simulator;
mod state;

pub use compile::*;
pub use derivative::*;
pub use guard::{stickslip_code_name, stickslip_last_error};
pub use inputs::*;
pub use model::*;
pub use simulator::*;
pub use state::*;

use std::ffi::c_char;

/// Version of this interface. It grows when a function or structure changes its meaning or layout, not when one is added.
pub const STICKSLIP_ABI_VERSION: u32 = 1;
/// The call did what it says.
pub const STICKSLIP_OK: i32 = 0;
/// The step was taken, but the multiplicity test (scene: `fidelity.multiplicity_test`) found more than one solution.
pub const STICKSLIP_NOT_UNIQUE: i32 = 1;
/// The step was taken, but rounding kept the friction law from holding to `fidelity.friction_tolerance`: the output
/// `solver.residual` tells to what share of the forces that meet at a contact node it holds, never worse than 1e-8, or than what
/// moves slip rates and stresses of slipping nodes by less than the tolerance.
pub const STICKSLIP_AT_ROUNDING: i32 = 2;
/// The step was taken, but displacement and slip lost more digits to rounding than `fidelity.tolerance` allows: a step of
/// millions of relaxation times with trapezoid or TR-BDF2 after a jump of the loads. The output `solver.lost_digits` tells the
/// share by estimate; stresses and energies may be off by some times as much. Backward Euler keeps the digits.
pub const STICKSLIP_DIGITS_LOST: i32 = 3;
/// The step was taken, but `fidelity.work_limit` ended a friction problem at its best iterate: the output `solver.residual` tells
/// how well the friction law holds.
pub const STICKSLIP_TRUNCATED: i32 = 4;
/// Causality of a port: set before a step, by default its value at the end of the step (`stickslip_set_inputs_meaning`).
pub const STICKSLIP_INPUT: i32 = 0;
/// Causality of a port: read after a step.
pub const STICKSLIP_OUTPUT: i32 = 1;
/// Causality of a port: a coefficient of the friction law, may be set between steps.
pub const STICKSLIP_PARAMETER: i32 = 2;

/// Version of the library, "major.minor.patch"; a static string. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn stickslip_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// `STICKSLIP_ABI_VERSION` of the library: compare it with that of the header. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn stickslip_abi_version() -> u32 {
    STICKSLIP_ABI_VERSION
}
