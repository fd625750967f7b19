//! The lifecycle of an instance, the same for FMI 2 and FMI 3: phases, one table of allowed calls, and the
//! calls that lead from phase to phase; values, derivatives and saved states have their own files.
//!
//! A refused call changes nothing: the phase, the state and the values stay, and the importer may go on, for instance by
//! restoring a saved state, with another step or by a reset. After a panic only freeing is left.

mod derivatives;
mod states;
mod values;

use crate::component::Component;
use crate::fault::{Fault, Outcome};
use crate::log::{Category, Log};
use crate::parameters;
use crate::saved::Saved;
use crate::variables::Role;
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
}
