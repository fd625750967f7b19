//! Friction laws: the bound of the tangential stress as a function of node, slip rate and accumulated slip.
//!
//! Within one stage the accumulated slip is itself a function of the slip rate, `s = base + per_rate * rate`
//! ([`SlipPath`]), so every law is, for the solver, a scalar function of the slip rate alone.

use super::evaluation::{Evaluation, NodalLaw, Nodes, SlipPath};
use crate::error::{Error, Result};
use crate::linalg::{exp_m1, exp_m1_and_exp};
use crate::scene::Friction;

/// A friction bound `g >= 0` in Pa.
pub trait FrictionLaw {
    /// Bound at contact node `node` and slip rate `rate >= 0` (m/s).
    fn bound(&self, node: usize, rate: f64, slip: SlipPath) -> f64;
    /// Total derivative of the bound by the slip rate, along `slip`, Pa s/m.
    fn slope(&self, node: usize, rate: f64, slip: SlipPath) -> f64;
    /// Partial derivative of the bound by the accumulated slip `slip.base` at fixed slip rate, Pa/m; 0 for a law without memory.
    fn slip_slope(&self, _node: usize, _rate: f64, _slip: SlipPath) -> f64 {
        0.0
    }
    /// Largest bound at rest over the nodes, times their weights, N.
    fn largest_at_rest(&self, nodes: Nodes) -> f64 {
        let slips = nodes.weights.iter().zip(nodes.slip_base).enumerate();
        let bounds = slips.map(|(node, (weight, base))| {
            let slip = SlipPath {
                base: *base,
                per_rate: nodes.per_rate,
            };
            weight * self.bound(node, 0.0, slip)
        });
        bounds.fold(0.0, f64::max)
    }
    /// Integral of the bound over the slip rate from 0 to `rate`, W/m^2.
    fn potential(&self, node: usize, rate: f64, slip: SlipPath) -> f64;

    /// The three together; a law whose terms share work may say so.
    fn evaluate(&self, node: usize, rate: f64, slip: SlipPath) -> Evaluation {
        Evaluation {
            bound: self.bound(node, rate, slip),
            slope: self.slope(node, rate, slip),
            potential: self.potential(node, rate, slip),
        }
    }

    /// The three at all nodes, times their weights; a law without branches is vectorized.
    #[inline(always)]
    fn evaluate_all(&self, nodes: Nodes, out: &mut NodalLaw) {
        out.fill(nodes, |node, rate, slip| self.evaluate(node, rate, slip));
    }
}

/// The laws a scene can name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// `g = 0`.
    Frictionless,
    /// `g = bound`.
    Tresca { bound: f64 },
    /// `g(r) = (a - b) exp(-alpha r) + b`, `a >= b >= 0`, `alpha >= 0` (7.14).
    Exponential { a: f64, b: f64, alpha: f64 },
}

/// Largest number of coefficients of a law.
pub const MAX_COEFFICIENTS: usize = 3;

impl Law {
    /// The law of a scene.
    pub fn from_scene(friction: &Friction) -> Law {
        match *friction {
            Friction::Frictionless {} => Law::Frictionless,
            Friction::Tresca { bound } => Law::Tresca { bound },
            Friction::Exponential { a, b, alpha } => Law::Exponential { a, b, alpha },
        }
    }

