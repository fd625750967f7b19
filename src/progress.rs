//! Where a compilation stands, and whether it goes on.

use crate::error::{Error, Result};
use std::ops::ControlFlow;

/// What a compilation is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(i32)]
pub enum Phase {
    /// Settings are measured for `fidelity.target_error`; their number is not known beforehand, and the fraction stays 0.
    Selection = 0,
    /// The mesh is made and the body assembled on it.
    Assembly = 1,
    /// What is kept of the body is made.
    Reduction = 2,
    /// The step is certified.
    Certificate = 3,
}

impl Phase {
    /// What a user reads.
    pub fn name(self) -> &'static str {
        match self {
            Phase::Selection => "selection of settings",
            Phase::Assembly => "assembly",
            Phase::Reduction => "model of the body",
            Phase::Certificate => "certificate",
        }
    }
}

/// Where a compilation stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    pub phase: Phase,
    /// Share of the work that is done, 0 to 1; it never falls.
    pub fraction: f64,
}

/// Is told where a compilation stands, some tens of times, and stops it with [`ControlFlow::Break`].
pub type Observer<'a> = dyn FnMut(Progress) -> ControlFlow<()> + 'a;

/// Tells the observer.
pub(crate) struct Watch<'a> {
    observer: &'a mut Observer<'a>,
    fraction: f64,
}

impl<'a> Watch<'a> {
    pub fn new(observer: &'a mut Observer<'a>) -> Watch<'a> {
        Watch {
            observer,
            fraction: 0.0,
        }
    }

    /// A phase has reached this fraction of the whole.
    ///
    /// # Errors
    /// [`Error::Cancelled`] when the observer stops the compilation.
    pub fn report(&mut self, phase: Phase, fraction: f64) -> Result<()> {
        self.fraction = self.fraction.max(fraction);
        let progress = Progress {
            phase,
            fraction: self.fraction,
        };
        match (self.observer)(progress) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::Cancelled {
                phase: phase.name(),
            }),
        }
    }
}
