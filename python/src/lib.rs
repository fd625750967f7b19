//! The extension module of the Python package `stickslip`: classes around the scene, the model, the state and the simulator of
//! the library, and what of them takes long, without the lock of the interpreter.
//!
//! ```text
//! package stickslip (Python: run to xarray, meshes, sweep)  ->  stickslip._native (here)  ->  stickslip, stickslip-fmu, stickslip-cli
//! ```
//!
//! Arrays are made by NumPy and filled through the buffer protocol (`array`). No class has state that a call may leave half
//! changed: simulators and states are behind a lock, and a call that finds it taken by another thread is refused.

mod array;
mod command;
mod compilation;
mod compile;
mod error;
mod free;
mod given;
mod held;
mod many;
mod model;
mod package;
mod port;
mod run;
mod scene;
mod simulator;
mod state;
mod sweep;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::command::command;
    #[pymodule_export]
    use crate::compile::compile;
    #[pymodule_export]
    use crate::error::error_codes;
    #[pymodule_export]
    use crate::many::step_many;
    #[pymodule_export]
    use crate::model::Model;
    #[pymodule_export]
    use crate::package::pack_fmu;
    #[pymodule_export]
    use crate::port::Port;
    #[pymodule_export]
    use crate::run::follow;
    #[pymodule_export]
    use crate::scene::{Scene, example_names, json_schema};
    #[pymodule_export]
    use crate::simulator::Simulator;
    #[pymodule_export]
    use crate::state::State;
    #[pymodule_export]
    use crate::sweep::sweep;
}
