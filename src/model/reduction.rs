//! Reduction of the body to the relaxation rates that its ports see, to a chosen tolerance.
//!
//! Galerkin projection on `span{ (c_i A + d_i B)^-1 P }` over a few shifts. The projected matrices need only the
//! transfer matrix (Loewner identities, `det = c_i d_j - c_j d_i`):
//!
//! ```text
//! X_i^T A X_j = (d_j H_j - d_i H_i) / det,   X_i^T B X_j = (c_i H_i - c_j H_j) / det
//! ```
//!
//! Directions that are dependent to rounding are dropped and the pair is diagonalised: `A = I`, `B = diag(rates)`.
//! Shifts are added, halving the angle between two known ones, until the transfer matrix agrees with the exact one at
//! every shift tested that is not used: entry by entry, and on the contact in the energy norm, where `|L^-1 (C_r - C) L^-T|`
//! with `C = L L^T` bounds the relative error of the compliance and of its inverse for any combination of forces or slips. Projection keeps the rates between the extreme
//! eigenvalues of `A^-1 B`, which the element rates bound: a rate outside is an error upstream.

use super::reduced::Reduced;
use super::transfer::{PortMatrix, Sample, sample, shift};
use crate::error::{Error, Result};
use crate::fem::Body;
use crate::linalg::{SparseCholesky, mirror_lower, symmetric_eigen};
use faer::{Mat, Par, Side};
use std::f64::consts::FRAC_PI_2;

/// Directions whose share of the scaled Gram matrix is below this are dependent. The first that leaves no rate outside the
/// bounds of the material is taken: rounding in a nearly dependent direction shows there first.
const RANK_TOLERANCES: [f64; 5] = [1e-13, 1e-12, 1e-11, 1e-10, 1e-9];
/// Most shifts that are tried before the tolerance is given up.
const MOST_SHIFTS: usize = 9;
/// Slack of the bounds on the rates, relative to the fastest.
const RATE_SLACK: f64 = 1e-6;

/// A reduced model with the record of how it was made.
pub struct Reduction {
    pub reduced: Reduced,
    pub record: ReductionRecord,
    pub synthesis: Synthesis,
}

