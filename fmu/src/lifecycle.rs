//! The lifecycle of an instance, the same for FMI 2 and FMI 3: phases, one table of allowed calls, and the
//! calls that lead from phase to phase; values, derivatives and saved states have their own files.
//!
//! A refused call changes nothing: the phase, the state and the values stay, and the importer may go on, for instance by
//! restoring a saved state, with another step or by a reset. After a panic only freeing is left.

mod derivatives;
mod events;
mod states;
mod values;

use crate::component::Component;
use crate::fault::{Fault, Outcome};
use crate::log::{Category, Log};
use crate::notes::Notes;
use crate::parameters;
use crate::phase::Phase;
use crate::registry;
use crate::saved::Saved;
use crate::variables::Role;
use events::Events;
use std::sync::Arc;
use stickslip::Simulator;

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
    EnterEventMode,
    UpdateDiscreteStates,
    EnterStepMode,
}

/// Allowed calls: before initialization, in initialization mode, in step mode, after termination, in event mode.
const ALLOWED: [(Call, [bool; 5]); 18] = {
    const Y: bool = true;
    const N: bool = false;
    [
        (Call::SetDebugLogging, [Y, Y, Y, Y, Y]),
        (Call::SetupExperiment, [Y, N, N, N, N]),
        (Call::EnterInitialization, [Y, N, N, N, N]),
        (Call::ExitInitialization, [N, Y, N, N, N]),
        (Call::DoStep, [N, N, Y, N, N]),
        (Call::Terminate, [N, N, Y, N, Y]),
        (Call::Reset, [Y, Y, Y, Y, Y]),
        (Call::Get, [Y, Y, Y, Y, Y]),
        (Call::SetInput, [Y, Y, Y, N, Y]),
        (Call::SetTunable, [Y, Y, Y, N, Y]),
        (Call::SetFixed, [Y, Y, N, N, N]),
        (Call::SetSlope, [Y, Y, Y, N, Y]),
        (Call::GetSlope, [N, N, Y, Y, Y]),
        (Call::Derivative, [N, Y, Y, Y, Y]),
        (Call::States, [Y, Y, Y, Y, Y]),
        (Call::EnterEventMode, [N, N, Y, N, N]),
        (Call::UpdateDiscreteStates, [N, N, N, N, Y]),
        (Call::EnterStepMode, [N, N, N, N, Y]),
    ]
};

/// Share of a step by which it may end after the stop time.
const PAST_STOP: f64 = 1e-3;

/// What the importer says about its simulation.
#[derive(Debug, Clone, Copy)]
pub struct Experiment {
    pub start_time: f64,
    /// Time that no step goes past.
    pub stop_time: Option<f64>,
    /// Relative tolerance, for scenes with `time.tolerance`.
    pub tolerance: Option<f64>,
}

/// One instance of the FMU.
pub struct Instance {
    pub log: Log,
    /// What steps have noted and the log was told.
    notes: Notes,
    /// The FMU as packed.
    packed: Arc<Component>,
    /// The FMU with the parameters of this instance, once compiled.
    component: Arc<Component>,
    simulator: Simulator,
    phase: Phase,
    start_time: f64,
    /// Time beyond which the importer promised not to step.
    stop_time: Option<f64>,
    parameters: Vec<f64>,
    /// All values, in the order of the variables.
    values: Vec<f64>,
    are_values_fresh: bool,
    saved: Vec<(u64, Saved)>,
    serial: u64,
    saves: u64,
    /// Present when the importer uses event mode.
    events: Option<Events>,
}

