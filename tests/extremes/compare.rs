//! How far two runs are apart.

use crate::case::Case;
use crate::run::{Point, Run, run};
use std::fmt;

/// Largest differences over the points that both runs have, relative to the largest values of the second.
#[derive(Debug, Clone, Copy)]
pub struct Distance {
    pub rates: f64,
    pub stress: f64,
}

impl Distance {
    pub fn largest(self) -> f64 {
        self.rates.max(self.stress)
    }
}

impl fmt::Display for Distance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "slip rates {:.1e}, stress {:.1e}",
            self.rates, self.stress
        )
    }
}

/// Relative size of the change of the loads whose effect is the sensitivity of a case.
const NUDGE: f64 = 1.0 / (1u64 << 30) as f64;

/// `found` against `reference`, after `map` has turned a point of `found` into what the reference should say.
pub fn distance(found: &Run, reference: &Run, map: impl Fn(&Point) -> Point) -> Distance {
    let (rate, stress) = reference.scales();
    let mut out = Distance {
        rates: 0.0,
        stress: 0.0,
    };
    for (a, b) in found.points.iter().zip(&reference.points) {
        let a = map(a);
        out.rates = out.rates.max(apart(&a.rates, &b.rates) / scale(rate));
        out.stress = out.stress.max(apart(&a.stress, &b.stress) / scale(stress));
    }
    out
}

fn scale(largest: f64) -> f64 {
    if largest == 0.0 { 1.0 } else { largest }
}

/// Largest difference; infinite where a number is none.
pub fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let difference = |(a, b): (&f64, &f64)| if a == b { 0.0 } else { (a - b).abs() };
    let all = a.iter().zip(b).map(difference);
    all.fold(
        0.0,
        |m: f64, d| if d.is_nan() { f64::INFINITY } else { m.max(d) },
    )
}

/// By how much a relative change of the loads is multiplied in the answer: 1 for a linear body, large where a node is about
/// to slip or a step has several solutions.
pub fn sensitivity(case: &Case, base: &Run) -> f64 {
    let nudged = run(&case.loaded(1.0 + NUDGE));
    if nudged.points.len() != base.points.len() {
        return f64::INFINITY;
    }
    (distance(&nudged, base, Point::clone).largest() / NUDGE).max(1.0)
}
