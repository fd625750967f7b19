//! The scene.

use crate::error::raised;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyTypeError, PyUnicodeDecodeError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyDict, PyString};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stickslip::{Error, Files, Folder, MemoryFiles};

/// Where the files are that a scene names.
#[derive(Clone)]
pub enum Source {
    Folder(PathBuf),
    Memory(MemoryFiles),
}

impl Files for Source {
    fn read(&self, name: &str) -> Result<Arc<[u8]>, String> {
        match self {
            Source::Folder(folder) => Folder(folder.clone()).read(name),
            Source::Memory(files) => files.read(name),
        }
    }
}

/// A scene: the validated content of `scene.json`. Immutable; two scenes are equal when their contents are.
///
/// Args:
///     source: a scene, a dict, JSON text, the path of a file, or the name of an embedded example (a file of that name wins).
///     name: what errors call the scene. Default: the path or the name that was given, or "scene".
///     folder: where the files are that the scene names (its mesh). Default: the folder of the file, or the current one.
///     files: the contents of these files instead, by name.
///
/// Raises:
///     Error: for the first mistake, with the JSON path, what was found there and what is allowed.
///     OSError: for a file that cannot be read.
///
/// >>> import stickslip
/// >>> scene = stickslip.Scene("kazmi2014")
/// >>> scene.name, scene.inputs
/// ('kazmi2014', {'press': -0.3})
/// >>> stickslip.Scene(scene.to_dict()) == scene
/// True
#[pyclass(frozen, module = "stickslip")]
#[derive(Clone)]
pub struct Scene {
    pub inner: Arc<stickslip::Scene>,
    /// What errors call it.
    pub source_name: String,
    pub files: Source,
}

impl Scene {
    /// The scene that a Python object means: a scene, a dict, JSON text, a file, an example.
    pub fn of(source: &Bound<'_, PyAny>) -> PyResult<Scene> {
        Scene::new(source, None, None, None)
    }

    pub fn replaced(&self, changes: &[(String, String)]) -> stickslip::Result<Scene> {
        let text = self.inner.to_json();
        let scene = stickslip::Scene::with_overrides(&text, &self.source_name, changes)?;
        Ok(Scene {
            inner: Arc::new(scene),
            ..self.clone()
        })
    }
}

/// JSON of a Python value; NumPy's numbers and arrays, tuples and paths are understood.
pub fn json_of(value: &Bound<'_, PyAny>) -> PyResult<String> {
    static DUMPS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let dumps = DUMPS.import(value.py(), "stickslip._json", "dumps")?;
    dumps.call1((value,))?.extract()
}

/// The Python value of JSON.
pub fn python_of<'py>(py: Python<'py>, json: &str) -> PyResult<Bound<'py, PyAny>> {
    static LOADS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    LOADS.import(py, "json", "loads")?.call1((json,))
}

