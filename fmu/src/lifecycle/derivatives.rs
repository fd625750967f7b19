//! Derivatives: slopes of inputs and outputs in time, and the outputs by the inputs of the last step or of this instant.

use super::{Call, Instance, Phase};
use crate::fault::{Fault, Outcome};
use crate::variables::{Role, Slope, Variable};
use stickslip::Simulator;

impl Instance {
    /// Sets the first derivatives of inputs by time: within the steps that follow an input is its value plus slope times the time
    /// since the beginning of the step.
    pub fn set_slopes(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Outcome {
        self.permit(Call::SetSlope)?;
        check_orders(references, orders, values.len())?;
        let places: Vec<usize> = self
            .places::<f64>(references, values.len())?
            .into_iter()
            .flatten()
            .collect();
        let mut ports = Vec::with_capacity(places.len());
        for (&place, &value) in places.iter().zip(values) {
            ports.push(self.input_at(place)? as u32);
            if !value.is_finite() {
                return Err(Fault::discard(format!(
                    "input derivative {value} is not a finite number"
                )));
            }
        }
        for (&port, &value) in ports.iter().zip(values) {
            self.simulator.set_input_slope(port, Some(value))?;
        }
        Ok(())
    }

    fn input_at(&self, place: usize) -> Outcome<usize> {
        let variables = &self.component.variables;
        match variables.at(place) {
            // the inputs are the first ports, after time: number and reference are the same
            Some(Variable {
                role: Role::Input, ..
            }) => Ok(place - 1),
            Some(other) => Err(Fault::error(format!("{} is not an input", other.name))),
            None => Err(Fault::error(format!("no variable at {place}"))),
        }
    }

    /// First derivatives of outputs by time at the end of the last step: exact for displacements and slips, and 0, which FMI has
    /// for a derivative that is not known, for other outputs.
    pub fn get_slopes(&mut self, references: &[u32], orders: &[i32], out: &mut [f64]) -> Outcome {
        self.permit(Call::GetSlope)?;
        self.refresh()?;
        let places = self.places::<f64>(references, out.len())?;
        check_orders(references, orders, references.len())?;
        let components = self.component.model.contact().components;
        let variables = &self.component.variables;
        let mut results = Vec::with_capacity(out.len());
        for place in places.into_iter().flatten() {
            let Some(variable) = variables.at(place) else {
                continue;
            };
            let element = place - variable.first;
            results.push(match variable.slope {
                Slope::Variable(other) => self.values[variables.all()[other].first + element],
                Slope::NormOf(other) => {
                    let from = variables.all()[other].first + element * components;
                    let node = &self.values[from..from + components];
                    node.iter().map(|v| v * v).sum::<f64>().sqrt()
                }
                Slope::Unknown if variable.role == Role::Output => 0.0,
                Slope::Unknown => {
                    return Err(Fault::error(format!(
                        "{} is not an output: it has no derivative by time",
                        variable.name
                    )));
                }
            });
        }
        out.copy_from_slice(&results);
        Ok(())
    }

    /// Derivatives of outputs by inputs, times a seed: over the last step (the library's `directional_derivative`), or, where there
    /// is none (in initialization mode, after it, after a restored state), at this instant (`instant_derivative`).
    pub fn directional(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        out: &mut [f64],
    ) -> Outcome {
        self.permit(Call::Derivative)?;
        let (outputs, inputs) = self.derivative_places(unknowns, out.len(), knowns, seed.len())?;
        let mut direction = vec![0.0; self.component.model.input_count()];
        for (&input, value) in inputs.iter().zip(seed) {
            direction[input] += value;
        }
        let mut all = vec![0.0; self.simulator.output_len()];
        self.differentiate(|simulator, has_step| match has_step {
            true => simulator.directional_derivative(&direction, &mut all),
            false => simulator.instant_derivative(&direction, &mut all),
        })?;
        for (out, &output) in out.iter_mut().zip(&outputs) {
            *out = all[output];
        }
        Ok(())
    }

    /// The transposed derivatives times a seed of the outputs.
    pub fn adjoint(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        out: &mut [f64],
    ) -> Outcome {
        self.permit(Call::Derivative)?;
        let (outputs, inputs) = self.derivative_places(unknowns, seed.len(), knowns, out.len())?;
        let mut weights = vec![0.0; self.simulator.output_len()];
        for (&output, value) in outputs.iter().zip(seed) {
            weights[output] += value;
        }
        let mut all = vec![0.0; self.component.model.input_count()];
        self.differentiate(|simulator, has_step| match has_step {
            true => simulator.adjoint_derivative(&weights, &mut all),
            false => simulator.instant_adjoint(&weights, &mut all),
        })?;
        for (out, &input) in out.iter_mut().zip(&inputs) {
            *out = all[input];
        }
        Ok(())
    }

    /// Runs `take` on the simulator, and says whether it has a last step. In initialization mode the simulator stands where
    /// leaving that mode now would bring it.
    fn differentiate(
        &mut self,
        take: impl FnOnce(&mut Simulator, bool) -> stickslip::Result<()>,
    ) -> Outcome {
        if self.phase != Phase::Initialization {
            let has_step = self.simulator.has_last_step();
            return Ok(take(&mut self.simulator, has_step)?);
        }
        self.compile()?;
        let before = self.simulator.state().clone();
        let start = self.simulator.init(self.start_time);
        let taken = start.and_then(|()| take(&mut self.simulator, false));
        self.simulator.restore(&before)?;
        Ok(taken?)
    }

    /// Numbers of outputs and inputs, each counted from the first of its kind.
    fn derivative_places(
        &self,
        unknowns: &[u32],
        unknown_values: usize,
        knowns: &[u32],
        known_values: usize,
    ) -> Outcome<(Vec<usize>, Vec<usize>)> {
        let first_output = 1 + self.component.model.input_count();
        let unknowns = self.places::<f64>(unknowns, unknown_values)?;
        let output = |place: usize| match self.component.variables.at(place) {
            Some(Variable {
                role: Role::Output, ..
            }) => Ok(place - first_output),
            Some(v) => Err(Fault::error(format!(
                "{} is not an output: there is no derivative of it",
                v.name
            ))),
            None => Err(Fault::error(format!("no variable at {place}"))),
        };
        let outputs = unknowns
            .into_iter()
            .flatten()
            .map(output)
            .collect::<Outcome<_>>()?;
        let knowns = self.places::<f64>(knowns, known_values)?;
        let inputs = knowns
            .into_iter()
            .flatten()
            .map(|place| self.input_at(place))
            .collect::<Outcome<_>>()?;
        Ok((outputs, inputs))
    }
}

fn check_orders(references: &[u32], orders: &[i32], values: usize) -> Outcome {
    if references.len() != orders.len() || values < orders.len() {
        return Err(Fault::error(
            "as many orders as value references are needed",
        ));
    }
    match orders.iter().find(|order| **order != 1) {
        None => Ok(()),
        Some(order) => Err(Fault::error(format!(
            "derivative of order {order}: only the first is known"
        ))),
    }
}
