//! Memory that is a power of the time, as a sum of exponentials.

use super::fit::{Curve, Point, fit, not_fitted, spread};
use super::resolved::{Pair, Resolved, branch};
use crate::message::number;
use crate::refusal::{Refusal, ensure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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

/// Largest relative error of a fit that is accepted.
const ALLOWED: f64 = 1e-2;
/// Relaxation times per decade to choose from.
const PER_DECADE: f64 = 4.0;

impl FractionalKernel {
    pub(super) fn resolve(&self, path: &str) -> Result<Resolved, Refusal> {
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
        let found = fit(Curve::Relaxation, &points, ends, spread(ends, PER_DECADE));
        let found = found.ok_or_else(|| not_fitted(&path))?;
        ensure(found.error <= ALLOWED, || {
            let found = format!(
                "a kernel that exponentials miss by {:.1} %",
                100.0 * found.error
            );
            Refusal::new(
                &path,
                found,
                format!("{} % between fewer decades", 100.0 * ALLOWED),
            )
        })?;
        let unit = self.longest.powf(-self.order);
        let of_term = |&(tau, weight): &(f64, f64)| {
            branch(tau, self.shear * unit * weight, self.bulk * unit * weight)
        };
        Ok(Resolved {
            branches: found.terms.iter().map(of_term).collect(),
            left: Pair::WHOLE,
            error: Some(found.error),
        })
    }
}

/// The gamma function between 0 and 1, by Lanczos's series (g = 7, 9 terms).
fn gamma(x: f64) -> f64 {
    const SERIES: [f64; 8] = [
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let terms = SERIES.iter().enumerate();
    let sum: f64 = terms.map(|(i, c)| c / (x + i as f64)).sum();
    let t = x + 6.5;
    let root = (2.0 * std::f64::consts::PI).sqrt();
    root * t.powf(x - 0.5) * (-t).exp() * (0.999_999_999_999_809_9 + sum)
}

#[cfg(test)]
mod tests {
    use super::super::memory::Branch;
    use super::*;

    #[test]
    fn powers_of_the_time_are_sums_of_exponentials() {
        assert!((gamma(0.5) - std::f64::consts::PI.sqrt()).abs() < 1e-13);
        for order in [0.2, 0.5, 0.8] {
            let text = format!(
                r#"{{"order": {order}, "shear": 3.0, "bulk": 0.0, "shortest": 1e-4, "longest": 1.0}}"#
            );
            let kernel: FractionalKernel = serde_json::from_str(&text).unwrap();
            let found = kernel.resolve("memory").unwrap();
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
