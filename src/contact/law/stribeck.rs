//! A bound that falls from rest to fast slip and rises with a viscous term (R. Stribeck):
//!
//! ```text
//! g(r) = kinetic + (static - kinetic) exp(-(r / velocity)^exponent) + viscous r,   exponent >= 1
//! G(r) = kinetic r + viscous r^2 / 2 + (static - kinetic) velocity J(r / velocity)
//! L    = (static - kinetic) (exponent / velocity) p^p e^-p - viscous,   p = 1 - 1 / exponent
//! ```
//!
//! Below 1 an exponent would make the slope at rest infinite. With `z = x^exponent` and `a = 1 / exponent`,
//!
//! ```text
//! J(x) = int_0^x exp(-t^exponent) dt = a gamma(a, z)
//!      = x e^-z (1 + z / (a+1) + z^2 / ((a+1)(a+2)) + ...)                         small z
//!      = J(infinity) - a x e^-z / (z+1-a - 1(1-a) / (z+3-a - 2(2-a) / (z+5-a - ...)))  large z
//! ```
//!
//! (NIST Handbook of Mathematical Functions, 8.7.1 and 8.9.2). Both have terms of one sign and reach rounding in some 25
//! terms; a quadrature would lose digits at rest, where `t^exponent` is not smooth. `J(infinity)` is the sum of both where
//! they meet, so no step remains there. The exponent 1 is an exponential law and costs as little.

use super::{At, Coefficient, Coefficients, FrictionLaw, Omitted, Range, Unit, Value};
use crate::contact::evaluation::{Evaluation, NodalLaw, Nodes};
use crate::linalg::exp_m1_and_exp;

pub struct Stribeck;

const STATIC: usize = 0;
const KINETIC: usize = 1;
const VELOCITY: usize = 2;
const EXPONENT: usize = 3;
const VISCOUS: usize = 4;

const AT_LEAST_ONE: Range = Range {
    least: 1.0,
    is_open: false,
    allowed: "a finite number >= 1",
};

const fn bound(name: &'static str, text: &'static str) -> Coefficient {
    Coefficient::new(name, Unit::VALUE, Range::NOT_NEGATIVE, text)
}

const DECLARED: [Coefficient; 5] = [
    bound("static", "Value at rest, {}; not negative."),
    bound(
        "kinetic",
        "Value at fast slip without its viscous part, {}; not negative.",
    ),
    Coefficient::new(
        "velocity",
        Unit::Own("m/s"),
        Range::POSITIVE,
        "Slip rate at which the value has fallen to 1/e of the way, m/s; positive.",
    ),
    Coefficient::new(
        "exponent",
        Unit::Own("1"),
        AT_LEAST_ONE,
        "Exponent of the slip rate; at least 1.",
    ),
    Coefficient {
        omitted: Omitted::Means(0.0),
        ..Coefficient::new(
            "viscous",
            Unit::VALUE_PER_RATE,
            Range::NOT_NEGATIVE,
            "Rise of the value with the slip rate, {}; not negative, default 0.",
        )
    },
];

impl FrictionLaw for Stribeck {
    fn name(&self) -> &'static str {
        "stribeck"
    }

    fn text(&self) -> &'static str {
        "`kinetic + (static - kinetic) exp(-(r / velocity)^exponent) + viscous r`."
    }

    fn coefficients(&self) -> &'static [Coefficient] {
        &DECLARED
    }

    fn evaluate(&self, at: &At) -> Evaluation {
        let curve = Curve::new(at.coefficient(EXPONENT));
        Node::at(&at.coefficients, at.node).on_curve(&curve, at.rate)
    }

    /// Without the integral J.
    fn value(&self, at: &At) -> Value {
        let exponent = at.coefficient(EXPONENT);
        let own = Node::at(&at.coefficients, at.node);
        let all = own.evaluate(exponent, at.rate, |_, _, _| 0.0);
        Value::new(all.bound, all.slope)
    }

    fn at_rest(&self, at: &At) -> f64 {
        at.coefficient(STATIC)
    }

    fn weakening(&self, at: &At) -> f64 {
        let own = Node::at(&at.coefficients, at.node);
        let exponent = at.coefficient(EXPONENT);
        let p = 1.0 - 1.0 / exponent;
        let steepest = p.powf(p) * exp_m1_and_exp(-p)[1];
        (own.fall() * (exponent / own.velocity) * steepest - own.viscous).max(0.0)
    }

    fn extremes(&self, coefficients: Coefficients, node: usize) -> [f64; 2] {
        let own = Node::at(&coefficients, node);
        let largest = if own.viscous > 0.0 {
            f64::INFINITY
        } else {
            own.at_rest.max(own.kinetic)
        };
        [largest, own.at_rest.min(own.kinetic)]
    }

    fn fill(&self, coefficients: Coefficients, nodes: Nodes, out: &mut NodalLaw) {
        let exponent = coefficients.field(EXPONENT);
        let is_one_number = coefficients.values(EXPONENT).len() == 1;
        if !is_one_number {
            return out.fill(nodes, |node, rate, _| {
                Node::at(&coefficients, node).on_curve(&Curve::new(exponent.at(node)), rate)
            });
        }
        let curve = Curve::new(exponent.at(0));
        if curve.exponent == 1.0 {
            let all = [STATIC, KINETIC, VELOCITY, VISCOUS].map(|i| coefficients.field(i));
            return out.fill(
                nodes,
                #[inline(always)]
                |node, rate, _| {
                    let [at_rest, kinetic, velocity, viscous] = all.map(
                        #[inline(always)]
                        |field| field.at(node),
                    );
                    let own = Node {
                        at_rest,
                        kinetic,
                        velocity,
                        viscous,
                    };
                    own.exponential(rate)
                },
            );
        }
        out.fill(nodes, |node, rate, _| {
            Node::at(&coefficients, node).on_curve(&curve, rate)
        });
    }
}

