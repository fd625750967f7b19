//! How a law varies over the body: a factor of all its moduli, by the place.

use super::{Parameter, ParameterKind, indexed};
use crate::expression::{PlaceFormula, PlaceProgram};
use crate::message::cut;
use crate::refusal::{Refusal, Verdict, ensure};

/// The variation of a law, as the scene writes it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Variation<'a> {
    /// Slopes g of the factor `1 + g.x`, 1/m; none for a factor of 1.
    pub gradient: &'a [f64],
    /// A factor of its own.
    pub factor: Option<&'a PlaceFormula>,
}

impl Variation<'_> {
    pub fn is_none(&self) -> bool {
        self.gradient.is_empty() && self.factor.is_none()
    }

    /// Values of the gradient, where there is one.
    pub fn parameters(&self) -> Vec<Parameter> {
        let kind = ParameterKind::Number("1/m");
        let text = "Slope of the factor of the law at the origin along an axis.";
        indexed("gradient", self.gradient.len(), kind, text)
    }

    pub fn check(&self, dimension: usize, path: &str) -> Verdict {
        let count = self.gradient.len();
        ensure(count == 0 || count == dimension, || {
            let allowed = format!("{dimension} numbers in {dimension} dimensions");
            Refusal::new(
                format!("{path}.gradient"),
                format!("{count} numbers"),
                allowed,
            )
        })?;
        self.parsed(path).map(|_| ())
    }

    fn parsed(&self, path: &str) -> Result<Option<PlaceProgram>, Refusal> {
        let parse = |formula: &PlaceFormula| {
            formula.parse().map_err(|fault| {
                let found = format!(
                    "{:?}: {} at character {}",
                    cut(&formula.expression),
                    fault.found,
                    fault.position
                );
                Refusal::new(format!("{path}.factor.expression"), found, fault.allowed)
            })
        };
        self.factor.map(parse).transpose()
    }

    /// The factor at each of these places, m; `path` is the place of the law in the scene.
    pub fn factors(
        &self,
        places: impl Iterator<Item = [f64; 3]>,
        path: &str,
    ) -> Result<Vec<f64>, Refusal> {
        let program = self.parsed(path)?;
        let positive = |value: f64, at: &[f64; 3], key: &str, what: &str| {
            ensure(value.is_finite() && value > 0.0, || {
                let found = format!("{value} at {at:?}");
                let allowed = format!("{what} finite and > 0 at the centroid of every cell");
                Refusal::new(format!("{path}.{key}"), found, allowed)
            })
        };
        let at_place = |at: [f64; 3]| {
            let slopes = self.gradient.iter().zip(&at);
            let linear = 1.0 + slopes.map(|(g, x)| g * x).sum::<f64>();
            positive(linear, &at, "gradient", "1 + g.x")?;
            let own = program.as_ref().map_or(1.0, |program| program.value(&at));
            positive(own, &at, "factor.expression", "a value")?;
            Ok(linear * own)
        };
        places.map(at_place).collect()
    }
}
