//! NumPy arrays of 64-bit numbers: made by NumPy, read and written through the buffer protocol.

use pyo3::buffer::PyBuffer;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyFloat, PyTuple};

fn numpy<'py>(
    py: Python<'py>,
    cell: &'static PyOnceLock<Py<PyAny>>,
    name: &str,
) -> PyResult<&'py Bound<'py, PyAny>> {
    cell.import(py, "numpy", name)
}

/// An array of numbers that are not set yet.
fn empty<'py>(py: Python<'py>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    static EMPTY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    numpy(py, &EMPTY, "empty")?.call1((PyTuple::new(py, shape)?,))
}

/// An array with these values, row by row; its shape has a dimension or more.
pub fn array<'py>(py: Python<'py>, values: &[f64], shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let array = empty(py, shape)?;
    if !values.is_empty() {
        PyBuffer::<f64>::get(&array)?.copy_from_slice(py, values)?;
    }
    Ok(array)
}

/// A float for a scalar, an array for all else.
pub fn value<'py>(py: Python<'py>, values: &[f64], shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    match (shape, values) {
        ([], [value]) => Ok(PyFloat::new(py, *value).into_any()),
        _ => array(py, values, shape),
    }
}

/// A matrix of the points of an array, as many components each as `width`.
pub fn points<'py>(
    py: Python<'py>,
    points: &[[f64; 3]],
    width: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let values: Vec<f64> = points.iter().flat_map(|p| p[..width].to_vec()).collect();
    array(py, &values, &[points.len(), width])
}

/// An array of integers, row by row.
pub fn integers<'py>(
    py: Python<'py>,
    values: &[u32],
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    static EMPTY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let options = PyDict::new(py);
    options.set_item("dtype", "int64")?;
    let array = numpy(py, &EMPTY, "empty")?.call((PyTuple::new(py, shape)?,), Some(&options))?;
    if !values.is_empty() {
        let values: Vec<i64> = values.iter().map(|v| i64::from(*v)).collect();
        PyBuffer::<i64>::get(&array)?.copy_from_slice(py, &values)?;
    }
    Ok(array)
}

/// The numbers of a number, a sequence, or an array of any kind, row by row.
pub fn numbers(values: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    if let Ok(value) = values.extract::<f64>() {
        return Ok(vec![value]);
    }
    if let Ok(buffer) = PyBuffer::<f64>::get(values) {
        return buffer.to_vec(values.py());
    }
    static AS_ARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = values.py();
    let array = numpy(py, &AS_ARRAY, "ascontiguousarray")?
        .call1((values, "float64"))
        .map_err(|error| {
            let failure =
                PyValueError::new_err("expected numbers: a float, a sequence or an array");
            failure.set_cause(py, Some(error));
            failure
        })?;
    PyBuffer::<f64>::get(&array)?.to_vec(py)
}

/// An array that is written here and only read by who has it.
pub struct Shown {
    buffer: PyBuffer<f64>,
    /// What is handed out: a view that cannot be written.
    view: Py<PyAny>,
}

impl Shown {
    pub fn new(py: Python<'_>, shape: &[usize]) -> PyResult<Shown> {
        // a buffer of no dimensions has no shape: the view has it
        let array = empty(py, &[shape.iter().product()])?;
        let buffer = PyBuffer::get(&array)?;
        let view = array.call_method1("reshape", (PyTuple::new(py, shape)?,))?;
        view.getattr("flags")?.setattr("writeable", false)?;
        Ok(Shown {
            buffer,
            view: view.unbind(),
        })
    }

    pub fn write(&self, py: Python<'_>, values: &[f64]) -> PyResult<()> {
        self.buffer.copy_from_slice(py, values)
    }

    pub fn view(&self, py: Python<'_>) -> Py<PyAny> {
        self.view.clone_ref(py)
    }
}