impl Instance {
    pub fn new(component: Arc<Component>, log: Log, serial: u64) -> Instance {
        let simulator = Simulator::new(Arc::clone(&component.model));
        Instance {
            log,
            notes: Notes::default(),
            phase: Phase::Instantiated,
            start_time: 0.0,
            stop_time: None,
            parameters: component.parameters.clone(),
            values: vec![0.0; component.variables.len()],
            are_values_fresh: false,
            saved: Vec::new(),
            serial,
            saves: 0,
            events: None,
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

    /// FMI 2 states the experiment apart from the initialization.
    pub fn setup(&mut self, experiment: Experiment) -> Outcome {
        self.permit(Call::SetupExperiment)?;
        self.take_up(experiment)
    }

    fn take_up(&mut self, experiment: Experiment) -> Outcome {
        let Experiment {
            start_time: start,
            stop_time: stop,
            tolerance,
        } = experiment;
        if !start.is_finite() {
            return Err(Fault::error(format!(
                "start time {start}: expected a finite number"
            )));
        }
        if let Some(stop) = stop.filter(|stop| !(stop.is_finite() && *stop >= start)) {
            return Err(Fault::error(format!(
                "stop time {stop}: expected a finite number that is not before the start time {start}"
            )));
        }
        if let Some(place) = self
            .component
            .variables
            .parameters()
            .place("time.tolerance")
            && let Some(tolerance) = tolerance
            && self.parameters[place] != 0.0
        {
            if !(tolerance.is_finite() && tolerance > 0.0) {
                return Err(Fault::error(format!(
                    "tolerance {tolerance}: expected a finite positive number"
                )));
            }
            self.parameters[place] = tolerance;
        }
        self.start_time = start;
        self.stop_time = stop;
        self.are_values_fresh = false;
        Ok(())
    }

    /// Enters initialization mode; FMI 3 states the experiment with it.
    pub fn enter_initialization(&mut self, experiment: Option<Experiment>) -> Outcome {
        self.permit(Call::EnterInitialization)?;
        let before = (self.start_time, self.stop_time, self.parameters.clone());
        if let Some(experiment) = experiment {
            self.take_up(experiment)?;
        }
        if let Err(fault) = self.compile() {
            (self.start_time, self.stop_time, self.parameters) = before;
            return Err(fault);
        }
        self.phase = Phase::Initialization;
        Ok(())
    }

    pub fn exit_initialization(&mut self) -> Outcome {
        self.permit(Call::ExitInitialization)?;
        self.compile()?;
        self.simulator.init(self.start_time)?;
        self.phase = self.phase_after_initialization();
        self.are_values_fresh = false;
        Ok(())
    }

    /// Takes up fixed parameters that were set.
    fn compile(&mut self) -> Outcome {
        if parameters::is_other_model(&self.parameters, &self.component.parameters) {
            let component = self.component_of(&self.parameters)?;
            let list = self.component.variables.parameters();
            let changes = list.overrides(&self.component.parameters, &self.parameters);
            let names: Vec<_> = changes
                .into_iter()
                .map(|(path, value)| format!("{path} = {value}"))
                .collect();
            let how = match self.packed.free_values(&self.parameters) {
                Some(_) => "set without compiling",
                None => "compiled with",
            };
            self.log
                .write(0, Category::Event, &format!("{how} {}", names.join(", ")));
            self.adopt(component)?;
        }
        let meaning = parameters::inputs_meaning(&self.parameters);
        Ok(self.simulator.set_inputs_meaning(meaning)?)
    }

    fn component_of(&self, parameters: &[f64]) -> Outcome<Arc<Component>> {
        if !parameters::is_other_model(parameters, &self.packed.parameters) {
            Ok(Arc::clone(&self.packed))
        } else {
            self.packed.with_parameters(parameters, registry::shared)
        }
    }

    /// Changes the model before the simulation starts, with the inputs and coefficients that were set.
    fn adopt(&mut self, component: Arc<Component>) -> Outcome {
        let mut simulator = Simulator::new(Arc::clone(&component.model));
        for variable in component.variables.all() {
            if let (Some(port), Role::Input | Role::Tunable) = (variable.port, variable.role) {
                let mut values = vec![0.0; variable.len];
                self.simulator.get(port, &mut values)?;
                for (element, value) in values.iter().enumerate() {
                    simulator.set_element(port, element, *value)?;
                }
                if let Some(slope) = self.simulator.input_slope(port) {
                    simulator.set_input_slope(port, Some(slope))?;
                }
            }
        }
        self.simulator = simulator;
        self.component = component;
        self.are_values_fresh = false;
        Ok(())
    }

    pub fn do_step(&mut self, time: f64, step: f64) -> Outcome {
        self.permit(Call::DoStep)?;
        if let Some(stop) = self.stop_time {
            // rounding that masters accumulate over many steps must not change the pad's step
            let slack = PAST_STOP * step + 64.0 * f64::EPSILON * stop.abs();
            if time + step > stop + slack {
                return Err(Fault::error(format!(
                    "a step from {time} to {} goes past the stop time {stop} of the experiment",
                    time + step
                )));
            }
        }
        self.simulator.do_step(time, step)?;
        self.notes.tell(&self.simulator, time, &self.log);
        self.are_values_fresh = false;
        Ok(())
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
        self.start_time = 0.0;
        self.stop_time = None;
        self.notes = Notes::default();
        self.phase = Phase::Instantiated;
        self.are_values_fresh = false;
        Ok(())
    }
}
