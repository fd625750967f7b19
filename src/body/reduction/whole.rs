//! All modes of a small body: the reduction of last resort, where the rates lie too far apart for a few shifts.
//!
//! With `A = L L^T`, the eigenvectors of `L^-1 B L^-T` are the modes, and nothing is projected: the only error is rounding.

use super::galerkin::Modes;
use super::scaling::Scaling;
use super::transfer::Sampler;
use crate::error::{Error, Result};
use crate::fem::OperatorPair;
use crate::linalg::{mirror_lower, symmetric_eigen};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Mat, Par, Side};
use std::f64::consts::FRAC_PI_2;

/// Dofs of the largest body whose modes are all computed: half a second.
const MOST_DOFS: usize = 400;

/// Whether all modes of a body with this many dofs are computed.
pub fn is_small(dofs: usize) -> bool {
    dofs <= MOST_DOFS
}

/// All modes, of rates in `interval`, and the fields of the body that they are (n x n, by dofs); `size` is the number of ports
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
    let viscosity = dense(operators, &sampler.operator(0.0));
    let factor = viscosity
        .llt(Side::Lower)
        .map_err(|_| Error::NotPositiveDefinite {
            what: "the viscosity of the body",
            pivot: 0,
        })?;
    let lower = factor.L();
    let mut pair = dense(operators, &sampler.operator(FRAC_PI_2));
    solve_lower_triangular_in_place(lower, pair.as_mut(), Par::Seq);
    solve_lower_triangular_in_place(lower, pair.as_mut().transpose_mut(), Par::Seq);
    let (mut rates, mut fields) = symmetric_eigen("the body", pair.as_ref())?;
    solve_upper_triangular_in_place(lower.transpose(), fields.as_mut(), Par::Seq);
    rates
        .iter_mut()
        .for_each(|rate| *rate = rate.clamp(low, high));
    let seen = scaling.apply_to_velocities(&sampler.ports().observe(fields.as_ref()));
    let n = fields.ncols();
    let modes = Modes {
        rates,
        outlier: (0.0, 0.0),
        ports: seen.transpose().to_owned(),
        fields: Mat::identity(n, n),
        forces: Mat::zeros(size, n),
    };
    Ok((modes, fields))
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
