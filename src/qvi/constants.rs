//! The constants of an inequality: m and L of (2.3), alpha of (2.4), beta of (2.5), c1 = |R| |q|.
//!
//! Those of matrices are computed from eigenvalues in the inner product of the space; those that functions declare are taken as
//! declared; where nothing is declared, sampling gives a bound from one side. The values of the history operators have the norm of
//! the space where they have its dimension and the Euclidean one elsewhere.
//!
//! ```text
//! phi(y1, v2) - phi(y1, v1) + phi(y2, v1) - phi(y2, v2) <= alpha |y1 - y2| |v1 - v2|             (2.4)
//! j(u1, v2) - j(u1, v1) + j(u2, v1) - j(u2, v2) <= beta |u1 - u2| |v1 - v2|                      (2.5)
//! ```

use super::functional::{Functional, Linear};
use super::sampling::Sampler;
use super::space::{largest_singular_value, orthonormal, smallest_symmetric_eigenvalue};
use super::{Inequality, SolveError};
use nalgebra::{DMatrix, DVector};

/// Where a constant comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// From eigenvalues.
    Computed,
    /// The user's word.
    Declared,
    /// The worst of samples: m is at most, the other constants are at least this large.
    Sampled,
}

/// A constant and where it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constant {
    pub value: f64,
    pub origin: Origin,
}

impl Constant {
    fn new(value: f64, origin: Origin) -> Constant {
        Constant { value, origin }
    }
}

/// All constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants {
    pub m: Constant,
    pub lipschitz: Constant,
    pub alpha: Constant,
    pub beta: Constant,
    pub c1: Constant,
}

/// Pairs of points that sampling looks at.
const SAMPLES: usize = 400;
/// Points of `[0, T]` at which kernels are evaluated for c1.
const TIMES: usize = 32;

impl Constants {
    /// Those of an inequality on `[0, T]`; with eigenvalues of dense matrices, so O(n^3) in the number of unknowns.
    ///
    /// # Errors
    /// [`SolveError::Singular`] for an inner product that is not positive definite.
    pub fn of(problem: &Inequality, end: f64) -> Result<Constants, SolveError> {
        let factor = problem.space.factor()?;
        let factor = factor.as_ref();
        let [m, lipschitz] = match (problem.operator.matrix(), problem.operator.constants()) {
            (Some(matrix), _) => {
                let matrix = orthonormal(&matrix.to_dense(), [factor, factor])?;
                [
                    smallest_symmetric_eigenvalue(&matrix),
                    largest_singular_value(&matrix),
                ]
                .map(|value| Constant::new(value, Origin::Computed))
            }
            (None, Some(constants)) => {
                constants.map(|value| Constant::new(value, Origin::Declared))
            }
            (None, None) => sampled_operator(problem, factor)?
                .map(|value| Constant::new(value, Origin::Sampled)),
        };
        let c1 = problem
            .histories
            .iter()
            .map(|history| history.largest(&problem.space, end, TIMES));
        let c1 = c1.map(|c| c * c).sum::<f64>().sqrt();
        Ok(Constants {
            m,
            lipschitz,
            alpha: alpha(problem, factor)?,
            beta: match problem.j.lipschitz() {
                Some(beta) => Constant::new(beta, Origin::Declared),
                None => Constant::new(sampled_beta(problem, SAMPLES), Origin::Sampled),
            },
            c1: Constant::new(c1, Origin::Computed),
        })
    }
}

fn alpha(problem: &Inequality, factor: Option<&DMatrix<f64>>) -> Result<Constant, SolveError> {
    if let Some(alpha) = problem.phi.lipschitz() {
        return Ok(Constant::new(alpha, Origin::Declared));
    }
    let n = problem.dimension();
    let matrices: Vec<_> = (0..problem.histories.len())
        .map(|i| problem.phi.linear(i))
        .collect();
    let is_known = matrices.iter().all(|m| !matches!(m, Linear::Nonlinear));
    if !problem.phi.is_linear() || !is_known {
        return Ok(Constant::new(
            sampled_alpha(problem, SAMPLES),
            Origin::Sampled,
        ));
    }
    // |[B_1 B_2 ...]|^2 is at most the sum of the squares, and is the largest eigenvalue of the sum of B_i B_i^T
    let mut sum = DMatrix::zeros(n, n);
    for matrix in &matrices {
        if let Linear::Matrix(matrix) = matrix {
            let matrix = matrix.to_dense();
            let from = if matrix.ncols() == n { factor } else { None };
            let matrix = orthonormal(&matrix, [factor, from])?;
            sum += &matrix * matrix.transpose();
        }
    }
    let largest = sum.symmetric_eigenvalues().max().max(0.0).sqrt();
    Ok(Constant::new(largest, Origin::Computed))
}

