//! The run that an FMU carries for comparison: the scene on its own signals, by the calls that an importer makes.

use crate::parameters;
use crate::variables::{Role, Variables};
use std::fmt::Write;
use std::sync::Arc;
use stickslip::scene::Inputs;
use stickslip::simulator::drive::Drive;
use stickslip::{Model, Result, Scene, Simulator};

/// Most communication steps of the run.
const LONGEST: u64 = 1000;

/// Input and output tables, CSV with one row per communication point. Names with a comma are quoted.
pub struct ReferenceRun {
    pub inputs: String,
    pub outputs: String,
    /// Communication step.
    pub step: f64,
    /// End of the run: that of the scene's own, or earlier where that is longer than a thousand steps.
    pub until: f64,
    /// Whether the inputs of a row were set before the step that ends at its time, not before the one that begins there.
    pub is_set_at_end: bool,
}

/// Runs a scene on its model: a row of inputs holds the loads at its time, which are set before the step that begins there (or,
/// where inputs mean the end of a step, that ends there).
///
/// # Errors
/// Those of the simulator.
pub fn reference_run(scene: &Scene, model: &Arc<Model>) -> Result<ReferenceRun> {
    let variables = Variables::new(model);
    let header = |role: Role| -> String {
        let mut line = "time".to_owned();
        for variable in variables.all().iter().filter(|v| v.role == role) {
            for name in variable.element_names() {
                let quote = if name.contains(',') { "\"" } else { "" };
                let _ = write!(line, ",{quote}{name}{quote}");
            }
        }
        line + "\n"
    };
    let (mut inputs, mut outputs) = (header(Role::Input), header(Role::Output));
    let mut simulator = Simulator::new(Arc::clone(model));
    simulator.set_inputs_meaning(parameters::inputs_meaning(
        &variables.parameters().values(scene),
    ))?;
    let mut values = vec![0.0; simulator.output_len()];
    let mut drive = Drive::start(scene, &mut simulator)?;
    let step = drive.points().step;
    let mut until = drive.simulator().time();
    for n in 0..=LONGEST {
        if n > 0 && drive.step_as_master()?.is_none() {
            break;
        }
        drive.simulator().get_outputs(&mut values)?;
        let time = drive.points().at(n);
        until = time;
        let row = drive.loads_at(time).to_vec();
        for (text, row) in [(&mut inputs, &row), (&mut outputs, &values)] {
            let _ = write!(text, "{time:?}");
            for value in row {
                let _ = write!(text, ",{value:?}");
            }
            text.push('\n');
        }
    }
    Ok(ReferenceRun {
        inputs,
        outputs,
        step,
        until,
        is_set_at_end: simulator.inputs_meaning() == Inputs::EndOfStep,
    })
}
