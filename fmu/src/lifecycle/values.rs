//! Reading and setting variables by reference. All values stand in one array in the order of the variables, so that a run of
//! consecutive references is one copy.

use super::{Call, Instance, Phase};
use crate::fault::{Fault, Outcome};
use crate::variables::Role;

/// A number of an importer: Float64 and Real, or the Int64 and Integer of an enumeration.
pub trait Scalar: Copy + PartialEq {
    /// Whether places of choices (rather than of numbers) are read with this type.
    const IS_CHOICE: bool;
    fn from_value(value: f64) -> Self;
    fn to_value(self) -> f64;
    fn copy(from: &[f64], to: &mut [Self]) {
        for (to, from) in to.iter_mut().zip(from) {
            *to = Self::from_value(*from);
        }
    }
}

impl Scalar for f64 {
    const IS_CHOICE: bool = false;
    fn from_value(value: f64) -> f64 {
        value
    }
    fn to_value(self) -> f64 {
        self
    }
    fn copy(from: &[f64], to: &mut [f64]) {
        to.copy_from_slice(from);
    }
}

impl Scalar for i32 {
    const IS_CHOICE: bool = true;
    fn from_value(value: f64) -> i32 {
        value as i32
    }
    fn to_value(self) -> f64 {
        f64::from(self)
    }
}

impl Scalar for i64 {
    const IS_CHOICE: bool = true;
    fn from_value(value: f64) -> i64 {
        value as i64
    }
    fn to_value(self) -> f64 {
        self as f64
    }
}
impl Instance {
    /// Brings `values` up to date. In initialization mode the outputs are those that leaving it now would give.
    pub(super) fn refresh(&mut self) -> Outcome {
        if self.are_values_fresh {
            return Ok(());
        }
        if self.phase == Phase::Initialization {
            self.compile()?;
            let before = self.simulator.state().clone();
            let outcome = self.simulator.init(self.start_time).map_err(Fault::from);
            let read = outcome.and_then(|()| self.read());
            self.simulator.restore(&before)?;
            read?;
        } else {
            self.read()?;
        }
        self.are_values_fresh = true;
        Ok(())
    }

    fn read(&mut self) -> Outcome {
        self.values[0] = self.time();
        for variable in self.component.variables.all() {
            if let Some(port) = variable.port {
                self.simulator
                    .get(port, &mut self.values[variable.range()])?;
            }
        }
        let first = self.component.variables.first_parameter();
        self.values[first..].copy_from_slice(&self.parameters);
        Ok(())
    }

    /// Values of variables; a run of consecutive references is one copy.
    pub fn get<T: Scalar>(&mut self, references: &[u32], out: &mut [T]) -> Outcome {
        self.permit(Call::Get)?;
        if references.is_empty() && out.is_empty() {
            return Ok(());
        }
        self.refresh()?;
        let variables = &self.component.variables;
        let limit = variables.first_choice();
        if let (Some(&first), false) = (references.first(), T::IS_CHOICE) {
            let first = first as usize;
            let is_run = references
                .iter()
                .enumerate()
                .fold(true, |run, (i, r)| run & (*r as usize == first + i));
            if is_run && first + references.len() <= limit && out.len() == references.len() {
                T::copy(&self.values[first..first + out.len()], out);
                return Ok(());
            }
        }
        let places = self.places::<T>(references, out.len())?;
        let mut rest = out;
        for places in places {
            let (head, tail) = rest.split_at_mut(places.len());
            T::copy(&self.values[places], head);
            rest = tail;
        }
        Ok(())
    }

    /// Places of references of variables of the type `T`, which together have `len` values.
    pub(super) fn places<T: Scalar>(
        &self,
        references: &[u32],
        len: usize,
    ) -> Outcome<Vec<std::ops::Range<usize>>> {
        let variables = &self.component.variables;
        let resolve = |&reference: &u32| {
            let unknown = || Fault::error(format!("unknown value reference {reference}"));
            let places = variables.resolve(reference).ok_or_else(unknown)?;
            if (places.start >= variables.first_choice()) != T::IS_CHOICE {
                let name = variables.name(reference);
                let kind = match T::IS_CHOICE {
                    true => "a number: it is read and set as Real (FMI 2) or Float64 (FMI 3)",
                    false => {
                        "an enumeration: it is read and set as Integer (FMI 2) or Int64 (FMI 3)"
                    }
                };
                return Err(Fault::error(format!("{name} is {kind}")));
            }
            Ok(places)
        };
        let places = references
            .iter()
            .map(resolve)
            .collect::<Outcome<Vec<_>>>()?;
        let total: usize = places.iter().map(ExactSizeIterator::len).sum();
        if total == len {
            Ok(places)
        } else {
            Err(Fault::error(format!(
                "the variables have {total} values, the call {len}"
            )))
        }
    }

    /// Sets variables, all or none.
    pub fn set<T: Scalar>(&mut self, references: &[u32], values: &[T]) -> Outcome {
        #[cfg(feature = "panic-injection")]
        assert!(
            references != [0xDEAD],
            "stickslip_fmu built with panic-injection"
        );
        let places: Vec<usize> = self
            .places::<T>(references, values.len())?
            .into_iter()
            .flatten()
            .collect();
        for (&place, value) in places.iter().zip(values) {
            self.check_set(place, value.to_value())?;
        }
        // only the range of a friction coefficient can still refuse: then what was set before it is taken back. Whether
        // coefficients fit each other is asked when the set is complete: at the end of the initialization, or by the next step
        let is_tunable = |place: &usize| {
            let variable = self.component.variables.at(*place);
            variable.is_some_and(|v| v.role == Role::Tunable)
        };
        let before = places
            .iter()
            .any(is_tunable)
            .then(|| self.simulator.state().clone());
        for (&place, value) in places.iter().zip(values) {
            let variable = self.component.variables.at(place);
            let port = variable.and_then(|v| Some((v.port?, place - v.first)));
            let first = self.component.variables.first_parameter();
            match port {
                Some((port, element)) => {
                    let value = value.to_value();
                    if let Err(error) = self.simulator.set_element(port, element, value) {
                        if let Some(before) = &before {
                            self.simulator.restore(before)?;
                        }
                        return Err(error.into());
                    }
                }
                None => self.parameters[place - first] = value.to_value(),
            }
        }
        self.are_values_fresh = false;
        Ok(())
    }

    fn check_set(&self, place: usize, value: f64) -> Outcome {
        let Some(variable) = self.component.variables.at(place) else {
            return Err(Fault::error(format!("no variable at {place}")));
        };
        match variable.role {
            Role::Time => return Err(Fault::error("time is set by stepping")),
            Role::Output => return Err(Fault::error(format!("{} is an output", variable.name))),
            Role::Input => self.permit(Call::SetInput)?,
            Role::Tunable => self.permit(Call::SetTunable)?,
            Role::Fixed => self.permit(Call::SetFixed).map_err(|_| {
                Fault::error(format!(
                    "{} is a fixed parameter: it is set before the initialization ends, not {}",
                    variable.name,
                    self.phase.name()
                ))
            })?,
        }
        if !value.is_finite() {
            return Err(Fault::discard(format!(
                "{}: {value} is not a finite number",
                variable.name
            )));
        }
        let parameter = place.wrapping_sub(self.component.variables.first_parameter());
        if variable.choice.is_some()
            && !self
                .component
                .variables
                .parameters()
                .is_choice(parameter, value as i64)
        {
            return Err(Fault::error(format!(
                "{}: there is no choice {value}",
                variable.name
            )));
        }
        Ok(())
    }
}
