//! Many simulators in one call.

use crate::array::numbers;
use crate::error::raised;
use crate::error::raised_with;
use crate::free::freely;
use crate::simulator::Simulator;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use stickslip::{Error, Result};

/// Steps many simulators by the same step (s), each from its own time, in one call.
///
/// Args:
///     simulators: of one model or of several; none of them twice.
///     step: size of the step, s.
///     inputs: (simulators, inputs): the inputs that are set before. Default: those that are set.
///     threads: number of threads. The results do not depend on it.
///
/// Raises:
///     Error: the failure of the first simulator that failed, by its place. Those that failed stay where they were, all others
///         are stepped.
#[pyfunction]
#[pyo3(signature = (simulators, step, *, inputs=None, threads=1))]
pub fn step_many(
    py: Python<'_>,
    simulators: Vec<Py<Simulator>>,
    step: f64,
    inputs: Option<&Bound<'_, PyAny>>,
    threads: usize,
) -> PyResult<()> {
    let inputs = inputs.map(numbers).transpose()?;
    let mut held = Vec::with_capacity(simulators.len());
    for simulator in &simulators {
        held.push(simulator.get().hold()?);
    }
    let counts = held.iter().map(|one| one.simulator.model().input_count());
    let (expected, counts) = (counts.clone().sum(), counts.collect::<Vec<_>>());
    if let Some(found) = inputs.as_ref().map(Vec::len).filter(|n| *n != expected) {
        return Err(raised(Error::Length {
            what: "inputs of all simulators",
            expected,
            found,
        }));
    }
    if threads == 0 {
        return Err(PyValueError::new_err("threads: expected 1 or more"));
    }
    // a row of inputs for each
    let mut rest = inputs.as_deref();
    let rows = counts.iter().map(|count| {
        let (head, tail) = rest?.split_at(*count);
        rest = Some(tail);
        Some(head)
    });
    let jobs = held.iter_mut().map(|one| &mut one.simulator).zip(rows);
    let jobs: Vec<_> = jobs.map(Mutex::new).collect();
    let failures = freely(py, || on_threads(&jobs, threads.min(jobs.len()), step));
    drop(jobs);
    for one in &mut held {
        one.show(py)?;
    }
    match failures.into_iter().min_by_key(|(place, _)| *place) {
        Some((place, error)) => Err(raised_with(error, Some(format!("simulator {place}: ")))),
        None => Ok(()),
    }
}

type Job<'a> = Mutex<(&'a mut stickslip::Simulator, Option<&'a [f64]>)>;

/// Places and errors of the jobs that failed.
fn on_threads(jobs: &[Job], threads: usize, step: f64) -> Vec<(usize, Error)> {
    let next = AtomicUsize::new(0);
    let failures = Mutex::new(Vec::new());
    let work = || {
        while let Some((place, job)) = {
            let place = next.fetch_add(1, Ordering::Relaxed);
            jobs.get(place).map(|job| (place, job))
        } {
            // every job is taken once: its lock is free
            let Ok(mut job) = job.lock() else { continue };
            if let (Err(error), Ok(mut failures)) = (stepped(&mut job, step), failures.lock()) {
                failures.push((place, error));
            }
        }
    };
    match threads {
        0 | 1 => work(),
        _ => std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(work);
            }
        }),
    }
    failures.into_inner().unwrap_or_default()
}

fn stepped(
    (simulator, inputs): &mut (&mut stickslip::Simulator, Option<&[f64]>),
    step: f64,
) -> Result<()> {
    if let Some(inputs) = inputs {
        simulator.set_inputs(inputs)?;
    }
    simulator.do_step(simulator.time(), step)
}
