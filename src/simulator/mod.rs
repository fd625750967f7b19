//! A simulator: one state of one model, driven by a master.

pub mod course;
pub mod drive;
mod inputs;
mod material;
mod reading;
mod saving;
mod work;

pub use reading::Past;

use crate::error::{Error, Result};
use crate::model::Model;
use crate::ports::{Causality, Port, Quantity};
use crate::state::State;
use crate::time::companion::{Alone, Companion};
use crate::time::control;
use crate::time::input_course;
use crate::time::record::record;
use crate::time::second;
use crate::time::sizes::MOST_INTERNAL_STEPS;
use crate::time::stage::settle;
use crate::time::step;
use crate::time::workspace::{Bend, Workspace};
use std::sync::Arc;

/// Relative deviation of the time of a call from the simulator's own that still counts as the same instant.
const SAME_INSTANT: f64 = 1e-6;

/// One simulation. Steps allocate nothing once the models' step sizes are known; a failed call changes nothing.
pub struct Simulator {
    model: Arc<Model>,
    /// The model it was made of: that of the numbers of the scene, where a material stays free.
    compiled: Arc<Model>,
    state: State,
    /// The state before the last step, its recorded past apart, for derivatives of it.
    previous: State,
    /// Size of the last step; `None` when the state is not the end of a step of this simulator.
    last_step: Option<f64>,
    trial: State,
    workspace: Workspace,
    /// Where inputs bend in the next step.
    bends: Vec<Bend>,
}

impl Clone for Simulator {
    /// The same simulation in the same state, independent from here on; the model is shared.
    fn clone(&self) -> Simulator {
        Simulator {
            model: Arc::clone(&self.model),
            compiled: Arc::clone(&self.compiled),
            state: self.state.clone(),
            previous: self.previous.clone(),
            last_step: self.last_step,
            trial: self.trial.clone(),
            workspace: Workspace::new(&self.model),
            bends: self.bends.clone(),
        }
    }
}

impl Simulator {
    /// A simulator before initialization.
    pub fn new(model: Arc<Model>) -> Simulator {
        let state = State::new(&model);
        Simulator {
            previous: state.clone(),
            last_step: None,
            trial: state.clone(),
            workspace: Workspace::new(&model),
            bends: Vec::new(),
            state,
            compiled: Arc::clone(&model),
            model,
        }
    }

    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Whether the simulation has begun.
    pub fn is_initialized(&self) -> bool {
        self.state.is_initialized != 0
    }

    /// Starts the simulation at `time` with the body undeformed, or displaced as `initial.displacement` says; inputs set before are
    /// the loads at that instant.
    ///
    /// # Errors
    /// [`Error::CallOrder`] when already initialized, [`Error::Value`] for a time that is not finite or for friction
    /// coefficients that do not fit each other, [`Error::NotConverged`], [`Error::Overflow`]; those of [`Model::with_material`] for
    /// numbers of a free material.
    pub fn init(&mut self, time: f64) -> Result<()> {
        if self.is_initialized() {
            return Err(Error::CallOrder {
                call: "init",
                expected: "init is called once; reset starts over",
            });
        }
        if !time.is_finite() {
            return Err(Error::Value {
                what: "the start time".into(),
                found: time,
                allowed: "a finite number",
            });
        }
        self.check_coefficients()?;
        self.take_material()?;
        self.attempt(|model, state, ws| {
            state.time = time;
            state.needs_settling = 0;
            input_course::start(model, state);
            state.start_memory(model);
            state.start_displacement(model);
            settle(model, state, ws, input_course::start_approach(model, state))?;
            second::start(model, state);
            control::start(model, state);
            state.is_initialized = 1;
            record(model, state);
            Ok(())
        })
    }

    /// Back to the state before initialization, with the inputs and coefficients of the scene.
    pub fn reset(&mut self) {
        self.put_model(Arc::clone(&self.compiled));
        self.state = State::new(&self.model);
        self.last_step = None;
    }

    /// Sets all inputs: the load intensities at the end of the next step (before [`Simulator::init`]: at the start), or what
    /// [`Simulator::set_inputs_meaning`] made of them. They stay until set again.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Value`] for a number that is not finite.
    pub fn set_inputs(&mut self, values: &[f64]) -> Result<()> {
        if values.len() != self.state.inputs.len() {
            return Err(Error::Length {
                what: "inputs",
                expected: self.state.inputs.len(),
                found: values.len(),
            });
        }
        if let Some(at) = values.iter().position(|v| !v.is_finite()) {
            return Err(Error::Value {
                what: format!("input {}", self.model.ports().all()[at].name),
                found: values[at],
                allowed: "a finite number",
            });
        }
        self.state.inputs.copy_from_slice(values);
        Ok(())
    }

