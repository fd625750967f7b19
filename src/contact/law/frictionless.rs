//! No tangential stress: `g = 0`.

use super::{At, Coefficient, Coefficients, FrictionLaw};
use crate::contact::evaluation::Evaluation;

pub struct Frictionless;

impl FrictionLaw for Frictionless {
    fn name(&self) -> &'static str {
        "frictionless"
    }

    fn text(&self) -> &'static str {
        "No tangential stress."
    }

    fn coefficients(&self) -> &'static [Coefficient] {
        &[]
    }

    fn evaluate(&self, _at: &At) -> Evaluation {
        Evaluation::default()
    }

    fn weakening(&self, _at: &At) -> f64 {
        0.0
    }

    fn extremes(&self, _coefficients: Coefficients, _node: usize) -> [f64; 2] {
        [0.0; 2]
    }
}
