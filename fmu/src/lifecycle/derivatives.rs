//! Derivatives: slopes of inputs and outputs in time, and the outputs by the inputs of the last step.

use super::{Call, Instance};
use crate::fault::{Fault, Outcome};
use crate::variables::{Role, Slope, Variable};

impl Instance {
    /// Sets the first derivatives of inputs by time: a step then ends with the value that was set plus slope times step.
    pub fn set_slopes(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Outcome {
        self.permit(Call::SetSlope)?;
        check_orders(references, orders, values.len())?;
        let places: Vec<usize> = self
            .places::<f64>(references, values.len())?
            .into_iter()
            .flatten()
            .collect();
        let mut slopes = self.slopes.clone();
        for (&place, &value) in places.iter().zip(values) {
            let input = self.input_at(place)?;
            if !value.is_finite() {
                return Err(Fault::discard(format!(
                    "input derivative {value} is not a finite number"
                )));
            }
            slopes[input] = value;
        }
        self.slopes = slopes;
        Ok(())
    }

    fn input_at(&self, place: usize) -> Outcome<usize> {
        let variables = &self.component.variables;
        match variables.at(place) {
            // the inputs are the first ports, after time
            Some(Variable {
                role: Role::Input, ..
            }) => Ok(place - 1),
            Some(other) => Err(Fault::error(format!("{} is not an input", other.name))),
            None => Err(Fault::error(format!("no variable at {place}"))),
        }
    }

    /// First derivatives of outputs by time at the end of the last step: known exactly for displacements and slips.
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
                Slope::Unknown => {
                    return Err(Fault::error(format!(
                        "{}: the derivative by time is known only for displacements and slips",
                        variable.name
                    )));
                }
            });
        }
        out.copy_from_slice(&results);
        Ok(())
    }

    /// Derivatives of outputs by inputs over the last step, times a seed (see the library's `directional_derivative`).
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
        self.simulator
            .directional_derivative(&direction, &mut all)?;
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
        self.simulator.adjoint_derivative(&weights, &mut all)?;
        for (out, &input) in out.iter_mut().zip(&inputs) {
            *out = all[input];
        }
        Ok(())
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
