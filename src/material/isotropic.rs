//! Isotropic laws: `tau -> c tr(tau) I + d tau`.
//!
//! Positive on symmetric tensors of dimension n exactly if `d > 0` and `n c + d > 0`.

use super::form::Form;
use super::plane_stress::{Plate, plate};
use super::variation::Variation;
use super::{Choice, Law, Parameter, ParameterKind, is_positive, parameter};
use crate::expression::PlaceFormula;
use crate::message::number;
use crate::refusal::{Refusal, Verdict, ensure, json};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `A tau = mu1 tr(tau) I + mu2 tau`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IsotropicViscosity {
    /// Coefficient of the trace, Pa s; `dimension * mu1 + mu2` is positive, or both are 0: no dashpot.
    pub mu1: f64,
    /// Coefficient of the strain rate, Pa s; positive, or 0 beside `mu1` = 0.
    #[schemars(extend("minimum" = 0))]
    pub mu2: f64,
    /// Slopes g of a factor `1 + g.x` of the law, 1/m, one per dimension; taken at the centroid of every cell. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gradient: Vec<f64>,
    /// A factor of the law, taken at the centroid of every cell; positive. Default: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "PlaceFormula")]
    pub factor: Option<PlaceFormula>,
}

/// `B tau = lambda tr(tau) I + E/(1 + kappa) tau`, with lambda by the convention.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IsotropicElasticity {
    /// Young's modulus E, Pa; positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: f64,
    /// Poisson's ratio kappa, in (-1, 0.5).
    #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
    pub poisson: f64,
    /// Coefficient of the trace.
    pub convention: Convention,
    /// Slopes g of a factor `1 + g.x` of the law, 1/m, one per dimension; taken at the centroid of every cell. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gradient: Vec<f64>,
    /// A factor of the law, taken at the centroid of every cell; positive. Default: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "PlaceFormula")]
    pub factor: Option<PlaceFormula>,
}

/// How lambda follows from Young's modulus E and Poisson's ratio kappa.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Convention {
    /// `E kappa / ((1 - kappa)(1 - 2 kappa))`, as printed in Kazmi et al. 2014.
    Kazmi2014,
    /// `E kappa / ((1 + kappa)(1 - 2 kappa))`; 2D only.
    PlaneStrain,
    /// `E kappa / (1 - kappa^2)`; 2D only. The viscosity is taken as already two-dimensional (the membrane law).
    PlaneStress,
    /// A plate with free faces; 2D only: E, kappa, mu1 and mu2 are those of the body, and what the strain across the plate leaves are
    /// laws of the plane and a branch of memory on the trace. Isotropic laws without memory that do not vary over the body.
    PlaneStressRelaxing,
    /// `E kappa / ((1 + kappa)(1 - 2 kappa))`; 3D only.
    ThreeDimensional,
}

/// The conventions.
pub(super) const CONVENTIONS: Choice = Choice {
    name: "Convention",
    words: &[
        "kazmi2014",
        "plane_strain",
        "plane_stress",
        "plane_stress_relaxing",
        "three_dimensional",
    ],
};

/// `c tr(tau) I + d tau`.
#[derive(Debug, Clone, Copy)]
struct Pair {
    lambda: f64,
    two_mu: f64,
}

impl Pair {
    /// `n c + d`, the eigenvalue on the identity.
    fn spherical(self, dimension: usize) -> f64 {
        dimension as f64 * self.lambda + self.two_mu
    }

    fn form(self) -> Form {
        let Pair { lambda, two_mu } = self;
        Form::Isotropic { lambda, two_mu }
    }
}

impl IsotropicViscosity {
    fn pair(&self) -> Pair {
        Pair {
            lambda: self.mu1,
            two_mu: self.mu2,
        }
    }
}

