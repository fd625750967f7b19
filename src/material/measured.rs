//! Memory as it is measured: storage and loss over the frequency, relaxation over the time. Branches are fitted to it.

use super::fit::{Curve, Fit, Point, fit, not_fitted, spread};
use super::resolved::{Pair, Resolved, branch};
use crate::refusal::{Refusal, Verdict, ensure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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

/// Largest relative error of a fit that is accepted.
const ALLOWED: f64 = 0.1;
/// Branches per decade that are fitted with.
const PER_DECADE: f64 = 1.5;

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
    ensure(fit.error <= ALLOWED, || {
        let found = format!(
            "a table that {} branches beside elasticity and viscosity miss by {:.1} %",
            fit.terms.len(),
            100.0 * fit.error
        );
        let allowed = format!(
            "what they meet to {} %: the shear modulus of the elasticity is what the table tends to at slow rates, that of the viscosity what it grows by at fast ones",
            100.0 * ALLOWED
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
        left: Pair::WHOLE,
        error: Some(fit.error),
    })
}

/// Candidates between two times.
fn count(terms: Option<u32>, ends: [f64; 2]) -> usize {
    terms.map_or_else(|| spread(ends, PER_DECADE), |terms| terms as usize)
}

impl DynamicMemory {
    pub(super) fn resolve(
        &self,
        of: Pair,
        viscosity: Pair,
        path: &str,
    ) -> Result<Resolved, Refusal> {
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
        let count = count(self.terms, ends);
        let fit = fit(Curve::Dynamic, &points, ends, count);
        of_fit(fit.ok_or_else(|| not_fitted(&path))?, self.bulk, of, &path)
    }
}

impl RelaxationMemory {
    pub(super) fn resolve(&self, of: Pair, path: &str) -> Result<Resolved, Refusal> {
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
        let count = count(self.terms, ends);
        let fit = fit(Curve::Relaxation, &points, ends, count);
        of_fit(fit.ok_or_else(|| not_fitted(&path))?, self.bulk, of, &path)
    }
}

#[cfg(test)]
mod tests {
    use super::super::memory::Branch;
    use super::*;

    const OF: Pair = Pair {
        shear: 2.0,
        bulk: 5.0,
    };

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
}
