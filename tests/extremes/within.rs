//! Oracles within one run: the law at every node, and the balance of energies.

use crate::case::{Case, Load};
use crate::judge::{Judge, TOLERANCES};
use crate::run::Point;

impl Judge<'_> {
    pub(crate) fn look_within(&mut self) {
        let base = self.base;
        self.find_faults("base", base);
        // a velocity that is set to zero knows no law
        let given = usize::from(self.case.start == "zero");
        for (n, point) in base.points.iter().enumerate().skip(given) {
            self.check_law(n, point);
        }
        self.check_energies();
    }

    /// Stick: at most the bound at rest. Slip: the bound at the slip rate, against it. Both relative to the node's own bound.
    fn check_law(&mut self, n: usize, point: &Point) {
        let c = self.base.components;
        let allowed = TOLERANCES * self.case.friction_tolerance;
        for (node, (w, stress)) in point
            .rates
            .chunks(c)
            .zip(point.stress.chunks(c))
            .enumerate()
        {
            let (rate, size) = (length(w), length(stress));
            let bound = self.case.law.bound(rate);
            let detail =
                format!("point {n} node {node}: rate {rate:e}, stress {size:e}, bound {bound:e}");
            let (oracle, violated) = if rate == 0.0 {
                ("law of stick", (size - bound).max(0.0))
            } else {
                let excess: Vec<f64> = w
                    .iter()
                    .zip(stress)
                    .map(|(w, s)| s + bound * (w / rate))
                    .collect();
                ("law of slip", length(&excess))
            };
            let error = if violated == 0.0 {
                0.0
            } else {
                // numbers that small have no digits of their own
                violated / bound.max(1e-300 * self.case.law.bound(0.0))
            };
            self.find(oracle, error, allowed, detail);
        }
    }

    /// Exact for the trapezoid from a consistent start; backward Euler only dissipates.
    fn check_energies(&mut self) {
        let is_exact = self.case.scheme == "trapezoid" && self.case.start == "consistent";
        if !is_exact && self.case.scheme != "backward_euler" {
            return;
        }
        let mut largest = rounding_of_energies(self.case).max(f64::MIN_POSITIVE);
        for (n, point) in self.base.points.iter().enumerate() {
            let [external, elastic, viscous, friction, error] = point.energies;
            largest = largest.max(external.abs() + elastic.abs() + viscous.abs() + friction.abs());
            let violated = if is_exact {
                error.abs()
            } else {
                (-error).max(0.0)
            };
            let detail = format!(
                "point {n}: work {external:e}, elastic {elastic:e}, viscous {viscous:e}, friction {friction:e}, {}",
                self.base.kind
            );
            self.find(
                "energy",
                violated / largest,
                TOLERANCES * self.tolerance(),
                detail,
            );
        }
    }
}

/// Energies below this, J, are rounding of what the loads could do: where everything sticks there is nothing else.
fn rounding_of_energies(case: &Case) -> f64 {
    let longest = case.size.iter().copied().fold(0.0, f64::max);
    let traction = |load: &Load| {
        let largest = load.course.iter().fold(0f64, |m, x| m.max(x.abs()));
        largest * if load.part.is_some() { 1.0 } else { longest }
    };
    let stress = case.loads.iter().map(traction).fold(0.0, f64::max);
    let volume: f64 = case.size.iter().product();
    let time = case.step * f64::from(case.cuts) * case.count() as f64;
    1e-9 * stress * stress * volume * (time / case.mu2).min(1.0 / case.young)
}

/// Euclidean norm of a nodal vector.
pub fn length(x: &[f64]) -> f64 {
    match x {
        [a] => a.abs(),
        [a, b] => a.hypot(*b),
        _ => x.iter().map(|v| v * v).sum::<f64>().sqrt(),
    }
}
