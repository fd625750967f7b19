//! The command `stickslip`: runs, checks, draws and packs scenes.

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
mod failure;
mod field;
mod fmu;
mod main_job;
mod paper;
mod pictures;
mod qvi;
mod run;
mod run_pictures;
mod source;
mod standard;
mod tradeoff;
mod vtk;

use arguments::{Arguments, Command};
use clap::Parser;
use failure::Failure;
use std::process::ExitCode;

fn main() -> ExitCode {
    match dispatch(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            console::warn(&failure.to_string());
            ExitCode::FAILURE
        }
    }
}

fn dispatch(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.command {
        None => main_job::run(),
        Some(Command::Run(options)) => run::run(options),
        Some(Command::Check(choice)) if check_mesh::is_meant(choice) => check_mesh::check(choice),
        Some(Command::Check(choice)) => check::check(choice),
        Some(Command::Fmu(options)) => fmu::run(options),
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
