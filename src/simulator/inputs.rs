//! What the inputs of a simulator mean in time, and their slopes.

use super::Simulator;
use crate::error::{Error, Result};
use crate::ports::Quantity;
use crate::scene::Inputs;
use crate::time::input_course;
use crate::time::workspace::Bend;

impl Simulator {
    /// Says what inputs mean from now on: by default what `time.inputs` of the scene says, and without it the load at the end of
    /// the next step. Before initialization; [`Simulator::reset`] takes it back.
    ///
    /// # Errors
    /// [`Error::CallOrder`] after initialization.
    pub fn set_inputs_meaning(&mut self, meaning: Inputs) -> Result<()> {
        if self.state.is_initialized != 0 {
            return Err(Error::CallOrder {
                call: "set_inputs_meaning",
                expected: "before init",
            });
        }
        self.state.set_meaning(meaning);
        Ok(())
    }

    /// What inputs mean.
    pub fn inputs_meaning(&self) -> Inputs {
        self.state.meaning()
    }

    /// Gives an input its slope, 1/s times its unit: in the steps that follow the load is the input at their beginning plus
    /// slope times time, whatever inputs mean otherwise. `None` takes the slope away.
    ///
    /// # Errors
    /// [`Error::Unknown`], [`Error::CallOrder`] for a port that is not an input, [`Error::Value`] for a number that is not finite.
    pub fn set_input_slope(&mut self, reference: u32, slope: Option<f64>) -> Result<()> {
        let port = self.model.ports().get(reference)?;
        let Quantity::Input(load) = port.quantity else {
            return Err(Error::CallOrder {
                call: "set_input_slope",
                expected: "the port is an input",
            });
        };
        match slope.filter(|slope| !slope.is_finite()) {
            Some(found) => Err(Error::Value {
                what: format!("slope of {}", port.name),
                found,
                allowed: "a finite number",
            }),
            None => {
                input_course::give_slope(&mut self.state, load, slope);
                Ok(())
            }
        }
    }

    /// Lets an input go through a value within the next step: between its ends and such points inputs are linear. Points are given
    /// in the order of the inputs and, for each, of their fractions of the step, between 0 and 1. They count for one step, also
    /// when it fails, and change nothing of what inputs mean at its ends. Displacements of driven parts have no points.
    pub(super) fn bend_input(&mut self, input: usize, fraction: f64, value: f64) {
        if !input_course::is_displaced(&self.model, input) {
            self.bends.push(Bend {
                input,
                fraction,
                value,
            });
        }
    }

    /// Room for so many bends in a step.
    pub(super) fn reserve_bends(&mut self, most: usize) {
        self.bends.reserve(most);
        self.workspace.course.bends.reserve(most);
    }

    /// The slope that was given for an input; `None` without one, and for other ports.
    pub fn input_slope(&self, reference: u32) -> Option<f64> {
        match self.model.ports().get(reference).ok()?.quantity {
            Quantity::Input(load) => input_course::given_slope(&self.state, load),
            _ => None,
        }
    }
}
