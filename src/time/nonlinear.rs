//! A stage of a body whose laws are not linear: Newton's method on the whole body, the friction problem solved exactly at every
//! iterate.
//!
//! A stage minimises `Phi(w) = Psi_A(w) + Psi_B(p + theta k w) / (theta k) - F.w + sum omega G(|w_c|)`. With the excess
//! `C(w) = C_A(w) + C_B(p + theta k w)` of the laws and its tangent T at a point (see `body::nonlinear`), an iterate `w_i` is followed by
//! the solution of
//!
//! ```text
//! (A + theta k B + T) w + E Lambda = F f - B p + T w_i - C(w_i),   Lambda in omega g(|w_c|) d|w_c|
//! ```
//!
//! condensed on the contact and solved as a stage of a linear body is. What is left there is the residual of the inclusion, because
//! friction and contact hold exactly at the new iterate:
//!
//! ```text
//! rho = C(w_{i+1}) - C(w_i) - T (w_{i+1} - w_i)
//! ```
//!
//! The iteration stops on it. With `d = w_{i+1} - w_i` and the contact forces held at those of the new iterate, Phi changes along d by
//!
//! ```text
//! phi(t) = t^2/2 d.(A + theta k B) d + Psi_C(w_i + t d) - Psi_C(w_i) - t C(w_i).d - t d.M d,   M = A + theta k B + T
//! ```
//!
//! which is no less than the change of Phi where the friction potential is convex, and falls from 0 with the slope `-d.M d` whatever
//! the law of friction is. Where the residual does not fall enough, the step is halved until phi decreases sufficiently.
//!
//! The factorization is kept over iterates and steps, and made anew, at the present iterate, when the residual falls by less than
//! [`RENEWAL`]. Its point is part of the state.

use super::body_newton::BodyNewton;
use super::linearised;
use super::memory::Span;
use super::pressed::Level;
use super::workspace::Workspace;
use crate::body::nonlinear::{ELASTIC, Nonlinear, VISCOUS, take_point};
use crate::body::{Scratch, StageCache};
use crate::error::{Error, Result};
use crate::linalg::dot;
use crate::model::Model;
use crate::state::{State, report};
use std::ops::Range;

/// The factorization is renewed when the residual falls by less.
const RENEWAL: f64 = 3.0;
/// A residual that falls to this share needs no look at Phi.
const ENOUGH: f64 = 0.5;
/// Sufficient decrease of phi per unit of its slope (Armijo).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Changes of phi below this share of its terms are rounding.
const PHI_ROUNDING: f64 = 1e-13;
/// Most halvings of a step.
const HALVINGS: usize = 30;
/// Most iterates of a stage.
const MOST_ITERATIONS: usize = 100;
/// Tolerance of the residual of the body as a share of that of friction, and the least that is asked for.
const SHARE: f64 = 0.1;
const LEAST_TOLERANCE: f64 = 1e-13;
/// Residual, relative to the forces of the body, below which one that an exact tangent no longer reduces is rounding.
const ROUNDING: f64 = 1e-9;

/// What a stage is solved for.
pub(super) type At = (f64, Level, Span);

/// Solves the stage for the explicit part and the inputs in `ws`, into `ws.velocities[index]`, whose contact is the warm start.
///
/// # Errors
/// [`Error::BodyNotConverged`], and those of a stage of a linear body.
pub(super) fn solve(
    model: &Model,
    nonlinear: &Nonlinear,
    state: &mut State,
    ws: &mut Workspace,
    at: At,
    index: usize,
) -> Result<()> {
    let Some(mut newton) = ws.nonlinear.take() else {
        return Ok(());
    };
    let stage = StageNewton {
        model,
        nonlinear,
        at,
        index,
    };
    let solved = stage.iterate(&mut newton, state, ws);
    ws.nonlinear = Some(newton);
    solved
}

struct StageNewton<'a> {
    model: &'a Model,
    nonlinear: &'a Nonlinear,
    at: At,
    index: usize,
}

