//! The state: all that future steps depend on, and nothing else. Small, flat, compared and restored bit for bit.

mod bytes;
mod plausible;
mod second;

pub(crate) use second::Second;

use crate::contact::law::MAX_COEFFICIENTS;
use crate::contact::solve::newton::linearisation::no_points;
use crate::error::{Error, Result};
use crate::linalg::dot;
use crate::model::Model;
use crate::scene::Inputs;

/// Where a simulation stands. Vectors over the contact go node by node, components inner.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Fingerprint of the model it belongs to.
    fingerprint: u64,
    /// Time, s.
    pub(crate) time: f64,
    /// Internal steps taken.
    pub(crate) steps: u64,
    /// Rows ever written to the history.
    pub(crate) recorded: u64,
    /// 0 before initialization, 1 after.
    pub(crate) is_initialized: u64,
    /// 1 when a coefficient changed and the velocity must be made consistent again.
    pub(crate) needs_settling: u64,
    /// What the inputs mean, by its place in [`MEANINGS`].
    meaning: u64,
    /// Displacement of the body, in the coordinates of its model.
    pub(crate) displacement: Vec<f64>,
    /// Velocity of the body, in the coordinates of its model.
    pub(crate) velocity: Vec<f64>,
    /// Tangential velocity of the contact nodes relative to the foundation, m/s (also the warm start).
    pub(crate) slip_rate: Vec<f64>,
    /// Tangential displacement relative to the foundation, m.
    pub(crate) slip: Vec<f64>,
    /// Contact forces Lambda of the friction law, N; the force on the body is minus this. A node that slips carries its bound.
    pub(crate) force: Vec<f64>,
    /// Contact forces with which the body is in balance, N: those of the law but for what the friction solver leaves. They
    /// do the work in the energy balance.
    pub(crate) reaction: Vec<f64>,
    /// Accumulated slip, m, one per node.
    pub(crate) accumulated_slip: Vec<f64>,
    /// Load intensities now.
    pub(crate) loads: Vec<f64>,
    /// Load intensities as set last; `meaning` says where in the next step.
    pub(crate) inputs: Vec<f64>,
    /// What is remembered of the inputs, and slopes that were given; see [`input_memory`].
    pub(crate) input_memory: Vec<f64>,
    /// Work-conjugate integrals of the loads, then probes: of the displacement.
    pub(crate) output_displacement: Vec<f64>,
    /// The same of the velocity.
    pub(crate) output_velocity: Vec<f64>,
    /// External work, elastic energy, viscous and frictional dissipation, J.
    pub(crate) energy: Vec<f64>,
    /// Coefficients of the friction law.
    pub(crate) coefficients: Vec<f64>,
    /// Points at which the friction solver last factored its matrix (see `friction::linearisation`).
    pub(crate) linearisation: Vec<f64>,
    /// Account of the last communication step; see [`report`].
    pub(crate) report: Vec<f64>,
    /// What step control and error estimate remember; see [`control`].
    pub(crate) control: Vec<f64>,
    /// The second solution; empty without an error estimate.
    pub(crate) second: Second,
    /// Ring of the last internal steps: time, slip rate, slip, tangential stress.
    pub(crate) history: Vec<f64>,
}

/// Places in `State::energy`.
pub(crate) mod energy {
    pub const EXTERNAL_WORK: usize = 0;
    pub const ELASTIC: usize = 1;
    pub const VISCOUS: usize = 2;
    pub const FRICTION: usize = 3;
    pub const COUNT: usize = 4;
}

/// Places in `State::report`.
pub(crate) mod report {
    pub const ITERATIONS: usize = 0;
    pub const RESIDUAL: usize = 1;
    pub const SOLUTIONS: usize = 2;
    pub const SOLUTION_GAP: usize = 3;
    /// 1 when the friction law holds as well as rounding allows, but not to the tolerance.
    pub const AT_ROUNDING: usize = 4;
    pub const COUNT: usize = 5;
}

/// Places in `State::control`.
pub(crate) mod control {
    /// Size proposed for the next pair of internal steps, s.
    pub const PROPOSED: usize = 0;
    /// Largest slip rate so far, discrete L2 norm over the contact.
    pub const LARGEST_SLIP_RATE: usize = 1;
    /// The same over all pairs tried.
    pub const CONTACT_SCALE: usize = 2;
    /// Largest velocity of the body over all pairs tried, norm of the viscosity.
    pub const BODY_SCALE: usize = 3;
    pub const COUNT: usize = 4;
}

/// Places in `State::input_memory`.
pub(crate) mod input_memory {
    /// Communication points that slopes of inputs are known from: 0, 1, or 2 for more.
    pub const POINTS: usize = 0;
    /// Size of the last communication step, s.
    pub const STEP: usize = 1;
    const LOADS: usize = 2;
    /// Of every load: its input at the beginning of the last step.
    pub const VALUE: usize = 0;
    /// The slope that led there, 1/s.
    pub const SLOPE: usize = 1;
    /// The slope that the host gave, 1/s.
    pub const GIVEN: usize = 2;
    /// 1 when it gave one.
    pub const IS_GIVEN: usize = 3;
    const PER_LOAD: usize = 4;