    /// Names of the coefficients, in the order of [`Law::coefficients`].
    pub fn coefficient_names(&self) -> &'static [&'static str] {
        match self {
            Law::Frictionless => &[],
            Law::Tresca { .. } => &["bound"],
            Law::Exponential { .. } => &["a", "b", "alpha"],
        }
    }

    /// Units of the coefficients.
    pub fn coefficient_units(&self) -> &'static [&'static str] {
        match self {
            Law::Frictionless => &[],
            Law::Tresca { .. } => &["Pa"],
            Law::Exponential { .. } => &["Pa", "Pa", "s/m"],
        }
    }

    /// Values of the coefficients; unused places are zero.
    pub fn coefficients(&self) -> [f64; MAX_COEFFICIENTS] {
        match *self {
            Law::Frictionless => [0.0; MAX_COEFFICIENTS],
            Law::Tresca { bound } => [bound, 0.0, 0.0],
            Law::Exponential { a, b, alpha } => [a, b, alpha],
        }
    }

    /// Refuses a value that the coefficient cannot have, whatever the other ones are.
    ///
    /// # Errors
    /// [`Error::Value`] when it is not finite or out of its range.
    pub fn check_coefficient(&self, index: usize, value: f64) -> Result<()> {
        if value.is_finite() && value >= 0.0 {
            return Ok(());
        }
        let name = self.coefficient_names().get(index).unwrap_or(&"?");
        Err(Error::Value {
            what: format!("contact.friction.{name}"),
            found: value,
            allowed: "a finite number >= 0",
        })
    }

    /// The same law with other coefficients (the first `coefficient_names().len()` of `values`): a complete set, in which the
    /// rules between coefficients hold too.
    ///
    /// # Errors
    /// [`Error::Value`] when a coefficient is not finite or out of its range, or does not fit the other ones.
    pub fn with_coefficients(&self, values: &[f64; MAX_COEFFICIENTS]) -> Result<Law> {
        for (i, value) in values[..self.coefficient_names().len()].iter().enumerate() {
            self.check_coefficient(i, *value)?;
        }
        let [first, second, third] = *values;
        Ok(match self {
            Law::Frictionless => Law::Frictionless,
            Law::Tresca { .. } => Law::Tresca { bound: first },
            Law::Exponential { .. } => {
                let (a, b, alpha) = (first, second, third);
                if a < b {
                    return Err(Error::Value {
                        what: format!("contact.friction.a, where contact.friction.b is {b:?}"),
                        found: a,
                        allowed: "a >= b",
                    });
                }
                Law::Exponential { a, b, alpha }
            }
        })
    }

    /// Lipschitz constant L_g of the bound, Pa s/m (5.16).
    pub fn lipschitz(&self) -> f64 {
        match *self {
            Law::Exponential { a, b, alpha } => (a - b) * alpha,
            _ => 0.0,
        }
    }

    /// Bound at rest, Pa.
    pub fn static_bound(&self) -> f64 {
        match *self {
            Law::Frictionless => 0.0,
            Law::Tresca { bound } => bound,
            Law::Exponential { a, .. } => a,
        }
    }

    /// Bound at an infinite slip rate, Pa.
    pub fn kinetic_bound(&self) -> f64 {
        match *self {
            Law::Frictionless => 0.0,
            Law::Tresca { bound } => bound,
            Law::Exponential { b, .. } => b,
        }
    }
}

impl FrictionLaw for Law {
    fn bound(&self, _node: usize, rate: f64, _slip: SlipPath) -> f64 {
        match *self {
            Law::Frictionless => 0.0,
            Law::Tresca { bound } => bound,
            Law::Exponential { a, b, alpha } => decayed(a, b, alpha, rate).bound,
        }
    }

    fn slope(&self, _node: usize, rate: f64, _slip: SlipPath) -> f64 {
        match *self {
            Law::Exponential { a, b, alpha } => decayed(a, b, alpha, rate).slope,
            _ => 0.0,
        }
    }

    fn potential(&self, _node: usize, rate: f64, _slip: SlipPath) -> f64 {
        match *self {
            Law::Frictionless => 0.0,
            Law::Tresca { bound } => bound * rate,
            // exp_m1 keeps the potential exact for small alpha * rate; alpha = 0 is the constant bound a
            Law::Exponential { a, b, alpha } if alpha > 0.0 => {
                b * rate - (a - b) * exp_m1(-alpha * rate) / alpha
            }
            Law::Exponential { a, .. } => a * rate,
        }
    }

    fn largest_at_rest(&self, nodes: Nodes) -> f64 {
        self.static_bound() * nodes.weights.iter().copied().fold(0.0, f64::max)
    }

    fn evaluate(&self, node: usize, rate: f64, slip: SlipPath) -> Evaluation {
        match *self {
            Law::Exponential { a, b, alpha } if alpha > 0.0 => exponential(a, b, alpha, rate),
            _ => Evaluation {
                bound: self.bound(node, rate, slip),
                slope: self.slope(node, rate, slip),
                potential: self.potential(node, rate, slip),
            },
        }
    }

    #[inline(always)]
    fn evaluate_all(&self, nodes: Nodes, out: &mut NodalLaw) {
        match *self {
            Law::Exponential { a, b, alpha } if alpha > 0.0 => {
                out.fill(nodes, |_, rate, _| exponential(a, b, alpha, rate));
            }
            _ => out.fill(nodes, |node, rate, slip| self.evaluate(node, rate, slip)),
        }
    }
}

/// Share of the static bound below which `a + (a - b) expm1` has lost digits of the bound.
const SMALL_SHARE: f64 = 1.0 / 1024.0;

/// Bound and slope of the exponential law, and the `expm1` they are made of.
struct Decayed {
    bound: f64,
    slope: f64,
    decay: f64,
}

/// A bound that has decayed far below the static one keeps its digits: it is then summed from its kinetic end.
#[inline(always)]
fn decayed(a: f64, b: f64, alpha: f64, rate: f64) -> Decayed {
    let [decay, left] = exp_m1_and_exp(-alpha * rate);
    let from_rest = a + (a - b) * decay;
    let is_small = from_rest < SMALL_SHARE * a;
    Decayed {
        bound: if is_small {
            b + (a - b) * left
        } else {
            from_rest
        },
        slope: -alpha * (a - b) * if is_small { left } else { 1.0 + decay },
        decay,
    }
}

