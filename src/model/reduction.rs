//! Reduction of the body to the relaxation rates that its ports see, to a chosen tolerance.
//!
//! Galerkin projection on `span{ (c_i A + d_i B)^-1 P }` over a few shifts (see `galerkin`), which are known beforehand from
//! the interval of rates (see `shifts`), from samples of the transfer matrix (see `transfer`): no basis of the length of the
//! body is ever formed. The result is then judged at the samples that are not shifts, the two ends among them. On the contact
//! `|L^-1 (C_r - C) L^-T|` with the compliance `C = L L^T` bounds the relative error of the compliance and of its
//! inverse for any combination of forces or slips. A load or probe of own response h and contact response c is right to
//! `|L^-1 (c_r - c)| / sqrt(h)`, for loads times [`LOAD_EMPHASIS`]. Projection keeps the rates between the extreme eigenvalues of
//! `A^-1 B`, which the element rates bound: a rate outside that matters is an error upstream.

use super::galerkin::{Modes, Projection};
use super::reduced::Reduced;
use super::scaling::Scaling;
use super::shifts::{Shifts, shift};
use super::transfer::{PortMatrix, Sampler};
use crate::error::{Error, Result};
use crate::fem::Body;
use crate::linalg::{SparseCholesky, StoredMatrix, mirror_lower, symmetric_eigenvalues};
use crate::scene::{Fidelity, Precision};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{Accum, Mat, MatMut, MatRef, Par};

/// What loads do to the contact is asked for to a smaller error than the tolerance: friction is a small difference of what
/// they push and what the body holds back, and its stress at a node is sharper than the energy of the contact tells.
/// Not below the rounding of the samples, though.
const LOAD_EMPHASIS: f64 = 1000.0;
/// Weight of the loads among the ports when their responses are ranked: they are few, and are kept nearly whole.
const LOAD_WEIGHT: f64 = 10.0;
/// Smooth contact forces whose derivatives are not taken from differences of samples, which would magnify their rounding errors:
/// those are largest where the whole body moves.
const SMOOTH_DIRECTIONS: usize = 16;
/// Shares of the tolerance that dropping nearly dependent responses may use, tried in this order: friction that weakens
/// magnifies errors of the body, and the larger shares are for tolerances at the limit of rounding.
const TRUNCATION_SHARES: [f64; 4] = [0.1, 0.02, 0.3, 1.0];
/// An outlying rate that changes the transfer matrix by more than this share, however many responses are kept, is no error of
/// the samples, but one upstream.
const OUTLIER: f64 = 1e-2;

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

/// Reduces `body` until the samples between the shifts agree to the tolerance, in the precision in which it is to be kept.
///
/// # Errors
/// [`Error::ReductionInaccurate`] when the tolerance is out of reach, [`Error::NotPositiveDefinite`] when the body is not held.
pub fn reduce(body: &Body, cholesky: &SparseCholesky, fidelity: &Fidelity) -> Result<Reduction> {
    let (tolerance, precision) = (fidelity.tolerance, fidelity.precision);
    let [slowest, fastest] = body.element_rates;
    let reference_rate = (slowest * fastest).sqrt();
    let interval = [slowest / reference_rate, fastest / reference_rate];
    let ports = PortMatrix::new(body);
    let mut sampler = Sampler::new(&ports, &body.operators, cholesky, reference_rate);
    let loads = body.loads.len();
    let of_loads = |value: f64| -> Vec<f64> {
        let others = 0..ports.others.len();
        others
            .map(|i| if i < loads { value } else { 1.0 })
            .collect()
    };
    // the condition of the operators, and with it the rounding of the samples, grows like the number of dofs
    let unit = match precision {
        Precision::Double => f64::EPSILON,
        Precision::Single => f64::from(f32::EPSILON),
    };
    let rounding = 2.0 * unit * body.len() as f64;
    let emphasis = (tolerance / rounding).clamp(1.0, LOAD_EMPHASIS);
    let (weights, emphasis) = (of_loads(LOAD_WEIGHT), of_loads(emphasis));

    let mut planned = Shifts::for_tolerance(interval, tolerance);
    let mut best = (f64::INFINITY, 0);
    let mut outlying: Option<(f64, f64)> = None;
    // the plan is for an even spectrum; a body that needs more than one shift beyond it is at the limit of rounding
    for _ in 0..2 {
        let Some(shifts) = planned else { break };
        let sampled = Sampled::new(&mut sampler, shifts, &weights, &emphasis)?;
        let projection = Projection::new(
            &sampled.shifts,
            &sampled.transfer,
            &sampled.derivatives,
            &emphasis,
        )?;
        let mut ranks = TRUNCATION_SHARES
            .map(|share| projection.rank_for(share * tolerance))
            .to_vec();
        ranks.dedup();
        for rank in ranks {
            let mut modes = projection.modes(rank, interval)?;
            if modes.outlier.0 > OUTLIER {
                outlying = outlying.or(Some(modes.outlier));
                continue;
            }
            let kept = keep(&mut modes, &sampled.scaling, precision);
            let achieved = sampled.error(&modes)?.max(f64::EPSILON);
            if achieved <= tolerance {
                return Ok(finish(
                    modes,
                    kept,
                    &sampled,
                    achieved,
                    loads,
                    reference_rate,
                ));
            }
            if achieved < best.0 {
                best = (achieved, rank);
            }
        }
        planned = sampled.shifts.refined(interval, tolerance);
    }
    match outlying {
        // whatever is kept, a rate outside that matters
        Some((_, rate)) if best.0 == f64::INFINITY => Err(Error::Body {
            what: format!(
                "the reduction gives a relaxation rate of {} 1/s, outside the [{slowest}, {fastest}] of the material",
                rate * reference_rate,
            ),
        }),
        _ => Err(Error::ReductionInaccurate {
            achieved: best.0,
            tolerance,
            states: best.1,
        }),
    }
}

