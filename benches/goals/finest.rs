//! The paper's finest run (linear elements, h = k = 1/256, all dofs) and a cheaper one: errors at t = 1 s against a run far
//! finer in space and time, and the CPU time of the steps, which is that per second of simulated time.

use super::{Outcome, clock, common};
use common::accuracy::{End, FINE, REFINED};
use common::{paper, started, steps};
use serde_json::{Value, json};
use std::sync::Arc;
use stickslip::{Compilation, Simulator};

/// Time for the runs of the cheap model, s.
const PATIENCE: f64 = 1.0;

/// Ways to step the cheap model: label, communication steps per second, scene.
type Way = (&'static str, u32, &'static [(&'static str, &'static str)]);
const NO_ESTIMATE: (&str, &str) = ("time.error_estimate", "false");
const CHEAP: [Way; 8] = [
    ("k = 1/32", 32, &[]),
    ("k = 1/64", 64, &[]),
    ("k = 1/96", 96, &[]),
    ("k = 1/128", 128, &[]),
    ("tr_bdf2, k = 1/32", 32, &[("time.scheme", "tr_bdf2")]),
    ("tr_bdf2, k = 1/64", 64, &[("time.scheme", "tr_bdf2")]),
    (
        "time.tolerance = 1e-4",
        8,
        &[("time.tolerance", "1e-4"), NO_ESTIMATE],
    ),
    (
        "time.tolerance = 2e-5",
        8,
        &[("time.tolerance", "2e-5"), NO_ESTIMATE],
    ),
];

fn compiled(per_second: u32, more: &[(&str, &str)]) -> (Compilation, Simulator) {
    let step = format!("{:?}", 1.0 / f64::from(per_second));
    let all = [&[("time.step", step.as_str())], more].concat();
    let compilation = Compilation::new(&paper(32, &all)).expect("a scene that compiles");
    let simulator = started(Arc::clone(&compilation.model));
    (compilation, simulator)
}

/// The run from its start; CPU time, s.
fn run(simulator: &mut Simulator, per_second: u32) -> f64 {
    let step = 1.0 / f64::from(per_second);
    clock::timed(|| steps(simulator, step, per_second as usize)).1
}

fn report(end: &End, reference: &End, cpu: f64) -> Value {
    let errors = end.errors(reference);
    json!({
        "cpu_s": cpu,
        "dofs": end.dofs(),
        "states": end.compilation.model.states(),
        "tip": errors.tip,
        "slip_rate": errors.slip_rate,
        "stress": errors.stress,
        "strain": errors.strain,
    })
}

pub fn measure() -> Outcome {
    let (compilation, mut simulator) = compiled(
        1024,
        &[&FINE[..], &[("fidelity.tolerance", "1e-6")]].concat(),
    );
    run(&mut simulator, 1024);
    let reference = End::new(compilation, &simulator);

    let mut out = serde_json::Map::new();
    for start in ["zero", "consistent"] {
        let (compilation, mut simulator) = compiled(
            256,
            &[
                ("mesh.cells", "[256, 128]"),
                ("fidelity.model", "full"),
                ("time.start", start),
            ],
        );
        let cpu = run(&mut simulator, 256);
        let end = End::new(compilation, &simulator);
        out.insert(
            format!("full, {start} start"),
            report(&end, &reference, cpu),
        );
    }
    for (label, per_second, more) in CHEAP {
        let (compilation, mut simulator) = compiled(per_second, &[&REFINED[..], more].concat());
        let start = simulator.state().clone();
        let (mut shortest, mut spent) = (f64::INFINITY, 0.0);
        while spent < PATIENCE {
            simulator.restore(&start)?;
            let begin = std::time::Instant::now();
            run(&mut simulator, per_second);
            let wall = begin.elapsed().as_secs_f64();
            shortest = shortest.min(wall);
            spent += wall;
        }
        let end = End::new(compilation, &simulator);
        out.insert(label.into(), report(&end, &reference, shortest));
    }
    Ok(Value::Object(out))
}
