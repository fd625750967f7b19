//! What must hold within one run: the conditions along the normal, the law at every node, the balance of forces and energies.

use super::case::{Case, Condition, Held, Load, Path};
use super::friction::{Coefficient, Friction};
use super::judge::Judge;
use super::run::{Point, Seen};
use crate::judge::TOLERANCES;
use crate::within::length;

impl Judge<'_> {
    pub(crate) fn look_within(&mut self) {
        let base = self.base;
        for (n, point) in base.points.iter().enumerate() {
            for (c, seen) in point.contacts.iter().enumerate() {
                self.check_normal(n, c, seen);
                self.check_friction(n, c, seen);
            }
            self.check_forces(n, point);
        }
        self.check_energies();
    }

    /// Complementarity where contact opens, the law of the foundation where it gives way.
    fn check_normal(&mut self, n: usize, c: usize, seen: &Seen) {
        let case = self.case;
        let scales = self.base.scales();
        let Some(gaps) = &seen.gap else { return };
        let (condition, allowed) = (&case.contacts[c].condition, TOLERANCES * self.tolerance());
        for (node, (&pressure, &gap)) in seen.pressure.iter().zip(gaps).enumerate() {
            let detail = format!(
                "point {n} contact {c} node {node}: pressure {pressure:e}, gap {gap:e}, {}",
                self.base.kind
            );
            match *condition {
                Condition::Bilateral => {}
                Condition::Unilateral(initial) => {
                    self.find("pulling", (-pressure).max(0.0), 0.0, detail.clone());
                    let size = scales
                        .displacement
                        .max(initial.largest())
                        .max(largest_motion(case));
                    self.find(
                        "penetration",
                        (-gap).max(0.0),
                        allowed * size,
                        detail.clone(),
                    );
                    // a share of zero is zero
                    let both = (pressure / scales.stress.max(f64::MIN_POSITIVE))
                        .min(gap.max(0.0) / size.max(f64::MIN_POSITIVE));
                    self.find("complementarity", both, allowed, detail);
                }
                Condition::Compliance {
                    gap: initial,
                    stiffness,
                    exponent,
                } => {
                    let depth = (-gap).max(0.0);
                    let size = scales
                        .displacement
                        .max(initial.largest())
                        .max(largest_motion(case));
                    // the depth is the difference of displacements of that size
                    let lost = stiffness
                        * ((depth + 1e-15 * size).powf(exponent) - depth.powf(exponent)).abs();
                    let error = (pressure - stiffness * depth.powf(exponent)).abs();
                    self.find(
                        "compliance",
                        error,
                        allowed * pressure.abs().max(1e-3 * scales.stress) + 4.0 * lost,
                        detail.clone(),
                    );
                    self.find("pulling", (-pressure).max(0.0), 0.0, detail);
                }
            }
        }
    }

    fn check_friction(&mut self, n: usize, c: usize, seen: &Seen) {
        let friction = &self.case.contacts[c].friction;
        // the bound at the start of a law with a state holds for the state given
        let components = self.base.components;
        let largest_pressure = seen.pressure.iter().fold(0.0, |m: f64, p| m.max(p.abs()));
        let nodes = seen
            .rates
            .chunks(components)
            .zip(seen.stress.chunks(components));
        for (node, (w, stress)) in nodes.enumerate() {
            let (rate, size) = (length(w), length(stress));
            let state = seen.state.as_ref().map_or(0.0, |s| s[node]);
            let pressure = seen.pressure[node];
            let bound = friction.bound(rate, seen.accumulated[node], state, pressure);
            let detail = format!(
                "point {n} contact {c} node {node}: rate {rate:e}, stress {size:e}, bound {bound:e}, pressure {pressure:e}, state {state:e}, {}",
                self.base.kind
            );
            let power: f64 = w.iter().zip(stress).map(|(w, s)| w * s).sum();
            self.find("friction drives", power, 0.0, detail.clone());
            // own bound, down to where the pressure itself is rounding
            let share = friction
                .coefficient()
                .value(rate, seen.accumulated[node], state)
                .abs();
            let least = if matches!(friction, Friction::Bound(_)) {
                0.0
            } else {
                1e-6 * share.min(1.0) * largest_pressure
            };
            let rounding = slack(friction.coefficient(), rate);
            let allowed = (TOLERANCES * self.case.friction_tolerance.max(self.base.floor)
                + rounding)
                * bound.max(least);
            if rate == 0.0 {
                self.find("law of stick", size - bound, allowed, detail);
            } else {
                let excess: Vec<f64> = w
                    .iter()
                    .zip(stress)
                    .map(|(w, s)| s + bound * (w / rate))
                    .collect();
                self.find("law of slip", length(&excess), allowed, detail);
            }
        }
    }

    /// In the plane, where one part holds the body along both axes: all forces add up to nothing, whatever the body is made of.
    fn check_forces(&mut self, n: usize, point: &Point) {
        let case = self.case;
        let Held::Driven { motions, .. } = &case.held else {
            return;
        };
        if case.dimension() != 2 || motions.iter().any(|m| matches!(m.path, Path::Rotation(_))) {
            return;
        }
        let mut terms: Vec<[f64; 2]> = Vec::new();
        for (motion, force) in motions.iter().zip(&point.reactions) {
            if let Path::Translation(direction) = &motion.path {
                terms.push([force * direction[0], force * direction[1]]);
            }
        }
        for (contact, seen) in case.contacts.iter().zip(&point.contacts) {
            let inward = if contact.part == "bottom" { 1.0 } else { -1.0 };
            terms.push([seen.force[0], 0.0]);
            terms.push([0.0, inward * seen.normal_force]);
        }
        for load in &case.loads {
            let force = load_at(case, load, n);
            let size = length(&load.direction);
            terms.push([
                force * load.direction[0] / size,
                force * load.direction[1] / size,
            ]);
        }
        for axis in 0..2 {
            let sum: f64 = terms.iter().map(|term| term[axis]).sum();
            let largest = terms.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
            // where nothing presses, friction is solved to its tolerance of the forces that meet at a node
            let floor = self.tolerance() * self.stress_floor() * case.size[0].max(case.size[1]);
            let allowed = TOLERANCES * self.tolerance() * largest + floor;
            self.find(
                "balance of forces",
                sum.abs(),
                allowed,
                format!("point {n} axis {axis}: {terms:?}, {}", self.base.kind),
            );
        }
    }

    /// Exact for the trapezoid where contact stays closed and keeps its place; backward Euler and midpoint, whose stages are the steps, take
    /// from friction what the law says. The other schemes take the power of friction at two or three instants and weigh it, so that a
    /// step in which a node turns round may give back what the error of the scheme allows.
    fn check_energies(&mut self) {
        let case = self.case;
        let is_linear = !case.is_nonlinear() && !case.holds;
        let is_exact =
            case.scheme == "trapezoid" && is_linear && case.is_bilateral() && !case.approaches();
        let dissipates = case.scheme == "backward_euler" && is_linear && !case.approaches();
        let is_single = matches!(case.scheme, "backward_euler" | "midpoint");
        let mut largest = f64::MIN_POSITIVE;
        let mut spent = 0.0;
        for (n, point) in self.base.points.iter().enumerate() {
            let [external, elastic, viscous, friction, error] = point.energies;
            largest = largest.max(external.abs() + elastic.abs() + viscous.abs() + friction.abs());
            let detail = format!(
                "point {n}: work {external:e}, elastic {elastic:e}, viscous {viscous:e}, friction {friction:e}, error {error:e}, {}",
                self.base.kind
            );
            // the forces of friction are those of balance, which carry its tolerance
            let scales = self.base.scales();
            let area: f64 = case.size.iter().product::<f64>() / case.size[1];
            let force = area * (scales.stress + applied(case) + self.stress_floor());
            let power = force * scales.rate.max(scales.displacement / case.step);
            let duration = case.step * f64::from(case.cuts) * case.count() as f64;
            let allowed =
                TOLERANCES * self.tolerance() * largest + self.tolerance() * power * duration;
            if is_single {
                self.find(
                    "friction gives back",
                    spent - friction,
                    allowed,
                    detail.clone(),
                );
            }
            spent = friction;
            if is_exact {
                self.find("energy", error.abs(), allowed, detail);
            } else if dissipates {
                self.find("energy", -error, allowed, detail);
            }
        }
    }
}

