//! How the steps of a run are solved, and what that was like.

use nalgebra::DVector;

/// How a step is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// The fixed point of the proof.
    Lambda,
    /// The linear part at once, the rest by iteration.
    Direct,
}

/// Tolerances of a run.
#[derive(Debug, Clone)]
pub struct Settings {
    pub solver: Solver,
    /// Change of the iterates of a step, relative to the larger of 1 and the largest component, at which it ends. Default 1e-13.
    pub tolerance: f64,
    /// Most iterations of a step. Default 500.
    pub most_iterations: usize,
    /// u_0; where it is `None` (default) the inequality at the start is solved.
    pub start: Option<DVector<f64>>,
}

impl Settings {
    pub fn new(solver: Solver) -> Settings {
        Settings {
            solver,
            tolerance: 1e-13,
            most_iterations: 500,
            start: None,
        }
    }
}

/// What the iterations of a run were like so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Iterations {
    /// Of the last step, of all steps, and most of a step.
    pub last: usize,
    pub total: usize,
    pub most: usize,
    /// Largest ratio of successive changes `|Lambda eta_1 - Lambda eta_2| / |eta_1 - eta_2|` in the norm of the space, over all steps.
    pub contraction: f64,
    /// Largest `|R w_nn q(t_n, t_n)|` met, s: the last weight of the history.
    pub own_weight: f64,
}
