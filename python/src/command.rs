//! The command.

use crate::free::freely;
use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;

/// Runs the command with these arguments, its name first, and returns its exit status.
#[pyfunction]
pub fn command(py: Python<'_>, arguments: Vec<OsString>, library: Option<PathBuf>) -> u8 {
    freely(py, || stickslip_cli::run(arguments, library))
}
