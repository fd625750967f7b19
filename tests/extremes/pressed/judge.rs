//! What is wrong with the answer to a case: between two runs.

use super::case::{Case, Condition, Held};
use super::distance::{Distance, distance, scaled};
use super::friction::{Coefficient, Friction};
use super::run::{Run, Scales, Seen, run};
use super::units::Units;
use crate::judge::{Finding, MOST_SENSITIVE, TOLERANCES};

/// Even powers: factors of Cholesky hold square roots of the pivots.
const UNITS: [(&str, [i32; 4]); 4] = [
    ("unit of stress", [10, 0, 0, 0]),
    ("unit of time", [0, -8, 0, 0]),
    ("unit of length", [0, 0, 6, 0]),
    ("unit of strain", [0, 0, 0, -12]),
];

/// Share of the stress that the motions would make in a cell against which stresses are measured at least.
const FLOOR: f64 = 1e-3;

/// Relative difference that counts as the same: a few roundings of forces that cancel.
const SAME: f64 = 1e-11;

/// Relative change of the inputs whose effect is the sensitivity of a case.
const NUDGE: f64 = 1.0 / (1u64 << 30) as f64;

pub struct Judge<'a> {
    pub case: &'a Case,
    pub base: &'a Run,
    pub findings: Vec<Finding>,
    /// Comparisons left out because the case magnifies rounding too much.
    pub sensitive: usize,
    sensitivity: Option<f64>,
}

