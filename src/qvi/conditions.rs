//! The conditions of the theory for an inequality and a size of step, and what a run did outside of them.
//!
//! ```text
//! beta < m                                        one solution u(t)                              (2.6)
//! k < (m - beta) / (alpha c1)                     one solution of every step, by the proof       (3.6)
//! (alpha c1 w_nn + beta) / m < 1                  Lambda contracts; w_nn = k/2: twice the step of (3.6)
//! ```
//!
//! The constants are those of the space in which the inequality is posed. For a finite element space they are those that the fully
//! discrete scheme asks for (Section 4 of the paper), and never worse than those of the whole space.

use super::constants::{Constant, Origin, operator_ratios, sampled_alpha, sampled_beta};
use super::functional::Linear;
use super::sampling::Sampler;
use super::settings::{Iterations, Solver};
use super::space::{orthonormal, smallest_symmetric_eigenvalue};
use super::{Constants, Inequality, SolveError};
use nalgebra::DMatrix;
use std::fmt;

/// Whether a condition holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    Holds,
    /// With a constant that only samples bound, it holds as far as they say.
    NotRefuted,
    Fails,
}

/// The conditions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// (2.6).
    pub uniqueness: Verdict,
    /// (3.6).
    pub step: Verdict,
    /// Whether Lambda contracts with the last weight that the quadrature has.
    pub contraction: Verdict,
    /// Largest k of (3.6), s; infinite where phi does not see the history, 0 where (2.6) fails.
    pub largest_step: f64,
    /// `(alpha c1 k + beta) / m`, as in the proof.
    pub factor_of_proof: f64,
    /// `(alpha c1 w_nn + beta) / m`.
    pub factor: f64,
    /// Smallest eigenvalue of the symmetric part of the operator that the direct solver inverts, in the norm of the space; the step
    /// has one solution where it is above beta. `None` for a nonlinear operator or a linear part without a matrix.
    pub implicit_m: Option<f64>,
}

impl Conditions {
    /// For steps of size k whose histories have the last weight `own_weight` times q, at the start of a run
    /// (`Iterations::own_weight` is `|R| |q|` times the last weight; it is what `factor` is computed with).
    pub fn of(constants: &Constants, k: f64, own_weight: f64) -> Conditions {
        let Constants {
            m, alpha, beta, c1, ..
        } = constants;
        let judge = |holds: bool, of: &[&Constant]| match holds {
            false => Verdict::Fails,
            true if of.iter().any(|c| c.origin == Origin::Sampled) => Verdict::NotRefuted,
            true => Verdict::Holds,
        };
        let strength = alpha.value * c1.value;
        let left = (m.value - beta.value).max(0.0);
        let largest_step = match (left, strength) {
            (0.0, _) => 0.0,
            (_, 0.0) => f64::INFINITY,
            _ => left / strength,
        };
        let factor = (alpha.value * own_weight + beta.value) / m.value;
        Conditions {
            uniqueness: judge(beta.value < m.value, &[m, beta]),
            step: judge(k < largest_step, &[m, alpha, beta, c1]),
            contraction: judge(factor < 1.0, &[m, alpha, beta]),
            largest_step,
            factor_of_proof: (strength * k + beta.value) / m.value,
            factor,
            implicit_m: None,
        }
    }

    /// With the constant of the operator that the direct solver inverts, for last weights `w q` of every history.
    ///
    /// # Errors
    /// [`SolveError::Singular`] for an inner product that is not positive definite.
    pub fn with_direct(
        self,
        problem: &Inequality,
        own_weights: &[f64],
    ) -> Result<Conditions, SolveError> {
        let Some(a) = problem.operator.matrix() else {
            return Ok(self);
        };
        let mut sum: DMatrix<f64> = a.to_dense();
        for (i, own) in own_weights.iter().enumerate() {
            match problem.phi.linear(i) {
                Linear::Matrix(matrix) => sum += matrix.to_dense() * *own,
                Linear::Zero => {}
                Linear::Nonlinear => return Ok(self),
            }
        }
        let factor = problem.space.factor()?;
        let sum = orthonormal(&sum, [factor.as_ref(), factor.as_ref()])?;
        Ok(Conditions {
            implicit_m: Some(smallest_symmetric_eigenvalue(&sum)),
            ..self
        })
    }
}

