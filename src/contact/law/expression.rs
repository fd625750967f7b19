//! A value that a scene writes out as a formula of slip rate, accumulated slip, pressure and place (`formula`), with exact
//! derivatives. It has no potential. L is the steepest fall among samples: close to the largest one of a smooth curve, but no bound.
//!
//! A value below zero or not finite is refused when the scene is compiled where samples of the slip rate find it. Elsewhere a value
//! below zero is cut at zero on a solver's way, and a solution that lies there is refused: the step fails, and the state is as it
//! was. One that is not finite fails as forces that overflow.

use super::formula::Formula;
use super::{At, Coefficient, Coefficients, Extent, FrictionLaw, Range, Unit, Value};
use crate::contact::evaluation::Evaluation;

pub struct Expression;

impl FrictionLaw for Expression {
    fn name(&self) -> &'static str {
        "expression"
    }

    fn text(&self) -> &'static str {
        "A formula of slip rate, accumulated slip, pressure and place."
    }

    fn coefficients(&self) -> &'static [Coefficient] {
        const LIST: [Coefficient; 1] = [Coefficient {
            extent: Extent::Formula,
            ..Coefficient::new(
                "formula",
                Unit::VALUE,
                Range::NOT_NEGATIVE,
                "Value, {}, not negative: a formula of r (slip rate, m/s), s (accumulated slip, m), p (pressure, Pa, >= 0), x, y, z (m), \
                 e.g. `0.3 + 0.2 * exp(-r / 0.01)`.",
            )
        }];
        &LIST
    }

    fn has_potential(&self) -> bool {
        false
    }

    fn depends_on_slip(&self, coefficients: Coefficients) -> bool {
        coefficients.formula().is_some_and(Formula::uses_slip)
    }

    fn evaluate(&self, at: &At) -> Evaluation {
        let Value { value, by_rate, .. } = self.value(at);
        Evaluation {
            bound: value,
            slope: by_rate,
            potential: f64::NAN,
        }
    }

    fn value(&self, at: &At) -> Value {
        let slip = at.slip.base + at.slip.per_rate * at.rate;
        let Some(formula) = at.coefficients.formula() else {
            return Value::new(f64::NAN, f64::NAN);
        };
        let said = formula.at(at.node, at.rate, slip, at.pressure);
        let [by_rate, by_slip, by_pressure] = said.slopes;
        Value {
            value: said.value,
            by_rate: by_rate + at.slip.per_rate * by_slip,
            by_pressure,
        }
    }

    fn fault(&self, at: &At) -> Option<f64> {
        let slip = at.slip.base + at.slip.per_rate * at.rate;
        let formula = at.coefficients.formula()?;
        formula.fault(at.node, at.rate, slip, at.pressure)
    }

    fn slip_slope(&self, at: &At) -> f64 {
        let slip = at.slip.base + at.slip.per_rate * at.rate;
        let formula = at.coefficients.formula();
        formula.map_or(f64::NAN, |formula| {
            formula.at(at.node, at.rate, slip, at.pressure).slopes[1]
        })
    }

    fn weakening(&self, at: &At) -> f64 {
        let formula = at.coefficients.formula();
        formula.map_or(f64::NAN, |formula| {
            let [by_rate, by_slip] = formula.curve(at.node).falls;
            by_rate + at.slip.per_rate * by_slip
        })
    }

    fn extremes(&self, coefficients: Coefficients, node: usize) -> [f64; 2] {
        let formula = coefficients.formula();
        formula.map_or([f64::NAN; 2], |formula| formula.curve(node).extremes)
    }
}
