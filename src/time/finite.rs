//! The one check that the numbers of a state are finite: after a step, and where the bytes of a state enter.
//!
//! Numbers far from the limits of their format need one pass over the state, a sum of squares: what is read from them (stress,
//! norms, energies, means) cannot overflow then. Only beyond that are all numbers and all outputs looked at one by one.

use crate::error::{Error, Result};
use crate::model::Model;
use crate::ports::Quantity;
use crate::ports::readout;
use crate::state::State;

/// Size of numbers whose squares, and sums of these over any mesh, are finite.
const MODERATE: f64 = 1e145;

/// Scratch of the check.
pub(crate) struct FiniteCheck {
    /// Sum of squares up to which nothing that is read from a state can overflow.
    largest_squares: f64,
    /// Values of the longest output.
    values: Vec<f64>,
}

impl FiniteCheck {
    pub fn new(model: &Model) -> FiniteCheck {
        let measures = (0..model.motions().loads()).map(|i| model.load_measure(i));
        let divisors = model.contact().weights.iter().copied().chain(measures);
        // stress is force by weight, mean displacement an integral by the measure of the part
        let largest = MODERATE * divisors.fold(1.0, f64::min);
        let longest = model.ports().outputs().map(|port| port.len()).max();
        FiniteCheck {
            largest_squares: largest * largest,
            values: vec![0.0; longest.unwrap_or(0)],
        }
    }

    /// What is not finite in a state, or in the outputs that it gives; `None` when all is.
    pub fn fault(&mut self, model: &Model, state: &State) -> Option<String> {
        // written so that NaN takes the long way
        if state.sum_of_squares() <= self.largest_squares {
            return None;
        }
        // by name where an output shows it; limits and counts hide what they were made from
        for port in model.ports().outputs() {
            let values = &mut self.values[..port.len()];
            readout::read(model, state, port, values);
            let is_shown = !matches!(
                port.quantity,
                Quantity::Stick
                    | Quantity::StickFraction
                    | Quantity::Status
                    | Quantity::OpenFraction
            );
            if is_shown && values.iter().any(|v| !v.is_finite()) {
                return Some(port.name.clone());
            }
        }
        (!state.is_finite()).then(|| "the motion of the body".to_owned())
    }

    /// Refuses a state that a step or an initialization has led to.
    ///
    /// # Errors
    /// [`Error::Overflow`].
    pub fn check(&mut self, model: &Model, state: &State) -> Result<()> {
        match self.fault(model, state) {
            None => Ok(()),
            Some(what) => Err(Error::Overflow {
                what,
                time: state.time,
            }),
        }
    }
}