/// What a run did outside of the theory, or against what was declared.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// (2.6) fails: several solutions are possible.
    SeveralSolutions { m: f64, beta: f64 },
    /// The step is larger than (3.6) allows; the proof says nothing of it.
    StepBeyondProof { k: f64, largest: f64 },
    /// Lambda need not contract; the direct solver is to be taken.
    LambdaMayDiverge { factor: f64 },
    /// Iterates came nearer by less than the declared constants say.
    ContractionAboveBound { seen: f64, bound: f64 },
    /// A sample contradicts a constant: what, the constant, what the sample says.
    Contradicted {
        what: &'static str,
        constant: f64,
        found: f64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::SeveralSolutions { m, beta } => write!(
                f,
                "several solutions are possible: beta = {beta:.4} is not below m = {m:.4} (2.6)"
            ),
            Warning::StepBeyondProof { k, largest } => write!(
                f,
                "the step {k:.4} is above {largest:.4}, up to which the proof has one solution (3.6)"
            ),
            Warning::LambdaMayDiverge { factor } => write!(
                f,
                "the fixed point of the proof need not contract (factor {factor:.4}); the direct solver is to be taken"
            ),
            Warning::ContractionAboveBound { seen, bound } => write!(
                f,
                "iterates came nearer by {seen:.6} only, where the constants say {bound:.6}: a constant is wrong"
            ),
            Warning::Contradicted {
                what,
                constant,
                found,
            } => write!(f, "{what} is {constant:.6}, but a sample has {found:.6}"),
        }
    }
}

/// All that is to be said of a run: its constants, conditions and warnings.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    pub constants: Constants,
    pub conditions: Conditions,
    /// Largest contraction factor seen.
    pub contraction: f64,
    pub warnings: Vec<Warning>,
}

/// Share by which a sample may exceed a constant through rounding.
const ROUNDING: f64 = 1e-5;

impl Record {
    /// Judges a run of `[0, T]` with steps of size k.
    ///
    /// # Errors
    /// Those of [`Constants::of`].
    pub fn of(
        problem: &Inequality,
        (end, k): (f64, f64),
        solver: Solver,
        iterations: &Iterations,
    ) -> Result<Record, SolveError> {
        let constants = Constants::of(problem, end)?;
        let conditions = Conditions::of(&constants, k, iterations.own_weight);
        let mut warnings = contradictions(problem, &constants)?;
        let (m, beta) = (constants.m.value, constants.beta.value);
        if conditions.uniqueness == Verdict::Fails {
            warnings.push(Warning::SeveralSolutions { m, beta });
        }
        // an explicit step is solvable whatever its size
        if conditions.step == Verdict::Fails && iterations.own_weight > 0.0 {
            let largest = conditions.largest_step;
            warnings.push(Warning::StepBeyondProof { k, largest });
        }
        let factor = conditions.factor;
        if solver == Solver::Lambda && conditions.contraction == Verdict::Fails {
            warnings.push(Warning::LambdaMayDiverge { factor });
        }
        let seen = iterations.contraction;
        if solver == Solver::Lambda && seen > factor * (1.0 + ROUNDING) {
            warnings.push(Warning::ContractionAboveBound {
                seen,
                bound: factor,
            });
        }
        Ok(Record {
            constants,
            conditions,
            contraction: seen,
            warnings,
        })
    }
}

/// Samples that contradict constants of an inequality.
fn contradictions(problem: &Inequality, constants: &Constants) -> Result<Vec<Warning>, SolveError> {
    let mut found = Vec::new();
    let mut note = |what, constant: f64, sample: f64, is_wrong: bool| {
        if is_wrong {
            found.push(Warning::Contradicted {
                what,
                constant,
                found: sample,
            });
        }
    };
    if constants.m.origin == Origin::Declared {
        let factor = problem.space.factor()?;
        let mut sampler = Sampler::new(4);
        let (mut lowest, mut highest): (f64, f64) = (f64::INFINITY, 0.0);
        for _ in 0..400 {
            let [u, v] = sampler.pair(problem.dimension());
            let [low, high] = operator_ratios(problem, factor.as_ref(), &u, &v);
            lowest = lowest.min(low);
            highest = highest.max(high);
        }
        let (m, l) = (constants.m.value, constants.lipschitz.value);
        note("m of (2.3)", m, lowest, lowest < m * (1.0 - ROUNDING));
        note("L of (2.3)", l, highest, highest > l * (1.0 + ROUNDING));
    }
    let alpha = constants.alpha;
    if alpha.origin == Origin::Declared {
        let sample = sampled_alpha(problem, 400);
        note(
            "alpha of (2.4)",
            alpha.value,
            sample,
            sample > alpha.value * (1.0 + ROUNDING),
        );
    }
    let beta = constants.beta;
    if beta.origin == Origin::Declared {
        let sample = sampled_beta(problem, 400);
        note(
            "beta of (2.5)",
            beta.value,
            sample,
            sample > beta.value * (1.0 + ROUNDING),
        );
    }
    Ok(found)
}