/// Relative error that rounding of the argument makes in the value of a law.
fn slack(coefficient: &Coefficient, rate: f64) -> f64 {
    match coefficient {
        // d ln(bound) from one unit in the last place of the exponent
        Coefficient::Creeping { value, a, b, .. } => 1e-14 * (1.0 + (value + 30.0 * b) / a),
        Coefficient::Stribeck { .. } | Coefficient::Exponential { .. } if rate > 0.0 => 1e-12,
        _ => 0.0,
    }
}

/// Largest stress that the loads apply, Pa.
fn applied(case: &Case) -> f64 {
    let longest = case.size.iter().copied().fold(0.0, f64::max);
    let stress = |load: &Load| {
        load.course.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
            * if load.part.is_some() { 1.0 } else { longest }
    };
    case.loads.iter().map(stress).fold(0.0, f64::max)
}

/// Total force of a load at a point, N per metre of depth.
fn load_at(case: &Case, load: &Load, n: usize) -> f64 {
    let measure = match load.part {
        None => case.size.iter().product(),
        Some("left" | "right") => case.size[1],
        Some(_) => case.size[0],
    };
    load.course[n] * measure
}

/// Largest displacement of a foundation along its normal.
fn largest_motion(case: &Case) -> f64 {
    let motions = case
        .contacts
        .iter()
        .flat_map(|c| &c.foundation)
        .filter(|m| m.path == Path::Approach);
    motions
        .flat_map(|m| &m.course)
        .fold(0.0, |m: f64, x| m.max(x.abs()))
}
