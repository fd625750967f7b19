//! The compiled model: what it is, its ports, its contact, its matrices, and fields on the mesh.

use crate::array::{array, integers, points, value};
use crate::compilation::compiled;
use crate::error::raised;
use crate::free::freely;
use crate::port::Port;
use crate::scene::{Scene, Source};
use crate::state::State;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyString, PyTuple};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use stickslip::fem::Body;
use stickslip::{Compilation, Error, Simulator};

/// A compiled scene: immutable, shared by any number of simulators and threads; made by `compile`. Pickles as its bytes. Two models
/// are equal when their compiled numbers are.
#[pyclass(frozen, module = "stickslip")]
pub struct Model {
    pub inner: Arc<stickslip::Model>,
    /// The scene with its run, and the setting that was picked for a target.
    pub scene: Scene,
    /// References of the ports by name.
    references: HashMap<String, u32>,
    /// The body, for fields; made again where it is asked for and not there.
    body: Mutex<Option<Arc<Compilation>>>,
}

impl Model {
    pub fn new(compilation: Compilation, source: &Scene) -> Model {
        let scene = Scene {
            inner: Arc::new(compilation.scene.clone()),
            source_name: source.source_name.clone(),
            files: Source::Memory(compilation.model.files().clone()),
        };
        let model = Arc::clone(&compilation.model);
        Model::of(model, scene, Some(Arc::new(compilation)))
    }

    fn of(inner: Arc<stickslip::Model>, scene: Scene, body: Option<Arc<Compilation>>) -> Model {
        let ports = inner.ports().all().iter();
        Model {
            references: ports.map(|p| (p.name.clone(), p.reference)).collect(),
            inner,
            scene,
            body: Mutex::new(body),
        }
    }

    /// The reference of the port that a name or a reference means.
    pub fn reference(&self, port: &Bound<'_, PyAny>) -> PyResult<u32> {
        let Ok(name) = port.cast::<PyString>() else {
            return port.extract();
        };
        let name = name.to_cow()?;
        self.references.get(name.as_ref()).copied().ok_or_else(|| {
            raised(Error::Unknown {
                what: "port",
                found: name.into_owned(),
            })
        })
    }

    /// The body. A model that came from bytes has none, and its scene is compiled again.
    pub fn compilation(&self, py: Python<'_>) -> PyResult<Arc<Compilation>> {
        let held = || self.body.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = held().clone();
        if let Some(compilation) = kept {
            return Ok(compilation);
        }
        let compilation = compiled(py, &self.scene, None)?;
        let (expected, found) = (self.inner.fingerprint(), compilation.model.fingerprint());
        if expected != found {
            return Err(raised(Error::Fingerprint { expected, found }));
        }
        let compilation = Arc::new(compilation);
        *held() = Some(Arc::clone(&compilation));
        Ok(compilation)
    }

    /// Displacement or velocity of all nodes, nodes x dimension.
    fn field<'py>(
        &self,
        py: Python<'py>,
        state: &State,
        of: fn(&Compilation, &stickslip::State) -> stickslip::Result<Vec<[f64; 3]>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let compilation = self.compilation(py)?;
        let field = freely(py, || {
            let mut simulator = Simulator::new(Arc::clone(&self.inner));
            state.restore(&mut simulator)?;
            of(&compilation, simulator.state())
        })
        .map_err(raised)?;
        points(py, &field, self.inner.summary().dimension)
    }
}