impl<'a> Judge<'a> {
    pub fn of(case: &'a Case, base: &'a Run) -> Judge<'a> {
        let mut judge = Judge {
            case,
            base,
            findings: Vec::new(),
            sensitive: 0,
            sensitivity: None,
        };
        judge.find_faults("base", base);
        judge.look_within();
        judge.change_units();
        judge.mirror();
        judge.split();
        judge.compare_models();
        judge
    }

    pub fn is_told(&self) -> bool {
        self.base.has_lost_digits
    }

    pub fn tolerance(&self) -> f64 {
        self.case
            .tolerance
            .max(self.case.friction_tolerance)
            .max(self.base.floor)
    }

    pub fn find(&mut self, oracle: &'static str, error: f64, allowed: f64, detail: String) {
        // written so that NaN is a finding
        let holds = error <= allowed;
        if !holds {
            self.findings.push(Finding {
                oracle,
                error,
                allowed,
                detail,
            });
        }
    }

    /// Stress below which a difference is rounding or the tolerance of the body in motions that strain nothing, Pa.
    pub fn stress_floor(&self) -> f64 {
        let Scales {
            rate, displacement, ..
        } = self.base.scales();
        self.case.natural_stress(rate, displacement)
    }

    fn find_faults(&mut self, of: &str, run: &Run) {
        for fault in &run.faults {
            self.find("fault", f64::INFINITY, 0.0, format!("{of}: {fault}"));
        }
    }

    fn change_units(&mut self) {
        for (oracle, powers) in UNITS {
            let units = Units::of_powers(powers);
            let other = run(&units.apply(self.case));
            self.find_faults(oracle, &other);
            let code = |run: &Run| run.refusal.as_ref().map(|r| (r.code, r.phase));
            let (base, exact) = (self.base, self.has_exact_units());
            if code(base) != code(&other) || base.points.len() != other.points.len() {
                let text = |run: &Run| {
                    run.refusal
                        .as_ref()
                        .map_or("runs".to_owned(), |r| r.text.clone())
                };
                if exact {
                    self.find(
                        oracle,
                        f64::INFINITY,
                        0.0,
                        format!(
                            "refused on one side only: {} / {}",
                            text(base),
                            text(&other)
                        ),
                    );
                }
                continue;
            }
            let d = distance(&other, base, FLOOR * self.stress_floor(), |seen| {
                scaled(seen, units)
            });
            if exact {
                self.find(oracle, d.largest(), SAME, format!("{d:?}, {}", base.kind));
            } else {
                self.find_apart(oracle, d, &other);
            }
        }
    }

    /// Whether powers of two pass through all formulas: powers with other exponents and logarithms of rates round.
    fn has_exact_units(&self) -> bool {
        self.case.contacts.iter().all(|contact| {
            let is_linear = !matches!(contact.condition, Condition::Compliance { exponent, .. } if exponent != 1.0);
            is_linear && !matches!(contact.friction.coefficient(), Coefficient::Creeping { .. })
        })
    }

    /// Whether a step may have several solutions: friction falls with the slip rate by about what the body resists, or more, or the
    /// coefficient is large. Either run has been found to keep the law.
    fn may_have_several(&self) -> bool {
        let case = self.case;
        let pressure = self.base.scales().stress;
        let resistance = case.resistance();
        case.contacts.iter().any(|contact| {
            let pressing = if matches!(contact.friction, Friction::Bound(_)) {
                1.0
            } else {
                pressure
            };
            let coefficient = contact.friction.coefficient();
            pressing * coefficient.weakening(case.step) > 0.1 * resistance
                || pressing == pressure && coefficient.largest() > 1.0
        })
    }

    fn mirror(&mut self) {
        if self.case.dimension() == 3 {
            return;
        }
        let other = run(&self.case.mirrored());
        self.find_faults("mirror", &other);
        let d = distance(&other, self.base, FLOOR * self.stress_floor(), |seen| {
            let reversed =
                |x: &[f64], sign: f64| x.iter().rev().map(|x| sign * x).collect::<Vec<f64>>();
            Seen {
                rates: reversed(&seen.rates, -1.0),
                stress: reversed(&seen.stress, -1.0),
                slip: reversed(&seen.slip, -1.0),
                pressure: reversed(&seen.pressure, 1.0),
                gap: seen.gap.as_ref().map(|gap| reversed(gap, 1.0)),
                ..seen.clone()
            }
        });
        self.find_apart("mirror", d, &other);
    }

    /// n internal steps in one communication step or in n. A held load jumps at every communication point; a displacement as an input
    /// has a velocity that rounding makes jump there, from which the velocity of the body is found anew.
    fn split(&mut self) {
        let is_displacement = matches!(
            self.case.held,
            Held::Driven {
                input: "displacement",
                ..
            }
        );
        if self.case.cuts == 1 || self.case.holds || is_displacement {
            return;
        }
        let mut other = run(&self.case.split());
        self.find_faults("splitting", &other);
        other.points = other
            .points
            .into_iter()
            .step_by(self.case.cuts as usize)
            .collect();
        let d = distance(&other, self.base, FLOOR * self.stress_floor(), Seen::clone);
        self.find_apart("splitting", d, &other);
    }

    fn compare_models(&mut self) {
        for model in ["full", "condensed", "reduced"] {
            if model == self.base.kind {
                continue;
            }
            let other = run(&self.case.with_model(model));
            self.find_faults(model, &other);
            let d = distance(&other, self.base, FLOOR * self.stress_floor(), Seen::clone);
            self.find_apart("other model", d, &other);
        }
    }

    fn find_apart(&mut self, oracle: &'static str, d: Distance, other: &Run) {
        let allowed = TOLERANCES * self.tolerance().max(other.floor);
        if d.largest() <= allowed {
            return;
        }
        let (case, base) = (self.case, self.base);
        if self.may_have_several() {
            self.sensitive += 1;
            return;
        }
        let factor = *self
            .sensitivity
            .get_or_insert_with(|| sensitivity(case, base));
        if factor > MOST_SENSITIVE || other.has_lost_digits && !base.has_lost_digits {
            self.sensitive += 1;
            return;
        }
        let detail = format!(
            "{d:?}, sensitivity {factor:.1e}, {} against {}",
            base.kind, other.kind
        );
        self.find(oracle, d.largest(), allowed * factor, detail);
    }
}

/// By how much a relative change of the inputs, or of the friction, is multiplied in the answer.
fn sensitivity(case: &Case, base: &Run) -> f64 {
    let mut rougher = case.clone();
    for contact in &mut rougher.contacts {
        let (Friction::Bound(coefficient) | Friction::Coulomb { coefficient, .. }) =
            &mut contact.friction;
        match coefficient {
            Coefficient::Number(x) => *x *= 1.0 + NUDGE,
            Coefficient::Exponential { rest, fast, .. }
            | Coefficient::Stribeck { rest, fast, .. } => {
                (*rest, *fast) = (*rest * (1.0 + NUDGE), *fast * (1.0 + NUDGE));
            }
            Coefficient::Weakening { rest, worn, .. } => {
                (*rest, *worn) = (*rest * (1.0 + NUDGE), *worn * (1.0 + NUDGE))
            }
            Coefficient::Creeping { value, .. } => *value *= 1.0 + NUDGE,
        }
    }
    let others = [
        case.driven_by(1.0 + NUDGE),
        case.driven_by(1.0 - NUDGE),
        rougher,
    ];
    let factor = |other: &Case| {
        let nudged = run(other);
        if nudged.points.len() == base.points.len() {
            distance(&nudged, base, 0.0, Seen::clone).largest() / NUDGE
        } else {
            f64::INFINITY
        }
    };
    others.iter().map(factor).fold(1.0, f64::max)
}
