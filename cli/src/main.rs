//! The executable of the command.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(stickslip_cli::run(std::env::args_os(), None))
}
