//! Sweeps: those of the command, with their rows as arrays.

use crate::array::array;
use crate::error::raised;
use crate::free::freely;
use crate::scene::Scene;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use stickslip_cli::failure::Failure;
use stickslip_cli::sweep::{self as sweeps, Axis, Course, Plan, Sampling, Study};

/// How often signals and progress have their turn.
const TURN: Duration = Duration::from_millis(50);

/// The course of an axis: values as JSON, or what the command takes after the path.
#[derive(FromPyObject)]
pub enum Given {
    Text(String),
    Values(Vec<String>),
}

fn failed(failure: Failure) -> PyErr {
    match failure {
        Failure::Library { error, .. } => raised(*error),
        Failure::File { .. } => PyOSError::new_err(failure.to_string()),
        _ => PyValueError::new_err(failure.to_string()),
    }
}

/// See `stickslip.sweep`. Columns by name, those of the axes first: arrays, or lists of text.
#[pyfunction]
#[pyo3(signature = (scene, vary, *, sampling, runs, seed, record, workers, table, resume, write, progress))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn sweep<'py>(
    py: Python<'py>,
    scene: &Scene,
    vary: Vec<(String, Given)>,
    sampling: &str,
    runs: Option<usize>,
    seed: u32,
    record: Vec<String>,
    workers: Option<usize>,
    table: Option<PathBuf>,
    resume: bool,
    write: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let axes = vary.into_iter().map(|(path, given)| match given {
        Given::Text(text) => Axis::parse(&format!("{path}={text}")),
        Given::Values(values) => Axis::new(&path, Course::Values(values)),
    });
    let axes: Vec<Axis> = axes.collect::<stickslip::Result<_>>().map_err(raised)?;
    let sampling = Sampling::of(sampling).map_err(raised)?;
    let plan = Plan::new(&axes, sampling, runs, seed).map_err(raised)?;
    let mut failure: Option<PyErr> = None;
    let (study, rows) = freely(py, || -> Result<_, Failure> {
        let files = Box::new(scene.files.clone());
        let name = &scene.source_name;
        let study = Study::new(&scene.inner, name, files, plan, &record);
        let study = study.map_err(Failure::of(name))?;
        let mut turn: Option<Instant> = None;
        let rows = sweeps::take(
            &study,
            workers,
            table.as_deref(),
            resume,
            &mut |done, of| {
                if done < of && turn.is_some_and(|turn| turn.elapsed() < TURN) {
                    return ControlFlow::Continue(());
                }
                turn = Some(Instant::now());
                match tell(progress.as_ref(), done, of) {
                    Ok(()) => ControlFlow::Continue(()),
                    Err(error) => {
                        failure = Some(error);
                        ControlFlow::Break(())
                    }
                }
            },
        )?;
        if let Some(table) = table.as_ref().filter(|_| write) {
            sweeps::write(table, &study, &rows)?;
        }
        Ok((study, rows))
    })
    .map_err(|other| failure.take().unwrap_or_else(|| failed(other)))?;
    if let Some(error) = failure {
        return Err(error);
    }
    let columns = PyDict::new(py);
    for (i, path) in study.plan.paths.iter().enumerate() {
        match study.axis(i) {
            Ok(numbers) => columns.set_item(path, array(py, &numbers, &[rows.len()])?)?,
            Err(texts) => columns.set_item(path, texts)?,
        }
    }
    for (i, name) in study.record.columns().iter().enumerate() {
        let values: Vec<f64> = rows.iter().map(|row| row.values[i]).collect();
        columns.set_item(name, array(py, &values, &[rows.len()])?)?;
    }
    let errors: Vec<_> = rows.iter().map(|row| row.error.as_deref()).collect();
    columns.set_item("error", errors)?;
    Ok(columns)
}

fn tell(progress: Option<&Py<PyAny>>, done: usize, of: usize) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        match progress {
            Some(progress) => progress.call1(py, (done, of)).map(drop),
            None => Ok(()),
        }
    })
}