/// Pairs of paths and JSON values of a dict and keywords; in a keyword `__` stands for the dot.
pub fn changes_of(
    changes: Option<&Bound<'_, PyDict>>,
    keywords: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<(String, String)>> {
    let mut all = Vec::new();
    for (dict, is_keyword) in [(changes, false), (keywords, true)] {
        for (path, value) in dict.iter().flat_map(|dict| dict.iter()) {
            let path: String = path.extract()?;
            let path = match is_keyword {
                true => path.replace("__", "."),
                false => path,
            };
            all.push((path, json_of(&value)?));
        }
    }
    Ok(all)
}

fn text_of(path: &Path, py: Python<'_>) -> PyResult<String> {
    let bytes = std::fs::read(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => {
            PyFileNotFoundError::new_err(format!("{}: {error}", path.display()))
        }
        _ => PyOSError::new_err(format!("{}: {error}", path.display())),
    })?;
    match String::from_utf8(bytes) {
        Ok(text) => Ok(text),
        Err(error) => Err(PyErr::from_value(
            PyUnicodeDecodeError::new_utf8(py, error.as_bytes(), error.utf8_error())?.into_any(),
        )),
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (source, *, name=None, folder=None, files=None))]
    fn new(
        source: &Bound<'_, PyAny>,
        name: Option<String>,
        folder: Option<PathBuf>,
        files: Option<BTreeMap<String, Vec<u8>>>,
    ) -> PyResult<Scene> {
        if let Ok(scene) = source.cast::<Scene>() {
            return Ok(scene.get().clone());
        }
        let py = source.py();
        let of_text = |text: &str, default: &str, place: PathBuf| {
            let source_name = name.clone().unwrap_or_else(|| default.to_owned());
            let inner = stickslip::Scene::from_json(text, &source_name).map_err(raised)?;
            let files = match &files {
                Some(files) => {
                    let files = files.iter();
                    let files = files.map(|(name, bytes)| (name.clone(), bytes[..].into()));
                    Source::Memory(MemoryFiles(files.collect()))
                }
                None => Source::Folder(folder.clone().unwrap_or(place)),
            };
            Ok(Scene {
                inner: Arc::new(inner),
                source_name,
                files,
            })
        };
        let of_file = |path: &Path| {
            let text = text_of(path, py)?;
            let place = Folder::of(path).0;
            of_text(&text, &path.to_string_lossy(), place)
        };
        if source.is_instance_of::<PyDict>() {
            return of_text(&json_of(source)?, "scene", PathBuf::new());
        }
        let Ok(text) = source.cast::<PyString>() else {
            return match source.extract::<PathBuf>() {
                Ok(path) => of_file(&path),
                Err(_) => Err(PyTypeError::new_err(
                    "a scene is a dict, JSON text, the path of a file or the name of an example",
                )),
            };
        };
        let text: String = text.extract()?;
        // a byte-order mark is skipped by the parser
        if text
            .trim_start_matches('\u{feff}')
            .trim_start()
            .starts_with('{')
        {
            return of_text(&text, "scene", PathBuf::new());
        }
        let path = Path::new(&text);
        match stickslip::scene::example(&text) {
            Some(example) if !path.is_file() => of_text(example, &text, PathBuf::new()),
            None if !path.exists() => {
                let names: Vec<_> = stickslip::scene::example_names().collect();
                Err(PyFileNotFoundError::new_err(format!(
                    "{}: neither a file nor an embedded example ({})",
                    stickslip::message::cut(&text),
                    names.join(", ")
                )))
            }
            _ => of_file(path),
        }
    }

    /// What pickling carries: the scene, and the bytes of the files that it names.
    fn __reduce__<'py>(slf: &Bound<'py, Scene>) -> PyResult<Bound<'py, PyAny>> {
        let (py, scene) = (slf.py(), slf.get());
        let files = PyDict::new(py);
        if let Some(name) = scene.inner.mesh.file() {
            let bytes = scene.files.read(name).map_err(|why| {
                raised(Error::Scene {
                    source_name: scene.source_name.clone(),
                    path: "mesh.file".to_owned(),
                    found: why,
                    allowed: "a file that can be read".to_owned(),
                })
            })?;
            files.set_item(name, PyBytes::new(py, &bytes))?;
        }
        let arguments = (scene.inner.to_json(), &scene.source_name, files);
        let restore = slf.get_type().getattr("_restored")?;
        Ok((restore, arguments).into_pyobject(py)?.into_any())
    }

    #[staticmethod]
    fn _restored(
        text: &str,
        source_name: &str,
        files: BTreeMap<String, Vec<u8>>,
    ) -> PyResult<Scene> {
        let inner = stickslip::Scene::from_json(text, source_name).map_err(raised)?;
        let files = files.into_iter();
        let files = files.map(|(name, bytes)| (name, bytes.into()));
        Ok(Scene {
            inner: Arc::new(inner),
            source_name: source_name.to_owned(),
            files: Source::Memory(MemoryFiles(files.collect())),
        })
    }

    /// The scene with values replaced: `{path: value}`, or keywords in which `__` stands for the dot. Applied in order.
    ///
    /// Raises:
    ///     Error: for a path that leads through something that is not there, and for a scene that is not valid then.
    ///
    /// >>> import stickslip
    /// >>> scene = stickslip.Scene("kazmi2014").with_({"loads[0].start": -0.2}, contact__friction__alpha=50)
    /// >>> scene["contact.friction.alpha"], scene["loads[0].start"]
    /// (50.0, -0.2)
    #[pyo3(signature = (changes=None, /, **keywords))]
    fn with_(
        &self,
        changes: Option<&Bound<'_, PyDict>>,
        keywords: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Scene> {
        self.replaced(&changes_of(changes, keywords)?)
            .map_err(raised)
    }

    /// The name of the scene.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// Names and start values of the inputs, in their order: loads, driven directions, motions of the foundation.
    #[getter]
    fn inputs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let inputs = PyDict::new(py);
        for (name, start) in self.inner.inputs() {
            inputs.set_item(name, start)?;
        }
        Ok(inputs)
    }

    /// The scene as JSON text, defaults written out.
    fn to_json(&self) -> String {
        self.inner.to_json()
    }

    /// The scene as a dict, defaults written out.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        python_of(py, &self.inner.to_json())
    }

    /// The value at a path, as plain Python.
    ///
    /// Raises:
    ///     Error: (`UNKNOWN`) for a path that leads nowhere.
    fn __getitem__<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        let json: Value = serde_json::to_value(self.inner.as_ref()).unwrap_or(Value::Null);
        let pointer = path.replace(']', "").replace(['.', '['], "/");
        match json.pointer(&format!("/{pointer}")) {
            Some(value) => python_of(py, &value.to_string()),
            None => Err(raised(Error::Unknown {
                what: "path of the scene",
                found: path.to_owned(),
            })),
        }
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let other = other.cast::<Scene>();
        other.is_ok_and(|other| other.get().inner == self.inner)
    }

    fn __repr__(&self) -> String {
        format!("<Scene {:?}>", self.inner.name)
    }
}

/// Names of the embedded examples.
#[pyfunction]
pub fn example_names() -> Vec<&'static str> {
    stickslip::scene::example_names().collect()
}

/// The JSON Schema of scenes, as text.
#[pyfunction]
pub fn json_schema() -> String {
    stickslip::scene::json_schema()
}
