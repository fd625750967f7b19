//! Samples of the transfer matrix: what a reduction is made from, and what it is judged by.
//!
//! A reduction is judged at the samples that are not shifts, the two ends among them. On the contact `|L^-1 (C_r - C) L^-T|` with
//! the compliance `C = L L^T` bounds the relative error of the compliance and of its inverse for any combination of forces or
//! slips. A load or probe of own response h and contact response c is right to `|L^-1 (c_r - c)| / sqrt(h)`, times its emphasis.

use super::fields::{Depth, Fields};
use super::scaling::Scaling;
use super::shifts::{Shifts, shift};
use super::transfer::Sampler;
use super::turn::Turn;
use crate::body::digits::Ends;
use crate::body::reduced::add_response;
use crate::error::Result;
use crate::linalg::{mirror_lower, symmetric_eigenvalues};
use crate::progress::{Phase, Watch};
use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{Mat, MatRef, Par};

/// Smooth contact forces whose responses are fields: the rounding errors of samples are largest where the whole body moves.
const SMOOTH_DIRECTIONS: usize = 3;

/// Fractions of a compilation between which the samples are taken.
const SAMPLING: [f64; 2] = [0.25, 0.8];

/// The scaled transfer matrix at all angles.
pub struct Sampled<'a> {
    pub shifts: Shifts,
    pub scaling: Scaling,
    pub transfer: Vec<Mat<f64>>,
    /// Its derivative by the angle at the shifts.
    pub derivatives: Vec<Mat<f64>>,
    /// Responses to loads and smooth contact forces, and their products in A with those to the ports at the shifts: ports x
    /// fields.
    pub fields: Fields,
    pub couplings: Vec<Mat<f64>>,
    /// Brings the smooth contact forces whose responses are fields to the first ports.
    pub turn: Turn,
    /// Factors `Z^T Z` of the contact blocks.
    factors: Vec<Mat<f64>>,
    emphasis: &'a [f64],
}

impl<'a> Sampled<'a> {
    pub fn new(
        sampler: &mut Sampler,
        ends: &Ends,
        shifts: Shifts,
        weights: &[f64],
        emphasis: &'a [f64],
        (loads, depth): (usize, Depth),
        watch: &mut Watch,
    ) -> Result<Sampled<'a>> {
        let middle = shifts.tests[shifts.tests.len() / 2];
        let reference = sampler.sample(shifts.angles[middle])?;
        let scaling = Scaling::new(&reference, weights);
        let directions = scaling.smooth_directions(SMOOTH_DIRECTIONS);
        let forces = sampler
            .ports()
            .forces(loads, &scaling.contact_forces(&directions));
        let mut fields = Fields::new(sampler, &reference, (forces, loads), depth);
        let (mut transfer, mut factors, mut couplings) = (Vec::new(), Vec::new(), Vec::new());
        let mut computed = Vec::new();
        for (at, angle) in shifts.angles.iter().enumerate() {
            let done = at as f64 / shifts.angles.len() as f64;
            watch.report(
                Phase::Reduction,
                SAMPLING[0] + (SAMPLING[1] - SAMPLING[0]) * done,
            )?;
            let own;
            let sample = if at == middle {
                &reference
            } else if let Some(end) = ends.at(*angle) {
                end
            } else {
                own = sampler.sample(*angle)?;
                &own
            };
            if shifts.shifts.contains(&at) {
                let seen = fields.couple(sampler, sample);
                couplings.push(scaling.apply_to_velocities(&seen));
                if shifts.computes_derivatives() {
                    computed.push(scaling.apply_to_matrix(&sampler.derivative(sample)));
                }
            }
            let scaled = scaling.apply(sample);
            transfer.push(scaled.h);
            factors.push(scaled.z);
        }
        fields.seen = scaling.apply_to_velocities(&fields.seen);
        let derivatives = match shifts.computes_derivatives() {
            true => computed,
            false => (0..shifts.count())
                .map(|i| shifts.derivative(i, &transfer))
                .collect(),
        };
        Ok(Sampled {
            shifts,
            scaling,
            transfer,
            derivatives,
            fields,
            couplings,
            turn: Turn::new(&directions),
            factors,
            emphasis,
        })
    }

    /// Largest error of modes with these rates and scaled port velocities (states x ports) at the samples that are not shifts: see
    /// the module.
    ///
    /// # Errors
    /// [`crate::Error::Body`] when an eigenvalue cannot be computed.
    pub fn error(&self, rates: &[f64], ports: MatRef<f64>) -> Result<f64> {
        let mut worst: f64 = 0.0;
        for &at in &self.shifts.tests {
            worst = worst.max(self.error_at(rates, ports, at)?);
        }
        Ok(worst)
    }

    /// The modes without those, of the smallest shares, whose shares of the response at any sample that judges sum to no more than
    /// `left_out`: see the module for what errors are measured in.
    pub fn seen_modes(&self, rates: &[f64], ports: MatRef<f64>, left_out: f64) -> Vec<usize> {
        let mut shares = vec![0.0_f64; rates.len()];
        for &at in &self.shifts.tests {
            let (exact, z) = (&self.transfer[at], &self.factors[at]);
            let contact = z.nrows();
            let (c, d) = shift(self.shifts.angles[at]);
            let mut on_contact = ports.get(.., ..contact).transpose().to_owned();
            solve_upper_triangular_in_place(z.transpose(), on_contact.as_mut(), Par::Seq);
            for (mode, (share, rate)) in shares.iter_mut().zip(rates).enumerate() {
                let amplitude = on_contact.col(mode).norm_l2();
                let mut largest = amplitude * amplitude;
                for (port, emphasis) in (contact..exact.nrows()).zip(self.emphasis) {
                    let own = exact[(port, port)];
                    if own > 0.0 {
                        let seen = ports[(mode, port)].abs() / own.sqrt();
                        largest = largest.max(emphasis * amplitude * seen).max(seen * seen);
                    }
                }
                *share = share.max(largest / (c + d * rate));
            }
        }
        let mut order: Vec<usize> = (0..rates.len()).collect();
        order.sort_by(|a, b| shares[*a].total_cmp(&shares[*b]));
        let mut sum = 0.0;
        let dropped = order.iter().take_while(|mode| {
            sum += shares[**mode];
            sum <= left_out
        });
        let mut kept = order[dropped.count()..].to_vec();
        kept.sort_unstable();
        kept
    }

    fn error_at(&self, rates: &[f64], ports: MatRef<f64>, at: usize) -> Result<f64> {
        let (exact, z) = (&self.transfer[at], &self.factors[at]);
        let (m, contact) = (exact.nrows(), z.nrows());
        let mut off = exact.clone();
        let at = shift(self.shifts.angles[at]);
        add_response(off.as_mut(), -1.0, ports, rates, at);
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