impl StageNewton<'_> {
    fn theta_k(&self) -> f64 {
        self.at.0
    }

    fn iterate(
        &self,
        newton: &mut BodyNewton,
        state: &mut State,
        ws: &mut Workspace,
    ) -> Result<()> {
        let theta_k = self.theta_k();
        let before = &ws.velocities[self.index.saturating_sub(1)].instant;
        let n = newton.velocity.len();
        newton.velocity.copy_from_slice(&before.velocity[..n]);
        let (range, is_known) = take_point(&mut state.main.tangents, theta_k);
        set_displacement(
            &ws.explicit.displacement,
            theta_k,
            &newton.velocity,
            &mut newton.displacement,
        );
        if !is_known {
            self.set_point(newton, state, &range);
        }
        let mut potential =
            self.evaluate(&newton.velocity, &newton.displacement, &mut newton.force);
        self.factor(newton, state, ws, &range)?;
        let mut is_exact = !is_known;
        let mut last: Option<f64> = None;
        let tolerance = (SHARE * self.model.solver().tolerance()).max(LEAST_TOLERANCE);
        for iteration in 1.. {
            newton.iterations += 1;
            let excess = ws.scratch.excess.iter_mut().zip(&newton.kept);
            for ((to, kept), force) in excess.zip(&newton.force) {
                *to = kept - force;
            }
            linearised::solve(self.model, state, ws, self.at, self.index)?;
            let next = &ws.velocities[self.index].instant.velocity[..n];
            for ((step, next), own) in newton.step.iter_mut().zip(next).zip(&newton.velocity) {
                *step = next - own;
            }
            set_displacement(
                &ws.explicit.displacement,
                theta_k,
                next,
                &mut newton.displacement,
            );
            let next_potential = self.evaluate(next, &newton.displacement, &mut newton.next_force);
            let body = self.model.body();
            body.apply_tangent(ws.stages.current(), next, &mut newton.next_kept);
            let (residual, scale) = self.residual(newton, next);
            if !(residual.is_finite() && scale.is_finite()) {
                return Err(Error::Overflow {
                    what: "the stress of a nonlinear law".into(),
                    time: state.time,
                });
            }
            if residual <= tolerance * scale {
                take_note(state, residual, scale);
                return Ok(());
            }
            let before = match last {
                Some(last) => last,
                None => self.set_step_image(newton, &ws.stages, &mut ws.scratch),
            };
            if is_exact && residual > ENOUGH * before && residual <= ROUNDING * scale {
                take_note(state, residual, scale);
                let ending = &mut state.report[report::ENDING];
                *ending = ending.max(report::AT_ROUNDING);
                return Ok(());
            }
            if iteration == MOST_ITERATIONS {
                return Err(Error::BodyNotConverged {
                    time: state.time,
                    residual: residual / scale,
                    tolerance,
                    iterations: iteration,
                });
            }
            if residual > ENOUGH * before {
                self.set_step_image(newton, &ws.stages, &mut ws.scratch);
                let image = &mut newton.work[1];
                body.apply_tangent(ws.stages.current(), &newton.step, image);
            }
            let is_whole = residual <= ENOUGH * before
                || self.decreases(newton, [potential, next_potential], 1.0);
            if is_whole {
                newton.velocity.copy_from_slice(next);
                std::mem::swap(&mut newton.force, &mut newton.next_force);
                std::mem::swap(&mut newton.kept, &mut newton.next_kept);
                potential = next_potential;
                last = Some(residual);
            } else {
                potential = self.shorten(newton, ws, potential);
                last = None;
            }
            is_exact = !is_whole || RENEWAL * residual > before;
            if is_exact {
                set_displacement(
                    &ws.explicit.displacement,
                    theta_k,
                    &newton.velocity,
                    &mut newton.displacement,
                );
                self.set_point(newton, state, &range);
                self.factor(newton, state, ws, &range)?;
            }
        }
        Ok(())
    }

    /// The point of the tangents moves to the iterate.
    fn set_point(&self, newton: &BodyNewton, state: &mut State, range: &Range<usize>) {
        let point = &mut state.main.tangents[range.clone()];
        self.nonlinear
            .gather([&newton.velocity, &newton.displacement], point);
    }

    /// Makes sure of the factorization at the point of the tangents, and of `T w`.
    fn factor(
        &self,
        newton: &mut BodyNewton,
        state: &State,
        ws: &mut Workspace,
        range: &Range<usize>,
    ) -> Result<()> {
        let point = &state.main.tangents[range.clone()];
        let body = self.model.body();
        let stage = ws
            .stages
            .get_at(body, self.theta_k(), point, &mut ws.scratch)?;
        body.apply_tangent(stage, &newton.velocity, &mut newton.kept);
        let version = stage.version;
        if newton.seen != version {
            newton.seen = version;
            ws.newton.forget();
            if let Some(pressed) = &mut ws.pressed {
                pressed.workspace.forget();
            }
        }
        Ok(())
    }

    /// C at a velocity and a displacement into `force`, and its potential, W.
    fn evaluate(&self, velocity: &[f64], displacement: &[f64], force: &mut [f64]) -> f64 {
        force.fill(0.0);
        let viscous = self.nonlinear.add_forces(VISCOUS, velocity, force);
        let elastic = self.nonlinear.add_forces(ELASTIC, displacement, force);
        match self.theta_k() {
            0.0 => viscous,
            theta_k => viscous + elastic / theta_k,
        }
    }

    /// Norms of the residual of the inclusion at the next iterate, and of the forces of the body that meet there, N.
    fn residual(&self, newton: &mut BodyNewton, next: &[f64]) -> (f64, f64) {
        let body = self.model.body();
        let BodyNewton {
            work: [left, image],
            displacement,
            ..
        } = newton;
        body.apply(VISCOUS, next, image);
        let mut scale = norm(image);
        body.apply(ELASTIC, displacement, image);
        scale += norm(image) + norm(&newton.next_force);
        let pairs = newton.next_force.iter().zip(&newton.next_kept);
        let own = newton.force.iter().zip(&newton.kept);
        for (left, ((force, kept), (own, own_kept))) in left.iter_mut().zip(pairs.zip(own)) {
            *left = (force - kept) - (own - own_kept);
        }
        (norm(left), scale)
    }

    /// `M d` into `newton.work[0]`: the residual of the iterate with the contact forces of the next one; its norm, N.
    fn set_step_image(
        &self,
        newton: &mut BodyNewton,
        stages: &StageCache,
        scratch: &mut Scratch,
    ) -> f64 {
        let image = &mut newton.work[0];
        let body = self.model.body();
        body.apply_stage(stages.current(), &newton.step, image, scratch);
        norm(image)
    }

    /// Whether phi decreases sufficiently over a share of the step, from the potential at the iterate to that at its end.
    fn decreases(&self, newton: &BodyNewton, [from, to]: [f64; 2], share: f64) -> bool {
        let step = &newton.step;
        let [slope, of_tangent] = newton.work.each_ref().map(|image| dot(step, image));
        let linear = slope - of_tangent;
        let work = share * dot(&newton.force, step);
        let phi = 0.5 * share * share * linear + (to - from - work) - share * slope;
        let rounding = PHI_ROUNDING * (from.abs() + to.abs() + work.abs());
        phi <= rounding - SUFFICIENT_DECREASE * share * slope
    }

    /// Halves the step until phi decreases, and moves the iterate; returns the potential there.
    fn shorten(&self, newton: &mut BodyNewton, ws: &Workspace, potential: f64) -> f64 {
        let mut share = 1.0;
        let explicit = &ws.explicit.displacement;
        for halving in 1..=HALVINGS {
            newton.halvings += 1;
            share *= 0.5;
            let moved = newton.next_kept.iter_mut().zip(&newton.velocity);
            for ((to, own), step) in moved.zip(&newton.step) {
                *to = own + share * step;
            }
            let to = &newton.next_kept;
            set_displacement(explicit, self.theta_k(), to, &mut newton.displacement);
            let at = self.evaluate(to, &newton.displacement, &mut newton.next_force);
            if halving == HALVINGS || self.decreases(newton, [potential, at], share) {
                newton.velocity.copy_from_slice(&newton.next_kept);
                std::mem::swap(&mut newton.force, &mut newton.next_force);
                return at;
            }
        }
        potential
    }
}

/// `u = p + theta k w`.
pub(super) fn set_displacement(explicit: &[f64], theta_k: f64, velocity: &[f64], out: &mut [f64]) {
    for ((out, p), w) in out.iter_mut().zip(explicit).zip(velocity) {
        *out = p + theta_k * w;
    }
}

/// The residual of a stage that is solved enters the account.
fn take_note(state: &mut State, residual: f64, scale: f64) {
    if residual > 0.0 {
        let entry = &mut state.report[report::RESIDUAL];
        *entry = entry.max(residual / scale);
    }
}

fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}
