//! A saved state.

use crate::error::raised;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::sync::{Mutex, MutexGuard, PoisonError};
use stickslip::Error;

/// How a state is kept: as a simulator saved it, or as the bytes that came from elsewhere, which only a simulator can read.
pub enum Kept {
    Live(Box<stickslip::State>),
    Bytes(Vec<u8>, f64),
}

impl Kept {
    fn bytes(&self) -> Vec<u8> {
        match self {
            Kept::Live(state) => state.to_bytes(),
            Kept::Bytes(bytes, _) => bytes.clone(),
        }
    }
}

/// A saved state: all that the future of a simulation depends on. Pickles as its bytes, which fit every simulator of the same
/// model, in any process.
#[pyclass(frozen, module = "stickslip")]
pub struct State(Mutex<Kept>);

impl State {
    pub fn new(state: stickslip::State) -> State {
        State(Mutex::new(Kept::Live(Box::new(state))))
    }

    /// What is kept. Nothing panics while it is held, and all of it is replaced at once.
    pub fn kept(&self) -> MutexGuard<'_, Kept> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Brings a simulator to this state.
    pub fn restore(&self, simulator: &mut stickslip::Simulator) -> stickslip::Result<()> {
        match &*self.kept() {
            Kept::Live(state) => simulator.restore(state),
            Kept::Bytes(bytes, _) => simulator.restore_bytes(bytes),
        }
    }
}

#[pymethods]
impl State {
    /// Time, s.
    #[getter]
    fn time(&self) -> f64 {
        match &*self.kept() {
            Kept::Live(state) => state.time(),
            Kept::Bytes(_, time) => *time,
        }
    }

    /// Versioned, checksummed bytes.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.kept().bytes())
    }

    /// The state of bytes. That they fit a model is checked when a simulator of it is brought to the state.
    ///
    /// Raises:
    ///     Error: `BYTES` for bytes that are no state of this version, or damaged.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<State> {
        let time = stickslip::State::time_of(bytes).map_err(raised)?;
        Ok(State(Mutex::new(Kept::Bytes(bytes.to_vec(), time))))
    }

    fn __reduce__<'py>(slf: &Bound<'py, State>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let restore = slf.get_type().getattr("from_bytes")?;
        let arguments = (slf.get().to_bytes(py),);
        Ok((restore, arguments).into_pyobject(py)?.into_any())
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        // one after the other: two threads may compare the same two states
        let other = other.cast::<State>();
        other.is_ok_and(|other| {
            let other = other.get().kept().bytes();
            other == self.kept().bytes()
        })
    }

    fn __repr__(&self) -> String {
        format!("<State at {:?} s>", self.time())
    }
}

/// Refuses what another thread is using.
pub fn busy() -> PyErr {
    raised(Error::CallOrder {
        call: "a call of a simulator",
        expected: "the simulator is in use by another thread; take one simulator per thread",
    })
}