/// One exponential serves bound, slope and potential.
#[inline(always)]
fn exponential(a: f64, b: f64, alpha: f64, rate: f64) -> Evaluation {
    let Decayed {
        bound,
        slope,
        decay,
    } = decayed(a, b, alpha, rate);
    Evaluation {
        bound,
        slope,
        potential: b * rate - (a - b) / alpha * decay,
    }
}

/// Bounds frozen node by node: the majorising problem of the paper's iteration (Problem 7.4).
#[derive(Debug, Clone, Copy)]
pub struct FrozenBounds<'a>(pub &'a [f64]);

impl FrictionLaw for FrozenBounds<'_> {
    fn bound(&self, node: usize, _rate: f64, _slip: SlipPath) -> f64 {
        self.0[node]
    }

    fn slope(&self, _node: usize, _rate: f64, _slip: SlipPath) -> f64 {
        0.0
    }

    fn potential(&self, node: usize, rate: f64, _slip: SlipPath) -> f64 {
        self.0[node] * rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: SlipPath = SlipPath {
        base: 0.0,
        per_rate: 0.0,
    };

    #[test]
    fn slope_and_potential_are_derivative_and_integral_of_the_bound() {
        let laws = [
            Law::Frictionless,
            Law::Tresca { bound: 0.3 },
            Law::Exponential {
                a: 0.003,
                b: 0.001,
                alpha: 100.0,
            },
            Law::Exponential {
                a: 3.0,
                b: 1.0,
                alpha: 0.0,
            },
        ];
        for law in laws {
            for rate in [1e-4, 0.01, 0.3] {
                let d = 1e-6 * rate;
                let slope = (law.bound(0, rate + d, AT) - law.bound(0, rate - d, AT)) / (2.0 * d);
                assert!((slope - law.slope(0, rate, AT)).abs() <= 1e-6 * (1.0 + slope.abs()));
                let bound =
                    (law.potential(0, rate + d, AT) - law.potential(0, rate - d, AT)) / (2.0 * d);
                assert!((bound - law.bound(0, rate, AT)).abs() <= 1e-6 * (1e-3 + bound.abs()));
            }
            for rate in [0.0, 1e-9, 1e-4, 0.01, 0.3, 50.0] {
                let all = law.evaluate(0, rate, AT);
                let mut nodal = NodalLaw::new(1);
                let nodes = Nodes {
                    weights: &[2.0],
                    rates: &[rate],
                    slip_base: &[0.0],
                    per_rate: 0.0,
                };
                law.evaluate_all(nodes, &mut nodal);
                assert_eq!(nodal.bound[0], 2.0 * all.bound);
                assert_eq!(nodal.slope[0], 2.0 * all.slope);
                assert_eq!(nodal.potential[0], 2.0 * all.potential);
                let close = |a: f64, b: f64| (a - b).abs() <= 1e-14 * (a.abs() + b.abs()) + 1e-17;
                assert!(close(all.bound, law.bound(0, rate, AT)));
                assert!(close(all.slope, law.slope(0, rate, AT)));
                assert!(close(all.potential, law.potential(0, rate, AT)));
            }
            assert_eq!(law.potential(0, 0.0, AT), 0.0);
            assert!((law.bound(0, 0.0, AT) - law.static_bound()).abs() < 1e-15);
        }
    }

    /// `a + (a - b) expm1` would leave only what rounding of `a` leaves: 7e-5 of the bound at the first of these rates.
    #[test]
    fn a_bound_far_below_the_static_one_keeps_its_digits() {
        let (a, alpha) = (0.002_915_296_635_569_256, 15.905_690_361_416_516);
        for b in [0.0, 1.829_174_241_068_124_5e-13] {
            let law = Law::Exponential { a, b, alpha };
            for rate in [1.752_592_413_445_908_5, 0.6, 5.0, 40.0] {
                let right = b + (a - b) * (-alpha * rate).exp();
                let slope = -alpha * (a - b) * (-alpha * rate).exp();
                for found in [law.bound(0, rate, AT), law.evaluate(0, rate, AT).bound] {
                    assert!((found / right - 1.0).abs() < 1e-12, "{found:e} {right:e}");
                }
                assert!((law.slope(0, rate, AT) / slope - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn coefficients_round_trip_and_are_checked() {
        let law = Law::Exponential {
            a: 3.0,
            b: 1.0,
            alpha: 2.0,
        };
        assert_eq!(law.with_coefficients(&law.coefficients()), Ok(law));
        assert!(law.with_coefficients(&[1.0, 2.0, 0.0]).is_err());
        assert!(law.with_coefficients(&[f64::NAN, 0.0, 0.0]).is_err());
        assert!(law.with_coefficients(&[1.0, 0.0, -1.0]).is_err());
        assert!(law.check_coefficient(1, 5.0).is_ok());
        assert!(law.check_coefficient(1, -5.0).is_err());
        // what a law does not have is not looked at
        let tresca = Law::Tresca { bound: 1.0 };
        assert!(tresca.with_coefficients(&[2.0, f64::NAN, -1.0]).is_ok());
    }
}
