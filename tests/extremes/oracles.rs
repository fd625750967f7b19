//! Oracles that need no reference solution: what must hold between two runs, and within one.

use crate::case::{Case, Law, Units};
use crate::compare::{Distance, distance, sensitivity};
use crate::exact::{NotSolved, solve_exactly};
use crate::run::{Point, Run, run};

/// A statement that does not hold.
#[derive(Debug, Clone)]
pub struct Finding {
    pub oracle: &'static str,
    pub error: f64,
    pub allowed: f64,
    pub detail: String,
}

/// Beyond this a case is too close to a change of its pattern of stick for runs that differ by rounding to be compared.
pub const MOST_SENSITIVE: f64 = 1e3;

/// Relative error of the slip rate that the tolerance of the friction solver allows, beyond which nothing is judged.
const WORST_JUDGED: f64 = 1e-2;

/// Factor between a tolerance and what counts as wrong.
const TOLERANCES: f64 = 10.0;

/// Relative difference that counts as the same bits.
const SAME: f64 = 1e-12;

/// What is found about one case.
#[derive(Debug, Default)]
pub struct Judge {
    pub findings: Vec<Finding>,
    /// What became of the comparison with the solution in 96 digits.
    pub exact: Option<Result<(), NotSolved>>,
    /// Comparisons that were skipped because the case is too sensitive.
    pub sensitive: usize,
    sensitivity: Option<f64>,
}

impl Judge {
    /// All oracles on a case and its run.
    pub fn judge(case: &Case, base: &Run) -> Judge {
        let mut judge = Judge::default();
        judge.within(case, base);
        judge.other_units(case, base);
        judge.flipped_loads(case, base);
        judge.mirror(case, base);
        judge.splitting(case, base);
        judge.superposition(case, base);
        judge.other_models(case, base);
        judge.exact(case, base);
        judge
    }

    fn add(&mut self, oracle: &'static str, error: f64, allowed: f64, detail: String) {
        if !(error <= allowed) {
            self.findings.push(Finding {
                oracle,
                error,
                allowed,
                detail,
            });
        }
    }

    /// A difference that only rounding and the tolerances of the solver may make.
    fn add_inexact(
        &mut self,
        oracle: &'static str,
        d: Distance,
        allowed: f64,
        case: &Case,
        base: &Run,
        other: &Run,
    ) {
        let error = d.largest();
        if error <= allowed {
            return;
        }
        let factor = *self
            .sensitivity
            .get_or_insert_with(|| sensitivity(case, base));
        if factor > MOST_SENSITIVE {
            self.sensitive += 1;
            return;
        }
        let detail = format!(
            "rates {:.1e}, stress {:.1e}, sensitivity {factor:.1e}, {} against {}",
            d.rates, d.stress, base.kind, other.kind
        );
        self.add(oracle, error, allowed * factor, detail);
    }

    /// The same refusals on both sides.
    fn same_end(&mut self, oracle: &'static str, base: &Run, other: &Run) {
        let code = |run: &Run| run.refusal.as_ref().map(|r| (r.code, r.phase));
        self.findings
            .extend(other.faults.iter().map(|fault| Finding {
                oracle: "fault",
                error: f64::INFINITY,
                allowed: 0.0,
                detail: format!("{oracle}: {fault}"),
            }));
        if code(base) != code(other) || base.points.len() != other.points.len() {
            let text = |run: &Run| {
                run.refusal
                    .as_ref()
                    .map_or("runs".into(), |r| r.text.clone())
            };
            let detail = format!("refused on one side only: {} / {}", text(base), text(other));
            self.add(oracle, f64::INFINITY, 0.0, detail);
        }
    }

    fn other_units(&mut self, case: &Case, base: &Run) {
        for (oracle, powers) in [
            ("unit of force", [10, 0, 0]),
            ("unit of time", [0, -8, 0]),
            ("unit of length", [0, 0, 6]),
        ] {
            let units = Units::of_powers(powers[0], powers[1], powers[2]);
            let other = run(&units.apply(case));
            self.same_end(oracle, base, &other);
            let d = distance(&other, base, |p| Point {
                rates: p.rates.iter().map(|x| x / units.rate()).collect(),
                stress: p.stress.iter().map(|x| x / units.stress).collect(),
                ..p.clone()
            });
            let detail = format!(
                "rates {:.1e}, stress {:.1e}, {}",
                d.rates, d.stress, base.kind
            );
            self.add(oracle, d.largest(), SAME, detail);
        }
    }

