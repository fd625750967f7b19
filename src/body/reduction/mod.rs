//! Reduction of the body to the relaxation rates that its ports see, to a chosen tolerance.
//!
//! Galerkin projection on `span{ (c_i A + d_i B)^-1 P }` over a few shifts (see `galerkin`). The shifts follow from the interval
//! of rates alone (see `shifts`), and the projection from samples of the transfer matrix (see `transfer`). Vectors of the
//! length of the body are formed for a few forces only, for which the samples are not accurate enough (see `fields`). The
//! result is judged at the samples that are not shifts (see `samples`). Exact projection keeps the rates between the extreme
//! eigenvalues of `A^-1 B`, which the element rates bound. A rate outside that matters shows an error before the reduction.
//! README.md in this folder goes through it step by step.

mod basis;
mod fields;
mod galerkin;
pub(crate) mod port_matrix;
mod responses;
mod samples;
mod scaling;
mod shifts;
mod synthesis;
pub(crate) mod transfer;
mod turn;
mod vectors;
mod whole;
mod zolotarev;

use crate::body::digits::Ends;
use crate::body::reduced::Reduced;
use crate::error::{Error, Result};
use crate::fem::Body;
use crate::linalg::StoredMatrix;
use crate::progress::Watch;
use crate::scene::{Fidelity, ModelKind, Precision};
use faer::Mat;
use fields::{Depth, held_loads};
use galerkin::{Modes, Projection};
use samples::Sampled;
use scaling::Scaling;
use shifts::{Derivatives, Shifts};
use transfer::Sampler;

/// The response of the contact to loads must be more accurate than the tolerance, by this factor at most. Friction is a small
/// difference between the load on the contact and the resistance of the body, so an error of the load is magnified; and the
/// stress at a single node reacts more strongly than the energy of the whole contact. The factor is smaller where the
/// rounding of the samples does not allow for it.
const LOAD_EMPHASIS: f64 = 1000.0;
/// How many times the rounding of the samples an error is at least that is told from it, where responses are vectors.
const ROUNDING_TOLD: f64 = 4.0;
/// Weight of the loads among the ports when their responses are ranked, where the fields do not hold them: they are few, and are
/// kept nearly whole.
const LOAD_WEIGHT: f64 = 5.0;
/// Shares of the tolerance that dropping nearly dependent responses may use, tried in this order: friction that weakens
/// magnifies errors of the body, and the larger shares are for tolerances at the limit of rounding.
const TRUNCATION_SHARES: [f64; 4] = [0.1, 0.02, 0.3, 1.0];
/// Shifts of the samples that judge a body with rates too far apart for a plan.
const JUDGING_SHIFTS: usize = 4;
/// Multiplications of a derivative that `auto` computes at most, per shift: seconds.
const DEAREST_DERIVATIVE: f64 = 4e9;
/// Rates outside the interval of the material come from errors of the samples and matter little. One that changes the transfer
/// matrix by more than this share, however many responses are kept, shows an error before the reduction.
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

/// What rebuilds the field of the body from modal coordinates: every mode is a sum of fields and of responses to port forces.
pub struct Synthesis {
    /// The fields (dofs x fields), and their weights in every mode (fields x states).
    pub fields: Mat<f64>,
    pub of_fields: Mat<f64>,
    /// Port forces at every shift that make up a mode: (shifts x ports) x states.
    pub forces: Mat<f64>,
    /// Angles of the shifts.
    pub angles: Vec<f64>,
    /// Reference rate that scales B, 1/s.
    pub reference_rate: f64,
    /// Time that makes A positive with B, s; see `transfer`.
    pub sigma: f64,
}

