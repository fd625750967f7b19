//! All modes of a small body: the reduction of last resort, where the rates lie too far apart for a few shifts.
//!
//! With `A = L L^T`, the eigenvectors of `L^-1 B L^-T` are the modes, and nothing is projected: the only error is rounding. With
//! memory the pencil is that of `crate::body`. Strains of a branch that its C does not see have no part in it: with
//! `C_j = R_j R_j^T`, R_j of as many columns as C_j has rank, and `y_j = sqrt(tau_j) R_j^T q_j`,
//!
//! ```text
//! A_ext = diag(A, I),   B_ext = [[B + sum C_j, -R_j / sqrt(tau_j)], [-R_j^T / sqrt(tau_j), I / tau_j]]
//! ```

use super::galerkin::Modes;
use super::scaling::Scaling;
use super::transfer::Sampler;
use crate::error::{Error, Result};
use crate::fem::OperatorPair;
use crate::linalg::{mirror_lower, symmetric_eigen};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Mat, Par, Scale, Side};

/// Dofs, with those of the branches, of the largest body whose modes are all computed: half a second.
const MOST_DOFS: usize = 400;
/// Share of the largest eigenvalue of a branch below which it does not see a field.
const UNSEEN: f64 = 1e-13;

/// Whether all modes of a body with this many dofs are computed.
pub fn is_small(dofs: usize) -> bool {
    dofs <= MOST_DOFS
}

/// All modes, of rates in `interval`, and the fields of the body that they are (n x modes, by dofs); `size` is the number of ports
/// at all shifts.
///
/// # Errors
/// [`Error::NotPositiveDefinite`] when nothing of the viscosity survives rounding.
pub fn modes(
    operators: &OperatorPair,
    sampler: &Sampler,
    scaling: &Scaling,
    size: usize,
    [low, high]: [f64; 2],
) -> Result<(Modes, Mat<f64>)> {
    let (viscosity, mut pair) = pencil(operators, sampler)?;
    let factor = viscosity
        .llt(Side::Lower)
        .map_err(|_| Error::NotPositiveDefinite {
            what: "the viscosity of the body",
            pivot: 0,
        })?;
    let lower = factor.L();
    solve_lower_triangular_in_place(lower, pair.as_mut(), Par::Seq);
    solve_lower_triangular_in_place(lower, pair.as_mut().transpose_mut(), Par::Seq);
    let (mut rates, mut fields) = symmetric_eigen("the body", pair.as_ref())?;
    solve_upper_triangular_in_place(lower.transpose(), fields.as_mut(), Par::Seq);
    rates
        .iter_mut()
        .for_each(|rate| *rate = rate.clamp(low, high));
    let fields = fields.get(..operators.n, ..).to_owned();
    let seen = scaling.apply_to_velocities(&sampler.ports().observe(fields.as_ref()));
    let count = fields.ncols();
    let modes = Modes {
        rates,
        outlier: (0.0, 0.0),
        ports: seen.transpose().to_owned(),
        fields: Mat::identity(count, count),
        forces: Mat::zeros(size, count),
    };
    Ok((modes, fields))
}

/// A_ext, with sigma B_ext where a material has no dashpot, and B_ext by the reference rate.
fn pencil(operators: &OperatorPair, sampler: &Sampler) -> Result<(Mat<f64>, Mat<f64>)> {
    let n = operators.n;
    let springs = operators
        .memory
        .iter()
        .map(|branch| {
            let spring = dense(operators, &branch.c);
            let root = root(&spring)?;
            Ok((branch.tau, spring, root))
        })
        .collect::<Result<Vec<_>>>()?;
    let size = n + springs.iter().map(|(.., root)| root.ncols()).sum::<usize>();
    let mut viscosity = Mat::<f64>::identity(size, size);
    let own = viscosity.as_mut().submatrix_mut(0, 0, n, n);
    { own }.copy_from(dense(operators, &operators.a));
    let mut elasticity = Mat::<f64>::zeros(size, size);
    let mut own = dense(operators, &operators.b);
    let mut at = n;
    for (tau, spring, root) in springs {
        own += spring;
        let count = root.ncols();
        let coupling = Scale(-1.0 / tau.sqrt()) * root;
        let to = elasticity.as_mut().submatrix_mut(0, at, n, count);
        { to }.copy_from(&coupling);
        let to = elasticity.as_mut().submatrix_mut(at, 0, count, n);
        { to }.copy_from(coupling.transpose());
        for i in at..at + count {
            elasticity[(i, i)] = 1.0 / tau;
        }
        at += count;
    }
    let to = elasticity.as_mut().submatrix_mut(0, 0, n, n);
    { to }.copy_from(&own);
    if sampler.sigma() > 0.0 {
        viscosity += Scale(sampler.sigma()) * &elasticity;
    }
    Ok((
        viscosity,
        Scale(1.0 / sampler.reference_rate()) * elasticity,
    ))
}

/// R with `R R^T` a matrix that is not negative, of as many columns as it has eigenvalues that are not 0.
fn root(matrix: &Mat<f64>) -> Result<Mat<f64>> {
    let (values, vectors) = symmetric_eigen("a branch of the memory", matrix.as_ref())?;
    let largest = values.iter().copied().fold(0.0, f64::max);
    let seen: Vec<usize> = (0..values.len())
        .filter(|&i| values[i] > UNSEEN * largest)
        .collect();
    Ok(Mat::from_fn(matrix.nrows(), seen.len(), |i, j| {
        vectors[(i, seen[j])] * values[seen[j]].sqrt()
    }))
}

/// The symmetric matrix whose lower triangle has these values.
fn dense(operators: &OperatorPair, values: &[f64]) -> Mat<f64> {
    let mut out = Mat::zeros(operators.n, operators.n);
    for (column, ends) in operators.col_ptr.windows(2).enumerate() {
        for at in ends[0]..ends[1] {
            out[(operators.row_idx[at], column)] = values[at];
        }
    }
    mirror_lower(out.as_mut());
    out
}
