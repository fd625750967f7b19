//! Memory as data sheets and other programs state it, brought to branches: shares of moduli, storage and loss over the
//! frequency, relaxation over the time, a fractional kernel.

use super::fit::{Curve, Fit, Point, fit};
use super::memory::{Branch, IsotropicBranch};
use crate::message::number;
use crate::refusal::{Refusal, Verdict, ensure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Long memory of a material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Memory {
    /// Branches of a generalised Maxwell body, in moduli.
    Branches(Vec<Branch>),
    /// Shares of the moduli of an isotropic elasticity.
    Relative(RelativeMemory),
    /// Storage and loss modulus in shear over the frequency.
    Dynamic(DynamicMemory),
    /// Relaxation modulus in shear over the time.
    Relaxation(RelaxationMemory),
    /// A power of the time.
    Fractional(FractionalMemory),
}

impl Default for Memory {
    fn default() -> Memory {
        Memory::Branches(Vec::new())
    }
}

/// A relaxation table of shares, as Abaqus, Ansys and others have it: `G(t) = G0 (1 - sum g_j (1 - exp(-t / tau_j)))`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelativeMemory {
    /// Its terms; shares of the shear modulus sum to less than 1, and those of the bulk modulus.
    pub relative: Vec<RelativeTerm>,
    /// What the moduli of the elasticity are: `instantaneous` (G0, K0) or `long_term` (what is left in the end).
    pub moduli: Moduli,
}

/// Shares of the instantaneous moduli that relax with a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelativeTerm {
    /// Relaxation time, s; positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub tau: f64,
    /// Share g of the shear modulus; not negative.
    #[schemars(extend("minimum" = 0))]
    pub shear: f64,
    /// Share k of the bulk modulus; not negative. Default: 0, the bulk does not relax.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub bulk: f64,
}

/// What moduli are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Moduli {
    Instantaneous,
    LongTerm,
}

/// Storage and loss, to which branches are fitted beside the elasticity (the long-term moduli) and the viscosity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DynamicMemory {
    /// Rows of frequency, storage modulus and loss modulus in shear, Pa; frequencies increase.
    #[schemars(length(min = 2))]
    pub dynamic: Vec<[f64; 3]>,
    /// Unit of the frequencies: `hertz` or `radians` (per second).
    pub frequency: Frequency,
    /// What the bulk modulus does.
    #[serde(default)]
    pub bulk: BulkMemory,
    /// Branches to choose from, spread evenly over the logarithm of the times. Default: 1.5 per decade.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "u32", extend("minimum" = 1, "maximum" = 64))]
    pub terms: Option<u32>,
}

/// Unit of a frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Frequency {
    Hertz,
    Radians,
}

/// What the bulk modulus does where only shear was measured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BulkMemory {
    /// It is elastic: that of the elasticity at all times.
    #[default]
    Elastic,
    /// It relaxes as the shear modulus does: the ratio of the two stays that of the elasticity.
    Proportional,
}

/// A relaxation modulus, to which branches are fitted beside the elasticity (the long-term moduli).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelaxationMemory {
    /// Rows of time after a step of strain, s, and modulus in shear, Pa; times increase.
    #[schemars(length(min = 2))]
    pub relaxation: Vec<[f64; 2]>,
    /// What the bulk modulus does.
    #[serde(default)]
    pub bulk: BulkMemory,
    /// Branches to choose from, spread evenly over the logarithm of the times. Default: 1.5 per decade.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "u32", extend("minimum" = 1, "maximum" = 64))]
    pub terms: Option<u32>,
}

/// A fractional derivative of the strain: the kernel `shear t^-order / Gamma(1 - order)`, as a sum of exponentials.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FractionalMemory {
    /// The kernel.
    pub fractional: FractionalKernel,
}

