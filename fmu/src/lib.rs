//! stickslip as a Functional Mock-up Unit: FMI 2.0 and FMI 3.0 Co-Simulation.
//!
//! ```text
//! importer -> fmi2, fmi3 (extern "C": pointers, panics) -> lifecycle (what is allowed when) -> stickslip::Simulator
//! packager -> description, documentation, reference run  \-> variables, parameters, component (what there is)
//! ```
//!
//! [`package`] makes an FMU of a scene. The FMU carries the compiled model, so that an instance starts without a mesh, and
//! the scene, from which it recompiles when the importer changes a fixed parameter before the initialization ends.

mod component;
mod description;
mod documentation;
mod fault;
pub mod fmi2;
pub mod fmi3;
mod guard;
mod lifecycle;
mod log;
mod notes;
mod package;
mod parameters;
mod phase;
mod reference_run;
mod registry;
mod saved;
mod variables;
mod xml;

pub use description::{FmiVersion, model_description, terminals};
pub use package::{Options, PackageError, Packed, find_library, package};