impl IsotropicElasticity {
    fn pair(&self) -> Pair {
        let IsotropicElasticity {
            young,
            poisson,
            convention,
            ..
        } = *self;
        let lambda = match convention {
            Convention::Kazmi2014 => young * poisson / ((1.0 - poisson) * (1.0 - 2.0 * poisson)),
            Convention::PlaneStrain | Convention::ThreeDimensional => {
                young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
            }
            Convention::PlaneStress | Convention::PlaneStressRelaxing => {
                young * poisson / (1.0 - poisson * poisson)
            }
        };
        Pair {
            lambda,
            two_mu: young / (1.0 + poisson),
        }
    }
}

/// The plate with free faces that two laws are, where the elasticity says so.
pub(super) fn plate_of(
    viscosity: &IsotropicViscosity,
    elasticity: &IsotropicElasticity,
) -> Option<Plate> {
    if elasticity.convention != Convention::PlaneStressRelaxing {
        return None;
    }
    let body = IsotropicElasticity {
        convention: Convention::ThreeDimensional,
        ..elasticity.clone()
    };
    let coefficients = |pair: Pair| [pair.lambda, pair.two_mu];
    Some(plate(
        coefficients(viscosity.pair()),
        coefficients(body.pair()),
    ))
}

/// Refuses a viscosity of a plate that is not positive as that of a body; `path` is its place in the scene.
pub(super) fn check_plate(viscosity: &IsotropicViscosity, path: &str) -> Verdict {
    let trace = viscosity.pair().spherical(3);
    ensure(viscosity.mu2 > 0.0 && is_positive(trace), || {
        let (mu1, trace) = (number(viscosity.mu1), number(trace));
        let found = format!("{mu1} (3 mu1 + mu2 = {trace})");
        let allowed = "3 mu1 + mu2 finite and > 0 with plane_stress_relaxing";
        Refusal::new(format!("{path}.mu1"), found, allowed)
    })
}

impl Law for IsotropicViscosity {
    fn parameters(&self, unit: &'static str) -> Vec<Parameter> {
        let number = ParameterKind::Number(unit);
        let mut all = vec![
            parameter("mu1", number, "Viscosity: coefficient of the trace."),
            parameter("mu2", number, "Viscosity: coefficient of the strain rate."),
        ];
        all.extend(self.variation().parameters());
        all
    }

    fn check(&self, dimension: usize, path: &str) -> Verdict {
        if self.mu1 == 0.0 && self.mu2 == 0.0 {
            return Ok(());
        }
        ensure(self.mu2 > 0.0, || {
            let allowed = "> 0, or 0 beside mu1 = 0: no dashpot";
            Refusal::new(format!("{path}.mu2"), number(self.mu2), allowed)
        })?;
        let trace = self.pair().spherical(dimension);
        ensure(is_positive(trace), || {
            let (mu1, trace) = (number(self.mu1), number(trace));
            Refusal::new(
                format!("{path}.mu1"),
                format!("{mu1} ({dimension} mu1 + mu2 = {trace})"),
                format!("{dimension} mu1 + mu2 finite and > 0: otherwise the body gains energy"),
            )
        })?;
        self.variation().check(dimension, path)
    }

    fn form(&self) -> Form {
        self.pair().form()
    }

    fn variation(&self) -> Variation<'_> {
        Variation {
            gradient: &self.gradient,
            factor: self.factor.as_ref(),
        }
    }
}

impl Law for IsotropicElasticity {
    fn parameters(&self, unit: &'static str) -> Vec<Parameter> {
        let text =
            "How the coefficient of the trace follows from Young's modulus and Poisson's ratio.";
        let mut all = vec![
            parameter("young", ParameterKind::Number(unit), "Young's modulus."),
            parameter("poisson", ParameterKind::Number("1"), "Poisson's ratio."),
            parameter("convention", ParameterKind::Choice(&CONVENTIONS), text),
        ];
        all.extend(self.variation().parameters());
        all
    }

