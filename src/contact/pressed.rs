//! Friction bounds that may depend on the normal force.

use super::evaluation::SlipPath;

/// What a friction bound is at one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressedBound {
    /// B(r, p), N.
    pub bound: f64,
    /// Its derivative by the slip rate along the stage, in which the accumulated slip grows with the rate, N s/m.
    pub by_rate: f64,
    /// dB/dp.
    pub by_force: f64,
}

/// Friction bounds of the nodes of a contact. `force` is the signed normal force p of the node, N; it presses where positive.
pub trait PressedBounds {
    /// Bound and derivatives at a node, a slip rate `rate >= 0`, m/s, and a normal force.
    fn evaluate(&self, node: usize, rate: f64, force: f64, slip: SlipPath) -> PressedBound;

    /// L: the largest rate at which the bound falls with the slip rate at this force, N s/m; 0 where it never does.
    fn weakening(&self, node: usize, force: f64) -> f64;
}
