//! The command `stickslip`: runs, checks, draws and packs scenes. A library, so that the Python package carries the command too.

mod arguments;
mod body_picture;
mod cell_fields;
mod check;
mod check_material;
mod check_mesh;
mod closing;
mod console;
mod contact_table;
mod course;
pub mod failure;
mod field;
mod fmu;
mod main_job;
mod npz;
mod paper;
mod pictures;
mod port_record;
mod qvi;
mod run;
mod run_pictures;
mod saved_state;
mod source;
mod standard;
pub mod sweep;
mod tradeoff;
mod vtk;

use arguments::{Arguments, Command};
use clap::Parser;
use failure::Failure;
use std::ffi::OsString;
use std::path::PathBuf;

/// Runs the command with these arguments, its name first, and returns its exit status. `library` is the FMU library that is packed
/// where the command line names none; default: the one that lies beside the executable.
pub fn run(arguments: impl IntoIterator<Item = OsString>, library: Option<PathBuf>) -> u8 {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // where it cannot be printed there is nobody to tell
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(u8::MAX);
        }
    };
    match dispatch(&arguments, library) {
        Ok(()) => 0,
        Err(failure) => {
            console::warn(&failure.to_string());
            1
        }
    }
}

fn dispatch(arguments: &Arguments, library: Option<PathBuf>) -> Result<(), Failure> {
    match &arguments.command {
        None => main_job::run(library),
        Some(Command::Run(options)) => run::run(options),
        Some(Command::Check(choice)) if check_mesh::is_meant(choice) => check_mesh::check(choice),
        Some(Command::Check(choice)) => check::check(choice),
        Some(Command::Fmu(options)) => fmu::run(options, library),
        Some(Command::Sweep(options)) => sweep::run(options),
        Some(Command::Tradeoff(options)) => tradeoff::run(options),
        Some(Command::Example { name: None }) => {
            let names: Vec<_> = stickslip::scene::example_names().collect();
            console::say(&names.join("\n"))
        }
        Some(Command::Example { name: Some(name) }) => {
            console::say(source::embedded(name)?.trim_end())
        }
        Some(Command::Schema) => console::say(&stickslip::scene::json_schema()),
        Some(Command::Qvi) => qvi::run(),
        Some(Command::Paper(options)) => paper::run(options),
    }
}