/// Length of a covector.
fn dual_norm(factor: Option<&DMatrix<f64>>, f: &DVector<f64>) -> f64 {
    match factor {
        None => f.norm(),
        Some(c) => c
            .solve_lower_triangular(f)
            .map_or(f64::NAN, |solved| solved.norm()),
    }
}

fn sampled_operator(
    problem: &Inequality,
    factor: Option<&DMatrix<f64>>,
) -> Result<[f64; 2], SolveError> {
    let mut sampler = Sampler::new(1);
    let (mut m, mut l): (f64, f64) = (f64::INFINITY, 0.0);
    for _ in 0..SAMPLES {
        let [u, v] = sampler.pair(problem.dimension());
        let [lowest, highest] = operator_ratios(problem, factor, &u, &v);
        m = m.min(lowest);
        l = l.max(highest);
    }
    Ok([m, l])
}

/// `(A u - A v, u - v) / |u - v|^2` and `|A u - A v| / |u - v|`.
pub(super) fn operator_ratios(
    problem: &Inequality,
    factor: Option<&DMatrix<f64>>,
    u: &DVector<f64>,
    v: &DVector<f64>,
) -> [f64; 2] {
    let force = problem.operator.apply(u) - problem.operator.apply(v);
    let difference = u - v;
    let size = problem.space.norm(&difference);
    [
        force.dot(&difference) / (size * size),
        dual_norm(factor, &force) / size,
    ]
}

/// The left side of (2.4) or (2.5) over `|v1 - v2|`.
fn four_terms(
    problem: &Inequality,
    of: &dyn Functional,
    [first, second]: [&[DVector<f64>]; 2],
    [v1, v2]: [&DVector<f64>; 2],
) -> f64 {
    let frozen = |at: &[DVector<f64>]| {
        let mut force = DVector::zeros(problem.dimension());
        let mut coefficients = vec![0.0; problem.parts.len()];
        of.freeze(at, &mut force, &mut coefficients);
        (force, coefficients)
    };
    let ((b1, c1), (b2, c2)) = (frozen(first), frozen(second));
    let mut sum = (b1 - b2).dot(&(v2 - v1));
    for ((part, c1), c2) in problem.parts.iter().zip(c1).zip(c2) {
        let of = |v: &DVector<f64>| part.shape.value(&v.as_slice()[part.components.clone()]);
        sum += (c1 - c2) * (of(v2) - of(v1));
    }
    sum / problem.space.norm(&(v1 - v2))
}

/// Largest ratio of (2.4) over samples.
pub(super) fn sampled_alpha(problem: &Inequality, samples: usize) -> f64 {
    let n = problem.dimension();
    let mut sampler = Sampler::new(2);
    let mut largest: f64 = 0.0;
    for _ in 0..samples {
        let pairs = problem.histories.iter().map(|history| {
            let [y1, y2] = sampler.pair(history.dimension(n));
            (y1, y2)
        });
        let (first, second): (Vec<_>, Vec<_>) = pairs.unzip();
        let squares = first.iter().zip(&second).map(|(y1, y2)| {
            let difference = y1 - y2;
            match difference.len() == n {
                true => problem.space.norm(&difference).powi(2),
                false => difference.norm_squared(),
            }
        });
        let size = squares.sum::<f64>().sqrt();
        if size == 0.0 {
            continue;
        }
        let [v1, v2] = sampler.pair(n);
        let found = four_terms(problem, &*problem.phi, [&first, &second], [&v1, &v2]);
        largest = largest.max(found.abs() / size);
    }
    largest
}

/// Largest ratio of (2.5) over samples, at fixed values of the history operators.
pub(super) fn sampled_beta(problem: &Inequality, samples: usize) -> f64 {
    let n = problem.dimension();
    let mut sampler = Sampler::new(3);
    let mut largest: f64 = 0.0;
    for _ in 0..samples {
        let [u1, u2] = sampler.pair(n);
        let size = problem.space.norm(&(&u1 - &u2));
        let values: Vec<_> = problem
            .histories
            .iter()
            .map(|history| sampler.pair(history.dimension(n))[0].clone())
            .collect();
        let with = |u: DVector<f64>| -> Vec<_> {
            std::iter::once(u).chain(values.iter().cloned()).collect()
        };
        let [v1, v2] = sampler.pair(n);
        let arguments = [with(u1), with(u2)];
        let found = four_terms(
            problem,
            &*problem.j,
            [&arguments[0], &arguments[1]],
            [&v1, &v2],
        );
        largest = largest.max(found.abs() / size);
    }
    largest
}
