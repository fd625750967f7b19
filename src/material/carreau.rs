//! Shear-thinning viscosity, after Carreau: `A eps = mu1 tr(eps) I + eta(|dev eps|) dev eps`,
//! `eta(r) = mu_inf + (mu_0 - mu_inf) / sqrt(1 + (r/c)^2)`.
//!
//! The tangent has the eigenvalues `eta` across the strain rate and `mu_inf + (mu_0 - mu_inf)(1 + (r/c)^2)^(-3/2)` along it, so that
//! in the deviator of the plane `m_A = min(mu_inf, d mu1)` and `L_A = max(mu_0, d mu1)`. A viscosity that depends on the whole
//! strain rate instead of its deviator would be neither monotone nor Lipschitz.

use super::excess::Deviator;
use super::thinning::ThinningLaw;
use super::variation::Variation;
use crate::expression::PlaceFormula;
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

impl ThinningLaw for CarreauViscosity {
    const TEXTS: [&'static str; 5] = [
        "Viscosity: coefficient of the trace.",
        "Viscosity: coefficient of the deviator at rest.",
        "Viscosity: coefficient of the deviator at large strain rates.",
        "Size of the deviator of the strain rate at which the viscosity falls.",
        "Deviator of the strain rate that the viscosity depends on.",
    ];
    const TRACE: &'static str = "mu1";
    const SIZE: &'static str = "1/s";

    fn trace(&self) -> f64 {
        self.mu1
    }

    fn curve(&self) -> [f64; 3] {
        [self.mu_0, self.mu_inf, self.c]
    }

    fn deviator(&self) -> Deviator {
        self.deviator
    }

    fn variation(&self) -> Variation<'_> {
        Variation {
            gradient: &self.gradient,
            factor: self.factor.as_ref(),
        }
    }
}