/// How a reduced model was made.
#[derive(Debug, Clone, PartialEq)]
pub struct ReductionRecord {
    /// Shifts used, as `s = c / d` in 1/s (infinite for the instantaneous response).
    pub shifts: Vec<f64>,
    /// Largest relative error of the transfer matrix and of its inverse on the contact, at shifts that are not used.
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

/// Reduces `body` until every unused shift tested agrees to `tolerance`.
///
/// # Errors
/// [`Error::ReductionInaccurate`] when the tolerance is out of reach, [`Error::NotPositiveDefinite`] when the body is not held.
pub fn reduce(body: &Body, cholesky: &SparseCholesky, tolerance: f64) -> Result<Reduction> {
    let ports = PortMatrix::new(body);
    let [slowest, fastest] = body.element_rates;
    let reference_rate = (slowest * fastest).sqrt();
    // a body without elasticity relaxes at rate zero: any positive scale serves
    let reference_rate = if reference_rate > 0.0 {
        reference_rate
    } else {
        1.0
    };
    let take = |angle| sample(&ports, &body.operators, cholesky, reference_rate, angle);

    let mut used = vec![take(0.0)?, take(FRAC_PI_2)?];
    let mut tests = vec![take(0.5 * FRAC_PI_2)?];
    loop {
        let mut candidate = project(&used, &ports, reference_rate, body)?;
        let errors = tests
            .iter()
            .map(|t| candidate.error_at(t, reference_rate, body.contact_len()))
            .collect::<Result<Vec<f64>>>()?;
        let (worst, achieved) = errors
            .iter()
            .copied()
            .enumerate()
            .fold((0, 0.0), |best, e| if e.1 > best.1 { e } else { best });
        if achieved <= tolerance {
            candidate.record.achieved = achieved;
            return Ok(candidate);
        }
        if used.len() == MOST_SHIFTS {
            return Err(Error::ReductionInaccurate {
                achieved,
                tolerance,
                states: candidate.reduced.rates.len(),
            });
        }
        let added = tests.swap_remove(worst);
        let angle = added.angle;
        let at = used.partition_point(|s| s.angle < angle);
        let (before, after) = (used[at - 1].angle, used[at].angle);
        used.insert(at, added);
        tests.push(take(0.5 * (before + angle))?);
        tests.push(take(0.5 * (angle + after))?);
    }
}

/// Galerkin projection on the samples.
fn project(
    used: &[Sample],
    ports: &PortMatrix,
    reference_rate: f64,
    body: &Body,
) -> Result<Reduction> {
    let m = ports.len();
    let (mut a, mut b) = loewner(used, m);
    // columns of very different size (viscous and elastic responses) are made comparable first
    let scale: Vec<f64> = (0..a.nrows()).map(|i| inverse_root(a[(i, i)])).collect();
    scale_both_sides(&mut a, &scale);
    scale_both_sides(&mut b, &scale);

    let (gram, vectors) = symmetric_eigen("the Gram matrix of the reduction", a.as_ref())?;
    let mut modes = independent_modes(&gram, &vectors, &b, RANK_TOLERANCES[0])?;
    for rank_tolerance in &RANK_TOLERANCES[1..] {
        if outlier(&modes.0, reference_rate, body.element_rates).is_some() {
            modes = independent_modes(&gram, &vectors, &b, *rank_tolerance)?;
        }
    }
    let (scaled_rates, mut synthesis) = modes;
    if let Some(rate) = outlier(&scaled_rates, reference_rate, body.element_rates) {
        let [slowest, fastest] = body.element_rates;
        return Err(Error::Body {
            what: format!(
                "the reduction gives a relaxation rate of {rate} 1/s, outside the [{slowest}, {fastest}] of the material"
            ),
        });
    }
    for (i, s) in scale.iter().enumerate() {
        synthesis.row_mut(i).iter_mut().for_each(|v| *v *= s);
    }
    let rates = scaled_rates.iter().map(|r| r * reference_rate).collect();
    let mut stacked = Mat::<f64>::zeros(used.len() * m, m);
    for (i, s) in used.iter().enumerate() {
        stacked.as_mut().subrows_mut(i * m, m).copy_from(&s.h);
    }
    let seen = synthesis.transpose() * &stacked;
    let contact_len = ports.contact_len;
    Ok(Reduction {
        reduced: Reduced {
            contact: seen.as_ref().subcols(0, contact_len).to_owned(),
            outputs: seen
                .as_ref()
                .subcols(contact_len, m - contact_len)
                .to_owned(),
            loads: body.loads.len(),
            rates,
        },
        record: ReductionRecord {
            shifts: used
                .iter()
                .map(|s| {
                    let (c, d) = shift(s.angle);
                    if d == 0.0 {
                        f64::INFINITY
                    } else {
                        reference_rate * c / d
                    }
                })
                .collect(),
            achieved: f64::NAN,
        },
        synthesis: Synthesis {
            forces: synthesis,
            reference_rate,
            angles: used.iter().map(|s| s.angle).collect(),
        },
    })
}

/// The projected pair `(X^T A X, X^T B X)` over all shifts.
fn loewner(used: &[Sample], m: usize) -> (Mat<f64>, Mat<f64>) {
    let size = used.len() * m;
    let (mut a, mut b) = (Mat::<f64>::zeros(size, size), Mat::<f64>::zeros(size, size));
    for (i, si) in used.iter().enumerate() {
        let (ci, di) = shift(si.angle);
        for (j, sj) in used.iter().enumerate() {
            let (cj, dj) = shift(sj.angle);
            let det = ci * dj - cj * di;
            for q in 0..m {
                for p in 0..m {
                    let (va, vb) = if i == j {
                        (si.a[(p, q)], si.b[(p, q)])
                    } else {
                        let (hi, hj) = (si.h[(p, q)], sj.h[(p, q)]);
                        ((dj * hj - di * hi) / det, (ci * hi - cj * hj) / det)
                    };
                    a[(i * m + p, j * m + q)] = va;
                    b[(i * m + p, j * m + q)] = vb;
                }
            }
        }
    }
    (a, b)
}

/// Diagonalises the pair on the directions above the rank tolerance: rates (scaled) and modes.
fn independent_modes(
    gram: &[f64],
    vectors: &Mat<f64>,
    b: &Mat<f64>,
    rank_tolerance: f64,
) -> Result<(Vec<f64>, Mat<f64>)> {
    let largest = gram.last().copied().unwrap_or(0.0);
    let dropped = gram.partition_point(|g| *g <= rank_tolerance * largest);
    let mut basis = vectors
        .as_ref()
        .subcols(dropped, gram.len() - dropped)
        .to_owned();
    for (j, g) in gram[dropped..].iter().enumerate() {
        let root = 1.0 / g.sqrt();
        basis.col_mut(j).iter_mut().for_each(|v| *v *= root);
    }
    let mut projected = basis.transpose() * (b * &basis);
    mirror_lower(projected.as_mut());
    let (rates, rotation) = symmetric_eigen("the reduced elasticity", projected.as_ref())?;
    Ok((rates, &basis * &rotation))
}

/// A rate (1/s) outside the bounds of the material, if there is one.
fn outlier(scaled: &[f64], reference_rate: f64, [slowest, fastest]: [f64; 2]) -> Option<f64> {
    let slack = RATE_SLACK * fastest;
    scaled
        .iter()
        .map(|r| r * reference_rate)
        .find(|rate| !(*rate >= slowest - slack && *rate <= fastest + slack))
}

impl Reduction {
    /// Relative error at a sample: see the module.
    fn error_at(&self, exact: &Sample, reference_rate: f64, contact_len: usize) -> Result<f64> {
        let (c, d) = shift(exact.angle);
        let r = self.reduced.rates.len();
        let m = exact.h.nrows();
        let mut seen = Mat::<f64>::zeros(m, r);
        for (j, rate) in self.reduced.rates.iter().enumerate() {
            let root = 1.0 / (c + d * rate / reference_rate).sqrt();
            for i in 0..m {
                let port = if i < contact_len {
                    self.reduced.contact[(j, i)]
                } else {
                    self.reduced.outputs[(j, i - contact_len)]
                };
                seen[(i, j)] = port * root;
            }
        }
        let h = &seen * seen.transpose();
        let contact = |h: &Mat<f64>| {
            h.as_ref()
                .submatrix(0, 0, contact_len, contact_len)
                .to_owned()
        };
        let exact_contact = contact(&exact.h);
        let lower = exact_contact
            .llt(Side::Lower)
            .map_err(|_| Error::NotPositiveDefinite {
                what: "the contact compliance",
                pivot: 0,
            })?;
        // L^-1 (C_r - C) L^-T: how much any combination of contact forces is off, relative to its own response
        let mut off = &contact(&h) - &exact_contact;
        for _ in 0..2 {
            let l = lower.L();
            faer::linalg::triangular_solve::solve_lower_triangular_in_place(
                l,
                off.as_mut(),
                Par::Seq,
            );
            off = off.transpose().to_owned();
        }
        Ok(relative_difference(&h, &exact.h).max(off.norm_l2()))
    }
}

/// Largest difference of two matrices with positive diagonals, entry (i, j) relative to `sqrt(exact_ii exact_jj)`.
fn relative_difference(a: &Mat<f64>, exact: &Mat<f64>) -> f64 {
    let scale: Vec<f64> = (0..exact.nrows())
        .map(|i| inverse_root(exact[(i, i)]))
        .collect();
    let mut largest: f64 = 0.0;
    for j in 0..exact.ncols() {
        for i in 0..exact.nrows() {
            largest = largest.max((a[(i, j)] - exact[(i, j)]).abs() * scale[i] * scale[j]);
        }
    }
    largest
}

/// `1 / sqrt(x)`, and 0 for a port that does nothing.
fn inverse_root(x: f64) -> f64 {
    if x > 0.0 { 1.0 / x.sqrt() } else { 0.0 }
}

fn scale_both_sides(a: &mut Mat<f64>, scale: &[f64]) {
    for j in 0..a.ncols() {
        for i in 0..a.nrows() {
            a[(i, j)] *= scale[i] * scale[j];
        }
    }
}
