//! Rate-and-state friction (Dieterich, Ruina), regularised at rest:
//!
//! ```text
//! mu = a asinh( r / (2 V0) exp((mu0 + b ln(V0 theta / D_c)) / a) )
//! theta' = 1 - r theta / D_c          aging
//! theta' = -q ln q, q = r theta / D_c     slip
//! ```
//!
//! with `mu0` = `coefficient`, `V0` = `rate`, `D_c` = `distance`. The value vanishes at rest, so no node sticks; it creeps. Within a
//! stage the state is that of a constant rate `rb` (`MemoryPath`) over the length `dt`, exactly. With `x = rb dt / D_c`,
//! `phi = (1 - e^-x) / x` and q before the stage,
//!
//! ```text
//! aging  theta = theta0 e^-x + dt phi
//! slip   ln theta = ln theta0 - (1 - e^-x) ln q
//! ```
//!
//! in which nothing is divided by a rate that may vanish. The value is computed from `ln theta` and `ln r`: the argument of asinh
//! overflows where `mu0 / a` is large. With `v = 2 V0 exp(-(mu0 + b ln(V0 theta / D_c)) / a)`,
//!
//! ```text
//! dmu/dr = a / hypot(r, v) + b r / hypot(r, v) dln(theta)/dr
//! L <= b share dt / D_c                                    aging
//! L <= b share dt / D_c (1.1 + max(0, ln(theta0 / dt)))    slip,   `share` of the stage's rate in rb
//! ```
//!
//! so L vanishes with the step. There is no closed potential. At steady slip, `theta = D_c / r`, both evolution laws give
//!
//! ```text
//! r dmu/dr = (a - b share (1 - e^-x)) r / hypot(r, v)
//! ```
//!
//! so a stage resists more the faster it slips up to `x = -ln(1 - a / (b share))`, and always where `a >= b share`.

use super::{
    At, Coefficient, Coefficients, Extent, FrictionLaw, MemoryPath, Omitted, Range, Unit, Value,
};
use crate::contact::evaluation::Evaluation;

pub struct RateAndState;

const COEFFICIENT: usize = 0;
const A: usize = 1;
const B: usize = 2;
const RATE: usize = 3;
const DISTANCE: usize = 4;
const EVOLUTION: usize = 5;
const INITIAL_STATE: usize = 6;

const fn positive(name: &'static str, unit: Unit, text: &'static str) -> Coefficient {
    Coefficient::new(name, unit, Range::POSITIVE, text)
}

const DECLARED: [Coefficient; 7] = [
    Coefficient::new(
        "coefficient",
        Unit::VALUE,
        Range::NOT_NEGATIVE,
        "Value of steady slip with the reference rate, {}; not negative.",
    ),
    positive(
        "a",
        Unit::VALUE,
        "Rise of the value with the logarithm of the slip rate, {}; positive.",
    ),
    positive(
        "b",
        Unit::VALUE,
        "Rise of the value with the logarithm of the state, {}; positive.",
    ),
    positive(
        "rate",
        Unit::Own("m/s"),
        "Reference slip rate, m/s; positive.",
    ),
    positive(
        "distance",
        Unit::Own("m"),
        "Slip over which the state forgets, m; positive.",
    ),
    Coefficient {
        extent: Extent::Choice(&["aging", "slip"]),
        ..Coefficient::new(
            "evolution",
            Unit::Own("1"),
            Range::NOT_NEGATIVE,
            "Law by which the state moves: `aging`, which heals at rest, or `slip`.",
        )
    },
    Coefficient {
        omitted: Omitted::Without,
        ..positive(
            "initial_state",
            Unit::Own("s"),
            "State at the start, s; positive, default `distance / rate`.",
        )
    },
];

