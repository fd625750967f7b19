//! Laws whose stress is no linear function of the strain: what they add to their linear form.
//!
//! ```text
//! sigma = D eps + psi(|dev eps|) dev eps,   psi >= 0,   (psi r)' >= 0
//! ```
//!
//! `D` is the form of the law: its lower tangent, so that what is added is monotone, and every sum of such laws is as elliptic as
//! the sum of their forms. The excess has the potential `int_0^|dev eps| psi(s) s ds` and the tangent
//!
//! ```text
//! psi I_dev + ((psi r)' - psi) n n^T,   n = dev eps / |dev eps|
//! ```
//!
//! with the eigenvalues `psi` across and `(psi r)'` along the strain. Norms are Frobenius norms. The deviator is the one of space,
//! `eps - tr(eps)/3 I` with its zz part, also for plane strain; `in_plane` is `eps - tr(eps)/2 I`, the paper's S^2.

use super::form::Form;
use super::voigt::Voigt;
use super::{Choice, Convention};
use crate::refusal::{Refusal, Verdict, ensure, json};
use nalgebra::Vector6;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;

/// Which deviator of the strain a law is of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Deviator {
    /// `eps - tr(eps)/3 I`, its zz component counted; in 2D that of plane strain.
    #[default]
    ThreeDimensional,
    /// `eps - tr(eps)/2 I`; 2D only.
    InPlane,
}

/// The deviators.
pub(super) const DEVIATORS: Choice = Choice {
    name: "Deviator",
    words: &["three_dimensional", "in_plane"],
};

impl Deviator {
    /// Share of the trace that the deviator takes off the diagonal.
    fn share(self) -> f64 {
        match self {
            Deviator::ThreeDimensional => 1.0 / 3.0,
            Deviator::InPlane => 0.5,
        }
    }

    /// `factor dev eps` as a linear form.
    pub(super) fn form(self, factor: f64) -> Form {
        Form::Isotropic {
            lambda: -factor * self.share(),
            two_mu: factor,
        }
    }

    /// Refuses a deviator that a dimension does not have; `path` is the place of the law.
    pub(super) fn check(self, dimension: usize, path: &str) -> Verdict {
        ensure(dimension == 2 || self != Deviator::InPlane, || {
            let found = format!("{} in {dimension} dimensions", json(&self));
            Refusal::new(format!("{path}.deviator"), found, "three_dimensional")
        })
    }

    /// Refuses the deviator of space beside moduli of plane stress, under which the strain has a zz component of its own.
    ///
    /// The relaxing one is no part of a law either: it couples elasticity and viscosity.
    pub(super) fn check_beside(self, convention: Option<Convention>, path: &str) -> Verdict {
        ensure(convention != Some(Convention::PlaneStressRelaxing), || {
            let allowed = "plane_strain, plane_stress: a plate that relaxes is of linear laws";
            let found = "\"plane_stress_relaxing\" in a law that is not linear";
            Refusal::new(format!("{path}.base.convention"), found, allowed)
        })?;
        let fits = convention != Some(Convention::PlaneStress) || self == Deviator::InPlane;
        ensure(fits, || {
            let found = format!("{} beside the convention plane_stress", json(&self));
            let allowed =
                "in_plane, or the convention plane_strain: in plane stress eps_zz is unknown";
            Refusal::new(format!("{path}.deviator"), found, allowed)
        })
    }
}

/// The function psi of the size of the deviator.
pub trait Curve: Debug + Send + Sync {
    /// What holds at `r = |dev eps| >= 0`.
    fn at(&self, r: f64) -> CurvePoint;
    /// The least upper bound of `psi` and of `(psi r)'`; their largest lower bound is 0.
    fn largest(&self) -> f64;
}

/// A curve at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// `psi(r)`, Pa or Pa s.
    pub secant: f64,
    /// `(psi r)'`.
    pub slope: f64,
    /// `int_0^r psi(s) s ds`.
    pub potential: f64,
}

/// What a law adds to its form.
#[derive(Debug)]
pub struct Excess {
    curve: Box<dyn Curve>,
    deviator: Deviator,
}

/// Stress, tangent and potential of an excess at a strain: components of Voigt, engineering shear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExcessPoint {
    /// Stress.
    pub stress: Vector6<f64>,
    /// Energy (per volume) or, of a viscosity, potential of the dissipation.
    pub potential: f64,
    secant: f64,
    /// `((psi r)' - psi)`.
    along: f64,
    /// The deviator over its size; zero where it vanishes.
    direction: Vector6<f64>,
    share: f64,
}

impl Excess {
    pub(super) fn new(curve: impl Curve + 'static, deviator: Deviator) -> Excess {
        Excess {
            curve: Box::new(curve),
            deviator,
        }
    }

    /// What holds at a strain (xx, yy, zz, yz, xz, xy), engineering shear; in two dimensions the components of z are 0.
    pub fn at(&self, strain: &Vector6<f64>) -> ExcessPoint {
        let share = self.deviator.share();
        let mean = share * (strain[0] + strain[1] + strain[2]);
        let mut dev = Vector6::zeros();
        for (i, (dev, strain)) in dev.iter_mut().zip(strain.iter()).enumerate() {
            *dev = if i < 3 { strain - mean } else { 0.5 * strain };
        }
        if self.deviator == Deviator::InPlane {
            dev[2] = 0.0;
        }
        let r = size(&dev);
        let point = self.curve.at(r);
        ExcessPoint {
            stress: dev * point.secant,
            potential: point.potential,
            secant: point.secant,
            along: point.slope - point.secant,
            direction: if r > 0.0 { dev / r } else { Vector6::zeros() },
            share,
        }
    }

    /// The form of which the excess is a part wherever it is largest: its tangent there.
    pub(super) fn largest(&self) -> Form {
        self.deviator.form(self.curve.largest())
    }
}

impl ExcessPoint {
    /// The tangent: stresses from engineering strains. The row and column of zz are those of the deviator of space; in two
    /// dimensions nothing reads them.
    pub fn tangent(&self) -> Voigt {
        let n = &self.direction;
        Voigt::from_fn(|i, j| {
            let own = match (i == j, i < 3) {
                (true, true) => 1.0,
                (true, false) => 0.5,
                _ => 0.0,
            };
            let trace = if i < 3 && j < 3 { self.share } else { 0.0 };
            self.secant * (own - trace) + self.along * n[i] * n[j]
        })
    }
}

/// Frobenius norm of a tensor with these components, whatever its size.
fn size(dev: &Vector6<f64>) -> f64 {
    let largest = dev.amax();
    if !(largest > 0.0 && largest.is_finite()) {
        return largest;
    }
    let square = |i: usize| (dev[i] / largest) * (dev[i] / largest);
    let normal: f64 = (0..3).map(square).sum();
    let shear: f64 = (3..6).map(square).sum();
    largest * (normal + 2.0 * shear).sqrt()
}