/// A power of the time, and where it is represented.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FractionalKernel {
    /// Order of the derivative, between 0 and 1.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub order: f64,
    /// Coefficient in shear, Pa s^order; not negative.
    #[schemars(extend("minimum" = 0))]
    pub shear: f64,
    /// Coefficient in bulk, Pa s^order; not negative, and not 0 beside a shear of 0.
    #[schemars(extend("minimum" = 0))]
    pub bulk: f64,
    /// Shortest time at which the kernel holds, s: about a hundredth of the step.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub shortest: f64,
    /// Longest time at which it holds, s: that of the run.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub longest: f64,
}

/// Shear and bulk modulus, or viscosity, of an isotropic law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    pub shear: f64,
    pub bulk: f64,
}

/// A memory as branches.
#[derive(Debug, Clone, PartialEq)]
pub struct Resolved {
    pub branches: Vec<Branch>,
    /// Factors of the moduli of the elasticity.
    pub left: Pair,
    /// Largest relative error of a fit, where there was one.
    pub error: Option<f64>,
}

/// Largest relative error of a fit to measurements, and to a kernel, that is accepted.
const ALLOWED: [f64; 2] = [0.1, 1e-2];
/// Branches per decade that tables are fitted with, and that kernels choose from.
const PER_DECADE: [f64; 2] = [1.5, 4.0];

const WHOLE: Pair = Pair {
    shear: 1.0,
    bulk: 1.0,
};

fn branch(tau: f64, shear: f64, bulk: f64) -> Branch {
    Branch::Isotropic(IsotropicBranch { tau, shear, bulk })
}

impl Memory {
    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        matches!(self, Memory::Branches(branches) if branches.is_empty())
    }

    /// The branches, beside an elasticity and a viscosity of these moduli (`None` for laws that are not isotropic); `path` is the
    /// place of the memory in the scene.
    ///
    /// # Errors
    /// Tables that do not ascend, shares that leave nothing, laws that are not isotropic, fits that miss too much.
    pub(super) fn resolve(
        &self,
        elasticity: Option<Pair>,
        viscosity: Option<Pair>,
        path: &str,
    ) -> Result<Resolved, Refusal> {
        let isotropic = |pair: Option<Pair>, what: &str| {
            pair.ok_or_else(|| {
                let found = format!("a data sheet beside {what} that is not isotropic");
                Refusal::new(path, found, "branches in moduli (tau, shear, bulk)")
            })
        };
        match self {
            Memory::Branches(branches) => Ok(Resolved {
                branches: branches.clone(),
                left: WHOLE,
                error: None,
            }),
            Memory::Relative(table) => table.resolve(isotropic(elasticity, "an elasticity")?, path),
            Memory::Dynamic(table) => {
                let own = isotropic(elasticity, "an elasticity")?;
                table.resolve(own, isotropic(viscosity, "a viscosity")?, path)
            }
            Memory::Relaxation(table) => {
                table.resolve(isotropic(elasticity, "an elasticity")?, path)
            }
            Memory::Fractional(memory) => memory.fractional.resolve(path),
        }
    }
}

impl RelativeMemory {
    fn resolve(&self, of: Pair, path: &str) -> Result<Resolved, Refusal> {
        let sum = |share: fn(&RelativeTerm) -> f64| self.relative.iter().map(share).sum::<f64>();
        let shares = Pair {
            shear: sum(|term| term.shear),
            bulk: sum(|term| term.bulk),
        };
        for (key, share) in [("shear", shares.shear), ("bulk", shares.bulk)] {
            ensure(share < 1.0, || {
                let found = format!("shares {key} that sum to {}", number(share));
                let allowed = "a sum below 1: otherwise nothing resists in the end";
                Refusal::new(format!("{path}.relative"), found, allowed)
            })?;
        }
        let left = Pair {
            shear: 1.0 - shares.shear,
            bulk: 1.0 - shares.bulk,
        };
        let (left, at_once) = match self.moduli {
            Moduli::Instantaneous => (left, of),
            Moduli::LongTerm => (
                WHOLE,
                Pair {
                    shear: of.shear / left.shear,
                    bulk: of.bulk / left.bulk,
                },
            ),
        };
        let terms = self
            .relative
            .iter()
            .filter(|t| t.shear > 0.0 || t.bulk > 0.0);
        let of_term =
            |t: &RelativeTerm| branch(t.tau, t.shear * at_once.shear, t.bulk * at_once.bulk);
        Ok(Resolved {
            branches: terms.map(of_term).collect(),
            left,
            error: None,
        })
    }
}