    /// The loads jump to `values` now, at the end of the last step: the next step begins with them, and the velocity follows
    /// before it is taken. The outputs stay those before the jump until then. Inputs become `values` too.
    ///
    /// # Errors
    /// Those of [`Simulator::set_inputs`].
    pub fn jump_inputs(&mut self, values: &[f64]) -> Result<()> {
        self.set_inputs(values)?;
        if input_course::jump(&self.model, &mut self.state) {
            self.state.needs_settling = self.state.is_initialized;
        }
        Ok(())
    }

    /// Sets one input or parameter. A coefficient of the friction law is checked against its own range here, and against the
    /// other coefficients when the set is complete: by [`Simulator::init`] or the next [`Simulator::do_step`]. So coefficients
    /// are set in any order. Outputs stay those of the last step or initialization until then.
    ///
    /// # Errors
    /// [`Error::Unknown`], [`Error::CallOrder`] for an output, [`Error::Value`], [`Error::Length`] for an array.
    pub fn set(&mut self, reference: u32, value: f64) -> Result<()> {
        let model = Arc::clone(&self.model);
        let port = model.ports().get(reference)?;
        let quantity = settable(&model, port, value)?;
        self.check_phase(quantity)?;
        self.check_count(port.len(), 1)?;
        self.put(quantity, 0, value);
        Ok(())
    }

    /// Sets one element of an input or parameter, otherwise as [`Simulator::set`] does.
    ///
    /// # Errors
    /// Those of [`Simulator::set`]; [`Error::Length`] for an element that the port does not have.
    pub fn set_element(&mut self, reference: u32, element: usize, value: f64) -> Result<()> {
        let model = Arc::clone(&self.model);
        let port = model.ports().get(reference)?;
        if element >= port.len() {
            return Err(Error::Length {
                what: "elements of the port",
                expected: port.len(),
                found: element.saturating_add(1),
            });
        }
        let quantity = settable(&model, port, value)?;
        self.check_phase(quantity)?;
        self.put(quantity, element, value);
        Ok(())
    }

    /// Sets inputs and parameters together: the values of the ports `references` one after the other, of an array all of them; of
    /// a port named twice the last values hold. The friction coefficients that result are checked as a set. All is set or, on
    /// an error, nothing.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are as many values as the ports have; those of [`Simulator::set`]; [`Error::Value`] for
    /// coefficients that do not fit each other.
    pub fn set_many(&mut self, references: &[u32], values: &[f64]) -> Result<()> {
        let model = Arc::clone(&self.model);
        let mut count: usize = 0;
        for reference in references {
            let port = model.ports().get(*reference)?;
            if port.causality == Causality::Output {
                return Err(Error::CallOrder {
                    call: "set",
                    expected: "the port is an output",
                });
            }
            count = count.saturating_add(port.len());
        }
        self.check_count(count, values.len())?;
        self.check_material_ports(references, values)?;
        // the trial state is scratch between steps
        let coefficients = &mut self.trial.coefficients;
        coefficients.copy_from_slice(&self.state.coefficients);
        let mut has_coefficients = false;
        let mut rest = values.iter();
        for reference in references {
            let port = model.ports().get(*reference)?;
            for (element, value) in rest.by_ref().take(port.len()).enumerate() {
                if let Quantity::Coefficient(i) = settable(&model, port, *value)? {
                    coefficients[model.friction().places()[i].first + element] = *value;
                    has_coefficients = true;
                }
            }
        }
        if has_coefficients {
            model.friction().check(coefficients)?;
        }
        let mut rest = values.iter();
        for reference in references {
            let port = model.ports().get(*reference)?;
            for (element, value) in rest.by_ref().take(port.len()).enumerate() {
                self.put(port.quantity, element, *value);
            }
        }
        Ok(())
    }

    fn check_count(&self, expected: usize, found: usize) -> Result<()> {
        if expected == found {
            return Ok(());
        }
        Err(Error::Length {
            what: "values to set",
            expected,
            found,
        })
    }

    /// Refuses friction coefficients that do not fit each other: what [`Simulator::init`] and [`Simulator::do_step`] do first.
    ///
    /// # Errors
    /// [`Error::Value`] that names a coefficient.
    pub fn check_coefficients(&self) -> Result<()> {
        self.model.friction().check(&self.state.coefficients)
    }

    /// Puts a value that has been checked where it belongs.
    fn put(&mut self, quantity: Quantity, element: usize, value: f64) {
        match quantity {
            Quantity::Input(i) => self.state.inputs[i] = value,
            Quantity::Coefficient(i) => {
                let at = self.model.friction().places()[i].first + element;
                if self.state.coefficients[at] != value {
                    self.state.coefficients[at] = value;
                    self.state.needs_settling = self.state.is_initialized;
                }
            }
            Quantity::Material(i) => self.state.material[i] = value,
            _ => {}
        }
    }

