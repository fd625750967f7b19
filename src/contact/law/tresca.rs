//! A bound that does not depend on the slip rate: `g = bound`. A coefficient of friction that is a number is this law too.

use super::{At, Coefficient, Coefficients, FrictionLaw, Range, Unit};
use crate::contact::evaluation::{Evaluation, NodalLaw, Nodes};

pub struct Tresca;

const BOUND: usize = 0;

impl FrictionLaw for Tresca {
    fn name(&self) -> &'static str {
        "tresca"
    }

    fn text(&self) -> &'static str {
        "Constant bound `g = bound`."
    }

    fn coefficients(&self) -> &'static [Coefficient] {
        const LIST: [Coefficient; 1] = [Coefficient::new(
            "bound",
            Unit::VALUE,
            Range::NOT_NEGATIVE,
            "Value, {}; not negative.",
        )];
        &LIST
    }

    #[inline(always)]
    fn evaluate(&self, at: &At) -> Evaluation {
        constant(at.coefficient(BOUND), at.rate)
    }

    #[inline(always)]
    fn at_rest(&self, at: &At) -> f64 {
        at.coefficient(BOUND)
    }

    fn weakening(&self, _at: &At) -> f64 {
        0.0
    }

    fn extremes(&self, coefficients: Coefficients, node: usize) -> [f64; 2] {
        [coefficients.at(BOUND, node); 2]
    }

    fn fill(&self, coefficients: Coefficients, nodes: Nodes, out: &mut NodalLaw) {
        let bound = coefficients.field(BOUND);
        out.fill(
            nodes,
            #[inline(always)]
            |node, rate, _| constant(bound.at(node), rate),
        );
    }
}

#[inline(always)]
fn constant(bound: f64, rate: f64) -> Evaluation {
    Evaluation {
        bound,
        slope: 0.0,
        potential: bound * rate,
    }
}