    fn check(&self, dimension: usize, path: &str) -> Verdict {
        let allowed: &[Convention] = match dimension {
            2 => &[
                Convention::Kazmi2014,
                Convention::PlaneStrain,
                Convention::PlaneStress,
                Convention::PlaneStressRelaxing,
            ],
            _ => &[Convention::Kazmi2014, Convention::ThreeDimensional],
        };
        ensure(allowed.contains(&self.convention), || {
            let found = format!("{} in {dimension} dimensions", json(&self.convention));
            let names: Vec<String> = allowed.iter().map(json).collect();
            Refusal::new(format!("{path}.convention"), found, names.join(", "))
        })?;
        let pair = self.pair();
        let is_usable = is_positive(pair.two_mu) && is_positive(pair.spherical(dimension));
        ensure(is_usable, || {
            let (lambda, two_mu) = (number(pair.lambda), number(pair.two_mu));
            let found = format!("lambda = {lambda}, 2 mu = {two_mu}");
            let allowed = format!("2 mu and {dimension} lambda + 2 mu finite and > 0");
            Refusal::new(path, found, allowed)
        })?;
        self.variation().check(dimension, path)
    }

    fn form(&self) -> Form {
        self.pair().form()
    }

    fn variation(&self) -> Variation<'_> {
        Variation {
            gradient: &self.gradient,
            factor: self.factor.as_ref(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn elasticity(convention: Convention) -> Pair {
        let law = IsotropicElasticity {
            young: 1.0,
            poisson: 0.3,
            convention,
            gradient: Vec::new(),
            factor: None,
        };
        law.pair()
    }

    /// The closed forms of lambda, evaluated by hand at E = 1, kappa = 0.3.
    #[test]
    fn lambda_follows_the_convention() {
        for (convention, lambda) in [
            (Convention::Kazmi2014, 0.3 / 0.28),
            (Convention::PlaneStrain, 0.3 / 0.52),
            (Convention::ThreeDimensional, 0.3 / 0.52),
            (Convention::PlaneStress, 0.3 / 0.91),
        ] {
            let pair = elasticity(convention);
            assert!((pair.lambda - lambda).abs() < 1e-15, "{convention:?}");
            assert!((pair.two_mu - 1.0 / 1.3).abs() < 1e-15);
        }
    }

    /// Plane stress is uniaxial in the plane: `sigma_yy = 0` at `eps_yy = -kappa eps_xx` gives `sigma_xx = E eps_xx`.
    #[test]
    fn plane_stress_gives_youngs_modulus() {
        let pair = elasticity(Convention::PlaneStress);
        let (xx, yy) = (1.0, -0.3);
        assert!((pair.lambda * (xx + yy) + pair.two_mu * yy).abs() < 1e-15);
        assert!((pair.lambda * (xx + yy) + pair.two_mu * xx - 1.0).abs() < 1e-15);
    }

    /// The declarations name the keys of the scene, and the choices its words.
    #[test]
    fn parameters_are_the_keys_of_the_scene() {
        let viscosity = IsotropicViscosity {
            mu1: 1.0,
            mu2: 2.0,
            gradient: vec![0.5, 0.0],
            factor: None,
        };
        let elasticity = IsotropicElasticity {
            young: 1.0,
            poisson: 0.3,
            convention: Convention::Kazmi2014,
            gradient: Vec::new(),
            factor: None,
        };
        for (json, law) in [
            (serde_json::to_value(&viscosity), &viscosity as &dyn Law),
            (serde_json::to_value(&elasticity), &elasticity),
        ] {
            let json = json.unwrap();
            let keys: Vec<_> = json.as_object().unwrap().keys().cloned().collect();
            let declared = law.parameters("Pa").into_iter();
            let key = |p: Parameter| p.key.split('[').next().unwrap_or_default().to_owned();
            let mut declared: Vec<String> = declared.map(key).collect();
            declared.sort_unstable();
            declared.dedup();
            assert_eq!(keys, declared);
        }
        for word in CONVENTIONS.words {
            let read: Result<Convention, _> = serde_json::from_value((*word).into());
            assert!(read.is_ok(), "{word}");
        }
    }
}
