//! The simulator: one simulation, used by one thread at a time.

use crate::array::{Shown, array, numbers, value};
use crate::error::raised;
use crate::free::freely;
use crate::given;
use crate::held::{Held, Inner};
use crate::model::Model;
use crate::state::{Kept, State};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use std::sync::{Arc, Mutex};
use stickslip::Error;
use stickslip::scene::Inputs;

/// One simulation of a model, stepped by its master. Inputs are those at the end of the next step, unless `inputs` or the scene says
/// otherwise. A call that fails changes nothing. One thread at a time: a call that finds the simulator in use by another thread raises
/// `Error` (`CALL_ORDER`); simulators of one model run in parallel on threads of their own.
///
/// Args:
///     model: the compiled scene.
///     inputs: what an input means, "end_of_step", "hold" or "continue". Default: `time.inputs` of the scene, or "end_of_step".
///
/// >>> import stickslip
/// >>> simulator = stickslip.Simulator(stickslip.compile("kazmi2014"))
/// >>> simulator.init()
/// >>> for _ in range(32):
/// ...     simulator["press"] = -0.3  # Pa, at the end of the step
/// ...     simulator.step(1 / 32)
/// >>> round(float(simulator["tip.displacement"][0]), 4)  # m
/// 0.1186
#[pyclass(frozen, module = "stickslip")]
pub struct Simulator {
    model: Py<Model>,
    inner: Mutex<Inner>,
}

impl Simulator {
    /// What a call works with, unless another thread does.
    pub fn hold(&self) -> PyResult<Held<'_>> {
        Held::of(&self.inner)
    }

    pub fn model_of(&self, py: Python<'_>) -> Py<Model> {
        self.model.clone_ref(py)
    }

    fn of(model: Py<Model>, simulator: stickslip::Simulator) -> Simulator {
        Simulator {
            model,
            inner: Mutex::new(Inner::new(simulator)),
        }
    }

    /// Calls the simulator without the lock of the interpreter, and then brings what is shown up to date.
    fn change(
        &self,
        py: Python<'_>,
        call: impl FnOnce(&mut stickslip::Simulator) -> stickslip::Result<()> + Send,
    ) -> PyResult<()> {
        let mut inner = self.hold()?;
        let Inner { simulator, .. } = &mut *inner;
        freely(py, || call(simulator)).map_err(raised)?;
        inner.show(py)
    }

    fn reference(&self, port: &Bound<'_, PyAny>) -> PyResult<u32> {
        self.model.get().reference(port)
    }

    /// A derivative along a seed: the values of inputs (of outputs for the adjoint), all of them or some by name.
    fn derivative<'py>(
        &self,
        py: Python<'py>,
        seed: &Bound<'py, PyAny>,
        is_adjoint: bool,
        instant: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut inner = self.hold()?;
        let simulator = &mut inner.simulator;
        let seed = match is_adjoint {
            true => given::outputs(self.model.get(), simulator.output_len(), seed)?,
            false => given::input_seed(self.model.get(), seed)?,
        };
        let len = match is_adjoint {
            true => simulator.model().input_count(),
            false => simulator.output_len(),
        };
        let mut out = vec![0.0; len];
        freely(py, || match (is_adjoint, instant) {
            (false, false) => simulator.directional_derivative(&seed, &mut out),
            (false, true) => simulator.instant_derivative(&seed, &mut out),
            (true, false) => simulator.adjoint_derivative(&seed, &mut out),
            (true, true) => simulator.instant_adjoint(&seed, &mut out),
        })
        .map_err(raised)?;
        array(py, &out, &[len])
    }
}

#[pymethods]
impl Simulator {
    #[new]
    #[pyo3(signature = (model, *, inputs=None))]
    fn new(model: Py<Model>, inputs: Option<&str>) -> PyResult<Simulator> {
        let mut simulator = stickslip::Simulator::new(Arc::clone(&model.get().inner));
        if let Some(word) = inputs {
            let meaning: Inputs = serde_json::from_value(word.into()).map_err(|_| {
                raised(Error::Scene {
                    source_name: "Simulator".to_owned(),
                    path: "inputs".to_owned(),
                    found: format!("{word:?}"),
                    allowed: "\"end_of_step\", \"hold\", \"continue\"".to_owned(),
                })
            })?;
            simulator.set_inputs_meaning(meaning).map_err(raised)?;
        }
        Ok(Simulator::of(model, simulator))
    }

