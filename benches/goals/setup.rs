//! Set-up, and loading what it made.

use super::{Outcome, clock};
use serde_json::json;
use std::time::{Duration, Instant};
use stickslip::{Model, Scene};

/// Compiles once: CPU time and peak memory; the bytes into `file`.
pub fn compile(scene: &Scene, file: Option<&str>) -> Outcome {
    let (model, cpu) = clock::timed(|| stickslip::compile(scene));
    let (model, peak) = (model?, clock::peak_memory());
    let bytes = model.to_bytes();
    if let Some(file) = file {
        std::fs::write(file, &bytes)?;
    }
    let summary = model.summary();
    Ok(json!({
        "cpu_s": cpu,
        "peak_mb": peak,
        "contact": model.contact().len(),
        "states": model.states(),
        "free_dofs": summary.free_dofs,
        "bytes": bytes.len(),
        "shifts": summary.reduction.as_ref().map(|r| r.shifts.len()),
        "achieved": summary.reduction.as_ref().map(|r| r.achieved),
    }))
}

/// Reads a file and makes a model of it: the first time, and the shortest of many.
pub fn load(file: &str) -> Outcome {
    let load = || -> Result<(), Box<dyn std::error::Error>> {
        std::hint::black_box(Model::from_bytes(&std::fs::read(file)?)?);
        Ok(())
    };
    let start = Instant::now();
    load()?;
    let first = start.elapsed();
    let shortest = clock::shortest(Duration::from_millis(500), 1, || {
        load().expect("what loaded once");
    });
    Ok(json!({
        "bytes": std::fs::metadata(file)?.len(),
        "first_ms": 1e3 * first.as_secs_f64(),
        "shortest_ms": 1e-3 * shortest,
    }))
}