/// Reduces `body` until the samples between the shifts agree to the tolerance, in the precision in which it is to be kept.
///
/// `sampler` is that of the body, `ends` are its samples at both ends.
///
/// # Errors
/// [`Error::ReductionInaccurate`] when the tolerance is out of reach, [`Error::NotPositiveDefinite`] when the body is not held,
/// [`Error::Cancelled`].
pub fn reduce(
    body: &Body,
    sampler: &mut Sampler,
    ends: &Ends,
    fidelity: &Fidelity,
    watch: &mut Watch,
) -> Result<Reduction> {
    let (tolerance, precision) = (fidelity.tolerance, fidelity.precision);
    let reference_rate = sampler.reference_rate();
    let sigma = sampler.sigma();
    let rates = body.element_rates.map(|rate| bounded(rate, sigma));
    let interval = rates.map(|rate| rate / reference_rate);
    let ports = sampler.ports();
    let loads = body.force_columns().count();
    let of_loads = |value: f64| -> Vec<f64> {
        let others = 0..ports.others.len();
        others
            .map(|i| if i < loads { value } else { 1.0 })
            .collect()
    };
    // the condition of the operators, and with it the rounding of the samples, grows like the number of dofs, where cells are
    // not flat and the material is not nearly incompressible
    let unit = match precision {
        Precision::Double => f64::EPSILON,
        Precision::Single => f64::from(f32::EPSILON),
    };
    let rounding = ends.lost_digits.max(2.0 * unit * body.len() as f64);
    let emphasis_for = |rounding: f64| (tolerance / rounding).clamp(1.0, LOAD_EMPHASIS);
    let emphasis = emphasis_for(rounding);
    // errors as small as the estimate of rounding are not told from it
    let emphasis_told = of_loads(emphasis_for(ROUNDING_TOLD * rounding));
    let depth = Depth::new(interval, tolerance, emphasis, TRUNCATION_SHARES[0]);
    let (weights, emphasis) = (of_loads(LOAD_WEIGHT), of_loads(emphasis));
    let held_loads = held_loads(loads);
    let mut search = Search {
        tolerance,
        precision,
        interval,
        closest: (f64::INFINITY, 0),
        outlying: None,
    };
    let units = (reference_rate, sigma);
    let of_fields = (held_loads, depth);
    let by_vectors = |sampler: &mut Sampler,
                      search: &mut Search,
                      watch: &mut Watch|
     -> Result<Option<Reduction>> {
        let plan = Shifts::without_derivatives(interval, tolerance);
        let Some(shifts) = plan.filter(|plan| vectors::are_affordable(sampler, plan.count()))
        else {
            return Ok(None);
        };
        let mut sampled = Sampled::new(
            sampler,
            ends,
            shifts,
            &weights,
            &emphasis_told,
            of_fields,
            watch,
        )?;
        for dropped in vectors::DROPPED {
            let (modes, fields) =
                vectors::modes(sampler, &sampled, (dropped, tolerance), interval)?;
            if let Some(truncated) = search.judge(modes, &sampled)? {
                sampled.fields.fields = fields;
                return Ok(Some(finish(truncated, sampled, loads, units, body.len())));
            }
        }
        Ok(None)
    };
    if fidelity.free_material
        && let Some(found) = by_vectors(sampler, &mut search, watch)?
    {
        return Ok(found);
    }
    let (mut planned, mut judge) = (None, None);
    // the plan is for an even spectrum; a body that needs more than one shift beyond it is at the limit of rounding
    for (derivatives, count) in ways(body, sampler, fidelity)
        .iter()
        .flat_map(|w| [(w, 0), (w, 1)])
    {
        let plan = match count {
            0 => Shifts::for_tolerance(interval, tolerance, *derivatives),
            _ => planned,
        };
        planned = None;
        let Some(shifts) = plan else { continue };
        if judge.is_some() && count == 0 && !shifts.computes_derivatives() {
            break;
        }
        let sampled = Sampled::new(sampler, ends, shifts, &weights, &emphasis, of_fields, watch)?;
        let smooth = 0..sampled.turn.len();
        let of_loads = ports.contact_len..ports.contact_len + held_loads;
        let is_held =
            |port| depth.holds_all && (smooth.contains(&port) || of_loads.contains(&port));
        let mut projection = Projection::new(&sampled, is_held, &emphasis)?;
        let mut found = search.truncate(&projection, &sampled)?;
        if found.is_none() {
            projection.order_by_energy()?;
            found = search.truncate(&projection, &sampled)?;
        }
        if let Some(truncated) = found {
            return Ok(finish(truncated, sampled, loads, units, body.len()));
        }
        planned = sampled.shifts.refined(interval, tolerance, *derivatives);
        judge = Some(sampled);
    }
    // `auto` has a better answer to that
    if has_whole(body, fidelity) {
        let mut sampled = match judge {
            Some(sampled) => sampled,
            None => {
                let shifts = Shifts::new(interval, JUDGING_SHIFTS, tolerance, Derivatives::Sampled);
                Sampled::new(sampler, ends, shifts, &weights, &emphasis, of_fields, watch)?
            }
        };
        let size = sampled.shifts.count() * ports.len();
        let (scaling, operators) = (&sampled.scaling, &body.operators);
        let (modes, fields) = whole::modes(operators, sampler, scaling, size, interval)?;
        if let Some(truncated) = search.judge(modes, &sampled)? {
            sampled.fields.fields = fields;
            return Ok(finish(truncated, sampled, loads, units, body.len()));
        }
    }
    if has_vectors(fidelity)
        && !fidelity.free_material
        && let Some(found) = by_vectors(sampler, &mut search, watch)?
    {
        return Ok(found);
    }
    Err(search.failure(rates, reference_rate))
}

/// A rate of the pair (A, B) as one of (A + sigma B, B).
pub(crate) fn bounded(rate: f64, sigma: f64) -> f64 {
    match sigma {
        0.0 => rate,
        _ => 1.0 / (1.0 / rate + sigma),
    }
}

/// Whether all modes of the body are the last resort.
fn has_whole(body: &Body, fidelity: &Fidelity) -> bool {
    (fidelity.free_material || fidelity.model == ModelKind::Reduced)
        && whole::is_small(body.len() * (1 + body.operators.memory.len()))
}