    fn flipped_loads(&mut self, case: &Case, base: &Run) {
        let other = run(&case.loaded(-1.0));
        self.same_end("flipped loads", base, &other);
        let d = distance(&other, base, |p| Point {
            rates: p.rates.iter().map(|x| -x).collect(),
            stress: p.stress.iter().map(|x| -x).collect(),
            ..p.clone()
        });
        let detail = format!(
            "rates {:.1e}, stress {:.1e}, {}",
            d.rates, d.stress, base.kind
        );
        self.add("flipped loads", d.largest(), SAME, detail);
    }

    fn mirror(&mut self, case: &Case, base: &Run) {
        if case.dimension() == 3 {
            return;
        }
        let other = run(&case.mirrored());
        let turned = |x: &[f64]| x.iter().rev().map(|x| -x).collect::<Vec<f64>>();
        let d = distance(&other, base, |p| Point {
            rates: turned(&p.rates),
            stress: turned(&p.stress),
            ..p.clone()
        });
        self.add_inexact(
            "mirror",
            d,
            TOLERANCES * tolerance(case, &[base]),
            case,
            base,
            &other,
        );
    }

    fn splitting(&mut self, case: &Case, base: &Run) {
        if case.cuts == 1 {
            return;
        }
        let mut other = run(&case.split());
        let cuts = case.cuts as usize;
        other.points = other.points.into_iter().step_by(cuts).collect();
        let d = distance(&other, base, Point::clone);
        self.add_inexact(
            "splitting",
            d,
            TOLERANCES * case.friction_tolerance,
            case,
            base,
            &other,
        );
    }

    fn superposition(&mut self, case: &Case, base: &Run) {
        if case.law != Law::Frictionless || case.loads.len() < 2 {
            return;
        }
        let parts: Vec<Run> = (0..case.loads.len())
            .map(|i| run(&case.with_load_alone(i)))
            .collect();
        if parts
            .iter()
            .any(|part| part.points.len() != base.points.len())
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
        let mut d = distance(&sum, base, Point::clone);
        d.stress = 0.0;
        // the parts may cancel
        let largest = parts.iter().map(|p| p.scales().0).fold(0.0, f64::max);
        d.rates *= if largest > 0.0 {
            (base.scales().0 / largest).min(1.0)
        } else {
            1.0
        };
        let detail = format!("{} {:.1e}", base.kind, d.rates);
        self.add(
            "superposition",
            d.rates,
            TOLERANCES * tolerance(case, &[base]),
            detail,
        );
    }

    fn other_models(&mut self, case: &Case, base: &Run) {
        for model in ["full", "condensed", "reduced"] {
            if model == base.kind {
                continue;
            }
            let other = run(&case.with_model(model));
            self.findings
                .extend(other.faults.iter().map(|fault| Finding {
                    oracle: "fault",
                    error: f64::INFINITY,
                    allowed: 0.0,
                    detail: format!("{model}: {fault}"),
                }));
            let d = distance(&other, base, Point::clone);
            self.add_inexact(
                "other model",
                d,
                TOLERANCES * tolerance(case, &[base, &other]),
                case,
                base,
                &other,
            );
        }
    }

    /// What must hold within one run.
    fn within(&mut self, case: &Case, base: &Run) {
        self.findings
            .extend(base.faults.iter().map(|fault| Finding {
                oracle: "fault",
                error: f64::INFINITY,
                allowed: 0.0,
                detail: fault.clone(),
            }));
        let skipped = usize::from(case.start == "zero");
        for (n, point) in base.points.iter().enumerate().skip(skipped) {
            self.law(case, base, n, point);
        }
        self.energy(case, base);
    }

    fn law(&mut self, case: &Case, base: &Run, n: usize, point: &Point) {
        let c = base.components;
        let allowed = TOLERANCES * case.friction_tolerance;
        for (node, (w, stress)) in point
            .rates
            .chunks(c)
            .zip(point.stress.chunks(c))
            .enumerate()
        {
            let (rate, size) = (length(w), length(stress));
            let bound = case.law.bound(rate);
            if rate == 0.0 {
                let excess = (size - bound).max(0.0);
                if excess > 0.0 {
                    let detail = format!("point {n} node {node}: stress {size:e} above {bound:e}");
                    self.add("law of stick", excess / bound, allowed, detail);
                }
            } else {
                let violated: Vec<f64> = w
                    .iter()
                    .zip(stress)
                    .map(|(w, s)| s + bound * (w / rate))
                    .collect();
                let error = length(&violated);
                if error > 0.0 {
                    let detail = format!(
                        "point {n} node {node}: rate {rate:e}, stress {size:e}, law {bound:e}"
                    );
                    self.add("law of slip", error / bound, allowed, detail);
                }
            }
        }
    }

