//! The body of a stage relative to what moves: foundations that slide, parts that are driven.
//!
//! The contact is solved for velocities relative to the foundation, the body for those without the share of its driven parts (see
//! `model::motions`). The difference of the two is the shift `s` of the contact velocities: `S (w - s) + Lambda = r - S s`. Everything
//! here is linear, and serves a stage and its tangents alike.

use super::velocity::Velocity;
use crate::body::{Scratch, Stage};
use crate::linalg::multiply;
use crate::model::Model;
use crate::state::Instant;

/// Scratch of the two ways.
pub(crate) struct Relative {
    /// Intensities of the columns of forces.
    forces: Vec<f64>,
    /// Intensity of that of the initial displacement: 1, and 0 for a tangent.
    initial: f64,
    /// The shift; empty where nothing moves.
    shift: Vec<f64>,
    /// S times it, then contact velocities of the body.
    shifted: Vec<f64>,
    /// Contact forces less what pins take; empty where there are none.
    pinned: Vec<f64>,
}

impl Relative {
    /// Of the stages of a model.
    pub fn new(model: &Model) -> Relative {
        Relative {
            initial: 1.0,
            ..Relative::of_tangents(model)
        }
    }

    /// Of their tangents, whose body starts with nothing.
    pub fn of_tangents(model: &Model) -> Relative {
        let motions = model.motions();
        let contact = match motions.is_empty() {
            true => 0,
            false => model.contact().force_len(),
        };
        Relative {
            forces: vec![0.0; motions.force_count()],
            initial: 0.0,
            shift: vec![0.0; contact],
            shifted: vec![0.0; contact],
            pinned: match model.contact().pins.is_empty() {
                true => Vec::new(),
                false => vec![0.0; model.contact().force_len()],
            },
        }
    }

    /// The condensed load of the free motion from the explicit displacement `p` under the inputs, relative to what moves.
    pub fn predict(
        &mut self,
        model: &Model,
        stage: &Stage,
        p: &[f64],
        inputs: &[f64],
        load: &mut [f64],
        scratch: &mut Scratch,
    ) {
        let motions = model.motions();
        motions.forces(inputs, &mut self.forces);
        if let Some(column) = motions.initial_column() {
            self.forces[column] = self.initial;
        }
        model.body().predict(stage, p, &self.forces, load, scratch);
        if self.shift.is_empty() {
            return;
        }
        motions.shift(inputs, &mut self.shift);
        multiply(stage.s.as_ref(), &self.shift, &mut self.shifted);
        for (load, shifted) in load.iter_mut().zip(&self.shifted) {
            *load -= shifted;
        }
    }

    /// Contact velocities of the body without the share of its driven parts, from those relative to what moves.
    pub fn of_body<'a>(&'a mut self, relative: &'a [f64]) -> &'a [f64] {
        if self.shift.is_empty() {
            return relative;
        }
        let both = relative.iter().zip(&self.shift);
        for (out, (relative, shift)) in self.shifted.iter_mut().zip(both) {
            *out = relative + shift;
        }
        &self.shifted
    }

    /// The velocity of the whole body from the contact that was solved after [`Relative::predict`], what is seen of it, and what drives
    /// it. `solved`: velocities relative to what moves, and forces with which the body is in balance; `None` for those that
    /// stand in `velocity`. `displacement` of the driven parts is the explicit one, and becomes that of the stage.
    pub fn correct(
        &mut self,
        model: &Model,
        (stage, theta_k): (&Stage, f64),
        solved: Option<[&[f64]; 2]>,
        (inputs, displacement): (&[f64], &mut [f64]),
        velocity: &mut Velocity,
        scratch: &mut Scratch,
    ) {
        let (body, motions) = (model.body(), model.motions());
        let Instant {
            velocity: of_body,
            slip_rate,
            reaction,
            output_velocity: seen,
            approach,
            drive_velocity,
            drive_force,
            foundation_force,
            ..
        } = &mut velocity.instant;
        let [relative, reaction] = solved.unwrap_or([slip_rate, reaction]);
        let mut pinned = std::mem::take(&mut self.pinned);
        let contact = self.of_body(relative);
        let own = match pinned.is_empty() {
            true => reaction,
            false => {
                pinned.copy_from_slice(reaction);
                for pin in &model.contact().pins {
                    pinned[pin.component] -= pin.resistance * contact[pin.component];
                }
                &pinned[..]
            }
        };
        body.correct(stage, contact, own, of_body, scratch);
        self.pinned = pinned;
        body.outputs(of_body, seen);
        velocity.load.copy_from_slice(inputs);
        motions.approach(inputs).copy_to(approach);
        if motions.is_empty() {
            return;
        }
        motions.drive_velocities(inputs, drive_velocity);
        motions.integrate(displacement, theta_k, inputs);
        motions.drive_forces(inputs, displacement, seen, reaction, drive_force);
        motions.foundation_forces(reaction, foundation_force);
        motions.add_outputs(|drive| inputs[motions.drive_input(drive)], seen);
    }
}
