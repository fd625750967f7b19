//! How many digits of a body survive 64-bit numbers, whatever model is made of it.
//!
//! An entry of an operator K is known to a rounding error `eps sqrt(K_ii K_jj)` or so: that is what assembly leaves, and what a
//! Cholesky factorization adds. A response `x = K^-1 f` is then known, relative to its energy, to about
//!
//! ```text
//! eps (sum_i K_ii x_i^2) / (x . f)
//! ```
//!
//! the energy that the diagonal alone would store over the one that is stored, once its terms have cancelled. The ratio is that
//! of lambda to mu where a nearly incompressible body keeps its volume, and the square of the aspect ratio where a body of flat
//! cells is drawn along them. It is taken for the loads and for smooth contact forces, on A and on B, the two ends of what a step
//! can meet. Against a solver with 400 bits, over thicknesses of 1 to 1e-7, `1 - 2 poisson` from 1e-2 to 1e-14 and `mu1 / mu2` up
//! to 1e13, slip rates and stresses are off by 0.05 to 3 times this figure (`tests/lost_digits.rs`).

use super::reduction::port_matrix::PortMatrix;
use super::reduction::transfer::{Sample, Sampler};
use crate::error::{Error, Result};
use crate::fem::{Body, OperatorPair};
use crate::scene::Scene;
use crate::time::scheme::Tableau;
use faer::Mat;
use std::f64::consts::{FRAC_PI_2, PI};

/// Loss, in tolerances, up to which an answer is accepted: errors then stay below ten tolerances.
pub(crate) const ALLOWED_LOSS: f64 = 2.0;

/// Share of the tolerance below which `eps k r` needs no attention. It is below 1 because the velocity may be a few times
/// `r |u|`.
const WORTH_A_LOOK: f64 = 0.1;

/// Whether steps of `k` of a body with this fastest relaxation rate may lose digits of its displacement that the tolerance
/// promises, whatever is left of its responses; see `crate::time::lost_digits`.
pub(crate) fn can_lose_in_steps(
    scene: &Scene,
    tableau: &Tableau,
    fastest_rate: f64,
    k: f64,
) -> bool {
    let takes_out = tableau.uses_start_velocity() && tableau.theta() > 0.0;
    takes_out && f64::EPSILON * k * fastest_rate > WORTH_A_LOOK * scene.fidelity.tolerance
}

/// The two ends of the transfer matrix, which the digits of a body are judged by.
pub struct Ends {
    /// Instantaneous (A) and long-time response (B).
    samples: [Sample; 2],
    /// Relative error of the responses by rounding, by estimate.
    pub lost_digits: f64,
}

impl Ends {
    /// Samples the body at both ends.
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`] when the body is not held, or nothing of an operator survives.
    pub fn new(sampler: &mut Sampler, body: &Body) -> Result<Ends> {
        let forces = forces(sampler.ports(), body);
        let mut lost_digits: f64 = 0.0;
        let mut at = |angle: f64| -> Result<Sample> {
            let sample = sampler.sample(angle)?;
            let mut responses = forces.clone();
            sampler.respond(&sample.lower, responses.as_mut());
            let lost = lost(
                &body.operators,
                &sampler.operator(angle),
                &forces,
                &responses,
            );
            // written so that a NaN stays
            lost_digits = if lost_digits >= lost {
                lost_digits
            } else {
                lost
            };
            Ok(sample)
        };
        let samples = [at(0.0)?, at(FRAC_PI_2)?];
        Ok(Ends {
            samples,
            lost_digits,
        })
    }

    /// The sample at one of the two angles.
    pub fn at(&self, angle: f64) -> Option<&Sample> {
        let end = [0.0, FRAC_PI_2].iter().position(|end| *end == angle)?;
        self.samples.get(end)
    }

    /// Refuses a body of which too little is left for `tolerance`.
    ///
    /// # Errors
    /// [`Error::LostDigits`].
    pub fn check(&self, tolerance: f64) -> Result<()> {
        let lost = self.lost_digits;
        if lost <= ALLOWED_LOSS * tolerance {
            return Ok(());
        }
        Err(Error::LostDigits { lost, tolerance })
    }
}

/// Loads and smooth contact forces, by dofs: along each contact direction a uniform traction and one that changes its sign.
fn forces(ports: &PortMatrix, body: &Body) -> Mat<f64> {
    let contact = &body.contact;
    let (c, last) = (contact.stride(), contact.node_count().max(2) - 1);
    let on_contact = Mat::from_fn(ports.contact_len, 2 * c, |i, j| {
        let (node, component) = (i / c, i % c);
        let wave = match j / c {
            0 => 1.0,
            _ => (PI * node as f64 / last as f64).cos(),
        };
        if component == j % c {
            contact.weights[node] * wave
        } else {
            0.0
        }
    });
    ports.forces(body.force_columns().count(), &on_contact)
}

/// Largest relative error of the responses (by dofs, one per column) of the operator with these values.
fn lost(operators: &OperatorPair, values: &[f64], forces: &Mat<f64>, responses: &Mat<f64>) -> f64 {
    let mut worst: f64 = 0.0;
    for (force, response) in forces.col_iter().zip(responses.col_iter()) {
        let (mut of_diagonal, mut stored) = (0.0, 0.0);
        for (dof, (x, f)) in response.iter().zip(force.iter()).enumerate() {
            // the diagonal begins its column
            of_diagonal += values[operators.col_ptr[dof]] * x * x;
            stored += x * f;
        }
        if of_diagonal == 0.0 {
            continue;
        }
        let lost = f64::EPSILON * of_diagonal / stored;
        if !(lost.is_finite() && lost > 0.0) {
            return f64::INFINITY;
        }
        worst = worst.max(lost);
    }
    worst
}
