//! The full model: every dof is a state, every step two sparse solves. The yardstick of the other models.
//!
//! The contact compliance `C = E^T M^-1 E` is solved for column by column, without the elimination order that the
//! condensed model relies on, so the two check each other.

use super::field::{BLOCK, Field, add};
use crate::body::nonlinear::Nonlinear;
use crate::body::{BodyModel, Scratch, Stage};
use crate::bytes::Writer;
use crate::error::{Error, Result};
use crate::linalg::multiply;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{ColMut, Mat};

pub struct Full(pub Field);

impl BodyModel for Full {
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
        let mut scratch = self.0.scratch();
        if self.0.nonlinear.is_some() {
            let width = BLOCK.min(self.contact_len());
            scratch.columns = Mat::zeros(self.0.len(), width);
        }
        scratch
    }

    fn factor(&self, theta_k: f64, stage: &mut Stage, scratch: &mut Scratch) -> Result<()> {
        self.0.factor(theta_k, stage, scratch)?;
        let (n, m) = (self.0.len(), self.contact_len());
        // kept where every step may factor
        let mut compliance = std::mem::replace(&mut scratch.square, Mat::new());
        let mut all_columns = std::mem::replace(&mut scratch.columns, Mat::new());
        let is_kept = compliance.nrows() == m;
        if !is_kept {
            compliance = Mat::zeros(m, m);
            all_columns = Mat::zeros(n, BLOCK.min(m));
        }
        for first in (0..m).step_by(BLOCK) {
            let width = BLOCK.min(m - first);
            let mut columns = all_columns.as_mut().subcols_mut(0, width);
            columns.fill(0.0);
            for j in 0..width {
                columns[(n - m + first + j, j)] = 1.0;
            }
            let cholesky = &self.0.cholesky;
            cholesky.solve(&stage.factor, columns.rb_mut(), &mut scratch.memory);
            compliance
                .as_mut()
                .subcols_mut(first, width)
                .copy_from(columns.rb().subrows(n - m, m));
        }
        // symmetric up to rounding: the mean of the two halves
        let is_definite = scratch.dense.factor(m, |j, column| {
            for (i, entry) in (j..).zip(column) {
                *entry = 0.5 * (compliance[(i, j)] + compliance[(j, i)]);
            }
        });
        if is_kept {
            (scratch.square, scratch.columns) = (compliance, all_columns);
        }
        if !is_definite {
            return Err(Error::NotPositiveDefinite {
                what: "the contact compliance",
                pivot: 0,
            });
        }
        scratch.dense.inverse(stage.s.as_mut());
        Ok(())
    }

    fn predict(&self, stage: &Stage, p: &[f64], f: &[f64], r: &mut [f64], scratch: &mut Scratch) {
        self.0
            .load(stage, p, f, &mut scratch.free, &mut scratch.lags);
        add(&mut scratch.free, &scratch.excess);
        self.0.cholesky.solve(
            &stage.factor,
            ColMut::from_slice_mut(&mut scratch.free).as_mat_mut(),
            &mut scratch.memory,
        );
        let interior = self.0.len() - self.contact_len();
        multiply(stage.s.as_ref(), &scratch.free[interior..], r);
    }

    fn correct(
        &self,
        stage: &Stage,
        contact_velocity: &[f64],
        contact_force: &[f64],
        w: &mut [f64],
        scratch: &mut Scratch,
    ) {
        let interior = self.0.len() - self.contact_len();
        let (own, branches) = w.split_at_mut(self.0.len());
        own[..interior].fill(0.0);
        own[interior..].copy_from_slice(contact_force);
        self.0.cholesky.solve(
            &stage.factor,
            ColMut::from_slice_mut(own).as_mat_mut(),
            &mut scratch.memory,
        );
        for (w, free) in own.iter_mut().zip(&scratch.free) {
            *w = free - *w;
        }
        own[interior..].copy_from_slice(contact_velocity);
        self.0.correct_branches(stage, own, &scratch.lags, branches);
    }

    fn products(&self, x: &[f64]) -> (f64, f64) {
        self.0.products(x)
    }

    fn strain_square(&self, x: &[f64]) -> f64 {
        self.0.strain_square(x)
    }

    fn cancelled_norm(&self, scratch: &Scratch) -> f64 {
        self.0.glassy_square(&scratch.free).sqrt()
    }

    fn outputs(&self, x: &[f64], out: &mut [f64]) {
        self.0.outputs(x, out);
    }

    fn stage_multiplications(&self) -> usize {
        // two solves with the factor and its transpose, B once, S once
        let contact = self.contact_len();
        4 * self.0.cholesky.len() + self.0.applications() + contact * contact
    }

    fn bytes(&self) -> usize {
        self.0.bytes()
    }

    fn write(&self, out: &mut Writer) {
        self.0.write(out);
    }
}