#[pymethods]
impl Model {
    /// The name of the scene.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.summary().name
    }

    /// The scene it was compiled from, with its run and, for `fidelity.target_error`, the setting that was picked.
    #[getter]
    fn scene(&self) -> Scene {
        self.scene.clone()
    }

    /// Identifies the compiled numbers: states fit models with the same fingerprint.
    #[getter]
    fn fingerprint(&self) -> u64 {
        self.inner.fingerprint()
    }

    /// All ports, in the order of their references.
    #[getter]
    fn ports<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let ports = self.inner.ports().all().iter();
        let ports: PyResult<Vec<_>> = ports.map(|p| Py::new(py, Port(p.clone()))).collect();
        PyTuple::new(py, ports?)
    }

    /// The port of a name or reference.
    ///
    /// Raises:
    ///     Error: `UNKNOWN`.
    fn port(&self, port: &Bound<'_, PyAny>) -> PyResult<Port> {
        let reference = self.reference(port)?;
        let port = self.inner.ports().get(reference).map_err(raised)?;
        Ok(Port(port.clone()))
    }

    /// What was built: sizes, kind of model, relaxation rates (1/s), error of the reduction, largest internal step (s), stability limit
    /// (s, or `None`), bytes.
    ///
    /// >>> import stickslip
    /// >>> info = stickslip.compile("kazmi2014").info
    /// >>> info["model"], info["mesh_nodes"], info["contact_nodes"]
    /// ('reduced', 1073, 32)
    #[getter]
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (model, summary) = (&self.inner, self.inner.summary());
        let info = PyDict::new(py);
        info.set_item("name", &summary.name)?;
        info.set_item("dimension", summary.dimension)?;
        info.set_item("model", kind(summary.kind))?;
        info.set_item("mesh_nodes", summary.mesh_nodes)?;
        info.set_item("mesh_cells", summary.mesh_cells)?;
        info.set_item("contact_nodes", model.contact().node_count())?;
        info.set_item("free_dofs", summary.free_dofs)?;
        info.set_item("dofs_with_multipliers", summary.dofs_with_multipliers)?;
        info.set_item("states", model.states())?;
        info.set_item("rates", (summary.rates[0], summary.rates[1]))?;
        let reduction = summary.reduction.as_ref();
        info.set_item("shifts", reduction.map(|r| r.shifts.clone()))?;
        info.set_item("reduction_error", reduction.map(|r| r.achieved))?;
        info.set_item("fallback", &summary.fallback)?;
        info.set_item("lost_digits", summary.lost_digits)?;
        info.set_item("largest_step", model.largest_step())?;
        info.set_item("stability_limit", model.stability_limit())?;
        info.set_item("model_bytes", summary.bytes)?;
        info.set_item("simulator_bytes", model.simulator_bytes())?;
        info.set_item("state_bytes", model.state_bytes())?;
        let picked = summary.selection.as_ref();
        info.set_item("picked", picked.map(|s| s.changes.clone()))?;
        Ok(info)
    }

    /// What guarantees (or not) that every step has exactly one solution: `is_step_unique`, `is_theorem_satisfied`, and the constants
    /// behind them (docs/theory.md); `largest_pressure` (Pa) up to which a step is proved to have one solution, for Coulomb's law.
    #[getter]
    fn certificate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let c = self.inner.certificate();
        let certificate = PyDict::new(py);
        certificate.set_item("is_step_unique", c.is_step_unique())?;
        certificate.set_item("is_theorem_satisfied", c.is_theorem_satisfied())?;
        certificate.set_item("c0_squared", c.c0_squared)?;
        certificate.set_item("l_g", c.l_g)?;
        certificate.set_item("m_a", c.m_a)?;
        certificate.set_item("sharp_step", c.sharp_step)?;
        certificate.set_item("sharp_instant", c.sharp_instant)?;
        certificate.set_item("margin", c.margin())?;
        let pressure = c.coulomb.as_ref().map(|_| c.largest_pressure());
        certificate.set_item("largest_pressure", pressure)?;
        Ok(certificate)
    }

    /// The contact nodes, in the order of all contact arrays: `node` (nodes,) numbers in the mesh, `position` (nodes, dimension) m,
    /// `weight` (nodes,) m in 2D, m^2 in 3D, `tangent` (nodes, components, dimension) unit vectors; where the scene has them `normal`
    /// (nodes, dimension) from the foundation into the body and `gap` (nodes,) m of the undeformed body.
    #[getter]
    fn contact<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let patch = self.inner.contact();
        let (nodes, dimension) = (patch.node_count(), self.inner.summary().dimension);
        let contact = PyDict::new(py);
        contact.set_item("node", integers(py, &patch.nodes, &[nodes])?)?;
        contact.set_item("position", points(py, &patch.points, dimension)?)?;
        contact.set_item("weight", array(py, &patch.weights, &[nodes])?)?;
        let components = patch.components;
        let tangents: Vec<f64> = patch
            .tangents
            .iter()
            .flat_map(|node| node[..components].iter().flat_map(|t| &t[..dimension]))
            .copied()
            .collect();
        let shape = [nodes, components, dimension];
        contact.set_item("tangent", array(py, &tangents, &shape)?)?;
        if patch.has_normal {
            contact.set_item("normal", points(py, &patch.normals, dimension)?)?;
        }
        if !patch.gaps.is_empty() {
            contact.set_item("gap", array(py, &patch.gaps, &[nodes])?)?;
        }
        Ok(contact)
    }

    /// The matrices of a reduced model, copied; `None` where the whole mesh is kept. In modal coordinates the viscosity is the identity:
    /// `q' = -rates q + contact.T f + outputs.T p`, with `rates` (states,) 1/s, `contact` (states, contact components) and `outputs`
    /// (states, loads + driven directions + probe components).
    ///
    /// >>> import stickslip
    /// >>> matrices = stickslip.compile("kazmi2014").matrices()
    /// >>> matrices["rates"].shape, matrices["contact"].shape
    /// ((114,), (114, 32))
    fn matrices<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(found) = self.inner.matrices() else {
            return Ok(None);
        };
        let states = found.rates.len();
        let of = |values: &[f64]| array(py, values, &[states, values.len() / states.max(1)]);
        let matrices = PyDict::new(py);
        matrices.set_item("rates", array(py, &found.rates, &[states])?)?;
        matrices.set_item("contact", of(&found.contact)?)?;
        matrices.set_item("outputs", of(&found.outputs)?)?;
        Ok(Some(matrices))
    }

    /// A vector over all outputs, as `Simulator.outputs` and the derivatives give it, as values by name: floats and arrays.
    fn unpack<'py>(
        &self,
        py: Python<'py>,
        outputs: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let values = crate::array::numbers(outputs)?;
        let expected = self.inner.ports().output_len();
        if values.len() != expected {
            return Err(raised(Error::Length {
                what: "outputs",
                expected,
                found: values.len(),
            }));
        }
        let unpacked = PyDict::new(py);
        let mut rest = &values[..];
        for port in self.inner.ports().outputs() {
            let (head, tail) = rest.split_at(port.len());
            unpacked.set_item(&port.name, value(py, head, &port.shape)?)?;
            rest = tail;
        }
        Ok(unpacked)
    }

    /// The compiled model as versioned, checksummed bytes; they hold the files that its scene names, and not the run.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.inner.to_bytes())
    }

    /// The model of `to_bytes`, bit for bit.
    ///
    /// Raises:
    ///     Error: `BYTES` for bytes that are no model of this version, or damaged.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Model> {
        let inner = freely(py, || stickslip::Model::from_bytes(bytes)).map_err(raised)?;
        let scene = Scene {
            inner: Arc::new(inner.scene().clone()),
            source_name: inner.summary().name.clone(),
            files: Source::Memory(inner.files().clone()),
        };
        Ok(Model::of(Arc::new(inner), scene, None))
    }

    /// Writes `to_bytes` to a file.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        Ok(std::fs::write(path, self.inner.to_bytes())?)
    }

    /// Reads the model of a file that `save` wrote.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Model> {
        Model::from_bytes(py, &std::fs::read(path)?)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Model>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let restore = slf.get_type().getattr("_restored")?;
        let run = serde_json::to_string(&slf.get().scene.inner.run).unwrap_or_default();
        let arguments = (slf.get().to_bytes(py), run);
        Ok((restore, arguments).into_pyobject(py)?.into_any())
    }

    /// The model of bytes with the run of its scene, which the bytes do not hold.
    #[staticmethod]
    fn _restored(py: Python<'_>, bytes: &[u8], run: String) -> PyResult<Model> {
        let mut model = Model::from_bytes(py, bytes)?;
        let change = [("run".to_owned(), run)];
        model.scene = model.scene.replaced(&change).map_err(raised)?;
        Ok(model)
    }

    /// Displacement of all nodes of the mesh in a state, (mesh nodes, dimension), m, global axes. A model that came from bytes compiles
    /// its scene again for this, once.
    fn displacement<'py>(&self, py: Python<'py>, state: &State) -> PyResult<Bound<'py, PyAny>> {
        self.field(py, state, Compilation::nodal_displacement)
    }

    /// Velocity of all nodes of the mesh in a state, (mesh nodes, dimension), m/s, as `displacement`.
    fn velocity<'py>(&self, py: Python<'py>, state: &State) -> PyResult<Bound<'py, PyAny>> {
        self.field(py, state, Compilation::nodal_velocity)
    }

    /// The mesh: `points` (nodes, dimension) m, `cells` (cells, nodes of a cell), `vtk_type` of the cells, `regions` (names) and
    /// `cell_region` (cells,), `leader` (nodes,), the node that each periodic node follows.
    fn mesh<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let compilation = self.compilation(py)?;
        let Body { mesh, .. } = &compilation.body;
        let found = PyDict::new(py);
        let dimension = mesh.dimension;
        found.set_item("points", points(py, &mesh.nodes, dimension)?)?;
        let shape = [mesh.cell_count(), mesh.element.nodes];
        found.set_item("cells", integers(py, &mesh.cell_nodes, &shape)?)?;
        found.set_item("vtk_type", mesh.element.vtk)?;
        found.set_item("regions", &mesh.regions)?;
        let regions = integers(py, &mesh.cell_regions, &[mesh.cell_count()])?;
        found.set_item("cell_region", regions)?;
        found.set_item("leader", integers(py, &mesh.leader, &[mesh.nodes.len()])?)?;
        Ok(found)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let other = other.cast::<Model>();
        other.is_ok_and(|other| other.get().inner.fingerprint() == self.inner.fingerprint())
    }

    fn __hash__(&self) -> u64 {
        self.inner.fingerprint()
    }

    fn __repr__(&self) -> String {
        let summary = self.inner.summary();
        format!(
            "<Model {:?}: {}, {} states, {} contact nodes>",
            summary.name,
            kind(summary.kind),
            self.inner.states(),
            self.inner.contact().node_count()
        )
    }
}

/// Name of a kind of model, as scenes write it.
fn kind(kind: stickslip::scene::ModelKind) -> String {
    let name = serde_json::to_value(kind).unwrap_or_default();
    name.as_str().unwrap_or_default().to_owned()
}
