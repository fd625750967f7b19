//! A bound that decays with the slip rate: `g(r) = (a - b) exp(-alpha r) + b`, `a >= b` (7.14).
//!
//! Scenes write it as the paper does, or as a kind of a bound or of a coefficient with other names of the same numbers.

use super::{At, Coefficient, Coefficients, FrictionLaw, Misfit, Range, Unit};
use crate::contact::evaluation::{Evaluation, NodalLaw, Nodes};
use crate::linalg::exp_m1_and_exp;

pub struct Exponential {
    name: &'static str,
    text: &'static str,
    declared: &'static [Coefficient; 3],
    rule: &'static str,
}

const fn not_negative(name: &'static str, unit: Unit, text: &'static str) -> Coefficient {
    Coefficient::new(name, unit, Range::NOT_NEGATIVE, text)
}

pub static OF_THE_PAPER: Exponential = Exponential {
    name: "exponential",
    text: "`g(r) = (a - b) exp(-alpha r) + b`.",
    declared: &[
        not_negative("a", Unit::VALUE, "Static bound, Pa; `a >= b`."),
        not_negative("b", Unit::VALUE, "Kinetic bound, Pa; not negative."),
        not_negative("alpha", Unit::Own("s/m"), "Decay, s/m; not negative."),
    ],
    rule: "a >= b",
};

pub static KIND: Exponential = Exponential {
    name: "exponential",
    text: "`(static - kinetic) exp(-decay r) + kinetic`.",
    declared: &[
        not_negative(
            "static",
            Unit::VALUE,
            "Value at rest, {}; `static >= kinetic`.",
        ),
        not_negative(
            "kinetic",
            Unit::VALUE,
            "Value at fast slip, {}; not negative.",
        ),
        not_negative(
            "decay",
            Unit::Own("s/m"),
            "Decay with the slip rate, s/m; not negative.",
        ),
    ],
    rule: "static >= kinetic",
};

const A: usize = 0;
const B: usize = 1;
const ALPHA: usize = 2;

impl FrictionLaw for Exponential {
    fn name(&self) -> &'static str {
        self.name
    }

    fn text(&self) -> &'static str {
        self.text
    }

    fn coefficients(&self) -> &'static [Coefficient] {
        self.declared
    }

    fn check(&self, coefficients: Coefficients) -> Result<(), Misfit> {
        coefficients.at_least(A, B, self.rule)
    }

    #[inline(always)]
    fn evaluate(&self, at: &At) -> Evaluation {
        let [a, b, alpha] = [A, B, ALPHA].map(|i| at.coefficient(i));
        if alpha > 0.0 {
            decaying(a, b, alpha, at.rate)
        } else {
            constant(a, b, at.rate)
        }
    }

    #[inline(always)]
    fn at_rest(&self, at: &At) -> f64 {
        at.coefficient(A)
    }

    fn weakening(&self, at: &At) -> f64 {
        let [a, b, alpha] = [A, B, ALPHA].map(|i| at.coefficient(i));
        (a - b) * alpha
    }

    fn extremes(&self, coefficients: Coefficients, node: usize) -> [f64; 2] {
        [coefficients.at(A, node), coefficients.at(B, node)]
    }

    fn fill(&self, coefficients: Coefficients, nodes: Nodes, out: &mut NodalLaw) {
        let [a, b, alpha] = [A, B, ALPHA].map(|i| coefficients.field(i));
        if coefficients.is_uniform() && alpha.at(0) > 0.0 {
            let (a, b, alpha) = (a.at(0), b.at(0), alpha.at(0));
            return out.fill(
                nodes,
                #[inline(always)]
                |_, rate, _| decaying(a, b, alpha, rate),
            );
        }
        out.fill(
            nodes,
            #[inline(always)]
            |node, rate, _| {
                let (a, b, alpha) = (a.at(node), b.at(node), alpha.at(node));
                if alpha > 0.0 {
                    decaying(a, b, alpha, rate)
                } else {
                    constant(a, b, rate)
                }
            },
        );
    }
}

/// Share of the static bound below which `a + (a - b) expm1` has lost digits of the bound.
const SMALL_SHARE: f64 = 1.0 / 1024.0;

/// The law for `alpha > 0`: one exponential serves bound, slope and potential. A bound that has decayed far below the static one
/// keeps its digits: it is then summed from its kinetic end.
#[inline(always)]
fn decaying(a: f64, b: f64, alpha: f64, rate: f64) -> Evaluation {
    let [decay, left] = exp_m1_and_exp(-alpha * rate);
    let from_rest = a + (a - b) * decay;
    let is_small = from_rest < SMALL_SHARE * a;
    Evaluation {
        bound: if is_small {
            b + (a - b) * left
        } else {
            from_rest
        },
        slope: -alpha * (a - b) * if is_small { left } else { 1.0 + decay },
        potential: b * rate - (a - b) / alpha * decay,
    }
}

/// The law for `alpha = 0`.
#[inline(always)]
fn constant(a: f64, b: f64, rate: f64) -> Evaluation {
    Evaluation {
        bound: a,
        slope: -0.0 * (a - b),
        potential: a * rate,
    }
}
