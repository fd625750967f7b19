//! The curve that falls from its value at rest to nothing: `psi = range / sqrt(1 + (r/c)^2)`.

use super::excess::{Curve, CurvePoint};
use super::is_positive;
use crate::linalg::length;
use crate::message::number;
use crate::refusal::{Refusal, Verdict, ensure};

/// What a coefficient that falls from `mu_0` at rest to `mu_inf` has above the latter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Thinning {
    /// `mu_0 - mu_inf`.
    pub range: f64,
    /// Size of the deviator at which it is `1 / sqrt 2` of that.
    pub c: f64,
}

impl Curve for Thinning {
    fn at(&self, r: f64) -> CurvePoint {
        let x = r / self.c;
        let root = length(1.0, x);
        let secant = self.range / root;
        CurvePoint {
            secant,
            slope: secant / root / root,
            // c^2 (root - 1), without its cancellation
            potential: self.range * r * (r / (root + 1.0)),
        }
    }

    fn largest(&self) -> f64 {
        self.range
    }
}

/// Refuses `0 < mu_inf <= mu_0`, `trace > 0`, `c > 0` where they do not hold; `trace` is the coefficient of the trace with its key.
pub(super) fn check(trace: (&str, f64), [mu_0, mu_inf, c]: [f64; 3], path: &str) -> Verdict {
    for (key, value) in [trace, ("mu_inf", mu_inf), ("c", c)] {
        ensure(is_positive(value), || {
            let allowed = format!("{key} > 0");
            Refusal::new(format!("{path}.{key}"), number(value), allowed)
        })?;
    }
    ensure(mu_0.is_finite() && mu_inf <= mu_0, || {
        let found = format!("{} with mu_inf = {}", number(mu_0), number(mu_inf));
        let allowed = "mu_inf <= mu_0: a coefficient that grows with the strain is not Lipschitz";
        Refusal::new(format!("{path}.mu_0"), found, allowed)
    })
}
