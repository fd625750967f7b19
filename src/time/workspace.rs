//! Scratch of one simulator: rebuilt at will, never saved, never changes a result.

use super::finite::FiniteCheck;
use super::scheme::{MAX_STAGES, Tableau};
use crate::body::{Scratch, StageCache};
use crate::contact::solve::fixed_point::FixedPointWorkspace;
use crate::contact::solve::multiplicity::MultiplicityWorkspace;
use crate::contact::solve::newton;
use crate::linalg::add_scaled;
use crate::model::Model;
use crate::state::layout::Blocks;
use crate::state::{Instant, State};

/// Rates and forces at one instant of a step, with what is made of them and the loads.
pub(crate) struct Velocity {
    pub instant: Instant,
    /// Magnitude of the slip rate, one per node.
    pub magnitude: Vec<f64>,
    pub load: Vec<f64>,
}

impl Velocity {
    pub fn new(model: &Model) -> Velocity {
        let sizes = State::sizes(model);
        Velocity {
            instant: Instant::allocate(&sizes),
            magnitude: vec![0.0; sizes.nodes],
            load: vec![0.0; sizes.loads],
        }
    }

    /// The instant a state stands at (loads apart).
    pub fn load_from(&mut self, state: &State) {
        self.instant.copy_blocks(&state.main.instant, |_| true);
        let components = self.instant.slip_rate.len() / self.magnitude.len();
        let rates = self.instant.slip_rate.chunks_exact(components);
        for (to, w) in self.magnitude.iter_mut().zip(rates) {
            *to = crate::contact::problem::norm(w);
        }
    }

    pub fn copy_warm_start(&mut self, state: &State) {
        let warm = &state.main.instant.slip_rate;
        self.instant.slip_rate.copy_from_slice(warm);
    }

    /// The contact of a stage: warm start and last forces of the next one.
    pub fn store_contact(&self, state: &mut State) {
        let (to, from) = (&mut state.main.instant, &self.instant);
        to.slip_rate.copy_from_slice(&from.slip_rate);
        to.force.copy_from_slice(&from.force);
        to.reaction.copy_from_slice(&from.reaction);
    }

    /// Makes this the instant of the state.
    pub fn store_into(&self, state: &mut State) {
        state.main.instant.copy_blocks(&self.instant, |_| true);
    }

    pub fn copy_from(&mut self, other: &Velocity) {
        self.instant.copy_blocks(&other.instant, |_| true);
        self.magnitude.copy_from_slice(&other.magnitude);
        self.load.copy_from_slice(&other.load);
    }

    /// The mean over a step (weights b_j) of rates, forces and loads at its start and its stages.
    pub fn set_mean(&mut self, tableau: &Tableau, velocities: &[Velocity]) {
        let count = tableau.stages().len() + 1;
        for (j, velocity) in velocities[..count].iter().enumerate() {
            let weight = tableau.weight(j);
            let to = self.instant.blocks_mut().map(|(_, block)| block);
            let from = velocity.instant.blocks().map(|(_, block)| block);
            let blocks = to.chain([&mut self.load]).zip(from.chain([&velocity.load]));
            for (to, from) in blocks {
                if j == 0 {
                    to.fill(0.0);
                }
                if weight != 0.0 {
                    add_scaled(to, weight, from);
                }
            }
        }
    }
}

/// Loads at the two ends of a communication step, linear between them, and their derivatives by the inputs.
#[derive(Debug, Clone, Default)]
pub(crate) struct LoadCourse {
    pub start: Vec<f64>,
    pub end: Vec<f64>,
    pub start_by_input: Vec<f64>,
    pub end_by_input: Vec<f64>,
}

impl LoadCourse {
    pub fn new(loads: usize) -> LoadCourse {
        let zeros = vec![0.0; loads];
        LoadCourse {
            start: zeros.clone(),
            end: zeros.clone(),
            start_by_input: zeros.clone(),
            end_by_input: zeros,
        }
    }

    /// Loads at a fraction of the communication step.
    pub fn at(&self, fraction: f64, loads: &mut [f64]) {
        let ends = self.start.iter().zip(&self.end);
        for (load, (from, to)) in loads.iter_mut().zip(ends) {
            *load = if fraction == 1.0 {
                *to
            } else {
                from + (to - from) * fraction
            };
        }
    }
}

/// Explicit part of a stage.
pub(crate) struct Explicit {
    pub displacement: Vec<f64>,
    pub accumulated_slip: Vec<f64>,
}

impl Explicit {
    pub fn new(model: &Model) -> Explicit {
        Explicit {
            displacement: vec![0.0; model.states()],
            accumulated_slip: vec![0.0; model.contact().node_count()],
        }
    }
}

/// Scratch of the control.
pub(crate) struct ControlWorkspace {
    /// The state before the pair.
    pub kept: State,
    /// Error of the displacement of the body.
    pub body: Vec<f64>,
    /// Error of the slip.
    pub contact: Vec<f64>,
    /// Pairs refused so far.
    pub refused: u64,
}

impl ControlWorkspace {
    pub fn new(model: &Model) -> ControlWorkspace {
        ControlWorkspace {
            kept: State::without_history(model),
            body: vec![0.0; model.states()],
            contact: vec![0.0; model.contact().len()],
            refused: 0,
        }
    }
}

pub(crate) struct Workspace {
    pub stages: StageCache,
    pub scratch: Scratch,
    pub newton: newton::Workspace,
    pub fixed_point: FixedPointWorkspace,
    pub multiplicity: MultiplicityWorkspace,
    /// The start of the step, then its stages.
    pub velocities: [Velocity; MAX_STAGES + 1],
    pub mean: Velocity,
    pub explicit: Explicit,
    /// Loads over the communication step.
    pub course: LoadCourse,
    /// Loads at the instant of the stage.
    pub load: Vec<f64>,
    pub condensed_load: Vec<f64>,
    /// Displacement of the last iterate of the fixed point.
    pub last_iterate: Vec<f64>,
    /// Scratch of the step control, where there is one.
    pub control: Option<ControlWorkspace>,
    pub finite: FiniteCheck,
}

impl Workspace {
    pub fn new(model: &Model) -> Workspace {
        let contact = model.contact();
        let (nodes, len) = (contact.node_count(), contact.len());
        let loads = vec![0.0; model.interpolations().len()];
        Workspace {
            stages: StageCache::new(model.body(), model.sizes_kept()),
            scratch: model.body().scratch(),
            newton: newton::Workspace::new(nodes, len),
            fixed_point: FixedPointWorkspace::new(nodes, len),
            multiplicity: MultiplicityWorkspace::new(nodes, len),
            velocities: std::array::from_fn(|_| Velocity::new(model)),
            mean: Velocity::new(model),
            explicit: Explicit::new(model),
            course: LoadCourse::new(loads.len()),
            load: loads,
            condensed_load: vec![0.0; len],
            last_iterate: vec![0.0; model.states()],
            finite: FiniteCheck::new(model),
            control: (model.tolerance().is_some()).then(|| ControlWorkspace::new(model)),
        }
    }
}