    /// Steps from `time` to `time + step`. A step of any size is cut into internal steps not larger than `time.step`: equal
    /// ones, or, with `time.tolerance`, as small as that asks for.
    ///
    /// # Errors
    /// [`Error::CallOrder`] before initialization, [`Error::Step`] for a step that is not positive or a time that does not
    /// continue the simulation, or that takes more than a million internal steps, [`Error::Value`] for friction coefficients
    /// that do not fit each other, [`Error::NotConverged`], [`Error::ToleranceOutOfReach`], [`Error::Overflow`] for results
    /// that are too large for a number. The state is then bit for bit what it was.
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<()> {
        if !self.is_initialized() {
            return Err(Error::CallOrder {
                call: "do_step",
                expected: "init first",
            });
        }
        if !(step.is_finite() && step > 0.0) {
            return Err(Error::Step {
                what: "communication step (finite and positive)",
                expected: self.model.largest_step(),
                found: step,
            });
        }
        let longest = MOST_INTERNAL_STEPS as f64 * self.model.largest_step();
        if step > longest {
            return Err(Error::Step {
                what: "communication step (at most a million internal steps)",
                expected: longest,
                found: step,
            });
        }
        let slack = SAME_INSTANT * step + 4.0 * f64::EPSILON * self.state.time.abs();
        let is_continuous = (time - self.state.time).abs() <= slack;
        if !is_continuous {
            return Err(Error::Step {
                what: "time of the step",
                expected: self.state.time,
                found: time,
            });
        }
        if time + step <= time {
            return Err(Error::Step {
                what: "communication step (at least the resolution of the time at which it begins)",
                expected: time.next_up() - time,
                found: step,
            });
        }
        self.check_coefficients()?;
        // those of the step before serve its derivatives until here
        std::mem::swap(&mut self.workspace.course.bends, &mut self.bends);
        self.bends.clear();
        self.attempt(|model, state, ws| {
            step::advance(model, state, ws, step, &mut Alone)?;
            state.time = time + step;
            Ok(())
        })?;
        std::mem::swap(&mut self.previous, &mut self.trial);
        self.last_step = Some(step);
        Ok(())
    }

    /// Runs `change` on a copy of the state, which becomes the state only when it succeeds and leaves finite numbers.
    fn attempt(
        &mut self,
        change: impl FnOnce(&Model, &mut State, &mut Workspace) -> Result<()>,
    ) -> Result<()> {
        self.trial.copy_present_from(&self.state)?;
        change(&self.model, &mut self.trial, &mut self.workspace)?;
        self.workspace.finite.check(&self.model, &self.trial)?;
        std::mem::swap(&mut self.state, &mut self.trial);
        self.state.take_past(&mut self.trial);
        Ok(())
    }

    /// Whether the state is the end of a step of this simulator, which [`Simulator::directional_derivative`] is of.
    pub fn has_last_step(&self) -> bool {
        self.last_step.is_some()
    }

    /// Solves something at the present state on the side.
    ///
    /// # Errors
    /// [`Error::CallOrder`] before initialization, [`Error::Value`] for friction coefficients that do not fit each other.
    pub(crate) fn solve_here(
        &mut self,
        call: &'static str,
        solve: impl FnOnce(&Model, &State, &mut Workspace) -> Result<()>,
    ) -> Result<()> {
        if !self.is_initialized() {
            return Err(Error::CallOrder {
                call,
                expected: "init first",
            });
        }
        self.check_coefficients()?;
        solve(&self.model, &self.state, &mut self.workspace)
    }

    /// Takes the last step once more, on the side and with a companion.
    ///
    /// # Errors
    /// [`Error::CallOrder`] when the state is not the end of a step.
    pub(crate) fn repeat_last_step(&mut self, companion: &mut impl Companion) -> Result<()> {
        let Some(step) = self.last_step else {
            return Err(Error::CallOrder {
                call: "the derivative of a step",
                expected: "do_step first (init, restore and reset leave no step behind)",
            });
        };
        self.trial.copy_present_from(&self.previous)?;
        let (trial, workspace) = (&mut self.trial, &mut self.workspace);
        step::advance(&self.model, trial, workspace, step, companion)
    }
}

/// What a value would be set to.
///
/// # Errors
/// [`Error::CallOrder`] for an output, [`Error::Value`] for a value that the port cannot have by itself.
fn settable(model: &Model, port: &Port, value: f64) -> Result<Quantity> {
    if !value.is_finite() {
        return Err(Error::Value {
            what: port.name.clone(),
            found: value,
            allowed: "a finite number",
        });
    }
    match port.quantity {
        Quantity::Input(_) => {}
        Quantity::Material(i) => model.check_number(i, value)?,
        Quantity::Coefficient(i) => {
            let (part, own) = model.friction().coefficient(i);
            part.law.check_value(own, value)?;
            let can_open = model.contact().can_open_at(part.nodes.start);
            if value != 0.0 && part.law.law().is_cohesion(own) && can_open {
                return Err(Error::Value {
                    what: port.name.clone(),
                    found: value,
                    allowed: "0 where contact can open",
                });
            }
        }
        _ => {
            return Err(Error::CallOrder {
                call: "set",
                expected: "the port is an output",
            });
        }
    }
    Ok(port.quantity)
}
