//! What the equations of the body and its contact determine: the main solution, and the second one of the error estimate.

use super::layout::blocks;
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
        /// Work-conjugate integrals of the loads, then probes: of the velocity.
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
        /// Points at which the friction solver last factored its matrix (see `contact::solve::newton::linearisation`).
        linearisation: Marks[|s| points_len(s.nodes, s.components)],
    }
}
