//! Vectors that a caller gives whole, or by the names of some of their ports.

use crate::array::numbers;
use crate::error::raised;
use crate::model::Model;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::{Error, Simulator};

/// The values of all inputs: those of a sequence, or those that a dict gives beside those that are set.
pub fn inputs(
    model: &Model,
    simulator: &Simulator,
    values: &Bound<'_, PyAny>,
) -> PyResult<Vec<f64>> {
    let Ok(dict) = values.cast::<PyDict>() else {
        return numbers(values);
    };
    let mut all = vec![0.0; model.inner.input_count()];
    for (i, value) in all.iter_mut().enumerate() {
        let into = std::slice::from_mut(value);
        simulator.get(i as u32, into).map_err(raised)?;
    }
    for (name, value) in dict.iter() {
        let reference = model.reference(&name)? as usize;
        let Some(to) = all.get_mut(reference) else {
            return Err(raised(Error::Unknown {
                what: "input",
                found: name.str()?.to_string(),
            }));
        };
        *to = value.extract()?;
    }
    Ok(all)
}

/// One number per input; a dict leaves the others zero.
pub fn input_seed(model: &Model, seed: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let Ok(dict) = seed.cast::<PyDict>() else {
        return numbers(seed);
    };
    let mut all = vec![0.0; model.inner.input_count()];
    for (name, value) in dict.iter() {
        let to = all.get_mut(model.reference(&name)? as usize);
        let to = to.ok_or_else(|| PyKeyError::new_err("not an input"))?;
        *to = value.extract()?;
    }
    Ok(all)
}

/// One number per output, of which there are so many; a dict leaves the others zero.
pub fn outputs(model: &Model, count: usize, seed: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let Ok(dict) = seed.cast::<PyDict>() else {
        return numbers(seed);
    };
    let mut all = vec![0.0; count];
    for (name, value) in dict.iter() {
        let (reference, values) = (model.reference(&name)?, numbers(&value)?);
        let mut at = 0;
        let mut outputs = model.inner.ports().outputs();
        let port = outputs.find(|port| {
            let is_it = port.reference == reference;
            at += if is_it { 0 } else { port.len() };
            is_it
        });
        let port = port.ok_or_else(|| PyKeyError::new_err("not an output"))?;
        if values.len() != port.len() {
            return Err(raised(Error::Length {
                what: "values of the port",
                expected: port.len(),
                found: values.len(),
            }));
        }
        all[at..at + port.len()].copy_from_slice(&values);
    }
    Ok(all)
}
