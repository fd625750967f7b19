//! What the equations of the body and its contact determine: the main solution, and the second one of the error estimate.

use super::layout::blocks;
use crate::contact::pressed;
use crate::contact::solve::newton::linearisation::points_len;

blocks! {
    /// Rates and forces at one instant. Vectors over the contact go node by node, components inner.
    pub(crate) struct Instant;
    plain {}
    groups {}
    blocks {
        /// Velocity of the body, in the coordinates of its model.
        velocity: Motion[|s| s.states],
        /// Tangential velocity of the contact nodes relative to the foundation, m/s.
        slip_rate: Motion[|s| s.contact()],
        /// Contact forces Lambda of the friction law, N; the force on the body is minus this. A node that slips carries its
        /// bound.
        force: Motion[|s| s.contact()],
        /// Contact forces with which the body is in balance, N. They differ from those of the law by the residual of the
        /// friction solver.
        /// They do the work in the energy balance.
        reaction: Motion[|s| s.contact()],
        /// Normal velocity of the body at the contact nodes, from the foundation into the body, m/s.
        normal_velocity: Motion[|s| s.normal()],
        /// Normal forces of the contact laws on the body, along that direction, N: the pressure times the weight.
        normal_force: Motion[|s| s.normal()],
        /// Normal forces with which the body is in balance, N.
        normal_reaction: Motion[|s| s.normal()],
        /// Displacements of the foundations of all contacts towards the body, m.
        approach: Motion[|s| if s.has_normal { s.contacts } else { 0 }],
        /// Velocities of the driven parts, m/s or rad/s.
        drive_velocity: Motion[|s| s.drives],
        /// What drives the driven parts and the foundation, N or N m; in balance.
        drive_force: Motion[|s| s.drives],
        foundation_force: Motion[|s| s.foundation],
        /// Work-conjugate integrals of the columns of forces, then probes: of the velocity. Those of loads and probes have the
        /// share of driven parts, those of the columns of these have not.
        output_velocity: Motion[|s| s.outputs],
        /// Norm of the free motion of which contact forces have left the velocity, where steps may lose digits by it (see
        /// `time::lost_digits`).
        cancelled: Magnitude[|s| usize::from(s.can_lose_digits)],
    }
}

blocks! {
    /// All that a step leaves for the next one and that is not given.
    pub(crate) struct Solution;
    plain {}
    groups {
        instant: Instant,
    }
    blocks {
        /// Displacement of the body, in the coordinates of its model.
        displacement: Motion[|s| s.states],
        /// Accumulated slip, m, one per node.
        accumulated_slip: Magnitude[|s| s.nodes],
        /// Normal displacement of the body at the contact nodes, from the foundation into the body, m.
        normal_displacement: Motion[|s| s.normal()],
        /// State of the friction law at every node, s, where it has one.
        friction_state: Given[|s| s.memory()],
        /// Points of the tangents with which the body is factored (see `body::nonlinear::points`).
        tangents: Motion[|s| s.tangents],
        /// Fading memory of slip, m, where laws have a kernel: its terms, node by node, contact by contact.
        slip_memory: Magnitude[|s| s.slip_memory],
        /// Deformation of foundations that remember it and of their branches, m, node by node (see `contact::relaxing`).
        penetration: Motion[|s| s.penetration],
        /// Points at which the friction solver last factored its matrix (see `contact::solve::newton::linearisation`).
        linearisation: Marks[|s| if s.has_normal { 0 } else { points_len(s.nodes, s.components) }],
        /// The same of the solver with pressure (see `contact::pressed`).
        pressed_point: PressedMarks[|s| if s.has_normal { pressed::points_len(s.nodes, s.components) } else { 0 }],
    }
}
