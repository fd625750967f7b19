//! Compilation with its progress, without the lock of the interpreter.

use crate::error::raised;
use crate::free::freely;
use crate::scene::Scene;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use stickslip::Compilation;
use stickslip::model::Progress;

/// The compilation of a scene.
pub fn compiled(
    py: Python<'_>,
    scene: &Scene,
    progress: Option<Py<PyAny>>,
) -> PyResult<Compilation> {
    let mut failure: Option<PyErr> = None;
    let outcome = freely(py, || {
        let mut observer = |now: Progress| {
            Python::attach(|py| match tell(py, progress.as_ref(), now) {
                Ok(true) => ControlFlow::Continue(()),
                Ok(false) => ControlFlow::Break(()),
                Err(error) => {
                    failure = Some(error);
                    ControlFlow::Break(())
                }
            })
        };
        Compilation::with(&scene.inner, &scene.files, &mut observer)
    });
    match failure {
        Some(error) => Err(error),
        None => outcome.map_err(raised),
    }
}

/// Whether the compilation goes on.
fn tell(py: Python<'_>, progress: Option<&Py<PyAny>>, now: Progress) -> PyResult<bool> {
    py.check_signals()?;
    let Some(progress) = progress else {
        return Ok(true);
    };
    let answer = progress.call1(py, (now.phase.name(), now.fraction))?;
    let answer = answer.bind(py);
    Ok(answer.is_none() || answer.is_truthy()?)
}
