//! `stickslip.compile`.

use crate::compilation::compiled;
use crate::model::Model;
use crate::scene::Scene;
use pyo3::prelude::*;

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
