//! A reduced body whose material stays free.
//!
//! What is kept: the modes of the pair (K_eps, K_tr) of `crate::material::Blend`, seen through the ports. In their coordinates both
//! forms are diagonal, `e_i` and `t_i`, and so is every operator of one isotropic material,
//!
//! ```text
//! A = mu2 e + mu1 t,   B = 2 mu e + lambda t,   C_j = 2 G_j e + (K_j - 2 G_j / 3) t
//! ```
//!
//! with its memory: no pencil of the branches is formed. A stage is that of a whole body (see `super::field`), mode by mode:
//!
//! ```text
//! M = A + theta k B + sum_j tau_j theta k / (tau_j + theta k) C_j
//! w = (F f - B p - sum_j tau_j / (tau_j + theta k) C_j (p - q_j) - P^T Lambda) / M
//! q_j' = (p - q_j + theta k w) / (tau_j + theta k)
//! ```
//!
//! How good it is: the pair that is reduced (`super::reduction`) has `K_eps + r K_tr` in the places of A and B, r the two ends of
//! [`RATIOS`]. Every M with a ratio between them is a sum of both that is nowhere negative, so that the error which the reduction
//! measures between its shifts, both ends among them, is that of every material and every step. What the material may be is
//! checked by `Blend` and `crate::scene`; several regions, laws that are not isotropic, vary or are not linear, a body without
//! dashpot, and forces that are compiled from the material (an initial displacement, motions that strain the body) are refused.

use crate::body::reduced::Reduced;
use crate::body::{BodyModel, Scratch, Stage};
use crate::bytes::{Reader, Writer};
use crate::error::Result;
use crate::linalg::{StoredMatrix, modal, multiply, multiply_transposed};
use crate::material::{Blend, RATIOS, Share};
use crate::scene::Precision;
use faer::Mat;
use std::sync::Arc;

/// The modes, whatever the material.
struct Modes {
    /// K_eps and K_tr of every mode.
    on_strain: Vec<f64>,
    on_trace: Vec<f64>,
    /// Contact velocities of every mode: modes x contact length.
    contact: StoredMatrix,
    /// Loads, then probes, of every mode: modes x outputs.
    outputs: Mat<f64>,
    /// How many of the outputs are loads.
    loads: usize,
}

/// A branch of the memory: relaxation time, s, and C of every mode.
struct Branch {
    tau: f64,
    modulus: Vec<f64>,
}

/// The modes with a material.
pub struct Free {
    modes: Arc<Modes>,
    viscosity: Vec<f64>,
    elasticity: Vec<f64>,
    branches: Vec<Branch>,
}

impl Free {
    /// From the reduction of the pair at both ends of the ratios.
    pub fn new(reduced: Reduced, blend: &Blend) -> Free {
        let Reduced {
            rates,
            contact,
            outputs,
            loads,
            ..
        } = reduced;
        let [low, high] = RATIOS;
        // the rates are no smaller than 1 but for rounding
        let on_trace: Vec<f64> = rates
            .iter()
            .map(|rate| ((rate - 1.0) / (high - low)).max(0.0))
            .collect();
        Modes::new(on_trace, contact, outputs, loads).with(blend)
    }

    /// The same modes with another material.
    pub fn with(&self, blend: &Blend) -> Free {
        Arc::clone(&self.modes).with(blend)
    }

    /// Branches of the memory that it has room for.
    pub fn branch_count(&self) -> usize {
        self.branches.len()
    }

    fn len(&self) -> usize {
        self.viscosity.len()
    }

    /// Entries of `c A + d B` with the memory eliminated, by their places.
    fn operator(&self, c: f64, d: f64, out: &mut [f64]) {
        for (out, (a, b)) in out
            .iter_mut()
            .zip(self.viscosity.iter().zip(&self.elasticity))
        {
            *out = c * a + d * b;
        }
        for branch in &self.branches {
            let weight = c * d * branch.lag_weight(c, d);
            if weight != 0.0 {
                for (out, modulus) in out.iter_mut().zip(&branch.modulus) {
                    *out += weight * modulus;
                }
            }
        }
    }

    /// Contact compliance of `x A + y B` (lower triangle).
    pub fn compliance(&self, x: f64, y: f64) -> Mat<f64> {
        let mut operator = vec![0.0; self.len()];
        self.operator(x, y, &mut operator);
        self.modes.compliance(&operator)
    }

