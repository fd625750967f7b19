//! Section 7 of the paper as scenes: the embedded example with other meshes, steps, friction coefficients and solvers.

use crate::course::{self, Effort, Frame};
use crate::failure::Failure;
use crate::field::NodalField;
use std::sync::Arc;
use std::time::{Duration, Instant};
use stickslip::{Compilation, Scene, Simulator};

/// Name of the embedded scene.
pub const NAME: &str = "kazmi2014";

/// The example with values replaced: pairs of a JSON path and a value.
pub fn scene(overrides: &[(&str, String)]) -> Result<Scene, Failure> {
    let text = crate::source::embedded(NAME)?;
    let overrides: Vec<_> = overrides
        .iter()
        .map(|(path, value)| ((*path).to_owned(), value.clone()))
        .collect();
    Scene::with_overrides(text, NAME, &overrides).map_err(Failure::of(NAME))
}

/// Overrides for `h = 1 / cells` and `k = 1 / steps`.
pub fn sizes(cells: u32, steps: u32) -> Vec<(&'static str, String)> {
    vec![
        ("mesh.cells", format!("[{cells}, {}]", cells / 2)),
        ("time.step", (1.0 / f64::from(steps)).to_string()),
    ]
}

/// Overrides for the paper's own iteration from its own starting velocity.
pub fn problem_7_4(stop: &str) -> Vec<(&'static str, String)> {
    vec![
        ("time.start", "zero".to_owned()),
        (
            "fidelity.solver",
            format!(r#"{{"kind": "fixed_point", "tolerance": 1e-6, "stop": "{stop}"}}"#),
        ),
    ]
}

/// A scene that has been run.
pub struct Finished {
    pub compilation: Compilation,
    /// The simulator at the end of the run.
    pub simulator: Simulator,
    pub frames: Vec<Frame>,
    pub effort: Effort,
    /// Time spent in the compilation.
    pub setup: Duration,
}

/// Compiles and runs a scene on its own signals.
pub fn finish(scene: &Scene) -> Result<Finished, Failure> {
    let start = Instant::now();
    let compilation = Compilation::new(scene).map_err(Failure::of(&scene.name))?;
    let setup = start.elapsed();
    let mut simulator = Simulator::new(Arc::clone(&compilation.model));
    let mut frames = Vec::new();
    let effort = course::follow(
        &compilation.scene,
        &scene.name,
        &mut simulator,
        |_, frame| {
            frames.push(frame.clone());
            Ok(())
        },
    )?;
    Ok(Finished {
        compilation,
        simulator,
        frames,
        effort,
        setup,
    })
}

/// Nodal fields of a displacement or velocity in the coordinates of the model.
pub fn nodal(compilation: &Compilation, states: &[f64]) -> Result<NodalField, Failure> {
    let field = compilation.field(states).map_err(Failure::of(NAME))?;
    Ok(compilation.body.displacement(&field))
}