    pub const fn of_load(load: usize) -> usize {
        LOADS + PER_LOAD * load
    }
}

/// Meanings of the inputs, by their number in a state.
const MEANINGS: [Inputs; 3] = [Inputs::EndOfStep, Inputs::Hold, Inputs::Continue];

const COUNTERS: usize = 6;
const BLOCKS: usize = 26;
/// How many of them, the first ones, internal steps change.
const STEPPED: usize = BLOCKS - 3;

impl State {
    /// The state before initialization.
    pub(crate) fn new(model: &Model) -> State {
        State::with_rows(model, model.history_capacity())
    }

    /// The same with another number of rows in the history.
    fn with_rows(model: &Model, rows: usize) -> State {
        let contact = model.contact().len();
        let nodes = model.contact().node_count();
        let outputs = model.output_count();
        let start = model.start_loads();
        State {
            fingerprint: model.fingerprint(),
            time: 0.0,
            steps: 0,
            recorded: 0,
            is_initialized: 0,
            needs_settling: 0,
            meaning: model.scene().time.inputs.unwrap_or_default() as u64,
            displacement: vec![0.0; model.states()],
            velocity: vec![0.0; model.states()],
            slip_rate: vec![0.0; contact],
            slip: vec![0.0; contact],
            force: vec![0.0; contact],
            reaction: vec![0.0; contact],
            accumulated_slip: vec![0.0; nodes],
            loads: start.clone(),
            input_memory: vec![0.0; input_memory::of_load(start.len())],
            inputs: start,
            output_displacement: vec![0.0; outputs],
            output_velocity: vec![0.0; outputs],
            energy: vec![0.0; energy::COUNT],
            coefficients: model.law().coefficients().to_vec(),
            linearisation: no_points(nodes, model.contact().components),
            report: vec![0.0; report::COUNT],
            control: vec![0.0; control::COUNT],
            second: if model.has_error_estimate() {
                Second {
                    displacement: vec![0.0; model.states()],
                    velocity: vec![0.0; model.states()],
                    slip_rate: vec![0.0; contact],
                    force: vec![0.0; contact],
                    reaction: vec![0.0; contact],
                    accumulated_slip: vec![0.0; nodes],
                    output_velocity: vec![0.0; outputs],
                    linearisation: no_points(nodes, model.contact().components),
                }
            } else {
                Second::default()
            },
            history: vec![0.0; rows * history_row(contact)],
        }
    }

    /// Zeros: the tangent of a state that depends on nothing yet.
    pub(crate) fn zero(model: &Model) -> State {
        let mut state = State::new(model);
        state.blocks_mut().into_iter().for_each(|b| b.fill(0.0));
        state
    }

    /// A state that only [`State::copy_steps_from`] writes.
    pub(crate) fn without_history(model: &Model) -> State {
        State {
            history: Vec::new(),
            ..State::with_rows(model, 0)
        }
    }

    /// The blocks; report, control and history are the last ones.
    fn blocks(&self) -> [&Vec<f64>; BLOCKS] {
        [
            &self.displacement,
            &self.velocity,
            &self.slip_rate,
            &self.slip,
            &self.force,
            &self.reaction,
            &self.accumulated_slip,
            &self.loads,
            &self.inputs,
            &self.input_memory,
            &self.output_displacement,
            &self.output_velocity,
            &self.energy,
            &self.coefficients,
            &self.linearisation,
            &self.second.displacement,
            &self.second.velocity,
            &self.second.slip_rate,
            &self.second.force,
            &self.second.reaction,
            &self.second.accumulated_slip,
            &self.second.output_velocity,
            &self.second.linearisation,
            &self.report,
            &self.control,
            &self.history,
        ]
    }

    fn blocks_mut(&mut self) -> [&mut Vec<f64>; BLOCKS] {
        [
            &mut self.displacement,
            &mut self.velocity,
            &mut self.slip_rate,
            &mut self.slip,
            &mut self.force,
            &mut self.reaction,
            &mut self.accumulated_slip,
            &mut self.loads,
            &mut self.inputs,
            &mut self.input_memory,
            &mut self.output_displacement,
            &mut self.output_velocity,
            &mut self.energy,
            &mut self.coefficients,
            &mut self.linearisation,
            &mut self.second.displacement,
            &mut self.second.velocity,
            &mut self.second.slip_rate,
            &mut self.second.force,
            &mut self.second.reaction,
            &mut self.second.accumulated_slip,
            &mut self.second.output_velocity,
            &mut self.second.linearisation,
            &mut self.report,
            &mut self.control,
            &mut self.history,
        ]
    }

