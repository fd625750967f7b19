//! The figures the project measures itself by, one JSON line per measurement. `scripts/goals.py` runs them all beside the
//! programs compared with; here is one measurement per process, so that its peak memory is its own:
//!
//! ```text
//! cargo bench --bench goals -- steps [SCENE] [PATH=VALUE]...      steps of the run, against their floor; the end of the run
//! cargo bench --bench goals -- course FILE                        steps of the run of a scene file
//! cargo bench --bench goals -- compile [SCENE] [PATH=VALUE]... [save=FILE]   set-up: CPU time, peak memory
//! cargo bench --bench goals -- load FILE                          a compiled model from its bytes
//! cargo bench --bench goals -- finest                             the finest run of the paper and what replaces it
//! cargo bench --bench goals -- estimate COURSE                    estimated over true error: paper, swinging, pad, seal
//! ```
//!
//! SCENE is the name of an embedded scene, `kazmi2014` by default.

mod clock;
#[path = "../../tests/common/mod.rs"]
mod common;
mod estimate;
mod finest;
mod setup;
mod steps;

use std::process::ExitCode;
use stickslip::Scene;

type Outcome = Result<serde_json::Value, Box<dyn std::error::Error>>;

fn main() -> ExitCode {
    // cargo bench adds an argument of its own
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let outcome = match arguments.split_first() {
        None => return ExitCode::SUCCESS,
        Some((row, rest)) => measure(row, rest),
    };
    match outcome {
        Ok(line) => {
            println!("{line}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("goals: {error}");
            ExitCode::FAILURE
        }
    }
}

fn measure(row: &str, rest: &[String]) -> Outcome {
    match (row, rest) {
        ("steps", _) => steps::measure(&scene(rest)?),
        ("course", [file]) => steps::course(file),
        ("compile", _) => {
            let (save, rest): (Vec<_>, Vec<_>) =
                rest.iter().cloned().partition(|a| a.starts_with("save="));
            let file = save.first().map(|a| &a["save=".len()..]);
            setup::compile(&scene(&rest)?, file)
        }
        ("load", [file]) => setup::load(file),
        ("finest", []) => finest::measure(),
        ("estimate", [course]) => estimate::measure(course),
        _ => Err(format!("no measurement {row} {}", rest.join(" ")).into()),
    }
}

/// An embedded scene with overrides.
fn scene(arguments: &[String]) -> Result<Scene, Box<dyn std::error::Error>> {
    let (mut name, mut overrides) = ("kazmi2014", Vec::new());
    for argument in arguments {
        match argument.split_once('=') {
            Some((path, value)) => overrides.push((path.to_string(), value.to_string())),
            None => name = argument,
        }
    }
    let text = stickslip::scene::example(name).ok_or(format!("no embedded scene {name}"))?;
    Ok(Scene::with_overrides(text, name, &overrides)?)
}
