//! Elasticity that softens in shear, after Hencky: `B eps = bulk tr(eps) I + mu(|dev eps|) dev eps`,
//! `mu(r) = mu_inf + (mu_0 - mu_inf) / sqrt(1 + (r/c)^2)`, the law of small elastic-plastic strains under loads that only grow.

use super::excess::Deviator;
use super::thinning::ThinningLaw;
use super::variation::Variation;
use crate::expression::PlaceFormula;
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

impl ThinningLaw for HenckyElasticity {
    const TEXTS: [&'static str; 5] = [
        "Elasticity: coefficient of the trace.",
        "Elasticity: coefficient of the deviator at rest.",
        "Elasticity: coefficient of the deviator at large strains.",
        "Size of the deviator of the strain at which the coefficient falls.",
        "Deviator of the strain that the elasticity depends on.",
    ];
    const TRACE: &'static str = "bulk";
    const SIZE: &'static str = "1";

    fn trace(&self) -> f64 {
        self.bulk
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
