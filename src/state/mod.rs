//! The state: all that future steps depend on, and nothing else. Small, flat, compared and restored bit for bit.

mod bytes;
pub(crate) mod layout;
mod plausible;
mod solution;

pub(crate) use solution::Instant;
use solution::Solution;

use crate::body::nonlinear::points_len;
use crate::contact::pressed;
use crate::contact::solve::newton::linearisation::clear_points;
use crate::error::{Error, Result};
use crate::linalg::dot;
use crate::model::Model;
use crate::scene::Inputs;
use layout::{Blocks, Kind, Sizes, blocks};

blocks! {
    /// Where a simulation stands. Vectors over the contact go node by node, components inner.
    pub struct State;
    plain {
        /// Fingerprint of the model it belongs to.
        fingerprint: u64,
        /// Time, s.
        time: f64,
        /// Internal steps taken.
        steps: u64,
        /// Rows ever written to the history.
        recorded: u64,
        /// 0 before initialization, 1 after.
        is_initialized: u64,
        /// 1 when a coefficient changed and the velocity must be made consistent again.
        needs_settling: u64,
        /// What the inputs mean, by its place in [`MEANINGS`].
        meaning: u64,
    }
    groups {
        /// The solution that the ports show; its slip rate is the warm start of the next step.
        main: Solution,
        /// The second solution of the error estimate, where there is one.
        second: Option<Solution>,
    }
    blocks {
        /// Tangential displacement relative to the foundation, m.
        slip: Motion[|s| s.contact()],
        /// Inputs now: intensities of loads, velocities of driven parts (also where displacements are given), velocities of the
        /// foundation and its displacement where it approaches.
        loads: Given[|s| s.inputs],
        /// Inputs as set last; `meaning` says where in the next step.
        inputs: Given[|s| s.inputs],
        /// What is remembered of the inputs, and slopes that were given; see [`input_memory`].
        input_memory: Given[|s| input_memory::of_load(s.inputs)],
        /// Work-conjugate integrals of the columns of forces, then probes: of the displacement.
        output_displacement: Motion[|s| s.outputs],
        /// Displacements of the driven parts, m or rad.
        drive_displacement: Motion[|s| s.drives],
        /// Means over the last internal step, where they are not those of its ends: slip rate, contact forces, normal forces.
        mean_slip_rate: Motion[|s| s.means(s.contact())],
        mean_force: Motion[|s| s.means(s.contact())],
        mean_normal_force: Motion[|s| s.means(s.normal())],
        /// External work, elastic energy, viscous and frictional dissipation, J; see [`energy`].
        energy: Motion[|_| energy::COUNT],
        /// Coefficients of the friction law, one after the other (see `ContactLaw::places`).
        coefficients: Given[|s| s.coefficients],
        /// Numbers of the material, where they stay free.
        material: Given[|s| s.material],
        /// Account of the last communication step; see [`report`].
        report: Account[|_| report::COUNT],
        /// What step control and error estimate remember; see [`control`].
        control: Account[|_| control::COUNT],
        /// Ring of the last internal steps: time, slip rate, slip, tangential stress.
        history: Past[|s| s.rows * history_row(s.contact())],
    }
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
    /// How the friction problem that was solved worst has ended: 0 within the tolerance, or one of the values below.
    pub const ENDING: usize = 4;
    /// Largest share of displacement and slip that is rounding, by estimate; see `time::lost_digits`.
    pub const LOST_DIGITS: usize = 5;
    /// Largest load of a stage against the proof that it has one solution; see `time::uniqueness`.
    pub const UNIQUENESS_LOAD: usize = 6;
    pub const COUNT: usize = 7;

    /// The friction law holds as well as rounding allows, but not to the tolerance.
    pub const AT_ROUNDING: f64 = 1.0;
    /// The limit of work has ended a solve at its best iterate.
    pub const TRUNCATED: f64 = 2.0;
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

impl State {
    /// The state before initialization.
    pub(crate) fn new(model: &Model) -> State {
        State::with_rows(model, model.history_capacity())
    }

    /// Sizes of the states of a model.
    pub(crate) fn sizes(model: &Model) -> Sizes {
        Sizes {
            states: model.states(),
            nodes: model.contact().node_count(),
            components: model.contact().components,
            inputs: model.input_count(),
            outputs: model.output_count(),
            drives: model.motions().drives.len(),
            foundation: model.motions().foundation.len(),
            contacts: model.contact().parts.len(),
            has_normal: model.contact().has_normal,
            has_means: !model.tableau().ends_with_stage(),
            tangents: (model.body().nonlinear()).map_or(0, |cells| points_len(cells.point_len())),
            has_memory: model.friction().has_memory(),
            slip_memory: model.friction().slip_memory_len(),
            penetration: (model.relaxing().last()).map_or(0, |part| part.numbers.end),
            coefficients: model.friction().start().len(),
            material: model.free_values().len(),
            has_second: model.has_error_estimate(),
            can_lose_digits: model.can_lose_digits(model.largest_step()),
            rows: model.history_capacity(),
        }
    }

    /// The same with another number of rows in the history.
    fn with_rows(model: &Model, rows: usize) -> State {
        let sizes = State::sizes(model);
        let mut state = State::allocate(&Sizes { rows, ..sizes });
        let (start, coefficients) = (model.starts(), model.friction().start());
        state.fingerprint = model.fingerprint();
        state.set_meaning(model.scene().time.inputs.unwrap_or_default());
        state.loads.copy_from_slice(start);
        state.inputs.copy_from_slice(start);
        state.coefficients.copy_from_slice(coefficients);
        state.material.copy_from_slice(model.free_values());
        state.start_memory(model);
        for (kind, points) in state.blocks_mut().filter(|(_, block)| !block.is_empty()) {
            match kind {
                Kind::Marks => clear_points(points),
                Kind::PressedMarks => pressed::clear_points(points),
                Kind::Motion | Kind::Magnitude | Kind::Given | Kind::Account | Kind::Past => {}
            }
        }
        state
    }

    /// The friction law has its first state.
    pub(crate) fn start_memory(&mut self, model: &Model) {
        for (node, state) in self.main.friction_state.iter_mut().enumerate() {
            let friction = model.friction();
            *state = friction.initial_state(&self.coefficients, node);
        }
        if let Some(second) = &mut self.second {
            second.friction_state.clone_from(&self.main.friction_state);
        }
    }

    /// The body has the displacement that it starts with.
    pub(crate) fn start_displacement(&mut self, model: &Model) {
        if let Some(initial) = model.initial() {
            self.slip.copy_from_slice(&initial.slip);
            self.main
                .normal_displacement
                .copy_from_slice(&initial.normal);
            self.output_displacement.copy_from_slice(&initial.outputs);
            self.energy[energy::ELASTIC] = initial.energy;
        }
    }

    /// Zeros: the tangent of a state that depends on nothing yet.
    pub(crate) fn zero(model: &Model) -> State {
        let mut state = State::new(model);
        state.blocks_mut().for_each(|(_, block)| block.fill(0.0));
        state
    }

    /// A state that only [`State::copy_steps_from`] writes.
    pub(crate) fn without_history(model: &Model) -> State {
        State::with_rows(model, 0)
    }

    /// The blocks in which every number is finite, but for the recorded past.
    fn numbers(&self) -> impl Iterator<Item = (Kind, &Vec<f64>)> {
        self.blocks()
            .filter(|(kind, _)| !matches!(kind, Kind::Marks | Kind::PressedMarks | Kind::Past))
    }

    /// Sum of the squares of all numbers but the recorded past; not a number, or infinite, where one of them is.
    pub(crate) fn sum_of_squares(&self) -> f64 {
        self.numbers().map(|(_, block)| dot(block, block)).sum()
    }

    /// Whether all numbers but the recorded past are finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.numbers()
            .all(|(_, block)| block.iter().all(|v| v.is_finite()))
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

    /// Copies another state of the same model without its recorded past: only rows recorded from now on will be needed, see
    /// [`State::take_past`].
    ///
    /// # Errors
    /// Those of [`State::copy_from`].
    pub(crate) fn copy_present_from(&mut self, other: &State) -> Result<()> {
        self.check_fingerprint(other.fingerprint)?;
        self.copy_blocks(other, |kind| kind != Kind::Past);
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

    /// Copies all that internal steps change of another state of the same model. The account of the communication step and
    /// the memory of the step control are kept: they count refused steps too. The history is not copied: a repeated
    /// pair writes at least as many rows, into the same slots.
    pub(crate) fn copy_steps_from(&mut self, other: &State) {
        self.copy_blocks(other, |kind| !matches!(kind, Kind::Account | Kind::Past));
        self.set_counters(other.counters());
    }

    /// Exchanges the main solution and the second one, where there is one.
    pub(crate) fn swap_second(&mut self) {
        if let Some(second) = &mut self.second {
            std::mem::swap(&mut self.main, second);
        }
    }

    /// Makes the second solution, where there is one, the same as the main one.
    pub(crate) fn copy_to_second(&mut self) {
        if let Some(second) = &mut self.second {
            second.copy_blocks(&self.main, |_| true);
        }
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
        &self.main.displacement
    }

    /// Velocity of the body in the coordinates of its model.
    pub fn velocity(&self) -> &[f64] {
        &self.main.instant.velocity
    }

    /// Number of values, counters apart: what a save copies.
    pub fn len(&self) -> usize {
        self.blocks().map(|(_, block)| block.len()).sum()
    }

    /// A state always holds values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Values of one row of the history: time, then slip rate, slip and tangential stress.
pub(crate) fn history_row(contact_len: usize) -> usize {
    1 + 3 * contact_len
}