/// Refuses rows whose first numbers do not ascend from above 0, or whose others are negative.
fn check_rows<const N: usize>(rows: &[[f64; N]], path: &str) -> Verdict {
    let ascends = rows.windows(2).all(|pair| pair[0][0] < pair[1][0]);
    let is_positive = rows
        .iter()
        .all(|row| row[0] > 0.0 && row[1..].iter().all(|v| *v >= 0.0));
    ensure(
        ascends && is_positive && rows.iter().flatten().all(|v| v.is_finite()),
        || {
            let allowed = "positive first numbers that increase, and moduli that are not negative";
            Refusal::new(path, "rows that do not", allowed)
        },
    )
}

/// Branches of a fitted curve, with the bulk that goes along.
fn of_fit(fit: Fit, bulk: BulkMemory, of: Pair, path: &str) -> Result<Resolved, Refusal> {
    ensure(fit.error <= ALLOWED[0], || {
        let found = format!(
            "a table that {} branches beside elasticity and viscosity miss by {:.1} %",
            fit.terms.len(),
            100.0 * fit.error
        );
        let allowed = format!(
            "what they meet to {} %: the shear modulus of the elasticity is what the table tends to at slow rates, that of the viscosity what it grows by at fast ones",
            100.0 * ALLOWED[0]
        );
        Refusal::new(path, found, allowed)
    })?;
    let ratio = match bulk {
        BulkMemory::Elastic => 0.0,
        BulkMemory::Proportional => of.bulk / of.shear,
    };
    let of_term = |(tau, shear): (f64, f64)| branch(tau, shear, ratio * shear);
    Ok(Resolved {
        branches: fit.terms.into_iter().map(of_term).collect(),
        left: WHOLE,
        error: Some(fit.error),
    })
}

/// Candidates between two times.
fn count(terms: Option<u32>, [from, to]: [f64; 2], per_decade: f64) -> usize {
    let natural = (per_decade * (to / from).log10()).ceil() + 1.0;
    terms.map_or(natural.clamp(1.0, 64.0) as usize, |terms| terms as usize)
}

impl DynamicMemory {
    fn resolve(&self, of: Pair, viscosity: Pair, path: &str) -> Result<Resolved, Refusal> {
        let path = format!("{path}.dynamic");
        check_rows(&self.dynamic, &path)?;
        let turn = match self.frequency {
            Frequency::Hertz => 2.0 * std::f64::consts::PI,
            Frequency::Radians => 1.0,
        };
        let points: Vec<Point> = self
            .dynamic
            .iter()
            .map(|[f, storage, loss]| Point {
                at: f * turn,
                known: [of.shear, f * turn * viscosity.shear],
                measured: [*storage, *loss],
            })
            .collect();
        let ends = [&points[points.len() - 1], &points[0]].map(|point| 1.0 / point.at);
        let count = count(self.terms, ends, PER_DECADE[0]);
        let fit = fit(Curve::Dynamic, &points, ends, count);
        of_fit(fit.ok_or_else(|| not_fitted(&path))?, self.bulk, of, &path)
    }
}

impl RelaxationMemory {
    fn resolve(&self, of: Pair, path: &str) -> Result<Resolved, Refusal> {
        let path = format!("{path}.relaxation");
        check_rows(&self.relaxation, &path)?;
        let points: Vec<Point> = self
            .relaxation
            .iter()
            .map(|[time, modulus]| Point {
                at: *time,
                known: [of.shear, 0.0],
                measured: [*modulus, 0.0],
            })
            .collect();
        let ends = [points[0].at, points[points.len() - 1].at];
        let count = count(self.terms, ends, PER_DECADE[0]);
        let fit = fit(Curve::Relaxation, &points, ends, count);
        of_fit(fit.ok_or_else(|| not_fitted(&path))?, self.bulk, of, &path)
    }
}