/// Whether the responses themselves are projected on: first for a material that stays free, whose rates lie decades apart, else where
/// samples do not suffice.
fn has_vectors(fidelity: &Fidelity) -> bool {
    fidelity.free_material || fidelity.model == ModelKind::Reduced
}

/// Where derivatives may come from, in the order in which that is tried. `auto` does not compute dear ones: it has the condensed model.
fn ways(body: &Body, sampler: &Sampler, fidelity: &Fidelity) -> &'static [Derivatives] {
    let is_dear = sampler.derivative_work() > DEAREST_DERIVATIVE;
    let is_plain = body.operators.memory.is_empty() && body.forms.have_dashpots();
    let may_be_dear = fidelity.free_material || fidelity.model == ModelKind::Reduced;
    if (is_plain && has_whole(body, fidelity)) || (is_dear && !may_be_dear) {
        &[Derivatives::Sampled]
    } else if is_plain {
        &[Derivatives::Sampled, Derivatives::Computed]
    } else {
        &[Derivatives::Computed]
    }
}

/// The search for the smallest truncation that meets the tolerance.
struct Search {
    tolerance: f64,
    precision: Precision,
    /// Relaxation rates of the material, relative to the reference rate.
    interval: [f64; 2],
    /// The smallest error so far, and its number of states.
    closest: (f64, usize),
    /// Effect and rate of the first outlying rate that mattered.
    outlying: Option<(f64, f64)>,
}

/// The modes of a truncation, with what is kept of their ports: contact velocities and outputs.
struct Truncated {
    modes: Modes,
    ports: (StoredMatrix, Mat<f64>),
    achieved: f64,
}

impl Search {
    fn truncate(
        &mut self,
        projection: &Projection,
        sampled: &Sampled,
    ) -> Result<Option<Truncated>> {
        let mut tried = 0;
        for share in TRUNCATION_SHARES {
            let rank = projection.rank_for(share * self.tolerance);
            if rank == tried {
                continue;
            }
            tried = rank;
            let modes = projection.modes(rank, self.interval)?;
            if modes.outlier.0 > OUTLIER {
                self.outlying = self.outlying.or(Some(modes.outlier));
                continue;
            }
            if let Some(found) = self.judge(modes, sampled)? {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    /// The modes as they are kept, where they meet the tolerance.
    fn judge(&mut self, mut modes: Modes, sampled: &Sampled) -> Result<Option<Truncated>> {
        let ports = keep(&mut modes, &sampled.scaling, self.precision);
        let achieved = sampled
            .error(&modes.rates, modes.ports.as_ref())?
            .max(f64::EPSILON);
        if achieved < self.closest.0 {
            self.closest = (achieved, modes.rates.len());
        }
        Ok((achieved <= self.tolerance).then_some(Truncated {
            modes,
            ports,
            achieved,
        }))
    }

    fn failure(&self, [slowest, fastest]: [f64; 2], reference_rate: f64) -> Error {
        match self.outlying {
            // whatever is kept, a rate outside that matters
            Some((_, rate)) if self.closest.0 == f64::INFINITY => Error::Body {
                what: format!(
                    "the reduction gives a relaxation rate of {} 1/s, outside the [{slowest}, {fastest}] of the material",
                    rate * reference_rate,
                ),
            },
            _ => Error::ReductionInaccurate {
                achieved: self.closest.0,
                tolerance: self.tolerance,
                states: self.closest.1,
            },
        }
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

/// The truncated modes in the units of the scene, of a body of `n` dofs.
fn finish(
    truncated: Truncated,
    sampled: Sampled,
    loads: usize,
    (reference_rate, sigma): (f64, f64),
    n: usize,
) -> Reduction {
    let Truncated {
        modes,
        ports: (contact, outputs),
        achieved,
    } = truncated;
    let (scaling, shifts) = (&sampled.scaling, &sampled.shifts);
    let m = modes.ports.ncols();
    let mut forces = modes.forces;
    for shift in 0..shifts.count() {
        sampled
            .turn
            .forth(forces.as_mut().subrows_mut(shift * m, m));
        scaling.apply_to_forces(forces.as_mut().subrows_mut(shift * m, m));
    }
    Reduction {
        reduced: Reduced {
            contact,
            outputs,
            loads,
            strain: None,
            sigma,
            rates: modes.rates.iter().map(|r| r * reference_rate).collect(),
        },
        record: ReductionRecord {
            shifts: shifts.rates(reference_rate),
            achieved,
        },
        synthesis: Synthesis {
            forces,
            reference_rate,
            sigma,
            // without the branches of the memory
            fields: sampled.fields.fields.get(..n, ..).to_owned(),
            of_fields: modes.fields,
            angles: (0..shifts.count()).map(|i| shifts.angle(i)).collect(),
        },
    }
}
