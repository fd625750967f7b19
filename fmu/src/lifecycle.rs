//! The lifecycle of an instance, the same for FMI 2 and FMI 3: phases, one table of allowed calls, and what each call does.
//!
//! A refused call changes nothing: the phase, the state and the values stay, and the importer may go on, for instance by
//! restoring a saved state, with another step or by a reset. After a panic only freeing is left.

use crate::component::Component;
use crate::fault::{Fault, Outcome};
use crate::log::{Category, Log};
use crate::parameters;
use crate::saved::Saved;
use crate::variables::{Role, Slope, Variable};
use std::sync::Arc;
use stickslip::Simulator;

/// Phase of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    Instantiated = 0,
    Initialization = 1,
    Stepping = 2,
    Terminated = 3,
}

impl Phase {
    pub fn from_number(number: u64) -> Option<Phase> {
        use Phase::*;
        [Instantiated, Initialization, Stepping, Terminated]
            .into_iter()
            .find(|p| *p as u64 == number)
    }

    fn name(self) -> &'static str {
        match self {
            Phase::Instantiated => "before initialization",
            Phase::Initialization => "in initialization mode",
            Phase::Stepping => "in step mode",
            Phase::Terminated => "after termination",
        }
    }
}

/// Calls whose permission depends on the phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Call {
    SetDebugLogging,
    SetupExperiment,
    EnterInitialization,
    ExitInitialization,
    DoStep,
    Terminate,
    Reset,
    Get,
    SetInput,
    SetTunable,
    SetFixed,
    SetSlope,
    GetSlope,
    Derivative,
    States,
}

/// Allowed calls: before initialization, in initialization mode, in step mode, after termination.
const ALLOWED: [(Call, [bool; 4]); 15] = {
    const Y: bool = true;
    const N: bool = false;
    [
        (Call::SetDebugLogging, [Y, Y, Y, Y]),
        (Call::SetupExperiment, [Y, N, N, N]),
        (Call::EnterInitialization, [Y, N, N, N]),
        (Call::ExitInitialization, [N, Y, N, N]),
        (Call::DoStep, [N, N, Y, N]),
        (Call::Terminate, [N, N, Y, N]),
        (Call::Reset, [Y, Y, Y, Y]),
        (Call::Get, [Y, Y, Y, Y]),
        (Call::SetInput, [Y, Y, Y, N]),
        (Call::SetTunable, [Y, Y, Y, N]),
        (Call::SetFixed, [Y, Y, N, N]),
        (Call::SetSlope, [Y, Y, Y, N]),
        (Call::GetSlope, [N, N, Y, Y]),
        (Call::Derivative, [N, N, Y, Y]),
        (Call::States, [Y, Y, Y, Y]),
    ]
};

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

/// One instance of the FMU.
pub struct Instance {
    pub log: Log,
    /// The FMU as packed.
    packed: Arc<Component>,
    /// The FMU with the parameters of this instance, once compiled.
    component: Arc<Component>,
    simulator: Simulator,
    phase: Phase,
    start_time: f64,
    parameters: Vec<f64>,
    /// Slopes of the inputs, per second.
    slopes: Vec<f64>,
    /// All values, in the order of the variables.
    values: Vec<f64>,
    are_values_fresh: bool,
    saved: Vec<(u64, Saved)>,
    serial: u64,
    saves: u64,
}

impl Instance {
    pub fn new(component: Arc<Component>, log: Log, serial: u64) -> Instance {
        let simulator = Simulator::new(Arc::clone(&component.model));
        Instance {
            log,
            phase: Phase::Instantiated,
            start_time: 0.0,
            parameters: component.parameters.clone(),
            slopes: vec![0.0; component.model.input_count()],
            values: vec![0.0; component.variables.len()],
            are_values_fresh: false,
            saved: Vec::new(),
            serial,
            saves: 0,
            simulator,
            packed: Arc::clone(&component),
            component,
        }
    }

    /// Refuses a call that the phase does not allow.
    pub fn permit(&self, call: Call) -> Outcome {
        let row = ALLOWED.iter().find(|(c, _)| *c == call);
        if row.is_some_and(|(_, phases)| phases[self.phase as usize]) {
            Ok(())
        } else {
            Err(Fault::error(format!(
                "{call:?} is not allowed {}",
                self.phase.name()
            )))
        }
    }

    pub fn time(&self) -> f64 {
        match self.phase {
            Phase::Instantiated | Phase::Initialization => self.start_time,
            _ => self.simulator.time(),
        }
    }

