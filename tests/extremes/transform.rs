//! Oracles between two runs: other units, flipped loads, the mirror, splitting, superposition, other models.

use crate::case::{Law, Units};
use crate::compare::{apart, distance};
use crate::judge::{Judge, SAME, TOLERANCES};
use crate::run::{Point, Run, run};

/// Powers of two of force, time and length. Even ones: the factors of the Cholesky decomposition hold square roots of the
/// pivots, and only powers of four keep the bits of those.
const UNITS: [(&str, [i32; 3]); 3] = [
    ("unit of force", [10, 0, 0]),
    ("unit of time", [0, -8, 0]),
    ("unit of length", [0, 0, 6]),
];

impl Judge<'_> {
    pub(crate) fn transform(&mut self) {
        for (oracle, powers) in UNITS {
            self.change_units(oracle, powers);
        }
        self.flip_loads();
        self.mirror();
        self.split();
        self.superpose();
    }

    /// The same numbers to the last bit: the discrete problem knows no units.
    fn change_units(&mut self, oracle: &'static str, powers: [i32; 3]) {
        let units = Units::of_powers(powers[0], powers[1], powers[2]);
        let other = run(&units.apply(self.case));
        self.find_other_end(oracle, &other);
        let d = distance(&other, self.base, |p| Point {
            rates: p.rates.iter().map(|x| x / units.rate()).collect(),
            stress: p.stress.iter().map(|x| x / units.stress).collect(),
            ..p.clone()
        });
        self.find(
            oracle,
            d.largest(),
            SAME,
            format!("{d}, {}", self.base.kind),
        );
        let energies = units.energy(self.case.dimension());
        for (n, (a, b)) in other.points.iter().zip(&self.base.points).enumerate() {
            let scale = b
                .energies
                .iter()
                .fold(f64::MIN_POSITIVE, |m, e| m.max(e.abs()));
            let error = apart(&a.energies.map(|e| e / energies), &b.energies) / scale;
            self.find(
                oracle,
                error,
                SAME,
                format!("energies of point {n}: {:?}", b.energies),
            );
        }
    }

    fn flip_loads(&mut self) {
        let other = run(&self.case.loaded(-1.0));
        self.find_other_end("flipped loads", &other);
        let negative = |x: &[f64]| x.iter().map(|x| -x).collect::<Vec<f64>>();
        let d = distance(&other, self.base, |p| Point {
            rates: negative(&p.rates),
            stress: negative(&p.stress),
            ..p.clone()
        });
        self.find(
            "flipped loads",
            d.largest(),
            SAME,
            format!("{d}, {}", self.base.kind),
        );
    }

    /// In the plane: the tetrahedra of a box are not their own mirror image.
    fn mirror(&mut self) {
        if self.case.dimension() == 3 {
            return;
        }
        let other = run(&self.case.mirrored());
        self.find_faults("mirror", &other);
        let turned = |x: &[f64]| x.iter().rev().map(|x| -x).collect::<Vec<f64>>();
        let d = distance(&other, self.base, |p| Point {
            rates: turned(&p.rates),
            stress: turned(&p.stress),
            ..p.clone()
        });
        self.find_apart("mirror", d, &other);
    }

    /// n internal steps in one communication step or in n.
    fn split(&mut self) {
        if self.case.cuts == 1 {
            return;
        }
        let mut other = run(&self.case.split());
        self.find_faults("splitting", &other);
        let cuts = self.case.cuts as usize;
        other.points = other.points.into_iter().step_by(cuts).collect();
        let d = distance(&other, self.base, Point::clone);
        self.find_apart("splitting", d, &other);
    }

    /// Without friction the body is linear.
    fn superpose(&mut self) {
        let case = self.case;
        if case.law != Law::Frictionless || case.loads.len() < 2 {
            return;
        }
        let parts: Vec<Run> = (0..case.loads.len())
            .map(|i| run(&case.with_load_alone(i)))
            .collect();
        if parts
            .iter()
            .any(|part| part.points.len() != self.base.points.len())
        {
            return;
        }
        let mut sum = parts[0].clone();
        for part in &parts[1..] {
            for (total, point) in sum.points.iter_mut().zip(&part.points) {
                total
                    .rates
                    .iter_mut()
                    .zip(&point.rates)
                    .for_each(|(a, b)| *a += b);
            }
        }
        let d = distance(&sum, self.base, Point::clone);
        // the parts may cancel: relative to the larger of them
        let largest = parts.iter().map(|part| part.scales().0).fold(0.0, f64::max);
        let share = if largest > 0.0 {
            (self.base.scales().0 / largest).min(1.0)
        } else {
            1.0
        };
        self.find(
            "superposition",
            d.rates * share,
            TOLERANCES * self.tolerance(),
            self.base.kind.clone(),
        );
    }

    /// Whatever is kept of the body, the answer is the same.
    pub(crate) fn compare_models(&mut self) {
        for model in ["full", "condensed", "reduced"] {
            if model == self.base.kind {
                continue;
            }
            let other = run(&self.case.with_model(model));
            self.find_faults(model, &other);
            let d = distance(&other, self.base, Point::clone);
            self.find_apart("other model", d, &other);
        }
    }
}