    /// The blocks but for points of linearisation, in which infinity is a mark, and the recorded past.
    fn numbers(&self) -> impl Iterator<Item = &Vec<f64>> {
        let marked = [&self.linearisation, &self.second.linearisation];
        let is_marked = move |block: &Vec<f64>| marked.iter().any(|m| std::ptr::eq(*m, block));
        let blocks = self.blocks().into_iter().take(BLOCKS - 1);
        blocks.filter(move |block| !is_marked(block))
    }

    /// Sum of the squares of all numbers but the recorded past; not a number, or infinite, where one of them is.
    pub(crate) fn sum_of_squares(&self) -> f64 {
        self.numbers().map(|block| dot(block, block)).sum()
    }

    /// Whether all numbers but the recorded past are finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.numbers().flatten().all(|v| v.is_finite())
    }

    /// The blocks that are zero before initialization.
    fn moving(&self) -> impl Iterator<Item = &Vec<f64>> {
        let given = [
            &self.loads,
            &self.inputs,
            &self.input_memory,
            &self.coefficients,
        ];
        let is_given = move |block: &Vec<f64>| given.iter().any(|g| std::ptr::eq(*g, block));
        self.numbers().filter(move |block| !is_given(block))
    }

    fn counters(&self) -> [u64; COUNTERS] {
        [
            self.time.to_bits(),
            self.steps,
            self.recorded,
            self.is_initialized,
            self.needs_settling,
            self.meaning,
        ]
    }

    fn set_counters(&mut self, counters: [u64; COUNTERS]) {
        self.time = f64::from_bits(counters[0]);
        [
            self.steps,
            self.recorded,
            self.is_initialized,
            self.needs_settling,
            self.meaning,
        ] = [
            counters[1],
            counters[2],
            counters[3],
            counters[4],
            counters[5],
        ];
    }

    /// Copies another state of the same model, without allocating.
    ///
    /// # Errors
    /// [`Error::Fingerprint`] (and nothing copied) when it is the state of another model.
    pub(crate) fn copy_from(&mut self, other: &State) -> Result<()> {
        self.copy_present_from(other)?;
        self.history.copy_from_slice(&other.history);
        Ok(())
    }

    /// Copies another state of the same model but for its recorded past, of which only what is recorded from now on will
    /// be of use: see [`State::take_past`].
    ///
    /// # Errors
    /// Those of [`State::copy_from`].
    pub(crate) fn copy_present_from(&mut self, other: &State) -> Result<()> {
        self.check_fingerprint(other.fingerprint)?;
        let blocks = self.blocks_mut().into_iter().zip(other.blocks());
        for (to, from) in blocks.take(BLOCKS - 1) {
            to.copy_from_slice(from);
        }
        self.set_counters(other.counters());
        Ok(())
    }

    /// Takes over the recorded past of the state this one began as, and adds to it what has been recorded since.
    pub(crate) fn take_past(&mut self, before: &mut State) {
        std::mem::swap(&mut self.history, &mut before.history);
        let row = history_row(self.slip.len());
        let capacity = (self.history.len() / row) as u64;
        let new = before.recorded.max(self.recorded.saturating_sub(capacity))..self.recorded;
        for record in new {
            let at = (record % capacity) as usize * row;
            self.history[at..at + row].copy_from_slice(&before.history[at..at + row]);
        }
    }

    /// Copies all that internal steps change of another state of the same model. Not the account of the communication step
    /// and the memory of the step control, which go on; nor the history: rows that were written in vain are written again.
    pub(crate) fn copy_steps_from(&mut self, other: &State) {
        let blocks = self.blocks_mut().into_iter().zip(other.blocks());
        for (to, from) in blocks.take(STEPPED) {
            to.copy_from_slice(from);
        }
        self.set_counters(other.counters());
    }

    fn check_fingerprint(&self, found: u64) -> Result<()> {
        if found == self.fingerprint {
            Ok(())
        } else {
            Err(Error::Fingerprint {
                expected: self.fingerprint,
                found,
            })
        }
    }

    /// What the inputs mean.
    pub(crate) fn meaning(&self) -> Inputs {
        MEANINGS[self.meaning as usize]
    }

    pub(crate) fn set_meaning(&mut self, meaning: Inputs) {
        self.meaning = meaning as u64;
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Displacement of the body in the coordinates of its model ([`crate::Compilation::field`] gives the nodal field).
    pub fn displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// Velocity of the body in the coordinates of its model.
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Number of values, counters apart: what a save copies.
    pub fn len(&self) -> usize {
        self.blocks().iter().map(|b| b.len()).sum()
    }

    /// A state always holds values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Friction coefficients as the law takes them.
    pub(crate) fn coefficient_array(&self) -> [f64; MAX_COEFFICIENTS] {
        let mut out = [0.0; MAX_COEFFICIENTS];
        for (out, value) in out.iter_mut().zip(&self.coefficients) {
            *out = *value;
        }
        out
    }
}

/// Values of one row of the history: time, then slip rate, slip and tangential stress.
pub(crate) fn history_row(contact_len: usize) -> usize {
    1 + 3 * contact_len
}
