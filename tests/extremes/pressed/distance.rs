//! How far two runs are apart.

use super::run::{Point, Run, Scales, Seen};
use super::units::Units;
use crate::compare::apart;

/// A contact back in the units of the base.
pub fn scaled(seen: &Seen, units: Units) -> Seen {
    let by = |x: &[f64], unit: f64| x.iter().map(|x| x / unit).collect::<Vec<f64>>();
    Seen {
        rates: by(&seen.rates, units.rate()),
        stress: by(&seen.stress, units.traction()),
        pressure: by(&seen.pressure, units.traction()),
        gap: seen.gap.as_ref().map(|gap| by(gap, units.displacement())),
        slip: by(&seen.slip, units.displacement()),
        ..seen.clone()
    }
}

/// Largest differences over the points of both, relative to the largest values of the second, stresses to `floor` at least.
#[derive(Debug, Clone, Copy)]
pub struct Distance {
    rates: f64,
    stress: f64,
    pressure: f64,
    displacement: f64,
}

impl Distance {
    pub fn largest(self) -> f64 {
        self.rates
            .max(self.stress)
            .max(self.pressure)
            .max(self.displacement)
    }
}

pub fn distance(found: &Run, reference: &Run, floor: f64, map: impl Fn(&Seen) -> Seen) -> Distance {
    let Scales {
        rate,
        stress,
        displacement,
    } = reference.scales();
    let stress = stress.max(floor);
    let share = |difference: f64, scale: f64| {
        if difference == 0.0 {
            0.0
        } else {
            difference / scale.max(f64::MIN_POSITIVE)
        }
    };
    let mut d = Distance {
        rates: 0.0,
        stress: 0.0,
        pressure: 0.0,
        displacement: 0.0,
    };
    let contacts = |point: &Point| point.contacts.clone();
    for (a, b) in found
        .points
        .iter()
        .zip(&reference.points)
        .flat_map(|(a, b)| contacts(a).into_iter().zip(contacts(b)))
    {
        let a = map(&a);
        d.rates = d.rates.max(share(apart(&a.rates, &b.rates), rate));
        d.stress = d.stress.max(share(apart(&a.stress, &b.stress), stress));
        d.pressure = d
            .pressure
            .max(share(apart(&a.pressure, &b.pressure), stress));
        d.displacement = d
            .displacement
            .max(share(apart(&a.slip, &b.slip), displacement));
        if let (Some(a), Some(b)) = (&a.gap, &b.gap) {
            d.displacement = d.displacement.max(share(apart(a, b), displacement));
        }
    }
    d
}
