//! The condensed model: every dof is a state, but a step is one sparse forward pass onto the contact, the friction
//! problem there, and one backward pass.
//!
//! With the contact eliminated last, `M = L L^T` leaves `S = L_cc L_cc^T` and `r` without any further solve.

use super::field::{Field, add};
use crate::body::nonlinear::Nonlinear;
use crate::body::{BodyModel, Scratch, Stage};
use crate::bytes::Writer;
use crate::error::Result;

pub struct Condensed(pub Field);

impl BodyModel for Condensed {
    fn states(&self) -> usize {
        self.0.states()
    }

    fn contact_len(&self) -> usize {
        self.0.contact_len
    }

    fn factor_len(&self) -> usize {
        self.0.cholesky.len()
    }

    fn tangent_len(&self) -> usize {
        self.0.tangent_len()
    }

    fn nonlinear(&self) -> Option<&Nonlinear> {
        self.0.nonlinear.as_ref()
    }

    fn apply(&self, which: usize, x: &[f64], y: &mut [f64]) {
        self.0.apply(which, x, y);
    }

    fn apply_tangent(&self, stage: &Stage, x: &[f64], y: &mut [f64]) {
        self.0.operators.apply(&stage.tangent, x, y);
    }

    fn apply_stage(&self, stage: &Stage, x: &[f64], y: &mut [f64], scratch: &mut Scratch) {
        self.0.apply_stage(stage, x, y, scratch);
    }

    fn scratch(&self) -> Scratch {
        self.0.scratch()
    }

    fn factor(&self, theta_k: f64, stage: &mut Stage, scratch: &mut Scratch) -> Result<()> {
        self.0.factor(theta_k, stage, scratch)?;
        let (factor, to) = (&stage.factor, stage.s.as_mut());
        let m = self.contact_len();
        // kept where every step may factor
        if scratch.square.nrows() == m {
            let lower = scratch.square.as_mut();
            self.0.cholesky.condensed_with(factor, lower, to);
        } else {
            self.0.cholesky.condensed(factor, to);
        }
        Ok(())
    }

    fn predict(&self, stage: &Stage, p: &[f64], f: &[f64], r: &mut [f64], scratch: &mut Scratch) {
        self.0
            .load(stage, p, f, &mut scratch.work, &mut scratch.lags);
        add(&mut scratch.work, &scratch.excess);
        self.0
            .cholesky
            .eliminate(&stage.factor, &scratch.work, &mut scratch.free);
        let interior = self.0.len() - self.contact_len();
        r.copy_from_slice(&scratch.free[interior..]);
    }

    fn correct(
        &self,
        stage: &Stage,
        contact_velocity: &[f64],
        _contact_force: &[f64],
        w: &mut [f64],
        scratch: &mut Scratch,
    ) {
        let interior = self.0.len() - self.contact_len();
        // the forward pass must survive: the fixed point corrects at every iterate
        scratch.work.copy_from_slice(&scratch.free);
        scratch.work[interior..].copy_from_slice(contact_velocity);
        let (own, branches) = w.split_at_mut(self.0.len());
        self.0
            .cholesky
            .substitute_back(&stage.factor, &mut scratch.work, own);
        self.0.correct_branches(stage, own, &scratch.lags, branches);
    }

    fn products(&self, x: &[f64]) -> (f64, f64) {
        self.0.products(x)
    }

    fn strain_square(&self, x: &[f64]) -> f64 {
        self.0.strain_square(x)
    }

    fn cancelled_norm(&self, _scratch: &Scratch) -> f64 {
        // the contact is put into the whole before anything is solved backwards
        0.0
    }

    fn outputs(&self, x: &[f64], out: &mut [f64]) {
        self.0.outputs(x, out);
    }

    fn stage_multiplications(&self) -> usize {
        // the factor once forward and once backward, B once
        2 * self.0.cholesky.len() + self.0.applications()
    }

    fn bytes(&self) -> usize {
        self.0.bytes()
    }

    fn write(&self, out: &mut Writer) {
        self.0.write(out);
    }
}
