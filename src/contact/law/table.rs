//! A bound from a table: linear between its points, constant before the first and beyond the last one.
//!
//! ```text
//! g(r) = scale * value(r);   L = scale * the steepest fall between two points
//! ```
//!
//! With `slip`, a table over slip rate and accumulated slip, linear along both (`surface`).
//!
//! The potential is summed up from rest, exactly: an evaluation takes the longer the more points are below the slip rate.

use super::surface::Surface;
use super::{
    At, Coefficient, Coefficients, Extent, FrictionLaw, Misfit, Omitted, Range, Unit, Value, Wrong,
};
use crate::contact::evaluation::{Evaluation, NodalLaw, Nodes};
use crate::message::number;

pub struct Table;

const RATE: usize = 0;
const VALUE: usize = 1;
const SCALE: usize = 2;
const SLIP: usize = 3;

const fn points(name: &'static str, unit: Unit, text: &'static str) -> Coefficient {
    Coefficient {
        extent: Extent::Points,
        ..Coefficient::new(name, unit, Range::NOT_NEGATIVE, text)
    }
}

const DECLARED: [Coefficient; 4] = [
    points(
        "rate",
        Unit::Own("m/s"),
        "Slip rates of the points, m/s; increasing, not negative.",
    ),
    Coefficient {
        extent: Extent::Grid,
        ..Coefficient::new(
            "value",
            Unit::VALUE,
            Range::NOT_NEGATIVE,
            "Values at the points, {}; not negative, as many as rates, or with `slip` a row per rate with as many numbers as slips.",
        )
    },
    Coefficient {
        omitted: Omitted::Means(1.0),
        ..Coefficient::new(
            "scale",
            Unit::Own("1"),
            Range::NOT_NEGATIVE,
            "Factor of the values; not negative, default 1.",
        )
    },
    Coefficient {
        omitted: Omitted::Without,
        ..points(
            "slip",
            Unit::Own("m"),
            "Accumulated slips of the points, m; increasing, not negative, default: the values depend on the rate alone.",
        )
    },
];

