//! Why an inequality could not be posed or solved.

use std::fmt;

/// Why a call of this module failed.
#[derive(Debug, Clone, PartialEq)]
pub enum SolveError {
    /// A vector or matrix has the wrong size.
    Shape {
        what: &'static str,
        expected: usize,
        found: usize,
    },
    /// A number is out of its range.
    Value {
        what: String,
        found: f64,
        allowed: &'static str,
    },
    /// A quadrature and a kernel do not fit.
    Rule {
        rule: &'static str,
        why: &'static str,
    },
    /// A scene whose contact is not of the form of the class here.
    Scene { what: &'static str },
    /// A matrix that must be inverted is singular, or not positive definite where it must be: at a step, that of the implicit part.
    Singular,
    /// A nonlinear operator without the constants m and L that its solver needs.
    NoConstants,
    /// The iteration of a step grows without end: its contraction factor is above 1.
    Diverged {
        step: usize,
        time: f64,
        iterations: usize,
        contraction: f64,
    },
    /// The iteration of a step did not come to its tolerance.
    NotConverged {
        step: usize,
        time: f64,
        iterations: usize,
        /// Last change of the iterates.
        change: f64,
        contraction: f64,
    },
    /// The frozen inequality in a step was not solved to its tolerance.
    InnerNotConverged { change: f64, iterations: usize },
}

impl SolveError {
    pub(super) fn check_shape(
        what: &'static str,
        expected: usize,
        found: usize,
    ) -> Result<(), SolveError> {
        if expected == found {
            return Ok(());
        }
        Err(SolveError::Shape {
            what,
            expected,
            found,
        })
    }
}

impl fmt::Display for SolveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SolveError::Shape {
                what,
                expected,
                found,
            } => write!(f, "{what}: expected {expected}, found {found}"),
            SolveError::Value {
                what,
                found,
                allowed,
            } => write!(f, "{what}: found {found}, allowed: {allowed}"),
            SolveError::Rule { rule, why } => {
                write!(f, "the quadrature \"{rule}\" cannot be used here: {why}")
            }
            SolveError::Scene { what } => {
                write!(f, "the contact of the scene is no inequality of this form: it has {what}")
            }
            SolveError::Singular => f.write_str(
                "a matrix is singular or not positive definite: an inner product, an operator, or the implicit part of \
                 a step, which a history term of negative sign makes singular at one size of step",
            ),
            SolveError::NoConstants => {
                f.write_str("a nonlinear operator needs its constants m and L (2.3)")
            }
            SolveError::Diverged {
                step,
                time,
                iterations,
                contraction,
            } => write!(
                f,
                "the iteration of step {step} (time {time}) diverges: factor {contraction:.3} after {iterations} iterations"
            ),
            SolveError::NotConverged {
                step,
                time,
                iterations,
                change,
                contraction,
            } => write!(
                f,
                "the iteration of step {step} (time {time}) stopped after {iterations} iterations with a change of {change:.1e} \
                 (factor {contraction:.3})"
            ),
            SolveError::InnerNotConverged { change, iterations } => write!(
                f,
                "the frozen inequality stopped after {iterations} iterations with a change of {change:.1e}"
            ),
        }
    }
}

impl std::error::Error for SolveError {}
