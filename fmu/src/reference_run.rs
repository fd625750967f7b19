//! The run that an FMU carries for comparison: the scene on its own signals, through the same simulator.

use crate::variables::{Role, Variables};
use std::fmt::Write;
use std::sync::Arc;
use stickslip::scene::Signal;
use stickslip::{Model, Result, Simulator};

/// Most communication steps of the run.
const LONGEST: f64 = 1000.0;

/// Input and output tables, CSV with one row per communication point. Names with a comma are quoted.
pub struct ReferenceRun {
    pub inputs: String,
    pub outputs: String,
    /// Communication step.
    pub step: f64,
    /// End of the run.
    pub until: f64,
}

/// Runs the scene of a model: the inputs of a row are those that hold at its time.
///
/// # Errors
/// Those of the simulator.
pub fn reference_run(model: &Arc<Model>) -> Result<ReferenceRun> {
    let scene = model.scene();
    let variables = Variables::new(model);
    let step = scene.run.step.unwrap_or(scene.time.step);
    let count = (scene.run.until / step).round().clamp(1.0, LONGEST) as usize;
    let inputs_at = |t: f64| -> Vec<f64> {
        let value = |load: &stickslip::scene::Load| {
            let signal = scene.run.signals.get(&load.name);
            signal.unwrap_or(&Signal::Constant(load.start)).at(t)
        };
        scene.loads.iter().map(value).collect()
    };
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
    let mut values = vec![0.0; simulator.output_len()];
    for i in 0..=count {
        let time = i as f64 * step;
        let row = inputs_at(time);
        simulator.set_inputs(&row)?;
        if i == 0 {
            simulator.init(0.0)?;
        } else {
            simulator.do_step(time - step, step)?;
        }
        simulator.get_outputs(&mut values)?;
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
        until: count as f64 * step,
    })
}
