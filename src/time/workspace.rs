//! Scratch of one simulator: rebuilt at will, never saved, never changes a result.

use super::control::{self, ControlWorkspace};
use super::finite::FiniteCheck;
use super::scheme::{MAX_STAGES, Tableau};
use crate::body::{Scratch, StageCache};
use crate::contact::solve::fixed_point::FixedPointWorkspace;
use crate::contact::solve::multiplicity::MultiplicityWorkspace;
use crate::contact::solve::newton;
use crate::linalg::add_scaled;
use crate::model::Model;
use crate::state::State;

/// Velocity, forces and loads at one instant of a step.
pub(crate) struct Velocity {
    pub body: Vec<f64>,
    pub contact: Vec<f64>,
    /// Magnitude of the slip rate, one per node.
    pub magnitude: Vec<f64>,
    /// Contact forces of the friction law.
    pub force: Vec<f64>,
    /// Contact forces with which the body is in balance.
    pub reaction: Vec<f64>,
    /// Work-conjugate integrals of the loads, then probes.
    pub outputs: Vec<f64>,
    pub load: Vec<f64>,
}

impl Velocity {
    pub fn new(model: &Model) -> Velocity {
        let contact = model.contact();
        Velocity {
            body: vec![0.0; model.states()],
            contact: vec![0.0; contact.len()],
            magnitude: vec![0.0; contact.node_count()],
            force: vec![0.0; contact.len()],
            reaction: vec![0.0; contact.len()],
            outputs: vec![0.0; model.output_count()],
            load: vec![0.0; model.interpolations().len()],
        }
    }

    /// The instant a state stands at (loads apart).
    pub fn load_from(&mut self, state: &State) {
        self.body.copy_from_slice(&state.velocity);
        self.contact.copy_from_slice(&state.slip_rate);
        self.force.copy_from_slice(&state.force);
        self.reaction.copy_from_slice(&state.reaction);
        self.outputs.copy_from_slice(&state.output_velocity);
        let components = self.contact.len() / self.magnitude.len();
        for (to, w) in self
            .magnitude
            .iter_mut()
            .zip(self.contact.chunks_exact(components))
        {
            *to = crate::contact::problem::norm(w);
        }
    }

    pub fn copy_warm_start(&mut self, state: &State) {
        self.contact.copy_from_slice(&state.slip_rate);
    }

    /// The contact of a stage: warm start and last forces of the next one.
    pub fn store_contact(&self, state: &mut State) {
        state.slip_rate.copy_from_slice(&self.contact);
        state.force.copy_from_slice(&self.force);
        state.reaction.copy_from_slice(&self.reaction);
    }

    /// Makes this the instant of the state.
    pub fn store_into(&self, state: &mut State) {
        self.store_contact(state);
        state.velocity.copy_from_slice(&self.body);
        state.output_velocity.copy_from_slice(&self.outputs);
    }

    pub fn copy_from(&mut self, other: &Velocity) {
        self.body.copy_from_slice(&other.body);
        self.contact.copy_from_slice(&other.contact);
        self.magnitude.copy_from_slice(&other.magnitude);
        self.force.copy_from_slice(&other.force);
        self.reaction.copy_from_slice(&other.reaction);
        self.outputs.copy_from_slice(&other.outputs);
        self.load.copy_from_slice(&other.load);
    }

    /// The mean over a step (weights b_j) of the velocities at its start and its stages; of the forces only those of balance.
    pub fn set_mean(&mut self, tableau: &Tableau, velocities: &[Velocity]) {
        let count = tableau.stages().len() + 1;
        for (j, velocity) in velocities[..count].iter().enumerate() {
            let weight = tableau.weight(j);
            let others = [
                &velocity.body,
                &velocity.contact,
                &velocity.reaction,
                &velocity.outputs,
                &velocity.load,
            ];
            for (to, from) in self.parts().into_iter().zip(others) {
                if j == 0 {
                    to.fill(0.0);
                }
                if weight != 0.0 {
                    add_scaled(to, weight, from);
                }
            }
        }
    }

    fn parts(&mut self) -> [&mut Vec<f64>; 5] {
        [
            &mut self.body,
            &mut self.contact,
            &mut self.reaction,
            &mut self.outputs,
            &mut self.load,
        ]
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
            stages: StageCache::new(model.body(), control::sizes_kept(model)),
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