impl FrictionLaw for RateAndState {
    fn name(&self) -> &'static str {
        "rate_and_state"
    }

    fn text(&self) -> &'static str {
        "`a asinh(r / (2 rate) exp((coefficient + b ln(rate theta / distance)) / a))`, theta the state."
    }

    fn coefficients(&self) -> &'static [Coefficient] {
        &DECLARED
    }

    fn has_potential(&self) -> bool {
        false
    }

    fn initial_state(&self, coefficients: Coefficients, node: usize) -> Option<f64> {
        let steady = || coefficients.at(DISTANCE, node) / coefficients.at(RATE, node);
        Some(coefficients.get(INITIAL_STATE, node).unwrap_or_else(steady))
    }

    fn advance(&self, coefficients: Coefficients, node: usize, path: MemoryPath, rate: f64) -> f64 {
        let node = Node::at(&coefficients, node);
        node.moved(path, rate).exp()
    }

    fn steady_limit(
        &self,
        coefficients: Coefficients,
        node: usize,
        length: f64,
        rate_share: f64,
    ) -> f64 {
        let Node { a, b, distance, .. } = Node::at(&coefficients, node);
        let share = a / (b * rate_share);
        if share >= 1.0 {
            f64::INFINITY
        } else {
            -(-share).ln_1p() * distance / length
        }
    }

    fn evaluate(&self, at: &At) -> Evaluation {
        let Value { value, by_rate, .. } = self.value(at);
        Evaluation {
            bound: value,
            slope: by_rate,
            potential: f64::NAN,
        }
    }

    fn value(&self, at: &At) -> Value {
        Node::at(&at.coefficients, at.node).value(at.memory, at.rate)
    }

    fn at_rest(&self, _at: &At) -> f64 {
        0.0
    }

    fn weakening(&self, at: &At) -> f64 {
        let node = Node::at(&at.coefficients, at.node);
        let MemoryPath {
            state,
            length,
            rate_share,
            ..
        } = at.memory;
        if length == 0.0 {
            return 0.0;
        }
        let most = match node.evolution {
            Evolution::Aging => 1.0,
            Evolution::Slip => 1.1 + (state / length).ln().max(0.0),
        };
        node.b * rate_share * length / node.distance * most
    }

    fn extremes(&self, _coefficients: Coefficients, _node: usize) -> [f64; 2] {
        [f64::INFINITY, 0.0]
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Evolution {
    Aging,
    Slip,
}

/// The coefficients of a node.
#[derive(Debug, Clone, Copy)]
struct Node {
    mu0: f64,
    a: f64,
    b: f64,
    rate: f64,
    distance: f64,
    evolution: Evolution,
}

/// Logarithm of the argument of asinh beyond which `asinh(u) = ln(2 u)` to rounding.
const LARGE: f64 = 20.0;
/// Logarithm of the smallest rate v, in units of V0, that slopes know: their reciprocals stay numbers.
const SMALLEST_LN: f64 = -345.0;
/// Below this x the functions phi are summed as series.
const SMALL: f64 = 0.5;

impl Node {
    fn at(coefficients: &Coefficients, node: usize) -> Node {
        let [mu0, a, b, rate, distance] =
            [COEFFICIENT, A, B, RATE, DISTANCE].map(|i| coefficients.at(i, node));
        let evolution = match coefficients.choice(EVOLUTION) {
            0 => Evolution::Aging,
            _ => Evolution::Slip,
        };
        Node {
            mu0,
            a,
            b,
            rate,
            distance,
            evolution,
        }
    }

    fn value(&self, path: MemoryPath, rate: f64) -> Value {
        let ln_state = self.moved(path, rate);
        let exponent =
            (self.mu0 + self.b * (self.rate / self.distance).ln() + self.b * ln_state) / self.a;
        // u = r / v
        let ln_u = (rate / (2.0 * self.rate)).ln() + exponent;
        let value = if ln_u > LARGE {
            self.a * (ln_u + std::f64::consts::LN_2)
        } else if exponent < -SMALLEST_LN {
            self.a * (rate / (2.0 * self.rate) * exponent.exp()).asinh()
        } else {
            self.a * ln_u.exp().asinh()
        };
        let v = 2.0 * self.rate * (-exponent).max(SMALLEST_LN).exp();
        let size = rate.hypot(v);
        let share = rate / size;
        // at rest the state's own slope may be infinite, and does not count
        let of_state = if share > 0.0 {
            self.b * share * self.ln_state_slope(path, rate)
        } else {
            0.0
        };
        Value::new(value, self.a / size + of_state)
    }

    /// `ln theta` at the end of the stage.
    fn moved(&self, path: MemoryPath, rate: f64) -> f64 {
        let mean = path.mean_rate(rate);
        let x = mean * (path.length / self.distance);
        match self.evolution {
            _ if path.length == 0.0 => path.state.ln(),
            Evolution::Aging => (path.state * (-x).exp() + path.length * phi(x)).ln(),
            // x may vanish where the rate does not: the logarithm is finite there
            Evolution::Slip if mean > 0.0 => {
                path.state.ln() + (-x).exp_m1() * self.ln_q(path.state, mean)
            }
            Evolution::Slip => path.state.ln(),
        }
    }

    /// `ln(rb theta / D_c)`, of factors whose product may leave the range of numbers.
    fn ln_q(&self, state: f64, mean: f64) -> f64 {
        mean.ln() + state.ln() - self.distance.ln()
    }

    /// `dln(theta)/dr`.
    fn ln_state_slope(&self, path: MemoryPath, rate: f64) -> f64 {
        let mean = path.mean_rate(rate);
        let by_rate = path.length / self.distance;
        let x = mean * by_rate;
        let slope = match self.evolution {
            _ if path.length == 0.0 => 0.0,
            Evolution::Aging => {
                let decayed = path.state * (-x).exp();
                (path.length * phi_slope(x) - decayed) / (decayed + path.length * phi(x))
            }
            Evolution::Slip => -((-x).exp() * self.ln_q(path.state, mean) + phi(x)),
        };
        path.rate_share * by_rate * slope
    }
}

/// `(1 - e^-x) / x` for `x >= 0`.
fn phi(x: f64) -> f64 {
    if x < SMALL {
        alternating(x, |n| 1.0 / (n + 2.0))
    } else {
        -(-x).exp_m1() / x
    }
}

/// Its derivative, `(e^-x (1 + x) - 1) / x^2`.
fn phi_slope(x: f64) -> f64 {
    if x < SMALL {
        // the sum of n (-x)^(n-1) (-1) / (n+1)! is -1/2 (1 - 2x/3 + x^2/4 - ...)
        -0.5 * alternating(x, |n| (n + 2.0) / ((n + 1.0) * (n + 3.0)))
    } else {
        ((-x).exp() - phi(x)) / x
    }
}

/// `1 - c(0) x + c(0) c(1) x^2 - ...` to rounding, for `x` below [`SMALL`].
fn alternating(x: f64, ratio: impl Fn(f64) -> f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for n in 0..16 {
        term *= -x * ratio(f64::from(n));
        sum += term;
    }
    sum
}
