//! Rates and forces at the instants of a step.

use super::scheme::Tableau;
use crate::contact::problem::norm;
use crate::linalg::add_scaled;
use crate::model::Model;
use crate::state::layout::Blocks;
use crate::state::{Instant, State};
use std::ops::Range;

/// Rates and forces at one instant of a step, with what is made of them and the loads.
pub(crate) struct Velocity {
    pub instant: Instant,
    /// Growth of the accumulated slip, one per node: the magnitude of the slip rate, where the node is not open.
    pub magnitude: Vec<f64>,
    /// The inputs there.
    pub load: Vec<f64>,
    /// State of the friction law there, where it has one.
    pub friction_state: Vec<f64>,
    /// Nodes of the contacts that can open.
    opening: Vec<Range<usize>>,
    /// Fading memory of slip there, m, where laws have a kernel: its terms, node by node.
    pub slip_memory: Vec<f64>,
    /// Deformation of foundations that remember it there, and of their branches, m, node by node.
    pub penetration: Vec<f64>,
}

impl Velocity {
    pub fn new(model: &Model) -> Velocity {
        let sizes = State::sizes(model);
        Velocity {
            instant: Instant::allocate(&sizes),
            magnitude: vec![0.0; sizes.nodes],
            load: vec![0.0; sizes.inputs],
            friction_state: vec![0.0; sizes.memory()],
            opening: (model.contact().parts.iter())
                .filter(|part| part.can_open)
                .map(|part| part.nodes.clone())
                .collect(),
            slip_memory: vec![0.0; sizes.slip_memory],
            penetration: vec![0.0; sizes.penetration],
        }
    }

    /// The instant a state stands at (loads apart).
    pub fn load_from(&mut self, state: &State) {
        self.instant.copy_blocks(&state.main.instant, |_| true);
        self.friction_state
            .copy_from_slice(&state.main.friction_state);
        self.slip_memory.copy_from_slice(&state.main.slip_memory);
        self.penetration.copy_from_slice(&state.main.penetration);
        self.set_magnitudes();
    }

    /// Growth of the accumulated slip from the slip rates.
    pub fn set_magnitudes(&mut self) {
        let components = self.instant.slip_rate.len() / self.magnitude.len();
        let rates = self.instant.slip_rate.chunks_exact(components);
        for (to, w) in self.magnitude.iter_mut().zip(rates) {
            *to = norm(w);
        }
        for nodes in &self.opening {
            let forces = &self.instant.normal_force[nodes.clone()];
            let forces = self.magnitude[nodes.clone()].iter_mut().zip(forces);
            for (to, _) in forces.filter(|(_, force)| **force <= 0.0) {
                *to = 0.0;
            }
        }
    }

    pub fn copy_warm_start(&mut self, state: &State) {
        let (to, warm) = (&mut self.instant, &state.main.instant);
        to.slip_rate.copy_from_slice(&warm.slip_rate);
        to.normal_velocity.copy_from_slice(&warm.normal_velocity);
        to.force.copy_from_slice(&warm.force);
        to.normal_force.copy_from_slice(&warm.normal_force);
    }

    /// The contact of a stage: warm start and last forces of the next one.
    pub fn store_contact(&self, state: &mut State) {
        let (to, from) = (&mut state.main.instant, &self.instant);
        to.slip_rate.copy_from_slice(&from.slip_rate);
        to.force.copy_from_slice(&from.force);
        to.reaction.copy_from_slice(&from.reaction);
        to.normal_velocity.copy_from_slice(&from.normal_velocity);
        to.normal_force.copy_from_slice(&from.normal_force);
    }

    /// Makes this the instant of the state.
    pub fn store_into(&self, state: &mut State) {
        state.main.instant.copy_blocks(&self.instant, |_| true);
        state
            .main
            .friction_state
            .copy_from_slice(&self.friction_state);
        state.main.slip_memory.copy_from_slice(&self.slip_memory);
        state.main.penetration.copy_from_slice(&self.penetration);
    }

    pub fn copy_from(&mut self, other: &Velocity) {
        self.instant.copy_blocks(&other.instant, |_| true);
        self.magnitude.copy_from_slice(&other.magnitude);
        self.load.copy_from_slice(&other.load);
        self.friction_state.copy_from_slice(&other.friction_state);
        self.slip_memory.copy_from_slice(&other.slip_memory);
        self.penetration.copy_from_slice(&other.penetration);
    }

    /// The mean over a step (weights b_j) of what energies and means are made of, at its start and its stages.
    pub fn set_mean(&mut self, tableau: &Tableau, velocities: &[Velocity]) {
        let known = &velocities[..tableau.stages().len() + 1];
        macro_rules! mean {
            ($($field:ident).+) => {
                let to = &mut self.$($field).+;
                to.fill(0.0);
                for (j, velocity) in known.iter().enumerate() {
                    let weight = tableau.weight(j);
                    if weight != 0.0 {
                        add_scaled(to, weight, &velocity.$($field).+);
                    }
                }
            };
        }
        mean!(load);
        mean!(instant.velocity);
        mean!(instant.slip_rate);
        mean!(instant.reaction);
        mean!(instant.output_velocity);
        mean!(instant.drive_force);
        mean!(instant.foundation_force);
        if !tableau.ends_with_stage() {
            mean!(instant.force);
            mean!(instant.normal_force);
        }
    }
}