fn not_fitted(path: &str) -> Refusal {
    Refusal::new(
        path,
        "numbers that nothing can be fitted to",
        "finite moduli of similar size",
    )
}

impl FractionalKernel {
    fn resolve(&self, path: &str) -> Result<Resolved, Refusal> {
        let path = format!("{path}.fractional");
        let decades = (self.longest / self.shortest).log10();
        ensure(decades > 0.0 && decades <= 12.0, || {
            let found = format!("{} to {}", number(self.shortest), number(self.longest));
            Refusal::new(
                &path,
                found,
                "a longest time beyond the shortest, within 12 decades",
            )
        })?;
        ensure(self.shear > 0.0 || self.bulk > 0.0, || {
            Refusal::new(&path, "shear = 0, bulk = 0", "a coefficient > 0")
        })?;
        let samples = (20.0 * decades).ceil() as usize + 1;
        let scale = 1.0 / gamma(1.0 - self.order);
        let points: Vec<Point> = (0..samples)
            .map(|i| {
                let at = self.shortest
                    * (self.longest / self.shortest).powf(i as f64 / (samples - 1) as f64);
                Point {
                    at,
                    known: [0.0; 2],
                    measured: [scale * (at / self.longest).powf(-self.order), 0.0],
                }
            })
            .collect();
        // the kernel goes on beyond both ends
        let ends = [0.3 * self.shortest, 10.0 * self.longest];
        let found = fit(
            Curve::Relaxation,
            &points,
            ends,
            count(None, ends, PER_DECADE[1]),
        );
        let found = found.ok_or_else(|| not_fitted(&path))?;
        ensure(found.error <= ALLOWED[1], || {
            let found = format!(
                "a kernel that exponentials miss by {:.1} %",
                100.0 * found.error
            );
            Refusal::new(
                &path,
                found,
                format!("{} % between fewer decades", 100.0 * ALLOWED[1]),
            )
        })?;
        let unit = self.longest.powf(-self.order);
        let of_term = |&(tau, weight): &(f64, f64)| {
            branch(tau, self.shear * unit * weight, self.bulk * unit * weight)
        };
        Ok(Resolved {
            branches: found.terms.iter().map(of_term).collect(),
            left: WHOLE,
            error: Some(found.error),
        })
    }
}

