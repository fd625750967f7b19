//! The run of a scene, recorded.

use crate::array::array;
use crate::error::raised;
use crate::free::freely;
use crate::model::Model;
use crate::scene::Scene;
use crate::simulator::Simulator;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;
use std::time::{Duration, Instant};
use stickslip::Compilation;
use stickslip::simulator::drive::Drive;

/// How often signals and progress have their turn.
const TURN: Duration = Duration::from_millis(50);

/// What is recorded of one port.
struct Column {
    reference: u32,
    shape: Vec<usize>,
    values: Vec<f64>,
}

/// What is recorded.
struct Record {
    times: Vec<f64>,
    columns: Vec<Column>,
    /// Displacement and velocity of all nodes, where they are asked for.
    fields: [Vec<f64>; 2],
}

impl Record {
    fn add(
        &mut self,
        simulator: &stickslip::Simulator,
        compilation: Option<&Compilation>,
    ) -> stickslip::Result<()> {
        self.times.push(simulator.time());
        for column in &mut self.columns {
            let from = column.values.len();
            let len: usize = column.shape.iter().product();
            column.values.resize(from + len, 0.0);
            simulator.get(column.reference, &mut column.values[from..])?;
        }
        let Some(compilation) = compilation else {
            return Ok(());
        };
        let dimension = compilation.model.summary().dimension;
        let state = simulator.state();
        let displacement = compilation.nodal_displacement(state)?;
        let velocity = compilation.nodal_velocity(state)?;
        for (to, field) in self.fields.iter_mut().zip([displacement, velocity]) {
            to.extend(field.iter().flat_map(|v| &v[..dimension]));
        }
        Ok(())
    }
}

/// Steps a simulator through the run of `scene` (its own or another one of the same inputs) and returns the times, the values of
/// the ports by name and, with `fields`, displacement and velocity of all nodes. A simulator that is initialized goes on from
/// where it stands; its first row is the point where it stands. `progress` is called with the points passed and their number.
#[pyfunction]
#[pyo3(signature = (simulator, scene, ports, *, fields=false, progress=None))]
pub fn follow<'py>(
    py: Python<'py>,
    simulator: &Simulator,
    scene: &Scene,
    ports: Vec<Bound<'py, PyAny>>,
    fields: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let model: Py<Model> = simulator.model_of(py);
    let model = model.get();
    let columns = ports.iter().map(|port| {
        let reference = model.reference(port)?;
        let port = model.inner.ports().get(reference).map_err(raised)?;
        Ok(Column {
            reference,
            shape: port.shape.clone(),
            values: Vec::new(),
        })
    });
    let mut record = Record {
        times: Vec::new(),
        columns: columns.collect::<PyResult<_>>()?,
        fields: [Vec::new(), Vec::new()],
    };
    let compilation: Option<Arc<Compilation>> = match fields {
        true => Some(model.compilation(py)?),
        false => None,
    };
    let mut held = simulator.hold()?;
    let inner = &mut held.simulator;
    freely(py, || -> PyResult<()> {
        let compilation = compilation.as_deref();
        let mut drive = match inner.is_initialized() {
            true => Drive::resume(&scene.inner, inner),
            false => Drive::start(&scene.inner, inner),
        }
        .map_err(raised)?;
        let count = drive.points().count;
        record.add(drive.simulator(), compilation).map_err(raised)?;
        let mut turn = Instant::now();
        while let Some(simulator) = drive.step().map_err(raised)? {
            record.add(simulator, compilation).map_err(raised)?;
            let is_last = drive.passed() == count;
            if is_last || turn.elapsed() >= TURN {
                tell(progress.as_ref(), drive.passed(), count)?;
                turn = Instant::now();
            }
        }
        Ok(())
    })?;
    held.show(py)?;
    drop(held);

    let rows = record.times.len();
    let recorded = PyDict::new(py);
    recorded.set_item("time", array(py, &record.times, &[rows])?)?;
    for (port, column) in ports.iter().zip(&record.columns) {
        let shape = [&[rows], &column.shape[..]].concat();
        recorded.set_item(port, array(py, &column.values, &shape)?)?;
    }
    if fields {
        let (nodes, dimension) = (
            model.inner.summary().mesh_nodes,
            model.inner.summary().dimension,
        );
        for (name, values) in ["displacement", "velocity"].iter().zip(&record.fields) {
            recorded.set_item(name, array(py, values, &[rows, nodes, dimension])?)?;
        }
    }
    Ok(recorded)
}

fn tell(progress: Option<&Py<PyAny>>, passed: u64, count: u64) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        match progress {
            Some(progress) => progress.call1(py, (passed, count)).map(drop),
            None => Ok(()),
        }
    })
}
