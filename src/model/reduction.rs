//! Reduction of the body to the relaxation rates that its ports see, to a chosen tolerance.
//!
//! Galerkin projection on `span{ (c_i A + d_i B)^-1 P }` over a few shifts (see `galerkin`), which are known beforehand from
//! the interval of rates (see `shifts`), from samples of the transfer matrix (see `transfer`): no basis of the length of the
//! body is ever formed. The result is then judged at the samples that are not shifts, the two ends among them: entry by entry, and
//! on the contact in the energy norm, where `|L^-1 (C_r - C) L^-T|` with `C = L L^T` bounds the relative error of the
//! compliance and of its inverse for any combination of forces or slips. Projection keeps the rates between the
//! extreme eigenvalues of `A^-1 B`, which the element rates bound: a rate outside is an error upstream.

use super::galerkin::{Modes, Projection, compliance_factor};
use super::reduced::Reduced;
use super::shifts::{Shifts, shift};
use super::transfer::{PortMatrix, Sampler};
use crate::error::{Error, Result};
use crate::fem::Body;
use crate::linalg::{SparseCholesky, symmetric_eigenvalues};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, Mat, MatMut, MatRef, Par};

/// Shares of the tolerance that dropping nearly dependent responses may use, tried in this order.
const TRUNCATION_SHARES: [f64; 3] = [0.3, 0.03, 0.003];
/// Rates may be this far beyond the bounds of the material, relative to the fastest: those of responses that hardly matter
/// carry the rounding errors of the samples, magnified.
const RATE_SLACK: f64 = 1e-2;

/// A reduced model with the record of how it was made.
pub struct Reduction {
    pub reduced: Reduced,
    pub record: ReductionRecord,
    pub synthesis: Synthesis,
}

/// How a reduced model was made.
#[derive(Debug, Clone, PartialEq)]
pub struct ReductionRecord {
    /// Shifts used, as `s = c / d` in 1/s, descending.
    pub shifts: Vec<f64>,
    /// Largest relative error of the transfer matrix and of its inverse on the contact, at angles between the shifts, the
    /// instantaneous and the long-time response among them.
    pub achieved: f64,
}

/// What rebuilds the field of the body from modal coordinates: every mode is a sum of responses to port forces.
pub struct Synthesis {
    /// Port forces at every shift that make up a mode: (shifts x ports) x states.
    pub forces: Mat<f64>,
    /// Angles of the shifts.
    pub angles: Vec<f64>,
    /// Reference rate that scales B, 1/s.
    pub reference_rate: f64,
}

/// Reduces `body` until the samples between the shifts agree to `tolerance`.
///
/// # Errors
/// [`Error::ReductionInaccurate`] when the tolerance is out of reach, [`Error::NotPositiveDefinite`] when the body is not held.
pub fn reduce(body: &Body, cholesky: &SparseCholesky, tolerance: f64) -> Result<Reduction> {
    let [slowest, fastest] = body.element_rates;
    let reference_rate = (slowest * fastest).sqrt();
    let interval = [slowest / reference_rate, fastest / reference_rate];
    let ports = PortMatrix::new(body);
    let mut sampler = Sampler::new(&ports, &body.operators, cholesky, reference_rate);
    let inaccurate = |achieved, states| Error::ReductionInaccurate {
        achieved,
        tolerance,
        states,
    };

    let mut planned = Shifts::for_tolerance(interval, tolerance);
    let mut best = inaccurate(f64::INFINITY, 0);
    // the plan is for an even spectrum; a body that needs more than one shift beyond it is at the limit of rounding
    for _ in 0..2 {
        let Some(shifts) = planned else { break };
        let samples = shifts
            .angles
            .iter()
            .map(|angle| sampler.sample(*angle))
            .collect::<Result<Vec<_>>>()?;
        let projection = Projection::new(&shifts, &samples, ports.contact_len)?;
        let mut last_rank = 0;
        for share in TRUNCATION_SHARES {
            let rank = projection.rank_for(share * tolerance);
            if rank == last_rank {
                continue;
            }
            last_rank = rank;
            let modes = projection.modes(rank)?;
            check_rates(&modes.rates, interval, reference_rate)?;
            let achieved = error_at_tests(&modes, &shifts, &samples, ports.contact_len)?;
            if achieved <= tolerance {
                let achieved = achieved.max(f64::EPSILON);
                return Ok(finish(
                    modes,
                    &shifts,
                    body,
                    &ports,
                    reference_rate,
                    achieved,
                ));
            }
            best = inaccurate(achieved, rank);
        }
        planned = shifts.refined(interval);
    }
    Err(best)
}