    /// Contact compliance of the form of the strain norm (lower triangle).
    pub fn strain_compliance(&self) -> Mat<f64> {
        self.modes.compliance(&self.modes.on_strain)
    }

    /// The fields of the branches in a state, or in what follows its displacement.
    fn fields<'a>(&'a self, fields: &'a [f64]) -> impl Iterator<Item = (&'a Branch, &'a [f64])> {
        self.branches.iter().zip(fields.chunks_exact(self.len()))
    }

    /// Reads what [`BodyModel::write`] wrote, for the given numbers of contact components, loads and outputs; `blend` gives the
    /// material for a number of branches.
    ///
    /// # Errors
    /// [`crate::Error::Bytes`].
    pub fn read(
        from: &mut Reader,
        (contact, loads, outputs): (usize, usize, usize),
        precision: Precision,
        blend: impl FnOnce(usize) -> Option<Blend>,
    ) -> Result<Free> {
        let branches = from.size()?;
        let on_trace = from.finite()?;
        // tr tr <= 3 eps : eps, in the form of the lower ratio
        let most = 3.0 / (1.0 + 3.0 * RATIOS[0]) * (1.0 + 1e-9);
        if on_trace.len() < contact || !on_trace.iter().all(|t| (0.0..=most).contains(t)) {
            return Err(Reader::refusal(format!(
                "{} modes of a free material with {contact} contact components",
                on_trace.len()
            )));
        }
        let is_single = precision == Precision::Single;
        let modes = on_trace.len();
        let blend = blend(branches)
            .filter(|blend| blend.branches.len() == branches)
            .ok_or_else(|| Reader::refusal("the material of the scene does not stay free"))?;
        let contact = StoredMatrix::read(from, is_single, (modes, contact))?;
        let outputs = from.matrix(modes, outputs)?;
        Ok(Modes::new(on_trace, contact, outputs, loads).with(&blend))
    }
}

impl Modes {
    fn new(
        on_trace: Vec<f64>,
        contact: StoredMatrix,
        outputs: Mat<f64>,
        loads: usize,
    ) -> Arc<Modes> {
        Arc::new(Modes {
            // the modes are orthonormal in the form of the lower ratio
            on_strain: on_trace.iter().map(|t| 1.0 - RATIOS[0] * t).collect(),
            on_trace,
            contact,
            outputs,
            loads,
        })
    }

    fn with(self: Arc<Modes>, blend: &Blend) -> Free {
        let of = |share: &Share| -> Vec<f64> {
            let forms = self.on_strain.iter().zip(&self.on_trace);
            forms
                .map(|(e, t)| share.on_strain * e + share.on_trace * t)
                .collect()
        };
        Free {
            viscosity: of(&blend.viscosity),
            elasticity: of(&blend.elasticity),
            branches: blend
                .branches
                .iter()
                .map(|(tau, share)| Branch {
                    tau: *tau,
                    modulus: of(share),
                })
                .collect(),
            modes: self,
        }
    }

    fn compliance(&self, operator: &[f64]) -> Mat<f64> {
        let m = self.contact.ncols();
        let weights: Vec<f64> = operator.iter().map(|entry| 1.0 / entry).collect();
        let mut columns = vec![0.0; m * m];
        self.contact.weighted_gram(&weights, &mut columns);
        Mat::from_fn(m, m, |i, j| if i < j { 0.0 } else { columns[j * m + i] })
    }
}

impl Branch {
    /// `tau / (c tau + d)`: what a shift `(c, d)` leaves of a lag, s.
    fn lag_weight(&self, c: f64, d: f64) -> f64 {
        self.tau / (c * self.tau + d)
    }
}

impl BodyModel for Free {
    fn states(&self) -> usize {
        self.len() * (1 + self.branches.len())
    }

    fn contact_len(&self) -> usize {
        self.modes.contact.ncols()
    }

    fn factor_len(&self) -> usize {
        self.len()
    }

    fn scratch(&self) -> Scratch {
        let (m, r) = (self.contact_len(), self.len());
        Scratch {
            lags: vec![0.0; self.states() - r],
            ..Scratch::of_modes(m, r)
        }
    }

