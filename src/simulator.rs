//! A simulator: one state of one model, driven by a master.

use crate::companion::{Alone, Companion};
use crate::error::{Error, Result};
use crate::error_estimate;
use crate::friction::newton::Work;
use crate::model::Model;
use crate::ports::Quantity;
use crate::readout;
use crate::record::record;
use crate::state::{State, history_row, report};
use crate::step;
use crate::step_control;
use crate::step_sizes::MOST_INTERNAL_STEPS;
use crate::workspace::Workspace;
use std::sync::Arc;

/// Relative deviation of the time of a call from the simulator's own that still counts as the same instant.
const SAME_INSTANT: f64 = 1e-6;

/// One simulation. Steps allocate nothing once the models' step sizes are known; a failed call changes nothing.
pub struct Simulator {
    model: Arc<Model>,
    state: State,
    /// The state before the last step, its recorded past apart, for derivatives of it.
    previous: State,
    /// Size of the last step; `None` when the state is not the end of a step of this simulator.
    last_step: Option<f64>,
    trial: State,
    workspace: Workspace,
}

impl Clone for Simulator {
    /// The same simulation in the same state, independent from here on; the model is shared.
    fn clone(&self) -> Simulator {
        Simulator {
            model: Arc::clone(&self.model),
            state: self.state.clone(),
            previous: self.previous.clone(),
            last_step: self.last_step,
            trial: self.trial.clone(),
            workspace: Workspace::new(&self.model),
        }
    }
}