/// Contact velocities and outputs of the modes in the units of the scene, as they are kept; the modes become those that were
/// kept.
fn keep(modes: &mut Modes, scaling: &Scaling, precision: Precision) -> (StoredMatrix, Mat<f64>) {
    let ports = scaling.unapply(&modes.ports);
    let (contact, outputs) = ports.split_at_col(scaling.contact_len());
    let contact = match precision {
        Precision::Double => StoredMatrix::Double(contact.to_owned()),
        Precision::Single => {
            let single = StoredMatrix::single(contact);
            let rounded = scaling.contact_velocities(&single.to_double());
            let mut ports = modes.ports.as_mut().subcols_mut(0, rounded.ncols());
            ports.copy_from(rounded);
            single
        }
    };
    (contact, outputs.to_owned())
}

/// The modes, with what is kept of their ports.
fn finish(
    modes: Modes,
    (contact, outputs): (StoredMatrix, Mat<f64>),
    sampled: &Sampled,
    achieved: f64,
    loads: usize,
    reference_rate: f64,
) -> Reduction {
    let (scaling, shifts) = (&sampled.scaling, &sampled.shifts);
    let m = modes.ports.ncols();
    let mut forces = modes.forces;
    for shift in 0..shifts.count() {
        scaling.apply_to_forces(forces.as_mut().subrows_mut(shift * m, m));
    }
    Reduction {
        reduced: Reduced {
            contact,
            outputs,
            loads,
            rates: modes.rates.iter().map(|r| r * reference_rate).collect(),
        },
        record: ReductionRecord {
            shifts: shifts.rates(reference_rate),
            achieved,
        },
        synthesis: Synthesis {
            forces,
            reference_rate,
            angles: (0..shifts.count()).map(|i| shifts.angle(i)).collect(),
        },
    }
}

/// The scaled transfer matrix at all angles.
struct Sampled<'a> {
    shifts: Shifts,
    scaling: Scaling,
    transfer: Vec<Mat<f64>>,
    /// Its derivative by the angle at the shifts.
    derivatives: Vec<Mat<f64>>,
    /// Factors `Z^T Z` of the contact blocks.
    factors: Vec<Mat<f64>>,
    emphasis: &'a [f64],
}

impl<'a> Sampled<'a> {
    fn new(
        sampler: &mut Sampler,
        shifts: Shifts,
        weights: &[f64],
        emphasis: &'a [f64],
    ) -> Result<Sampled<'a>> {
        let middle = shifts.tests[shifts.tests.len() / 2];
        let scaling = Scaling::new(&sampler.sample(shifts.angles[middle])?, weights);
        let directions = scaling.smooth_directions(SMOOTH_DIRECTIONS);
        let forces = scaling.contact_forces(&directions);
        let (mut transfer, mut factors, mut exact) = (Vec::new(), Vec::new(), Vec::new());
        for (at, angle) in shifts.angles.iter().enumerate() {
            let sample = sampler.sample(*angle)?;
            if shifts.shifts.contains(&at) {
                exact.push(sampler.derivative(&sample, &forces));
            }
            let scaled = scaling.apply(&sample);
            transfer.push(scaled.h);
            factors.push(scaled.z);
        }
        let mut derivatives = Vec::new();
        for (i, (&at, exact)) in shifts.shifts.iter().zip(&exact).enumerate() {
            let mut derivative = shifts.derivative(i, &transfer);
            scaling.correct_derivative(&mut derivative, exact, &factors[at], &directions);
            derivatives.push(derivative);
        }
        Ok(Sampled {
            shifts,
            scaling,
            transfer,
            derivatives,
            factors,
            emphasis,
        })
    }

    /// Largest error of the modes at the samples that are not shifts: see the module.
    fn error(&self, modes: &Modes) -> Result<f64> {
        let mut worst: f64 = 0.0;
        for &at in &self.shifts.tests {
            worst = worst.max(self.error_at(modes, at)?);
        }
        Ok(worst)
    }

    fn error_at(&self, modes: &Modes, at: usize) -> Result<f64> {
        let (exact, z) = (&self.transfer[at], &self.factors[at]);
        let (m, contact) = (exact.nrows(), z.nrows());
        let mut off = exact.clone();
        let (to, ports) = (off.as_mut(), modes.ports.as_ref());
        add_response(to, -1.0, ports, &modes.rates, shift(self.shifts.angles[at]));
        mirror_lower(off.as_mut());

        let on_contact = off.as_mut().subrows_mut(0, contact);
        solve_upper_triangular_in_place(z.transpose(), on_contact, Par::Seq);
        let mut worst: f64 = 0.0;
        for (j, emphasis) in (contact..m).zip(self.emphasis) {
            let own = exact[(j, j)];
            // a port that does nothing has no error
            if own > 0.0 {
                let on_contact = off.get(..contact, j).norm_l2() / own.sqrt();
                worst = worst.max(emphasis * on_contact);
                for i in (contact..m).filter(|&i| exact[(i, i)] > 0.0) {
                    worst = worst.max(off[(i, j)].abs() / (own * exact[(i, i)]).sqrt());
                }
            }
        }
        let mut energy = off.get(..contact, ..contact).transpose().to_owned();
        solve_upper_triangular_in_place(z.transpose(), energy.as_mut(), Par::Seq);
        let energy = symmetric_eigenvalues("the error of the reduction", energy.as_ref())?;
        Ok(energy.iter().fold(worst, |worst, v| v.abs().max(worst)))
    }
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
