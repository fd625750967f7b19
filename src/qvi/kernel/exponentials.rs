//! Exponential sums: every term is a scalar recursion, exact in the kernel.
//!
//! ```text
//! S_n = E S_{n-1} + a z_{n-1} + b z_n         for every term, kappa = k / tau
//!
//! nodal       E = e^-kappa, and the weights of the points
//! product     E = e^-kappa,                      b = k (phi1 - phi2')   a = k phi2'     z linear in a step
//! mean        E = e^-kappa,                      a = b = k phi1 / 2                  z its mean in a step
//! relaxation  E = (1 - kappa/2)/(1 + kappa/2),   a = b = k / (2 + kappa)
//! ```
//!
//! with `phi1 = (1 - e^-kappa)/kappa` and `phi2' = (1 - e^-kappa (1 + kappa))/kappa^2`, all weights nonnegative.

use super::Own;
use super::sums::{Point, Sums, Term};
use crate::qvi::{Quadrature, SolveError};

/// `weight exp(-(t-s)/tau)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExponentialTerm {
    pub weight: f64,
    /// Relaxation time, s, positive; infinite for a constant.
    pub tau: f64,
}

impl ExponentialTerm {
    /// Its value at a lag, s.
    pub fn value(&self, lag: f64) -> f64 {
        self.weight * (-lag / self.tau).exp()
    }
}

/// One term with its recursion.
pub(super) struct Recursion {
    weight: f64,
    decay: f64,
    /// Factors of the value before and of that at the point.
    before: f64,
    own: f64,
}

/// The sums of these terms.
pub(super) fn sums(
    terms: &[ExponentialTerm],
    dimension: usize,
    rule: Quadrature,
    k: f64,
) -> Result<Sums<Recursion>, SolveError> {
    let of = |term: &ExponentialTerm| {
        if term.tau <= 0.0 || term.tau.is_nan() || !term.weight.is_finite() {
            return Err(SolveError::Value {
                what: "relaxation time of an exponential term".to_owned(),
                found: term.tau,
                allowed: "a positive number, or infinity, beside a finite weight",
            });
        }
        let kappa = k / term.tau;
        let [decay, before, own] = match rule {
            Quadrature::Product => {
                let [first, second] = integrals(kappa);
                [(-kappa).exp(), k * second, k * (first - second)]
            }
            Quadrature::Mean => {
                let [first, _] = integrals(kappa);
                [(-kappa).exp(), 0.5 * k * first, 0.5 * k * first]
            }
            Quadrature::Relaxation => {
                let each = k / (2.0 + kappa);
                [(1.0 - 0.5 * kappa) / (1.0 + 0.5 * kappa), each, each]
            }
            _ => [(-kappa).exp(), 0.0, 0.0],
        };
        Ok(Recursion {
            weight: term.weight,
            decay,
            before,
            own,
        })
    };
    let recursions = terms.iter().map(of).collect::<Result<_, _>>()?;
    Sums::new(recursions, dimension, rule, k)
}

impl Term for Recursion {
    fn add(&self, _: &Point, sum: &[f64], out: &mut [f64]) {
        for (out, sum) in out.iter_mut().zip(sum) {
            *out += self.weight * sum;
        }
    }

    fn own(terms: &[Recursion], _: usize, at: &Point) -> Own {
        Own::Number(if at.rule.is_nodal() {
            let weights: f64 = terms.iter().map(|term| term.weight).sum();
            at.rule.weight(at.k, at.n, at.n) * weights
        } else if at.n == 0 {
            0.0
        } else {
            terms.iter().map(|term| term.weight * term.own).sum()
        })
    }

    /// A sum is `E S_{n-1} + a z_{n-1}`.
    fn push(&self, at: &Point, z: &[f64], sum: &mut [f64]) {
        let factor = match (at.rule.is_nodal(), at.n == 0) {
            (true, _) => self.decay * at.settled(),
            (false, true) => self.before,
            (false, false) => self.decay * self.own + self.before,
        };
        for (sum, z) in sum.iter_mut().zip(z) {
            *sum = self.decay * *sum + factor * z;
        }
    }
}

/// `int_0^1 e^-(kappa x) dx` and the same with the weight x, for `kappa >= 0`: shares of the end and of the beginning of a step.
fn integrals(kappa: f64) -> [f64; 2] {
    if kappa > 0.5 {
        let decay = (-kappa).exp();
        return [
            (1.0 - decay) / kappa,
            (1.0 - decay * (1.0 + kappa)) / (kappa * kappa),
        ];
    }
    let (mut term, mut sums) = (1.0, [0.0; 2]);
    for n in 0..18 {
        let n = f64::from(n);
        sums[0] += term / (n + 1.0);
        sums[1] += term / (n + 2.0);
        term *= -kappa / (n + 1.0);
    }
    sums
}

/// `t^-order / Gamma(1 - order)`, the kernel of a fractional derivative of an order in (0, 1), as a sum of exponentials with positive
/// weights on `shortest <= t <= longest`, s, to a relative error of about `tolerance`: the trapezoid of
///
/// ```text
/// t^-a = 1/Gamma(a) int exp(-t e^x + a x) dx
/// ```
///
/// # Errors
/// [`SolveError::Value`] for an order, times or a tolerance out of range.
pub fn fractional_kernel(
    order: f64,
    [shortest, longest]: [f64; 2],
    tolerance: f64,
) -> Result<Vec<ExponentialTerm>, SolveError> {
    let fault = |what: &str, found, allowed| SolveError::Value {
        what: what.to_owned(),
        found,
        allowed,
    };
    if !(order > 0.0 && order < 1.0) {
        return Err(fault("fractional order", order, "between 0 and 1"));
    }
    if !(shortest > 0.0 && shortest < longest && longest.is_finite()) {
        return Err(fault(
            "shortest time of a kernel",
            shortest,
            "0 < shortest < longest",
        ));
    }
    if !(tolerance > 0.0 && tolerance < 0.1) {
        return Err(fault(
            "tolerance of a kernel",
            tolerance,
            "between 0 and 0.1",
        ));
    }
    // Gamma(a) Gamma(1 - a) = pi / sin(pi a)
    let product = std::f64::consts::PI / (std::f64::consts::PI * order).sin();
    let step =
        2.0 * std::f64::consts::PI / ((3.0 / tolerance).ln() + order * (1.0 / 1.0_f64.cos()).ln());
    // Gamma(1 + a) lies in [0.885, 1]
    let lowest = tolerance.ln() / order - longest.ln();
    let highest = ((1.0 / tolerance).ln() + 1.0).ln() - shortest.ln();
    let places = (lowest / step).floor() as i64..=(highest / step).ceil() as i64;
    Ok(places
        .map(|place| {
            let x = place as f64 * step;
            ExponentialTerm {
                weight: step * (order * x).exp() / product,
                tau: (-x).exp(),
            }
        })
        .collect())
}
