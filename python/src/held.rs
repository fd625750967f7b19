//! A simulator in the hands of one call: its scratch, and the floating-point environment that it computes in.

use crate::array::Shown;
use crate::error::raised;
use crate::state::busy;
use pyo3::prelude::*;
use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, MutexGuard, TryLockError};
use stickslip::Error;
use stickslip::float_environment::DefaultEnvironment;

/// What a call works with.
pub struct Inner {
    pub simulator: stickslip::Simulator,
    /// The ports that are shown, with their references.
    pub shown: Vec<(u32, Shown)>,
    /// Values on their way to an array, or inputs on theirs from one.
    pub values: Vec<f64>,
}

/// A simulator that is in use, in the floating-point environment that it computes in.
pub struct Held<'a> {
    inner: MutexGuard<'a, Inner>,
    _environment: DefaultEnvironment,
}

impl Held<'_> {
    /// Holds a simulator, unless another thread does.
    ///
    /// # Errors
    /// `CALL_ORDER`, and `POISONED` after a panic.
    pub fn of(inner: &Mutex<Inner>) -> PyResult<Held<'_>> {
        match inner.try_lock() {
            Ok(inner) => Ok(Held {
                inner,
                _environment: DefaultEnvironment::enter(),
            }),
            Err(TryLockError::WouldBlock) => Err(busy()),
            Err(TryLockError::Poisoned(_)) => Err(raised(Error::Poisoned {
                what: "a call of it panicked".to_owned(),
            })),
        }
    }
}

impl Deref for Held<'_> {
    type Target = Inner;

    fn deref(&self) -> &Inner {
        &self.inner
    }
}

impl DerefMut for Held<'_> {
    fn deref_mut(&mut self) -> &mut Inner {
        &mut self.inner
    }
}

impl Inner {
    pub fn new(simulator: stickslip::Simulator) -> Inner {
        Inner {
            simulator,
            shown: Vec::new(),
            values: Vec::new(),
        }
    }

    /// Reads a port into `values`.
    pub fn read(&mut self, reference: u32) -> PyResult<&[f64]> {
        let ports = self.simulator.model().ports();
        let len = ports.get(reference).map_err(raised)?.len();
        self.values.resize(len, 0.0);
        self.simulator
            .get(reference, &mut self.values)
            .map_err(raised)?;
        Ok(&self.values)
    }

    /// Brings what is shown up to date.
    pub fn show(&mut self, py: Python<'_>) -> PyResult<()> {
        for i in 0..self.shown.len() {
            self.read(self.shown[i].0)?;
            self.shown[i].1.write(py, &self.values)?;
        }
        Ok(())
    }
}