/// One row of the recorded past of a contact node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Past<'a> {
    /// Time, s.
    pub time: f64,
    /// Slip rate, one value per tangential component, m/s.
    pub slip_rate: &'a [f64],
    /// Slip, m.
    pub slip: &'a [f64],
    /// Tangential stress on the body, Pa.
    pub tangential_stress: &'a [f64],
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
            state,
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

    /// Starts the simulation at `time` with the body undeformed; inputs set before are the loads at that instant.
    ///
    /// # Errors
    /// [`Error::CallOrder`] when already initialized, [`Error::Value`] for a time that is not finite,
    /// [`Error::NotConverged`].
    pub fn init(&mut self, time: f64) -> Result<()> {
        if self.state.is_initialized != 0 {
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
        self.attempt(|model, state, ws| {
            state.time = time;
            state.loads.copy_from_slice(&state.inputs);
            state.needs_settling = 0;
            step::settle(model, state, ws)?;
            error_estimate::start(model, state);
            step_control::start(model, state);
            state.is_initialized = 1;
            record(model, state);
            Ok(())
        })
    }

    /// Back to the state before initialization, with the inputs and coefficients of the scene.
    pub fn reset(&mut self) {
        self.state = State::new(&self.model);
        self.last_step = None;
    }

    /// Sets all inputs: the load intensities at the end of the next step (before [`Simulator::init`]: at the start).
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

    /// Sets one input or parameter.
    ///
    /// # Errors
    /// [`Error::Unknown`], [`Error::CallOrder`] for an output, [`Error::Value`].
    pub fn set(&mut self, reference: u32, value: f64) -> Result<()> {
        let model = Arc::clone(&self.model);
        let port = model.ports().get(reference)?;
        if !value.is_finite() {
            return Err(Error::Value {
                what: port.name.clone(),
                found: value,
                allowed: "a finite number",
            });
        }
        match port.quantity {
            Quantity::Load(i) => self.state.inputs[i] = value,
            Quantity::Coefficient(i) => {
                let mut coefficients = self.state.coefficient_array();
                coefficients[i] = value;
                model.law().with_coefficients(&coefficients)?;
                if self.state.coefficients[i] != value {
                    self.state.coefficients[i] = value;
                    self.state.needs_settling = self.state.is_initialized;
                }
            }
            _ => {
                return Err(Error::CallOrder {
                    call: "set",
                    expected: "the port is an output",
                });
            }
        }
        Ok(())
    }

    /// Steps from `time` to `time + step`. A step of any size is cut into internal steps not larger than `time.step`: equal
    /// ones, or, with `time.tolerance`, as small as that asks for.
    ///
    /// # Errors
    /// [`Error::CallOrder`] before initialization, [`Error::Step`] for a step that is not positive or a time that does not
    /// continue the simulation, or that takes more than a million internal steps, [`Error::NotConverged`],
    /// [`Error::ToleranceOutOfReach`]. The state is then bit for bit what
    /// it was.
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<()> {
        if self.state.is_initialized == 0 {
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
        if !is_continuous || time + step <= time {
            return Err(Error::Step {
                what: "time of the step",
                expected: self.state.time,
                found: time,
            });
        }
        self.attempt(|model, state, ws| {
            step::advance(model, state, ws, step, &mut Alone)?;
            state.time = time + step;
            Ok(())
        })?;
        std::mem::swap(&mut self.previous, &mut self.trial);
        self.last_step = Some(step);
        Ok(())
    }

    /// Runs `change` on a copy of the state, which becomes the state only when it succeeds.
    fn attempt(
        &mut self,
        change: impl FnOnce(&Model, &mut State, &mut Workspace) -> Result<()>,
    ) -> Result<()> {
        self.trial.copy_present_from(&self.state)?;
        change(&self.model, &mut self.trial, &mut self.workspace)?;
        std::mem::swap(&mut self.state, &mut self.trial);
        self.state.take_past(&mut self.trial);
        Ok(())
    }

    /// Values of a port, by its reference, into `out` (of the port's length).
    ///
    /// # Errors
    /// [`Error::Unknown`], [`Error::Length`].
    pub fn get(&self, reference: u32, out: &mut [f64]) -> Result<()> {
        let port = self.model.ports().get(reference)?;
        if out.len() != port.len() {
            return Err(Error::Length {
                what: "values of the port",
                expected: port.len(),
                found: out.len(),
            });
        }
        readout::read(&self.model, &self.state, port, out);
        Ok(())
    }

    /// Values of a port, by its name.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    pub fn get_by_name(&self, name: &str) -> Result<Vec<f64>> {
        let port = self.model.ports().find(name)?;
        let mut out = vec![0.0; port.len()];
        readout::read(&self.model, &self.state, port, &mut out);
        Ok(out)
    }

    /// Number of values of all outputs together.
    pub fn output_len(&self) -> usize {
        self.model.ports().output_len()
    }

    /// All outputs one after the other, in the order of their references.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn get_outputs(&self, out: &mut [f64]) -> Result<()> {
        if out.len() != self.output_len() {
            return Err(Error::Length {
                what: "outputs",
                expected: self.output_len(),
                found: out.len(),
            });
        }
        let mut rest = out;
        for port in self.model.ports().outputs() {
            let (head, tail) = rest.split_at_mut(port.len());
            readout::read(&self.model, &self.state, port, head);
            rest = tail;
        }
        Ok(())
    }

    /// The recorded past of a contact node, oldest first: at most `history.capacity` internal steps.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a node beyond the last.
    pub fn slip_history(&self, node: usize) -> Result<impl Iterator<Item = Past<'_>>> {
        let contact = self.model.contact();
        if node >= contact.node_count() {
            return Err(Error::Unknown {
                what: "contact node",
                found: node.to_string(),
            });
        }
        let (c, m) = (contact.components, contact.len());
        let capacity = self.model.history_capacity() as u64;
        let kept = self.state.recorded.min(capacity);
        let row_len = history_row(m);
        let history = &self.state.history;
        Ok(
            (self.state.recorded - kept..self.state.recorded).map(move |i| {
                let at = (i % capacity) as usize * row_len;
                let row = &history[at..at + row_len];
                let part = |block: usize| &row[1 + block * m + node * c..][..c];
                Past {
                    time: row[0],
                    slip_rate: part(0),
                    slip: part(1),
                    tangential_stress: part(2),
                }
            }),
        )
    }

    /// A state of this model to save into; holds the state before initialization.
    pub fn new_state(&self) -> State {
        State::new(&self.model)
    }

    /// Copies the state into `to`, a state of the same model; allocates nothing.
    ///
    /// # Errors
    /// [`Error::Fingerprint`] for the state of another model.
    pub fn save(&self, to: &mut State) -> Result<()> {
        to.copy_from(&self.state)
    }

    /// Makes a saved state the current one; allocates nothing. There is no step to take derivatives of afterwards.
    ///
    /// # Errors
    /// [`Error::Fingerprint`] for the state of another model.
    pub fn restore(&mut self, from: &State) -> Result<()> {
        self.state.copy_from(from)?;
        self.last_step = None;
        Ok(())
    }

    /// The state as versioned, checksummed bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.state.to_bytes()
    }

    /// Continues from the bytes of a state of the same model; on failure the state stays. There is no step to take
    /// derivatives of afterwards.
    ///
    /// # Errors
    /// [`Error::Bytes`], [`Error::Fingerprint`].
    pub fn restore_bytes(&mut self, bytes: &[u8]) -> Result<()> {
        self.state.read_bytes(bytes)?;
        self.last_step = None;
        Ok(())
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

    /// Most solutions of one internal step of the last communication step that the multiplicity test found (0 when it is
    /// off), and the largest difference between them, m/s.
    pub fn solutions(&self) -> (f64, f64) {
        let report = &self.state.report;
        (report[report::SOLUTIONS], report[report::SOLUTION_GAP])
    }

    /// Keeps the iterates of the fixed-point solver from now on; steps then allocate.
    pub fn keep_iterates(&mut self) {
        self.workspace.fixed_point.keep_trace();
    }

    /// Iterates of the last stage that the fixed-point solver solved: slip rates (m/s) and forces on the foundation (N).
    /// Empty unless kept.
    pub fn iterates(&self) -> impl Iterator<Item = (&[f64], &[f64])> {
        self.workspace.fixed_point.iterates()
    }

    /// Work done so far by the default friction solver.
    pub fn friction_work(&self) -> Work {
        self.workspace.newton.work()
    }

    /// Internal steps since the start of the simulation; part of the state.
    pub fn internal_steps(&self) -> u64 {
        self.state.steps
    }

    /// Stages solved so far by this simulator, those of refused steps, error estimates and derivatives included.
    pub fn stage_solves(&self) -> u64 {
        self.workspace.stages.solves()
    }

    /// Pairs of internal steps that the step control has refused so far.
    pub fn refused_pairs(&self) -> u64 {
        let control = self.workspace.control.as_ref();
        control.map_or(0, |control| control.refused)
    }

    /// Stage factorizations made so far: one per step size that was not among the last few.
    pub fn factorizations(&self) -> u64 {
        self.workspace.stages.factorizations
    }
}
