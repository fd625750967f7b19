//! Elasticity that softens in shear, after Hencky: `B eps = bulk tr(eps) I + mu(|dev eps|) dev eps`,
//! `mu(r) = mu_inf + (mu_0 - mu_inf) / sqrt(1 + (r/c)^2)`, the law of small elastic-plastic strains under loads that only grow.

use super::excess::{DEVIATORS, Deviator, Excess};
use super::form::Form;
use super::thinning::{self, Thinning};
use super::variation::Variation;
use super::{Law, Parameter, ParameterKind, parameter};
use crate::expression::PlaceFormula;
use crate::refusal::Verdict;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `B eps = bulk tr(eps) I + mu(|dev eps|) dev eps` with `mu(r) = mu_inf + (mu_0 - mu_inf) / sqrt(1 + (r/c)^2)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HenckyElasticity {
    /// Coefficient of the trace, Pa: the bulk modulus of the deviator `three_dimensional`; positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub bulk: f64,
    /// Coefficient of the deviator at rest (twice the shear modulus), Pa; `mu_inf` or larger.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mu_0: f64,
    /// The same at large strains, Pa; positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mu_inf: f64,
    /// Size of the deviator of the strain at which the coefficient falls; positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub c: f64,
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

impl Law for HenckyElasticity {
    fn parameters(&self, unit: &'static str) -> Vec<Parameter> {
        let mut all = vec![
            parameter(
                "bulk",
                ParameterKind::Number(unit),
                "Elasticity: coefficient of the trace.",
            ),
            parameter(
                "mu_0",
                ParameterKind::Number(unit),
                "Elasticity: coefficient of the deviator at rest.",
            ),
            parameter(
                "mu_inf",
                ParameterKind::Number(unit),
                "Elasticity: coefficient of the deviator at large strains.",
            ),
            parameter(
                "c",
                ParameterKind::Number("1"),
                "Size of the deviator of the strain at which the coefficient falls.",
            ),
            parameter(
                "deviator",
                ParameterKind::Choice(&DEVIATORS),
                "Deviator of the strain that the elasticity depends on.",
            ),
        ];
        all.extend(self.variation().parameters());
        all
    }

    fn check(&self, dimension: usize, path: &str) -> Verdict {
        thinning::check(("bulk", self.bulk), [self.mu_0, self.mu_inf, self.c], path)?;
        self.deviator.check(dimension, path)?;
        self.variation().check(dimension, path)
    }

    fn form(&self) -> Form {
        let trace = Form::Isotropic {
            lambda: self.bulk,
            two_mu: 0.0,
        };
        trace.plus(&self.deviator.form(self.mu_inf))
    }

    fn excess(&self) -> Option<Excess> {
        let range = self.mu_0 - self.mu_inf;
        (range > 0.0).then(|| Excess::new(Thinning { range, c: self.c }, self.deviator))
    }
    fn variation(&self) -> Variation<'_> {
        Variation {
            gradient: &self.gradient,
            factor: self.factor.as_ref(),
        }
    }
}