/// The gamma function between 0 and 1, by Lanczos's series (g = 7, 9 terms).
fn gamma(x: f64) -> f64 {
    const SERIES: [f64; 8] = [
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_13,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_571_6e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let terms = SERIES.iter().enumerate();
    let sum: f64 = terms.map(|(i, c)| c / (x + i as f64)).sum();
    let t = x + 6.5;
    let root = (2.0 * std::f64::consts::PI).sqrt();
    root * t.powf(x - 0.5) * (-t).exp() * (0.999_999_999_999_809_93 + sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    const OF: Pair = Pair {
        shear: 2.0,
        bulk: 5.0,
    };

    fn read(text: &str) -> Memory {
        serde_json::from_str(text).unwrap()
    }

    fn resolved(text: &str) -> Result<Resolved, Refusal> {
        read(text).resolve(Some(OF), Some(OF), "memory")
    }

    #[test]
    fn shares_are_of_the_instantaneous_moduli() {
        let text = r#"{"relative": [{"tau": 0.1, "shear": 0.3, "bulk": 0.1}, {"tau": 2, "shear": 0.2}], "moduli": "MODULI"}"#;
        let at_once = resolved(&text.replace("MODULI", "instantaneous")).unwrap();
        let close = |a: f64, b: f64| (a - b).abs() < 1e-14;
        assert!(close(at_once.left.shear, 0.5) && close(at_once.left.bulk, 0.9));
        let Branch::Isotropic(first) = &at_once.branches[0];
        assert!(close(first.shear, 0.6) && close(first.bulk, 0.5));
        let late = resolved(&text.replace("MODULI", "long_term")).unwrap();
        assert_eq!(late.left, WHOLE);
        let Branch::Isotropic(second) = &late.branches[1];
        assert!(close(second.shear, 0.2 * 2.0 / 0.5) && second.bulk == 0.0);
        let all = r#"{"relative": [{"tau": 0.1, "shear": 1.0}], "moduli": "long_term"}"#;
        assert!(resolved(all).is_err());
        assert!(read(all).resolve(None, Some(OF), "memory").is_err());
    }

    /// A table made of branches is met, also by branches elsewhere.
    #[test]
    fn storage_and_loss_are_met() {
        let terms = [(0.004, 3.0), (0.1, 1.5), (1.3, 0.7)];
        let row = |i: u32| {
            let f = 0.01 * 10_f64.powf(f64::from(i) / 5.0);
            let w = 2.0 * std::f64::consts::PI * f;
            let (mut storage, mut loss) = (OF.shear, w * 0.001);
            for (tau, g) in terms {
                let x = w * tau;
                storage += g * x * x / (1.0 + x * x);
                loss += g * x / (1.0 + x * x);
            }
            [f, storage, loss]
        };
        let memory = DynamicMemory {
            dynamic: (0..=25).map(row).collect(),
            frequency: Frequency::Hertz,
            bulk: BulkMemory::Proportional,
            terms: None,
        };
        let viscosity = Pair {
            shear: 0.001,
            bulk: 0.0,
        };
        let found = memory.resolve(OF, viscosity, "memory").unwrap();
        assert!(found.error.unwrap() < 0.05, "{found:?}");
        let sum: f64 = found
            .branches
            .iter()
            .map(|Branch::Isotropic(b)| b.shear)
            .sum();
        assert!((sum / 5.2 - 1.0).abs() < 0.05);
        for Branch::Isotropic(b) in &found.branches {
            assert!((b.bulk / b.shear - 2.5).abs() < 1e-12);
        }
        // in the wrong unit the table is no longer that of this viscosity
        let stiff = Pair { shear: 9.0, ..OF };
        let refused = memory.resolve(stiff, viscosity, "memory").unwrap_err();
        assert!(format!("{refused:?}").contains("memory.dynamic"));
    }

    #[test]
    fn a_relaxation_of_branches_gives_them_back() {
        let row = |i: u32| {
            let t = 0.001 * 10_f64.powf(f64::from(i) / 8.0);
            [
                t,
                OF.shear + 1.2 * (-t / 0.001_f64).exp() + 0.8 * (-t / 1.0_f64).exp(),
            ]
        };
        let memory = RelaxationMemory {
            relaxation: (0..=24).map(row).collect(),
            bulk: BulkMemory::Elastic,
            terms: Some(4),
        };
        let found = memory.resolve(OF, "memory").unwrap();
        assert!(found.error.unwrap() < 1e-10, "{found:?}");
        let known: Vec<(f64, f64)> = found
            .branches
            .iter()
            .map(|Branch::Isotropic(b)| (b.tau, b.shear))
            .collect();
        assert_eq!(known.len(), 2, "{known:?}");
        assert!((known[0].1 - 1.2).abs() < 1e-9 && (known[1].1 - 0.8).abs() < 1e-9);
    }

    #[test]
    fn powers_of_the_time_are_sums_of_exponentials() {
        assert!((gamma(0.5) - std::f64::consts::PI.sqrt()).abs() < 1e-13);
        for order in [0.2, 0.5, 0.8] {
            let text = format!(
                r#"{{"fractional": {{"order": {order}, "shear": 3.0, "bulk": 0.0, "shortest": 1e-4, "longest": 1.0}}}}"#
            );
            let found = resolved(&text).unwrap();
            assert!(found.error.unwrap() < 2e-3, "{order}: {:?}", found.error);
            assert!(found.branches.len() < 26, "{}", found.branches.len());
            for t in [3e-4_f64, 0.01, 0.5] {
                let sum: f64 = found
                    .branches
                    .iter()
                    .map(|Branch::Isotropic(b)| b.shear * (-t / b.tau).exp())
                    .sum();
                let exact = 3.0 * t.powf(-order) / gamma(1.0 - order);
                assert!(
                    (sum / exact - 1.0).abs() < 2e-3,
                    "{order}, {t}: {sum} {exact}"
                );
            }
        }
    }
}
