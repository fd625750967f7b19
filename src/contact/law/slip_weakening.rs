//! A value that falls with the accumulated slip, linearly over a distance:
//!
//! ```text
//! g(s) = dynamic + (static - dynamic) max(0, 1 - s / distance)
//! L    = per_rate (static - dynamic) / distance, where s grows by per_rate times the slip rate in a stage
//! ```
//!
//! So L vanishes with the step. A dynamic value above the static one makes slip stronger, with `L = 0`.

use super::{At, Coefficient, Coefficients, FrictionLaw, Range, Unit};
use crate::contact::evaluation::{Evaluation, SlipPath};

pub struct SlipWeakening;

const STATIC: usize = 0;
const DYNAMIC: usize = 1;
const DISTANCE: usize = 2;

const DECLARED: [Coefficient; 3] = [
    Coefficient::new(
        "static",
        Unit::VALUE,
        Range::NOT_NEGATIVE,
        "Value before any slip, {}; not negative.",
    ),
    Coefficient::new(
        "dynamic",
        Unit::VALUE,
        Range::NOT_NEGATIVE,
        "Value after the slip `distance`, {}; not negative.",
    ),
    Coefficient::new(
        "distance",
        Unit::Own("m"),
        Range::POSITIVE,
        "Accumulated slip over which the value changes, m; positive.",
    ),
];

impl FrictionLaw for SlipWeakening {
    fn name(&self) -> &'static str {
        "slip_weakening"
    }

    fn text(&self) -> &'static str {
        "`dynamic + (static - dynamic) max(0, 1 - s / distance)`, s the accumulated slip (m)."
    }

    fn coefficients(&self) -> &'static [Coefficient] {
        &DECLARED
    }

    fn depends_on_slip(&self, _coefficients: Coefficients) -> bool {
        true
    }

    fn evaluate(&self, at: &At) -> Evaluation {
        Node::at(&at.coefficients, at.node).along(at.slip, at.rate)
    }

    fn slip_slope(&self, at: &At) -> f64 {
        let node = Node::at(&at.coefficients, at.node);
        node.slope(at.slip.base + at.slip.per_rate * at.rate)
    }

    fn weakening(&self, at: &At) -> f64 {
        let node = Node::at(&at.coefficients, at.node);
        (-node.slope(0.0) * at.slip.per_rate).max(0.0)
    }

    fn extremes(&self, coefficients: Coefficients, node: usize) -> [f64; 2] {
        let node = Node::at(&coefficients, node);
        [
            node.at_start.max(node.dynamic),
            node.at_start.min(node.dynamic),
        ]
    }
}

/// The coefficients of a node.
#[derive(Debug, Clone, Copy)]
struct Node {
    at_start: f64,
    dynamic: f64,
    distance: f64,
}

impl Node {
    fn at(coefficients: &Coefficients, node: usize) -> Node {
        let [at_start, dynamic, distance] =
            [STATIC, DYNAMIC, DISTANCE].map(|i| coefficients.at(i, node));
        Node {
            at_start,
            dynamic,
            distance,
        }
    }

    /// From the nearer end, which keeps the digits of either.
    fn value(&self, slip: f64) -> f64 {
        let share = slip / self.distance;
        if share >= 1.0 {
            self.dynamic
        } else if share < 0.5 {
            self.at_start + (self.dynamic - self.at_start) * share
        } else {
            self.dynamic + (self.at_start - self.dynamic) * (1.0 - share)
        }
    }

    /// By the slip.
    fn slope(&self, slip: f64) -> f64 {
        if slip < self.distance {
            (self.dynamic - self.at_start) / self.distance
        } else {
            0.0
        }
    }

    fn along(&self, path: SlipPath, rate: f64) -> Evaluation {
        let slip = path.base + path.per_rate * rate;
        let bound = self.value(slip);
        // trapezoids are exact on straight pieces
        let falling = if slip <= self.distance {
            rate
        } else {
            ((self.distance - path.base).max(0.0) / path.per_rate).min(rate)
        };
        let end = if falling < rate { self.dynamic } else { bound };
        let first = falling * (0.5 * (self.value(path.base) + end));
        Evaluation {
            bound,
            slope: self.slope(slip) * path.per_rate,
            potential: first + (rate - falling) * self.dynamic,
        }
    }
}
