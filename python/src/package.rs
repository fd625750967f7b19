//! Packs FMUs.

use crate::error::raised;
use crate::free::freely;
use crate::scene::Scene;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::PathBuf;
use stickslip_fmu::{FmiVersion, Options, PackageError, package};

/// See `stickslip.pack_fmu`.
#[pyfunction]
#[pyo3(signature = (scene, *, fmi=3, scalar=false, library=None))]
pub fn pack_fmu<'py>(
    scene: &Bound<'py, PyAny>,
    fmi: u32,
    scalar: bool,
    library: Option<PathBuf>,
) -> PyResult<Bound<'py, PyDict>> {
    let py = scene.py();
    let scene = Scene::of(scene)?;
    let version = match (fmi, scalar) {
        (2, true) => return Err(PyValueError::new_err("scalar: FMI 2 has no arrays")),
        (2, false) => FmiVersion::Fmi2,
        (3, _) => FmiVersion::Fmi3,
        _ => {
            return Err(PyValueError::new_err(format!(
                "fmi: found {fmi}, allowed: 2, 3"
            )));
        }
    };
    let options = Options {
        version,
        is_scalar: scalar,
        library,
        source_name: scene.source_name.clone(),
    };
    let text = scene.inner.to_json();
    let packed =
        freely(py, || package(&text, &scene.files, &options)).map_err(|error| match error {
            PackageError::Scene(error) => raised(error),
            PackageError::NoLibrary(_) => PyFileNotFoundError::new_err(error.to_string()),
            PackageError::TestLibrary(_) | PackageError::Date(_) => {
                PyValueError::new_err(error.to_string())
            }
            PackageError::Io(..) => PyOSError::new_err(error.to_string()),
        })?;
    let found = PyDict::new(py);
    found.set_item("bytes", PyBytes::new(py, &packed.bytes))?;
    found.set_item("library", packed.library)?;
    found.set_item("glibc", packed.glibc)?;
    Ok(found)
}