    /// The discrete problem solved with 96 digits. Every internal step is seen, so that of several solutions of a step the
    /// one of the run is followed.
    fn exact(&mut self, case: &Case, base: &Run) {
        let (split, run_of_split);
        let (case, base) = if case.cuts == 1 {
            (case, base)
        } else {
            split = case.split();
            run_of_split = run(&split);
            (&split, &run_of_split)
        };
        let exact = match solve_exactly(case, base) {
            Ok(exact) => exact,
            Err(reason) => {
                self.exact = Some(Err(reason));
                return;
            }
        };
        self.exact = Some(Ok(()));
        let scales = base.scales();
        let model = if base.kind == "reduced" {
            case.tolerance
        } else {
            0.0
        };
        for (n, (exact, point)) in exact.iter().zip(&base.points).enumerate() {
            let steps = (1 + n * case.cuts as usize) as f64;
            let allowed = |per_residual: f64, scale: f64| {
                TOLERANCES * steps * (case.friction_tolerance * per_residual + model * scale)
                    + SAME * scale
            };
            let allowed_rate = allowed(exact.rate_per_residual, scales.0);
            if allowed_rate > WORST_JUDGED * scales.0 {
                self.sensitive += 1;
                return;
            }
            for i in 0..point.rates.len() {
                let error = (point.rates[i] - exact.rates[i]).abs();
                let detail = format!(
                    "point {n} component {i}: {:e}, exact {:e} (relative to {:e}) {}",
                    point.rates[i], exact.rates[i], scales.0, base.kind
                );
                self.add(
                    "exact slip rate",
                    error / scales.0.max(f64::MIN_POSITIVE),
                    allowed_rate / scales.0.max(f64::MIN_POSITIVE),
                    detail,
                );
                let error = (point.stress[i] - exact.stress[i]).abs();
                let allowed = allowed(exact.stress_per_residual[i], scales.1);
                let detail = format!(
                    "point {n} component {i}: {:e}, exact {:e} {}",
                    point.stress[i], exact.stress[i], base.kind
                );
                self.add(
                    "exact stress",
                    error / scales.1.max(f64::MIN_POSITIVE),
                    allowed / scales.1.max(f64::MIN_POSITIVE),
                    detail,
                );
            }
        }
    }

    fn energy(&mut self, case: &Case, base: &Run) {
        let (mut largest, is_exact) = (
            0f64,
            case.scheme == "trapezoid" && case.start == "consistent",
        );
        if !is_exact && case.scheme != "backward_euler" {
            return;
        }
        for (n, point) in base.points.iter().enumerate() {
            let [external, elastic, viscous, friction, error] = point.energies;
            largest = largest.max(external.abs() + elastic.abs() + viscous.abs() + friction.abs());
            // backward Euler dissipates: the balance may only be positive
            let violated = if is_exact {
                error.abs()
            } else {
                (-error).max(0.0)
            };
            let relative = violated
                / largest
                    .max(rounding_of_energies(case))
                    .max(f64::MIN_POSITIVE);
            let detail = format!(
                "point {n}: work {external:e}, elastic {elastic:e}, viscous {viscous:e}, friction {friction:e}"
            );
            self.add(
                "energy",
                relative,
                TOLERANCES * tolerance(case, &[base]),
                detail,
            );
        }
    }
}

/// Energies below this, J, are rounding of what the loads could do: where everything sticks there is nothing else.
fn rounding_of_energies(case: &Case) -> f64 {
    let traction = |load: &crate::case::Load| {
        let largest = load.course.iter().fold(0f64, |m, x| m.max(x.abs()));
        largest
            * if load.part.is_some() {
                1.0
            } else {
                case.size.iter().copied().fold(0.0, f64::max)
            }
    };
    let stress = case.loads.iter().map(traction).fold(0.0, f64::max);
    let volume: f64 = case.size.iter().product();
    let time = case.step * f64::from(case.cuts) * case.count() as f64;
    1e-12 * stress * stress * volume * (time / case.mu2).min(1.0 / case.young)
}

/// The tolerance that the answers of these runs promise.
fn tolerance(case: &Case, runs: &[&Run]) -> f64 {
    if runs.iter().any(|run| run.kind == "reduced") {
        case.tolerance.max(case.friction_tolerance)
    } else {
        case.friction_tolerance
    }
}

pub fn length(x: &[f64]) -> f64 {
    match x {
        [a] => a.abs(),
        [a, b] => a.hypot(*b),
        _ => x.iter().map(|v| v * v).sum::<f64>().sqrt(),
    }
}