/// The coefficients of a node but for the exponent.
#[derive(Debug, Clone, Copy)]
struct Node {
    at_rest: f64,
    kinetic: f64,
    velocity: f64,
    viscous: f64,
}

impl Node {
    fn at(coefficients: &Coefficients, node: usize) -> Node {
        Node {
            at_rest: coefficients.at(STATIC, node),
            kinetic: coefficients.at(KINETIC, node),
            velocity: coefficients.at(VELOCITY, node),
            viscous: coefficients.at(VISCOUS, node),
        }
    }

    #[inline(always)]
    fn fall(&self) -> f64 {
        self.at_rest - self.kinetic
    }

    fn on_curve(&self, curve: &Curve, rate: f64) -> Evaluation {
        self.evaluate(curve.exponent, rate, |x, z, left| {
            curve.integral(x, z, left)
        })
    }

    fn evaluate(
        &self,
        exponent: f64,
        rate: f64,
        integral: impl FnOnce(f64, f64, f64) -> f64,
    ) -> Evaluation {
        if exponent == 1.0 {
            return self.exponential(rate);
        }
        let x = rate / self.velocity;
        let y = x.powf(exponent - 1.0);
        let z = x * y;
        let [decay, left] = exp_m1_and_exp(-z);
        // where nothing is left, y may be infinite
        let steepness = if left > 0.0 { y * left } else { 0.0 };
        self.sum(rate, [decay, left], exponent * steepness, || {
            integral(x, z, left)
        })
    }

    /// The exponent 1.
    #[inline(always)]
    fn exponential(&self, rate: f64) -> Evaluation {
        let [decay, left] = exp_m1_and_exp(-(rate / self.velocity));
        self.sum(
            rate,
            [decay, left],
            left,
            #[inline(always)]
            || -decay,
        )
    }

    /// The law from `exp(-z) - 1` and `exp(-z)`, the derivative of `-exp(-z)` by `r / velocity`, and J. The falling part is summed
    /// from its nearer end, which keeps its digits.
    #[inline(always)]
    fn sum(
        &self,
        rate: f64,
        [decay, left]: [f64; 2],
        steepness: f64,
        integral: impl FnOnce() -> f64,
    ) -> Evaluation {
        let fall = self.fall();
        let from_rest = self.at_rest + fall * decay;
        let from_fast = self.kinetic + fall * left;
        let falling = if decay > -0.5 { from_rest } else { from_fast };
        Evaluation {
            bound: falling + self.viscous * rate,
            slope: self.viscous - fall / self.velocity * steepness,
            potential: (self.kinetic + 0.5 * self.viscous * rate) * rate
                + fall * self.velocity * integral(),
        }
    }
}

/// z at which the series for J ends and the continued fraction begins.
const MEETING: f64 = 3.0;
/// Beyond this the rest of J is below its rounding.
const FAR: f64 = 40.0;
/// Terms of either at most; 30 are enough from 0 to `MEETING` and from there on.
const TERMS: u32 = 200;

/// J of an exponent.
#[derive(Debug, Clone, Copy)]
struct Curve {
    exponent: f64,
    /// J at infinity.
    whole: f64,
}

impl Curve {
    fn new(exponent: f64) -> Curve {
        let a = 1.0 / exponent;
        let (x, left) = (MEETING.powf(a), exp_m1_and_exp(-MEETING)[1]);
        let whole = if exponent == 1.0 {
            1.0
        } else {
            x * left * (series(a, MEETING) + a * fraction(a, MEETING))
        };
        Curve { exponent, whole }
    }

    /// `J(x)`, with `z = x^exponent` and `left = exp(-z)`.
    fn integral(&self, x: f64, z: f64, left: f64) -> f64 {
        let a = 1.0 / self.exponent;
        if z <= MEETING {
            x * left * series(a, z)
        } else if z < FAR {
            self.whole - a * x * left * fraction(a, z)
        } else {
            self.whole
        }
    }
}

/// `1 + z / (a+1) + z^2 / ((a+1)(a+2)) + ...`
fn series(a: f64, z: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for n in 1..TERMS {
        term *= z / (a + f64::from(n));
        sum += term;
        if term <= 0.5 * f64::EPSILON * sum {
            break;
        }
    }
    sum
}

/// `1 / (z+1-a - 1(1-a) / (z+3-a - 2(2-a) / (z+5-a - ...)))` by the method of Lentz; no denominator vanishes for `z > 0`, `a <= 1`.
fn fraction(a: f64, z: f64) -> f64 {
    let mut denominator = z + 1.0 - a;
    let (mut d, mut c) = (1.0 / denominator, 1.0 / f64::MIN_POSITIVE);
    let mut value = d;
    for n in 1..TERMS {
        let n = f64::from(n);
        let numerator = -n * (n - a);
        denominator += 2.0;
        d = 1.0 / (denominator + numerator * d);
        c = denominator + numerator / c;
        let factor = c * d;
        value *= factor;
        if (factor - 1.0).abs() <= f64::EPSILON {
            break;
        }
    }
    value
}