    /// The model.
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<Model> {
        self.model_of(py)
    }

    /// Time, s.
    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.hold()?.simulator.time())
    }

    /// Starts the simulation at `time` (s) with the body undeformed; inputs set before are the loads at that instant.
    ///
    /// Raises:
    ///     Error: `CALL_ORDER` when already initialized; `VALUE`; `NOT_CONVERGED`.
    #[pyo3(signature = (time=0.0))]
    fn init(&self, py: Python<'_>, time: f64) -> PyResult<()> {
        self.change(py, |simulator| simulator.init(time))
    }

    /// Back to the state before initialization, with the inputs and coefficients of the scene.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.change(py, |simulator| {
            simulator.reset();
            Ok(())
        })
    }

    /// Steps by `step` (s), of any size: it is cut into internal steps not larger than `time.step`. `time` (s), where it is given, must
    /// be the time at which the simulation stands. The interpreter is free for other threads meanwhile.
    ///
    /// Raises:
    ///     Error: `STEP`, `VALUE`, `NOT_CONVERGED`, `TOLERANCE_OUT_OF_REACH`, `OVERFLOW`; the state is then as it was.
    #[pyo3(signature = (step, time=None))]
    fn step(&self, py: Python<'_>, step: f64, time: Option<f64>) -> PyResult<()> {
        self.change(py, |simulator| {
            simulator.do_step(time.unwrap_or(simulator.time()), step)
        })
    }

    /// The value of a port: a float, or a new array of its shape. `simulator[port]` is the same.
    fn get<'py>(&self, py: Python<'py>, port: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let reference = self.reference(port)?;
        let mut inner = self.hold()?;
        let model = Arc::clone(inner.simulator.model());
        let values = inner.read(reference)?;
        let shape = &model.ports().all()[reference as usize].shape;
        value(py, values, shape)
    }

    fn __getitem__<'py>(
        &self,
        py: Python<'py>,
        port: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.get(py, port)
    }

    /// The values of a port as an array that is always those of now: after every step, `init`, `restore`, `reset` and setting. Read-only,
    /// without a copy; it lives as long as it is held, also without the simulator. The same array at every call.
    ///
    /// >>> import stickslip
    /// >>> simulator = stickslip.Simulator(stickslip.compile("kazmi2014"))
    /// >>> rate = simulator.view("contact.slip_rate")
    /// >>> simulator.init()
    /// >>> float(abs(rate).max()) > 0
    /// True
    fn view(&self, py: Python<'_>, port: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        let reference = self.reference(port)?;
        let mut inner = self.hold()?;
        if let Some((_, shown)) = inner.shown.iter().find(|(of, _)| *of == reference) {
            return Ok(shown.view(py));
        }
        let model = Arc::clone(inner.simulator.model());
        let port = model.ports().get(reference).map_err(raised)?;
        let shown = Shown::new(py, &port.shape)?;
        shown.write(py, inner.read(reference)?)?;
        let view = shown.view(py);
        inner.shown.push((reference, shown));
        Ok(view)
    }

    /// All outputs one after the other, in the order of their references: a new array; see `Model.unpack`.
    fn outputs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut inner = self.hold()?;
        let Inner {
            simulator, values, ..
        } = &mut *inner;
        values.resize(simulator.output_len(), 0.0);
        simulator.get_outputs(values).map_err(raised)?;
        array(py, values, &[values.len()])
    }

    /// Sets an input or parameter, or several of them together: `set(name, value)`, `set({name: value, ...})`. An array port takes an array.
    /// Friction coefficients are checked as a set when they are set together, else by the next step. `simulator[port] = value` is the same.
    ///
    /// Raises:
    ///     Error: `UNKNOWN`, `VALUE`, `LENGTH`; `CALL_ORDER` for an output. Then nothing is set.
    #[pyo3(signature = (port, value=None))]
    fn set(
        &self,
        py: Python<'_>,
        port: &Bound<'_, PyAny>,
        value: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let mut inner = self.hold()?;
        match (port.cast::<PyDict>(), value) {
            (Ok(dict), None) => {
                let (mut references, mut all) = (Vec::new(), Vec::new());
                for (name, value) in dict.iter() {
                    references.push(self.reference(&name)?);
                    all.extend(numbers(&value)?);
                }
                inner
                    .simulator
                    .set_many(&references, &all)
                    .map_err(raised)?;
            }
            (Err(_), Some(value)) => {
                let reference = self.reference(port)?;
                match value.extract::<f64>() {
                    Ok(value) => inner.simulator.set(reference, value).map_err(raised)?,
                    Err(_) => {
                        let values = numbers(value)?;
                        let set = inner.simulator.set_many(&[reference], &values);
                        set.map_err(raised)?;
                    }
                }
            }
            _ => {
                return Err(PyTypeError::new_err(
                    "set(name, value) or set({name: value, ...})",
                ));
            }
        }
        inner.show(py)
    }

    fn __setitem__(
        &self,
        py: Python<'_>,
        port: &Bound<'_, PyAny>,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        self.set(py, port, Some(value))
    }

    /// Sets all inputs (a sequence in their order) or some (a dict).
    fn set_inputs(&self, py: Python<'_>, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut inner = self.hold()?;
        let values = given::inputs(self.model.get(), &inner.simulator, values)?;
        inner.simulator.set_inputs(&values).map_err(raised)?;
        inner.show(py)
    }

    /// The inputs jump to these values now: the next step begins with them. Otherwise as `set_inputs`.
    fn jump_inputs(&self, py: Python<'_>, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut inner = self.hold()?;
        let values = given::inputs(self.model.get(), &inner.simulator, values)?;
        inner.simulator.jump_inputs(&values).map_err(raised)?;
        inner.show(py)
    }

    /// Gives an input its slope (1/s times its unit): in the steps that follow the load is the input at their beginning plus slope times
    /// time. `None` takes the slope away.
    fn set_input_slope(&self, port: &Bound<'_, PyAny>, slope: Option<f64>) -> PyResult<()> {
        let reference = self.reference(port)?;
        let mut inner = self.hold()?;
        inner
            .simulator
            .set_input_slope(reference, slope)
            .map_err(raised)
    }

    /// Saves the state, bit for bit: into a new `State`, or into one that is given, which allocates nothing. Returns it.
    ///
    /// >>> import stickslip
    /// >>> simulator = stickslip.Simulator(stickslip.compile("kazmi2014"))
    /// >>> simulator.init()
    /// >>> state = simulator.save()
    /// >>> simulator.step(0.1)
    /// >>> simulator.restore(state)
    /// >>> simulator.time
    /// 0.0
    #[pyo3(signature = (into=None))]
    fn save(&self, py: Python<'_>, into: Option<Py<State>>) -> PyResult<Py<State>> {
        let inner = self.hold()?;
        let Some(state) = into else {
            return Py::new(py, State::new(inner.simulator.state().clone()));
        };
        {
            let mut kept = state.get().kept();
            match &mut *kept {
                Kept::Live(to) => inner.simulator.save(to).map_err(raised)?,
                Kept::Bytes(..) => *kept = Kept::Live(Box::new(inner.simulator.state().clone())),
            }
        }
        Ok(state)
    }

    /// Brings the simulation to a saved state of the same model. There is no step to take derivatives of afterwards.
    ///
    /// Raises:
    ///     Error: `FINGERPRINT` for the state of another model, `BYTES`.
    fn restore(&self, py: Python<'_>, state: &State) -> PyResult<()> {
        self.change(py, |simulator| state.restore(simulator))
    }

    /// An independent simulation in the same state; the model is shared. `copy.copy` does the same.
    fn copy(&self, py: Python<'_>) -> PyResult<Simulator> {
        let simulator = self.hold()?.simulator.clone();
        Ok(Simulator::of(self.model.clone_ref(py), simulator))
    }

    fn __copy__(&self, py: Python<'_>) -> PyResult<Simulator> {
        self.copy(py)
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> PyResult<Simulator> {
        self.copy(py)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Simulator>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let restore = slf.get_type().getattr("_restored")?;
        let simulator = slf.get();
        let arguments = (simulator.model.clone_ref(py), simulator.save(py, None)?);
        Ok((restore, arguments).into_pyobject(py)?.into_any())
    }

    #[staticmethod]
    fn _restored(model: Py<Model>, state: &State) -> PyResult<Simulator> {
        let mut simulator = stickslip::Simulator::new(Arc::clone(&model.get().inner));
        state.restore(&mut simulator).map_err(raised)?;
        Ok(Simulator::of(model, simulator))
    }

    /// Derivative of all outputs at the end of the last step by its inputs, along `seed` (one value per input, or a dict of some): a
    /// vector over all outputs, see `Model.unpack`. With `instant` of the outputs now by the loads now, without a step.
    ///
    /// Raises:
    ///     Error: `CALL_ORDER` when the state is not the end of a step.
    #[pyo3(signature = (seed, *, instant=false))]
    fn directional_derivative<'py>(
        &self,
        py: Python<'py>,
        seed: &Bound<'py, PyAny>,
        instant: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.derivative(py, seed, false, instant)
    }

    /// The transposed derivative: `seed` has one value per output (or is a dict of some), the result one per input.
    #[pyo3(signature = (seed, *, instant=false))]
    fn adjoint_derivative<'py>(
        &self,
        py: Python<'py>,
        seed: &Bound<'py, PyAny>,
        instant: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.derivative(py, seed, true, instant)
    }

    /// The recorded past of a contact node, at most `history.capacity` internal steps, oldest first: `time` (rows,) s, `slip_rate` m/s,
    /// `slip` m and `tangential_stress` Pa, each (rows, components).
    fn slip_history<'py>(&self, py: Python<'py>, node: usize) -> PyResult<Bound<'py, PyDict>> {
        let inner = self.hold()?;
        let components = inner.simulator.model().contact().components;
        let mut columns = [const { Vec::new() }; 4];
        for row in inner.simulator.slip_history(node).map_err(raised)? {
            columns[0].push(row.time);
            columns[1].extend_from_slice(row.slip_rate);
            columns[2].extend_from_slice(row.slip);
            columns[3].extend_from_slice(row.tangential_stress);
        }
        let history = PyDict::new(py);
        let rows = columns[0].len();
        history.set_item("time", array(py, &columns[0], &[rows])?)?;
        let names = ["slip_rate", "slip", "tangential_stress"];
        for (name, values) in names.iter().zip(&columns[1..]) {
            history.set_item(name, array(py, values, &[rows, components])?)?;
        }
        Ok(history)
    }

    /// What was done so far: internal steps, stages solved, factorizations.
    #[getter]
    fn work<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let inner = self.hold()?;
        let simulator = &inner.simulator;
        let work = PyDict::new(py);
        work.set_item("internal_steps", simulator.internal_steps())?;
        work.set_item("stage_solves", simulator.stage_solves())?;
        work.set_item("factorizations", simulator.factorizations())?;
        work.set_item("refused_pairs", simulator.refused_pairs())?;
        let friction = simulator.friction_work();
        work.set_item("friction_factorizations", friction.factorizations)?;
        work.set_item("friction_solves", friction.solves)?;
        Ok(work)
    }

    fn __repr__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyString>> {
        let model = &self.model.get().inner;
        let time = match self.hold() {
            Ok(inner) => format!("at {:?} s", inner.simulator.time()),
            Err(_) => "in use".to_owned(),
        };
        let text = format!("<Simulator of {:?} {time}>", model.summary().name);
        Ok(PyString::new(py, &text))
    }
}