fn finish(
    modes: Modes,
    shifts: &Shifts,
    body: &Body,
    ports: &PortMatrix,
    reference_rate: f64,
    achieved: f64,
) -> Reduction {
    let (m, contact) = (ports.len(), ports.contact_len);
    let angles: Vec<f64> = (0..shifts.count())
        .map(|i| shifts.angles[shifts.at(i)])
        .collect();
    Reduction {
        reduced: Reduced {
            contact: modes.ports.get(.., ..contact).to_owned(),
            outputs: modes.ports.get(.., contact..m).to_owned(),
            loads: body.loads.len(),
            rates: modes.rates.iter().map(|r| r * reference_rate).collect(),
        },
        record: ReductionRecord {
            shifts: angles
                .iter()
                .map(|angle| reference_rate / angle.tan())
                .collect(),
            achieved,
        },
        synthesis: Synthesis {
            forces: modes.forces,
            reference_rate,
            angles,
        },
    }
}

/// Checks the rates against the bounds of the material.
fn check_rates(rates: &[f64], [low, high]: [f64; 2], reference_rate: f64) -> Result<()> {
    let slack = RATE_SLACK * high;
    for rate in rates {
        if !(*rate >= low - slack && *rate <= high + slack) {
            return Err(Error::Body {
                what: format!(
                    "the reduction gives a relaxation rate of {} 1/s, outside the [{}, {}] of the material",
                    *rate * reference_rate,
                    low * reference_rate,
                    high * reference_rate
                ),
            });
        }
    }
    Ok(())
}

/// Largest error at the samples that are not shifts: see the module.
fn error_at_tests(
    modes: &Modes,
    shifts: &Shifts,
    samples: &[Mat<f64>],
    contact_len: usize,
) -> Result<f64> {
    let mut worst: f64 = 0.0;
    for at in shifts.tests() {
        let error = error_at(modes, shifts.angles[at], &samples[at], contact_len)?;
        worst = worst.max(error);
    }
    Ok(worst)
}

fn error_at(modes: &Modes, angle: f64, exact: &Mat<f64>, contact_len: usize) -> Result<f64> {
    let (c, d) = shift(angle);
    let m = exact.nrows();
    let mut off = exact.clone();
    add_response(
        off.as_mut(),
        -1.0,
        modes.ports.as_ref(),
        &modes.rates,
        (c, d),
    );
    let mut entrywise: f64 = 0.0;
    for j in 0..m {
        for i in j..m {
            let scale = (exact[(i, i)] * exact[(j, j)]).sqrt();
            // a port that does nothing has no error
            if scale > 0.0 {
                entrywise = entrywise.max(off[(i, j)].abs() / scale);
            }
            off[(j, i)] = off[(i, j)];
        }
    }
    let lower = compliance_factor(exact.get(..contact_len, ..contact_len))?;
    let mut energy = off.get(..contact_len, ..contact_len).to_owned();
    for _ in 0..2 {
        solve_lower_triangular_in_place(lower.as_ref(), energy.as_mut(), Par::Seq);
        energy = energy.transpose().to_owned();
    }
    let energy = symmetric_eigenvalues("the error of the reduction", energy.as_ref())?
        .iter()
        .fold(0.0, |worst, v| v.abs().max(worst));
    Ok(entrywise.max(energy))
}

/// Adds `weight ports^T diag(1 / (c + d rate)) ports` to the lower triangle of `to`.
pub fn add_response(
    to: MatMut<f64>,
    weight: f64,
    ports: MatRef<f64>,
    rates: &[f64],
    (c, d): (f64, f64),
) {
    let mut weighted = ports.to_owned();
    for j in 0..ports.ncols() {
        for (value, rate) in weighted.col_mut(j).iter_mut().zip(rates) {
            *value /= c + d * rate;
        }
    }
    matmul(
        to,
        BlockStructure::TriangularLower,
        Accum::Add,
        ports.transpose(),
        BlockStructure::Rectangular,
        weighted.as_ref(),
        BlockStructure::Rectangular,
        weight,
        Par::Seq,
    );
}
