//! Laws with a coefficient of the deviator that falls with its size, and the curve that it has above its last value:
//! `psi = range / sqrt(1 + (r/c)^2)`.

use super::excess::{Curve, CurvePoint, DEVIATORS, Deviator, Excess};
use super::form::Form;
use super::variation::Variation;
use super::{Law, Parameter, ParameterKind, is_positive, parameter};
use crate::linalg::length;
use crate::message::number;
use crate::refusal::{Refusal, Verdict, ensure};

/// What a coefficient that falls from `mu_0` at rest to `mu_inf` has above the latter.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Thinning {
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

/// A law with such a coefficient: `a tr(eps) I + mu(|dev eps|) dev eps`.
pub(super) trait ThinningLaw: std::fmt::Debug {
    /// What it says of its parameters: trace, deviator at rest, deviator at large sizes, size, deviator.
    const TEXTS: [&'static str; 5];
    /// Key of the coefficient of the trace.
    const TRACE: &'static str;
    /// Unit of the size of the deviator.
    const SIZE: &'static str;

    /// The coefficient of the trace.
    fn trace(&self) -> f64;
    /// `mu_0`, `mu_inf` and `c`.
    fn curve(&self) -> [f64; 3];
    fn deviator(&self) -> Deviator;
    fn variation(&self) -> Variation<'_>;
}

impl<T: ThinningLaw> Law for T {
    fn parameters(&self, unit: &'static str) -> Vec<Parameter> {
        let [trace, at_rest, at_large, size, deviator] = T::TEXTS;
        let number = |key, unit, text| parameter(key, ParameterKind::Number(unit), text);
        let mut all = vec![
            number(T::TRACE, unit, trace),
            number("mu_0", unit, at_rest),
            number("mu_inf", unit, at_large),
            number("c", T::SIZE, size),
            parameter("deviator", ParameterKind::Choice(&DEVIATORS), deviator),
        ];
        all.extend(ThinningLaw::variation(self).parameters());
        all
    }

    fn check(&self, dimension: usize, path: &str) -> Verdict {
        let [mu_0, mu_inf, c] = self.curve();
        for (key, value) in [(T::TRACE, self.trace()), ("mu_inf", mu_inf), ("c", c)] {
            ensure(is_positive(value), || {
                let allowed = format!("{key} > 0");
                Refusal::new(format!("{path}.{key}"), number(value), allowed)
            })?;
        }
        ensure(mu_0.is_finite() && mu_inf <= mu_0, || {
            let found = format!("{} with mu_inf = {}", number(mu_0), number(mu_inf));
            let allowed =
                "mu_inf <= mu_0: a coefficient that grows with the strain is not Lipschitz";
            Refusal::new(format!("{path}.mu_0"), found, allowed)
        })?;
        self.deviator().check(dimension, path)?;
        ThinningLaw::variation(self).check(dimension, path)
    }

    fn form(&self) -> Form {
        let trace = Form::Isotropic {
            lambda: self.trace(),
            two_mu: 0.0,
        };
        let [_, mu_inf, _] = self.curve();
        trace.plus(&self.deviator().form(mu_inf))
    }

    fn excess(&self) -> Option<Excess> {
        let [mu_0, mu_inf, c] = self.curve();
        let range = mu_0 - mu_inf;
        (range > 0.0).then(|| Excess::new(Thinning { range, c }, self.deviator()))
    }

    fn variation(&self) -> Variation<'_> {
        ThinningLaw::variation(self)
    }
}
