//! A whole run.

use super::{Evolution, Inequality, Iterations, Quadrature, Settings, SolveError};
use nalgebra::DVector;

/// u at all points of a run, and what its iterations were like.
#[derive(Debug, Clone)]
pub struct Trajectory {
    pub times: Vec<f64>,
    pub u: Vec<DVector<f64>>,
    pub iterations: Iterations,
}

/// Solves N steps on `[0, T]`.
///
/// # Errors
/// Those of [`Evolution`].
pub fn solve(
    of: &Inequality,
    rule: &Quadrature,
    (end, steps): (f64, usize),
    settings: Settings,
) -> Result<Trajectory, SolveError> {
    let k = end / steps as f64;
    let mut evolution = Evolution::new(of, rule, k, settings)?;
    let (mut times, mut u) = (Vec::new(), Vec::new());
    for n in 0..=steps {
        u.push(evolution.advance()?.clone());
        times.push(n as f64 * k);
    }
    Ok(Trajectory {
        times,
        u,
        iterations: *evolution.iterations(),
    })
}
