//! Elasticity with a penalty beyond von Mises's convex, the paper's example of (5.14): `B eps = E eps + beta (eps - P_K eps)`,
//! `K = {|dev eps| <= kappa}`.
//!
//! `eps - P_K eps = (1 - kappa/|dev eps|)_+ dev eps`: exactly linear while `|dev eps| <= kappa`, stiffer by beta beyond. Monotone, with
//! the potential `1/2 eps.E eps + beta/2 (|dev eps| - kappa)_+^2`, and `L_B` the largest eigenvalue of `E + beta dev`.

use super::excess::{Curve, CurvePoint, DEVIATORS, Deviator, Excess};
use super::form::Form;
use super::isotropic::{Convention, IsotropicElasticity};
use super::matrix::MatrixLaw;
use super::orthotropic::Orthotropic;
use super::variation::Variation;
use super::{Law, Parameter, ParameterKind, is_positive, parameter};
use crate::expression::PlaceFormula;
use crate::message::number;
use crate::refusal::{Refusal, Verdict, ensure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `B eps = E eps + beta (1 - kappa/|dev eps|)_+ dev eps`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VonMisesElasticity {
    /// The linear elasticity E.
    pub base: Base,
    /// What the coefficient of the deviator gains beyond `kappa`, Pa; 0 or larger.
    #[schemars(range(min = 0))]
    pub beta: f64,
    /// Size of the deviator of the strain up to which the law is linear; 0 or larger.
    #[schemars(range(min = 0))]
    pub kappa: f64,
    /// Which deviator. Default: `three_dimensional`.
    #[serde(default)]
    pub deviator: Deviator,
    /// Slopes g of a factor `1 + g.x` of the law, 1/m, one per dimension; taken at the centroid of every cell. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gradient: Vec<f64>,
    /// A factor of the law, taken at the centroid of every cell; positive. Default: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "PlaceFormula")]
    pub factor: Option<PlaceFormula>,
}

/// The linear part of a law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case")]
pub enum Base {
    Isotropic(IsotropicElasticity),
    Orthotropic(Orthotropic),
    Matrix(MatrixLaw),
}

impl Base {
    fn law(&self) -> &dyn Law {
        match self {
            Base::Isotropic(law) => law,
            Base::Orthotropic(law) => law,
            Base::Matrix(law) => law,
        }
    }

    /// What its plane keeps, where it says that.
    fn convention(&self) -> Option<Convention> {
        match self {
            Base::Isotropic(law) => Some(law.convention),
            Base::Orthotropic(law) => law.convention,
            Base::Matrix(_) => None,
        }
    }
}

/// The penalty.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Penalty {
    beta: f64,
    kappa: f64,
}

impl Curve for Penalty {
    fn at(&self, r: f64) -> CurvePoint {
        let Penalty { beta, kappa } = *self;
        if r <= kappa && kappa > 0.0 {
            return CurvePoint {
                secant: 0.0,
                slope: 0.0,
                potential: 0.0,
            };
        }
        let beyond = r - kappa;
        CurvePoint {
            secant: if kappa > 0.0 {
                beta * (beyond / r)
            } else {
                beta
            },
            slope: beta,
            potential: 0.5 * beta * beyond * beyond,
        }
    }

    fn largest(&self) -> f64 {
        self.beta
    }
}

impl Law for VonMisesElasticity {
    fn parameters(&self, unit: &'static str) -> Vec<Parameter> {
        let base = self.base.law().parameters(unit).into_iter();
        let mut all: Vec<Parameter> = base
            .map(|p| Parameter {
                key: format!("base.{}", p.key),
                ..p
            })
            .collect();
        all.extend([
            parameter(
                "beta",
                ParameterKind::Number(unit),
                "Elasticity: what the coefficient of the deviator gains beyond kappa.",
            ),
            parameter(
                "kappa",
                ParameterKind::Number("1"),
                "Size of the deviator of the strain up to which the law is linear.",
            ),
            parameter(
                "deviator",
                ParameterKind::Choice(&DEVIATORS),
                "Deviator of the strain that the elasticity depends on.",
            ),
        ]);
        all.extend(self.variation().parameters());
        all
    }

    fn check(&self, dimension: usize, path: &str) -> Verdict {
        let base = self.base.law();
        base.check(dimension, &format!("{path}.base"))?;
        ensure(base.variation().is_none(), || {
            let allowed = "none: gradient and factor are those of the whole law, beside base";
            Refusal::new(format!("{path}.base"), "a gradient or factor", allowed)
        })?;
        for (key, value) in [("beta", self.beta), ("kappa", self.kappa)] {
            ensure(value.is_finite() && value >= 0.0, || {
                let allowed = format!("{key} >= 0: otherwise the law is not monotone");
                Refusal::new(format!("{path}.{key}"), number(value), allowed)
            })?;
        }
        self.deviator.check(dimension, path)?;
        self.deviator.check_beside(self.base.convention(), path)?;
        self.variation().check(dimension, path)
    }

    fn form(&self) -> Form {
        self.base.law().form()
    }

    fn excess(&self) -> Option<Excess> {
        let (beta, kappa) = (self.beta, self.kappa);
        is_positive(beta).then(|| Excess::new(Penalty { beta, kappa }, self.deviator))
    }
    fn variation(&self) -> Variation<'_> {
        Variation {
            gradient: &self.gradient,
            factor: self.factor.as_ref(),
        }
    }
}
