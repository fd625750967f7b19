//! A bound from a table: linear between its points, constant before the first and beyond the last one.
//!
//! ```text
//! g(r) = scale * value(r);   L = scale * the steepest fall between two points
//! ```
//!
//! The potential is summed up from rest, exactly: an evaluation takes the longer the more points are below the slip rate.

use super::{
    At, Coefficient, Coefficients, Extent, FrictionLaw, Misfit, Omitted, Range, Unit, Wrong,
};
use crate::contact::evaluation::{Evaluation, NodalLaw, Nodes};
use crate::message::number;

pub struct Table;

const RATE: usize = 0;
const VALUE: usize = 1;
const SCALE: usize = 2;

const fn points(name: &'static str, unit: Unit, text: &'static str) -> Coefficient {
    Coefficient {
        extent: Extent::Points,
        ..Coefficient::new(name, unit, Range::NOT_NEGATIVE, text)
    }
}

const DECLARED: [Coefficient; 3] = [
    points(
        "rate",
        Unit::Own("m/s"),
        "Slip rates of the points, m/s; increasing, not negative.",
    ),
    points(
        "value",
        Unit::VALUE,
        "Values at the points, {}; not negative, as many as rates.",
    ),
    Coefficient {
        omitted: Omitted::Means(1.0),
        ..Coefficient::new(
            "scale",
            Unit::Own("1"),
            Range::NOT_NEGATIVE,
            "Factor of the values; not negative, default 1.",
        )
    },
];

impl FrictionLaw for Table {
    fn name(&self) -> &'static str {
        "table"
    }

    fn text(&self) -> &'static str {
        "Linear between the points (`rate`, `value`), constant outside them, times `scale`."
    }

    fn coefficients(&self) -> &'static [Coefficient] {
        &DECLARED
    }

    fn check(&self, coefficients: Coefficients) -> Result<(), Misfit> {
        let (rates, values) = (coefficients.values(RATE), coefficients.values(VALUE));
        if rates.len() != values.len() {
            return Err(Misfit {
                coefficient: VALUE,
                wrong: Wrong::Count,
                found: values.len() as f64,
                rule: "as many values as rates",
                allowed: format!("as many as rates: {}", rates.len()),
                beside: None,
            });
        }
        let falls = rates.windows(2).position(|pair| pair[1] <= pair[0]);
        match falls {
            None => Ok(()),
            Some(before) => Err(Misfit {
                coefficient: RATE,
                wrong: Wrong::Entry(before + 1),
                found: rates[before + 1],
                rule: "rates that increase",
                allowed: format!("rates that increase: more than {}", number(rates[before])),
                beside: None,
            }),
        }
    }

    fn evaluate(&self, at: &At) -> Evaluation {
        let (rates, values) = (at.coefficients.values(RATE), at.coefficients.values(VALUE));
        look_up(rates, values, at.coefficient(SCALE), at.rate)
    }

    fn weakening(&self, coefficients: Coefficients, node: usize) -> f64 {
        let (rates, values) = (coefficients.values(RATE), coefficients.values(VALUE));
        let pieces = rates.windows(2).zip(values.windows(2));
        let falls = pieces.map(|(r, v)| (v[0] - v[1]) / (r[1] - r[0]));
        coefficients.at(SCALE, node) * falls.fold(0.0, f64::max)
    }

    fn extremes(&self, coefficients: Coefficients, node: usize) -> [f64; 2] {
        let (values, scale) = (
            coefficients.values(VALUE).iter(),
            coefficients.at(SCALE, node),
        );
        let largest = values.clone().fold(0.0, |most: f64, v| most.max(*v));
        [
            scale * largest,
            scale * values.fold(f64::INFINITY, |least, v| least.min(*v)),
        ]
    }

    fn fill(&self, coefficients: Coefficients, nodes: Nodes, out: &mut NodalLaw) {
        let (rates, values) = (coefficients.values(RATE), coefficients.values(VALUE));
        let scale = coefficients.field(SCALE);
        out.fill(nodes, |node, rate, _| {
            look_up(rates, values, scale.at(node), rate)
        });
    }
}

fn look_up(rates: &[f64], values: &[f64], scale: f64, rate: f64) -> Evaluation {
    let scaled = |bound: f64, slope: f64, potential: f64| Evaluation {
        bound: scale * bound,
        slope: scale * slope,
        potential: scale * potential,
    };
    let (mut from, mut value, mut potential) = (0.0, values[0], 0.0);
    for (&to, &next) in rates.iter().zip(values) {
        let length = to - from;
        if rate < to {
            let way = rate - from;
            let share = way / length;
            // never below the lower end
            let bound = (1.0 - share) * value + share * next;
            let piece = way * (0.5 * (value + bound));
            return scaled(bound, (next - value) / length, potential + piece);
        }
        potential += length * (0.5 * (value + next));
        (from, value) = (to, next);
    }
    scaled(value, 0.0, potential + (rate - from) * value)
}