    fn factor(&self, theta_k: f64, stage: &mut Stage, scratch: &mut Scratch) -> Result<()> {
        self.operator(1.0, theta_k, &mut stage.factor);
        for entry in &mut stage.factor {
            *entry = 1.0 / *entry;
        }
        scratch.condense(&self.modes.contact, stage)
    }

    fn predict(&self, stage: &Stage, p: &[f64], f: &[f64], r: &mut [f64], scratch: &mut Scratch) {
        let modes = &self.modes;
        let (own, fields) = p.split_at(self.len());
        let loads = modes.outputs.as_ref().subcols(0, modes.loads);
        multiply(loads, f, &mut scratch.free);
        let lags = scratch.lags.chunks_exact_mut(self.len());
        for ((branch, field), lags) in self.fields(fields).zip(lags) {
            let weight = branch.lag_weight(1.0, stage.implicit());
            let modes = own.iter().zip(field).zip(&branch.modulus);
            let out = lags.iter_mut().zip(&mut scratch.free);
            for ((lag, free), ((p, q), modulus)) in out.zip(modes) {
                *lag = p - q;
                *free -= weight * modulus * *lag;
            }
        }
        modal::free_motion(&mut scratch.free, &self.elasticity, own, &stage.factor);
        modes
            .contact
            .multiply_transposed(&scratch.free, &mut scratch.contact);
        multiply(stage.s.as_ref(), &scratch.contact, r);
    }

    fn correct(
        &self,
        stage: &Stage,
        _contact_velocity: &[f64],
        contact_force: &[f64],
        w: &mut [f64],
        scratch: &mut Scratch,
    ) {
        let (own, fields) = w.split_at_mut(self.len());
        self.modes.contact.multiply(contact_force, own);
        modal::corrected_motion(own, &scratch.free, &stage.factor);
        let implicit = stage.implicit();
        let lags = scratch.lags.chunks_exact(self.len());
        let fields = fields.chunks_exact_mut(self.len());
        for ((branch, lags), field) in self.branches.iter().zip(lags).zip(fields) {
            let scale = branch.tau + implicit;
            for ((rate, lag), w) in field.iter_mut().zip(lags).zip(&*own) {
                *rate = (lag + implicit * w) / scale;
            }
        }
    }

    fn products(&self, x: &[f64]) -> (f64, f64) {
        let (own, fields) = x.split_at(self.len());
        let square = |values: &[f64]| modal::squares(own, values).1;
        let (mut a, mut b) = (square(&self.viscosity), square(&self.elasticity));
        for (branch, field) in self.fields(fields) {
            a += branch.tau * modal::squares(field, &branch.modulus).1;
            let modes = own.iter().zip(field).zip(&branch.modulus);
            b += modes
                .map(|((u, q), modulus)| modulus * (u - q) * (u - q))
                .sum::<f64>();
        }
        (a, b)
    }

    fn strain_square(&self, x: &[f64]) -> f64 {
        modal::squares(&x[..self.len()], &self.modes.on_strain).1
    }

    fn cancelled_norm(&self, scratch: &Scratch) -> f64 {
        // that of the springs which resist at once, no less than with what the branches follow
        let glassy = self.branches.iter().fold(
            modal::squares(&scratch.free, &self.elasticity).1,
            |sum, branch| sum + modal::squares(&scratch.free, &branch.modulus).1,
        );
        glassy.sqrt()
    }

    fn outputs(&self, x: &[f64], out: &mut [f64]) {
        multiply_transposed(self.modes.outputs.as_ref(), &x[..self.len()], out);
    }

    fn stage_multiplications(&self) -> usize {
        // the contact ports forward and backward, the loads, S once, the branches twice
        let (r, contact) = (self.len(), self.contact_len());
        r * (2 * contact + self.modes.loads + 4 * self.branches.len()) + contact * contact
    }

    fn bytes(&self) -> usize {
        let modes = &self.modes;
        let numbers = self.len() * (4 + self.branches.len() + modes.outputs.ncols());
        numbers * std::mem::size_of::<f64>() + modes.contact.bytes()
    }

    fn write(&self, out: &mut Writer) {
        out.word(self.branches.len() as u64);
        out.floats(&self.modes.on_trace);
        self.modes.contact.write(out);
        out.matrix(self.modes.outputs.as_ref());
    }
}
