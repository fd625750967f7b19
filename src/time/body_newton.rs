//! Scratch of Newton's method on a body whose laws are not linear (`time::nonlinear`).

use crate::model::Model;

/// Scratch of the stages, and counts.
pub(crate) struct BodyNewton {
    /// The iterate, and the step from it.
    pub velocity: Vec<f64>,
    pub step: Vec<f64>,
    /// Displacement of the iterate that is evaluated.
    pub displacement: Vec<f64>,
    /// C and T w, at the iterate and at the next one.
    pub force: Vec<f64>,
    pub next_force: Vec<f64>,
    pub kept: Vec<f64>,
    pub next_kept: Vec<f64>,
    pub work: [Vec<f64>; 2],
    /// A point of tangents that no state keeps.
    pub point: Vec<f64>,
    /// Factorization of the body whose contact operator the friction solvers have seen last.
    pub seen: u64,
    /// Iterates so far, and halvings of steps.
    pub iterations: u64,
    pub halvings: u64,
}

impl BodyNewton {
    /// Scratch for a model; `None` where all laws are linear.
    pub fn new(model: &Model) -> Option<BodyNewton> {
        let nonlinear = model.body().nonlinear()?;
        // of the body alone, without what follows the displacement in a state
        let vector = || vec![0.0; nonlinear.len()];
        Some(BodyNewton {
            velocity: vector(),
            step: vector(),
            displacement: vector(),
            force: vector(),
            next_force: vector(),
            kept: vector(),
            next_kept: vector(),
            work: [vector(), vector()],
            point: vec![0.0; nonlinear.point_len()],
            seen: 0,
            iterations: 0,
            halvings: 0,
        })
    }
}