    /// FMI 2 states the start time apart from the initialization.
    pub fn setup(&mut self, start_time: f64) -> Outcome {
        self.permit(Call::SetupExperiment)?;
        self.set_start(start_time)
    }

    fn set_start(&mut self, start_time: f64) -> Outcome {
        if !start_time.is_finite() {
            return Err(Fault::error(format!(
                "start time {start_time}: expected a finite number"
            )));
        }
        self.start_time = start_time;
        self.are_values_fresh = false;
        Ok(())
    }

    pub fn enter_initialization(&mut self, start_time: Option<f64>) -> Outcome {
        self.permit(Call::EnterInitialization)?;
        let before = self.start_time;
        self.set_start(start_time.unwrap_or(before))?;
        self.compile().inspect_err(|_| self.start_time = before)?;
        self.phase = Phase::Initialization;
        Ok(())
    }

    pub fn exit_initialization(&mut self) -> Outcome {
        self.permit(Call::ExitInitialization)?;
        self.compile()?;
        self.simulator.init(self.start_time)?;
        self.phase = Phase::Stepping;
        self.are_values_fresh = false;
        Ok(())
    }

    /// Takes up fixed parameters that were set.
    fn compile(&mut self) -> Outcome {
        if self.parameters != self.component.parameters {
            let component = self.component_of(&self.parameters)?;
            let names: Vec<_> = parameters::overrides(&self.component.parameters, &self.parameters)
                .into_iter()
                .map(|(path, value)| format!("{path} = {value}"))
                .collect();
            self.log.write(
                0,
                Category::Event,
                &format!("compiled with {}", names.join(", ")),
            );
            self.adopt(component)?;
        }
        Ok(())
    }

    fn component_of(&self, parameters: &[f64]) -> Outcome<Arc<Component>> {
        if parameters == self.packed.parameters {
            Ok(Arc::clone(&self.packed))
        } else {
            self.packed.with_parameters(parameters)
        }
    }

    /// Changes the model before the simulation starts, with the inputs and coefficients that were set.
    fn adopt(&mut self, component: Arc<Component>) -> Outcome {
        let mut simulator = Simulator::new(Arc::clone(&component.model));
        for variable in component.variables.all() {
            if let (Some(port), Role::Input | Role::Tunable) = (variable.port, variable.role) {
                let mut value = [0.0];
                self.simulator.get(port, &mut value)?;
                simulator.set(port, value[0])?;
            }
        }
        self.simulator = simulator;
        self.component = component;
        self.are_values_fresh = false;
        Ok(())
    }

    pub fn do_step(&mut self, time: f64, step: f64) -> Outcome {
        self.permit(Call::DoStep)?;
        let before: Option<Vec<f64>> = self.slopes.iter().any(|s| *s != 0.0).then(|| self.inputs());
        if let Some(before) = &before {
            let pairs = before.iter().zip(&self.slopes);
            let ends: Vec<f64> = pairs.map(|(value, slope)| value + step * slope).collect();
            self.simulator.set_inputs(&ends)?;
        }
        let outcome = self.simulator.do_step(time, step);
        if let (Err(_), Some(before)) = (&outcome, &before) {
            self.simulator.set_inputs(before)?;
        }
        outcome?;
        self.are_values_fresh = false;
        Ok(())
    }

    fn inputs(&self) -> Vec<f64> {
        let variables = self.component.variables.all().iter();
        let inputs = variables
            .filter(|v| v.role == Role::Input)
            .filter_map(|v| v.port);
        inputs
            .map(|port| {
                let mut value = [0.0];
                self.simulator
                    .get(port, &mut value)
                    .map_or(0.0, |()| value[0])
            })
            .collect()
    }

    pub fn terminate(&mut self) -> Outcome {
        self.permit(Call::Terminate)?;
        self.phase = Phase::Terminated;
        Ok(())
    }

    pub fn reset(&mut self) -> Outcome {
        self.permit(Call::Reset)?;
        self.component = Arc::clone(&self.packed);
        self.simulator = Simulator::new(Arc::clone(&self.component.model));
        self.parameters.clone_from(&self.packed.parameters);
        self.slopes.fill(0.0);
        self.start_time = 0.0;
        self.phase = Phase::Instantiated;
        self.are_values_fresh = false;
        Ok(())
    }