impl FrictionLaw for Table {
    fn name(&self) -> &'static str {
        "table"
    }

    fn text(&self) -> &'static str {
        "Linear between the points (`rate`, `value`), or (`rate`, `slip`, `value`), constant outside them, times `scale`."
    }

    fn coefficients(&self) -> &'static [Coefficient] {
        &DECLARED
    }

    fn check(&self, coefficients: Coefficients) -> Result<(), Misfit> {
        let (rates, slips) = (coefficients.values(RATE), coefficients.values(SLIP));
        let wrong = |wrong, found: usize, allowed| Misfit {
            coefficient: VALUE,
            wrong,
            found: found as f64,
            rule: "as many values as rates",
            allowed,
            beside: None,
            words: None,
        };
        let place = coefficients.place(VALUE);
        match (slips.len(), place.columns) {
            (0, None) if place.len != rates.len() => {
                let allowed = format!("as many as rates: {}", rates.len());
                return Err(wrong(Wrong::Count, place.len, allowed));
            }
            (0, Some(columns)) => {
                let allowed = "a list of numbers without slip".to_owned();
                return Err(wrong(Wrong::Rows, place.len / columns, allowed));
            }
            (1.., None) => {
                let allowed = "rows of numbers beside slip".to_owned();
                return Err(wrong(Wrong::Count, place.len, allowed));
            }
            (slips, Some(columns)) if slips != columns => {
                let allowed = format!("as many as slips: {slips}");
                return Err(wrong(Wrong::Row(0), columns, allowed));
            }
            (_, Some(columns)) if place.len / columns != rates.len() => {
                let allowed = format!("as many as rates: {}", rates.len());
                return Err(wrong(Wrong::Rows, place.len / columns, allowed));
            }
            _ => {}
        }
        increasing(RATE, rates, "rates that increase")?;
        increasing(SLIP, slips, "slips that increase")
    }

    fn depends_on_slip(&self, coefficients: Coefficients) -> bool {
        !coefficients.values(SLIP).is_empty()
    }

    fn evaluate(&self, at: &At) -> Evaluation {
        let scale = at.coefficient(SCALE);
        match Surface::of(at.coefficients) {
            Some(surface) => scaled(scale, surface.along(at.slip, at.rate)),
            None => {
                let (rates, values) = (at.coefficients.values(RATE), at.coefficients.values(VALUE));
                look_up(rates, values, scale, at.rate)
            }
        }
    }

    fn value(&self, at: &At) -> Value {
        match Surface::of(at.coefficients) {
            Some(surface) => {
                let slip = at.slip.base + at.slip.per_rate * at.rate;
                let [value, by_rate, by_slip] = surface
                    .derivatives(at.rate, slip)
                    .map(|x| x * at.coefficient(SCALE));
                Value::new(value, by_rate + at.slip.per_rate * by_slip)
            }
            None => {
                let all = self.evaluate(at);
                Value::new(all.bound, all.slope)
            }
        }
    }

    fn at_rest(&self, at: &At) -> f64 {
        self.value(&At { rate: 0.0, ..*at }).value
    }

    fn slip_slope(&self, at: &At) -> f64 {
        Surface::of(at.coefficients).map_or(0.0, |surface| {
            let slip = at.slip.base + at.slip.per_rate * at.rate;
            at.coefficient(SCALE) * surface.derivatives(at.rate, slip)[2]
        })
    }

    fn weakening(&self, at: &At) -> f64 {
        let coefficients = at.coefficients;
        if let Some(surface) = Surface::of(coefficients) {
            return at.coefficient(SCALE) * surface.steepest_fall(at.slip.per_rate);
        }
        let (rates, values) = (coefficients.values(RATE), coefficients.values(VALUE));
        let pieces = rates.windows(2).zip(values.windows(2));
        let falls = pieces.map(|(r, v)| (v[0] - v[1]) / (r[1] - r[0]));
        at.coefficient(SCALE) * falls.fold(0.0, f64::max)
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
        let scale = coefficients.field(SCALE);
        if let Some(surface) = Surface::of(coefficients) {
            return out.fill(nodes, |node, rate, slip| {
                scaled(scale.at(node), surface.along(slip, rate))
            });
        }
        let (rates, values) = (coefficients.values(RATE), coefficients.values(VALUE));
        out.fill(nodes, |node, rate, _| {
            look_up(rates, values, scale.at(node), rate)
        });
    }
}

impl<'a> Surface<'a> {
    /// `None` for a table over the slip rate alone.
    fn of(coefficients: Coefficients<'a>) -> Option<Surface<'a>> {
        let slips = coefficients.values(SLIP);
        (!slips.is_empty()).then(|| Surface {
            rates: coefficients.values(RATE),
            slips,
            values: coefficients.values(VALUE),
        })
    }
}

fn increasing(coefficient: usize, points: &[f64], rule: &'static str) -> Result<(), Misfit> {
    let falls = points.windows(2).position(|pair| pair[1] <= pair[0]);
    match falls {
        None => Ok(()),
        Some(before) => Err(Misfit {
            coefficient,
            wrong: Wrong::Entry(before + 1),
            found: points[before + 1],
            rule,
            allowed: format!("{rule}: more than {}", number(points[before])),
            beside: None,
            words: None,
        }),
    }
}

fn scaled(scale: f64, one: Evaluation) -> Evaluation {
    Evaluation {
        bound: scale * one.bound,
        slope: scale * one.slope,
        potential: scale * one.potential,
    }
}

fn look_up(rates: &[f64], values: &[f64], scale: f64, rate: f64) -> Evaluation {
    let scaled = |bound, slope, potential| {
        let one = Evaluation {
            bound,
            slope,
            potential,
        };
        scaled(scale, one)
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
