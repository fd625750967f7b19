//! Inequalities with exact solutions, each about another part of the class; what the command `stickslip qvi` and the tests run.
//!
//! | | what it is about | solution |
//! |---|---|---|
//! | P1 | `m u + kappa (a + int u) = f` | `cos 2t + t` |
//! | P2 | matrix kernel of two times, R(t), A not symmetric | `(t, t^2)` |
//! | P3 | stick until t = 1/2, friction that weakens with the slip rate | `max(0, t - 1/2)^2` |
//! | P4 | `K = [0, inf)`, exponential kernel | `max(0, sin 2 pi t)` |
//! | P5 | nonlinear A, history in the bound | `d (1 + sin(t)/2)` |
//! | P6 | half-space and friction | on the boundary until t = 1/2 |
//! | P7 ([`Bar`]) | finite elements of a bar with friction at its end | `cos t (x + sin(pi x)/2)` |

mod bar;
mod exact;

pub use bar::Bar;
pub use exact::{friction_of_rate, linear};

use super::{Inequality, Quadrature, Settings, SolveError, Solver, solve};
use nalgebra::DVector;

/// An inequality and its solution.
pub struct Example {
    pub name: &'static str,
    pub text: &'static str,
    pub problem: Inequality,
    pub exact: Box<dyn Fn(f64) -> DVector<f64>>,
}

impl Example {
    /// Largest error of a component over the points of N steps on `[0, 1]`.
    ///
    /// # Errors
    /// Those of [`solve`].
    pub fn error(
        &self,
        rule: &Quadrature,
        steps: usize,
        solver: Solver,
    ) -> Result<f64, SolveError> {
        let run = solve(&self.problem, rule, (1.0, steps), Settings::new(solver))?;
        let errors = run.times.iter().zip(&run.u);
        let errors = errors.map(|(t, u)| (u - (self.exact)(*t)).amax());
        Ok(errors.fold(0.0, f64::max))
    }
}

/// P1 to P6.
///
/// # Errors
/// None; the data are fixed.
pub fn all() -> Result<Vec<Example>, SolveError> {
    Ok(vec![
        exact::linear(2.0, 3.0),
        exact::two_times(),
        exact::friction_of_rate(2.0),
        exact::one_sided()?,
        exact::nonlinear(),
        exact::half_space()?,
    ])
}