    /// Brings `values` up to date. In initialization mode the outputs are those that leaving it now would give.
    fn refresh(&mut self) -> Outcome {
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
    fn places<T: Scalar>(
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
                return Err(Fault::error(format!("{name} is of another type")));
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
        // only the law of friction can still refuse: then what was set before it is taken back
        let before = self.simulator.state().clone();
        for (&place, value) in places.iter().zip(values) {
            let port = self.component.variables.at(place).and_then(|v| v.port);
            let first = self.component.variables.first_parameter();
            match port {
                Some(port) => {
                    if let Err(error) = self.simulator.set(port, value.to_value()) {
                        self.simulator.restore(&before)?;
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
            Role::Fixed => self
                .permit(Call::SetFixed)
                .map_err(|f| Fault::error(format!("{}: {}", variable.name, f.message)))?,
        }
        if !value.is_finite() {
            return Err(Fault::discard(format!(
                "{}: {value} is not a finite number",
                variable.name
            )));
        }
        let parameter = place.wrapping_sub(self.component.variables.first_parameter());
        if variable.choice.is_some() && !parameters::is_choice(parameter, value as i64) {
            return Err(Fault::error(format!(
                "{}: there is no choice {value}",
                variable.name
            )));
        }
        Ok(())
    }

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

    /// Saves the state, into `handle` when that is one of this instance; the handle of the saved state.
    pub fn save(&mut self, handle: Option<u64>) -> Outcome<u64> {
        self.permit(Call::States)?;
        if let Some(handle) = handle {
            let at = self.find(handle)?;
            let saved = &mut self.saved[at].1;
            if !Arc::ptr_eq(&saved.component, &self.component) {
                saved.component = Arc::clone(&self.component);
                saved.state = self.simulator.new_state();
            }
            self.simulator.save(&mut saved.state)?;
            saved.phase = self.phase;
            saved.start_time = self.start_time;
            saved.parameters.copy_from_slice(&self.parameters);
            saved.slopes.copy_from_slice(&self.slopes);
            return Ok(handle);
        }
        let saved = Saved {
            component: Arc::clone(&self.component),
            state: self.simulator.state().clone(),
            phase: self.phase,
            start_time: self.start_time,
            parameters: self.parameters.clone(),
            slopes: self.slopes.clone(),
        };
        Ok(self.keep(saved))
    }

    /// Handles are numbers, never addresses, and are not used twice: a freed or foreign one is not mistaken for another.
    fn keep(&mut self, saved: Saved) -> u64 {
        self.saves += 1;
        let handle = (self.serial << 32) | self.saves;
        self.saved.push((handle, saved));
        handle
    }

    fn find(&self, handle: u64) -> Outcome<usize> {
        let unknown = || {
            Fault::error(
                "this is no saved state of this instance: freed, or saved by another instance",
            )
        };
        self.saved
            .iter()
            .position(|(h, _)| *h == handle)
            .ok_or_else(unknown)
    }

    pub fn restore(&mut self, handle: u64) -> Outcome {
        self.permit(Call::States)?;
        let at = self.find(handle)?;
        let saved = &self.saved[at].1;
        if !Arc::ptr_eq(&saved.component, &self.component) {
            self.simulator = Simulator::new(Arc::clone(&saved.component.model));
            self.component = Arc::clone(&saved.component);
        }
        self.simulator.restore(&saved.state)?;
        self.phase = saved.phase;
        self.start_time = saved.start_time;
        self.parameters.copy_from_slice(&saved.parameters);
        self.slopes.copy_from_slice(&saved.slopes);
        self.are_values_fresh = false;
        Ok(())
    }

    pub fn free_saved(&mut self, handle: u64) -> Outcome {
        let at = self.find(handle)?;
        self.saved.swap_remove(at);
        Ok(())
    }

    pub fn serialized_len(&self, handle: u64) -> Outcome<usize> {
        self.permit(Call::States)?;
        Ok(self.saved[self.find(handle)?].1.byte_len())
    }

    pub fn serialize(&self, handle: u64, out: &mut [u8]) -> Outcome {
        self.permit(Call::States)?;
        let bytes = self.saved[self.find(handle)?].1.to_bytes();
        match out.get_mut(..bytes.len()) {
            Some(out) => out.copy_from_slice(&bytes),
            None => {
                let (needed, found) = (bytes.len(), out.len());
                return Err(Fault::error(format!(
                    "the state needs {needed} bytes, the buffer has {found}"
                )));
            }
        }
        Ok(())
    }

    pub fn deserialize(&mut self, bytes: &[u8]) -> Outcome<u64> {
        self.permit(Call::States)?;
        let inputs = self.slopes.len();
        let saved = Saved::from_bytes(bytes, inputs, |parameters| self.component_of(parameters))?;
        Ok(self.keep(saved))
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
