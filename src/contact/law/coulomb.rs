//! Coulomb's law: a bound in proportion to the pressure.
//!
//! ```text
//! g = min(cap, cohesion + mu P)
//! P = max(p, 0), or |p| where tension bounds the friction too;   p the pressure, Pa, > 0 presses
//! ```
//!
//! The coefficient mu of any kind comes from the law of the kind; here are the numbers beside it.

use super::{Coefficient, Coefficients, Field, Omitted, Range, Unit, Value};
use crate::contact::pressed::PressedBound;

pub const DECLARED: [Coefficient; 2] = [
    Coefficient {
        omitted: Omitted::Means(0.0),
        ..Coefficient::new(
            "cohesion",
            Unit::Own("Pa"),
            Range::NOT_NEGATIVE,
            "Bound without pressure, Pa; not negative, default 0.",
        )
    },
    Coefficient {
        omitted: Omitted::Without,
        ..Coefficient::new(
            "cap",
            Unit::Own("Pa"),
            Range::NOT_NEGATIVE,
            "Largest bound under any pressure, Pa; not negative, default none.",
        )
    },
];

/// The numbers of Coulomb's law beside its coefficient, over the contact nodes.
#[derive(Debug, Clone, Copy)]
pub struct Coulomb<'a> {
    /// Whether tension bounds the friction as pressure does.
    pub tension: bool,
    cohesion: Field<'a>,
    cap: Option<Field<'a>>,
}

impl<'a> Coulomb<'a> {
    /// Those whose numbers begin at the place `first` of all coefficients.
    pub fn new(tension: bool, coefficients: Coefficients<'a>, first: usize) -> Coulomb<'a> {
        let has_cap = !coefficients.values(first + 1).is_empty();
        Coulomb {
            tension,
            cohesion: coefficients.field(first),
            cap: has_cap.then(|| coefficients.field(first + 1)),
        }
    }

    /// The bound of a node of this weight, with `pressing` as [`pressing`] gives it and the coefficient there. At a force of 0 and at
    /// the cap the derivatives are those on the side of more pressure.
    pub fn bound(
        &self,
        node: usize,
        weight: f64,
        [pressing, sign]: [f64; 2],
        mu: Value,
    ) -> PressedBound {
        let free = weight * self.cohesion.at(node) + mu.value * pressing;
        let most = self.cap.map_or(f64::INFINITY, |cap| weight * cap.at(node));
        if free >= most {
            return PressedBound {
                bound: most,
                by_rate: 0.0,
                by_force: 0.0,
            };
        }
        PressedBound {
            bound: free,
            by_rate: mu.by_rate * pressing,
            by_force: (mu.value + mu.by_pressure * (pressing / weight)) * sign,
        }
    }
}

/// P times the weight of a node, N, and its derivative by the normal force, N.
pub fn pressing(force: f64, tension: bool) -> [f64; 2] {
    if force >= 0.0 {
        [force, 1.0]
    } else if tension {
        [-force, -1.0]
    } else {
        // NaN stays NaN
        [0.0 * force, 0.0]
    }
}
