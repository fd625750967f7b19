//! Shear-thinning viscosity, after Carreau: `A eps = mu1 tr(eps) I + eta(|dev eps|) dev eps`,
//! `eta(r) = mu_inf + (mu_0 - mu_inf) / sqrt(1 + (r/c)^2)`.
//!
//! The tangent has the eigenvalues `eta` across the strain rate and `mu_inf + (mu_0 - mu_inf)(1 + (r/c)^2)^(-3/2)` along it, so that
//! in the deviator of the plane `m_A = min(mu_inf, d mu1)` and `L_A = max(mu_0, d mu1)`. A viscosity that depends on the whole
//! strain rate instead of its deviator would be neither monotone nor Lipschitz.

use super::excess::{DEVIATORS, Deviator, Excess};
use super::form::Form;
use super::thinning::{self, Thinning};
use super::variation::Variation;
use super::{Law, Parameter, ParameterKind, parameter};
use crate::expression::PlaceFormula;
use crate::refusal::Verdict;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `A eps = mu1 tr(eps) I + eta(|dev eps|) dev eps` with `eta(r) = mu_inf + (mu_0 - mu_inf) / sqrt(1 + (r/c)^2)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CarreauViscosity {
    /// Coefficient of the trace, Pa s; positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mu1: f64,
    /// Coefficient of the deviator at rest, Pa s; `mu_inf` or larger.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mu_0: f64,
    /// The same at large strain rates, Pa s; positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mu_inf: f64,
    /// Size of the deviator of the strain rate at which the viscosity falls, 1/s; positive.
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

impl Law for CarreauViscosity {
    fn parameters(&self, unit: &'static str) -> Vec<Parameter> {
        let mut all = vec![
            parameter(
                "mu1",
                ParameterKind::Number(unit),
                "Viscosity: coefficient of the trace.",
            ),
            parameter(
                "mu_0",
                ParameterKind::Number(unit),
                "Viscosity: coefficient of the deviator at rest.",
            ),
            parameter(
                "mu_inf",
                ParameterKind::Number(unit),
                "Viscosity: coefficient of the deviator at large strain rates.",
            ),
            parameter(
                "c",
                ParameterKind::Number("1/s"),
                "Size of the deviator of the strain rate at which the viscosity falls.",
            ),
            parameter(
                "deviator",
                ParameterKind::Choice(&DEVIATORS),
                "Deviator of the strain rate that the viscosity depends on.",
            ),
        ];
        all.extend(self.variation().parameters());
        all
    }

    fn check(&self, dimension: usize, path: &str) -> Verdict {
        thinning::check(("mu1", self.mu1), [self.mu_0, self.mu_inf, self.c], path)?;
        self.deviator.check(dimension, path)?;
        self.variation().check(dimension, path)
    }

    fn form(&self) -> Form {
        let trace = Form::Isotropic {
            lambda: self.mu1,
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
