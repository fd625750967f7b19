//! Compilation, with its progress, without the lock of the interpreter.

use crate::error::raised;
use crate::free::freely;
use crate::model::Model;
use crate::scene::Scene;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use stickslip::Compilation;
use stickslip::model::Progress;

/// Compiles a scene: meshes, assembles, reduces and certifies. The interpreter is free for other threads meanwhile.
///
/// Args:
///     scene: a `Scene`, or what `Scene` takes.
///     progress: called some tens of times with the phase (text) and the fraction done (0 to 1). When it returns a false value
///         other than `None`, the compilation stops.
///
/// Raises:
///     Error: `SCENE`, `BODY`, `REDUCTION_INACCURATE` and so on; `CANCELLED` when `progress` stopped it. What `progress` raises,
///         and `KeyboardInterrupt`, stop it too and come out here.
///
/// >>> import stickslip
/// >>> stickslip.compile("kazmi2014")
/// <Model "kazmi2014": reduced, 114 states, 32 contact nodes>
#[pyfunction]
#[pyo3(signature = (scene, *, progress=None))]
pub fn compile(scene: &Bound<'_, PyAny>, progress: Option<Py<PyAny>>) -> PyResult<Model> {
    let py = scene.py();
    let scene = Scene::of(scene)?;
    let compilation = compiled(py, &scene, progress)?;
    Ok(Model::new(compilation, &scene))
}

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
