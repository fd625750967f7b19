//! Galerkin projection on the responses themselves: for rates decades apart, where the products of responses that samples tell are
//! too coarse.
//!
//! At a shift that is far from a rate the response of a mode is thousands of times smaller, or larger, than at one that is near. Its
//! products from samples (see `responses`) are right to the rounding of the largest, and what is dropped for its little energy in A may
//! have much of it in B. So every response is computed here as a field, made orthonormal to those before it in `A + B` (B by the
//! reference rate), which both ends are equally far from, and dropped by what it adds to itself. Modes that the ports hardly see are
//! left out in the end. It takes memory for the fields.

use super::basis::Basis;
use super::galerkin::Modes;
use super::samples::Sampled;
use super::transfer::Sampler;
use crate::error::Result;
use crate::linalg::symmetric_eigen;
use faer::Mat;
use std::f64::consts::FRAC_PI_2;

/// Shares of a response below which it is dropped, tried in this order: errors are their squares, magnified by the distance of the
/// rates.
pub const DROPPED: [f64; 4] = [1e-5, 1e-6, 1e-7, 1e-9];
/// Share of the tolerance that the modes left out have together.
const LEFT_OUT: f64 = 0.1;
/// Most numbers of the fields: 300 MB, and as many for their images.
const MOST_NUMBERS: usize = 40_000_000;
/// Most multiplications of making them orthonormal: half a minute.
const MOST_WORK: f64 = 6e10;
/// Responses that are computed together.
const BLOCK: usize = 32;

/// Whether there are memory and time for the responses to so many ports at so many shifts.
pub fn are_affordable(sampler: &Sampler, shifts: usize) -> bool {
    let rows = sampler.field_len();
    let columns = (shifts * sampler.ports().len()).min(rows);
    let work = 4.0 * rows as f64 * (columns as f64).powi(2);
    rows.saturating_mul(columns) <= MOST_NUMBERS && work <= MOST_WORK
}

/// The modes of the projection on all responses that have more than the share `dropped` of their own, of rates in an interval, and the
/// fields that they are sums of (n x fields, by dofs), for a tolerance.
///
/// # Errors
/// [`crate::Error::NotPositiveDefinite`] when the body is not held; [`crate::Error::Body`] when the eigenvalues cannot be computed.
pub fn modes(
    sampler: &mut Sampler,
    sampled: &Sampled,
    (dropped, tolerance): (f64, f64),
    [low, high]: [f64; 2],
) -> Result<(Modes, Mat<f64>)> {
    let (viscosity, elasticity) = (sampler.viscosity(), sampler.operator(FRAC_PI_2));
    let (ports, shifts) = (sampler.ports(), &sampled.shifts);
    let m = ports.len();
    let rows = sampler.field_len();
    let mut basis = Basis::dropping(rows, (shifts.count() * m).min(rows), dropped);
    for shift in 0..shifts.count() {
        let sample = sampler.sample(shifts.angle(shift))?;
        for from in (0..m).step_by(BLOCK) {
            let mut columns = ports.columns(from..m.min(from + BLOCK));
            sampler.respond(&sample.lower, columns.as_mut());
            let responses = sampler.with_branches(columns, None);
            basis.add(responses, |x| {
                sampler.viscous_images(&viscosity, x) + sampler.elastic_images(&elasticity, x)
            });
        }
    }
    let fields = basis.into_fields();
    let pair = sampler.elastic_gram(&elasticity, fields.as_ref());
    let (mut rates, mut weights) = symmetric_eigen("the reduced elasticity", pair.as_ref())?;
    // what of a mode of a rate is in B, and its amplitude for a unit in A
    let share = |rate: f64| rate / (1.0 + rate);
    for (rate, mode) in rates.iter_mut().zip(weights.col_iter_mut()) {
        let of_elasticity = rate.clamp(share(low), share(high));
        *rate = (of_elasticity / (1.0 - of_elasticity)).clamp(low, high);
        let amplitude = (1.0 + *rate).sqrt();
        mode.iter_mut().for_each(|weight| *weight *= amplitude);
    }
    let own = fields.get(..ports.rows, ..).to_owned();
    let seen = sampled
        .scaling
        .apply_to_velocities(&ports.observe(own.as_ref()));
    let all = weights.transpose() * seen.transpose();
    let kept = sampled.seen_modes(&rates, all.as_ref(), LEFT_OUT * tolerance);
    let rates: Vec<f64> = kept.iter().map(|&mode| rates[mode]).collect();
    let modes = Modes {
        ports: Mat::from_fn(kept.len(), all.ncols(), |i, port| all[(kept[i], port)]),
        outlier: (0.0, 0.0),
        forces: Mat::zeros(shifts.count() * m, rates.len()),
        fields: Mat::from_fn(weights.nrows(), kept.len(), |i, j| weights[(i, kept[j])]),
        rates,
    };
    Ok((modes, own))
}
