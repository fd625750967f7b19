//! A trial point of the contact problem.

use super::evaluation::NodalLaw;

/// Velocities of the contact and all that follows from them.
pub struct Point {
    /// Tangential velocities w.
    pub w: Vec<f64>,
    /// `S w - r`: minus the contact forces Lambda that the body asks for.
    pub y: Vec<f64>,
    /// Magnitude of the slip rate, one per node.
    pub rates: Vec<f64>,
    /// The law at every node, times the nodal weight.
    pub law: NodalLaw,
    /// Whether `y` comes from a product with S, and not from that of another point and the forces of the step to here.
    pub is_exact: bool,
}

impl Point {
    pub fn new(nodes: usize, len: usize) -> Point {
        Point {
            w: vec![0.0; len],
            y: vec![0.0; len],
            rates: vec![0.0; nodes],
            law: NodalLaw::new(nodes),
            is_exact: false,
        }
    }
}
