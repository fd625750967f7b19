//! The functions of formulas: name, value, derivatives.

use std::fmt;

/// A function of one number.
pub struct UnaryFunction {
    pub name: &'static str,
    pub value: fn(f64) -> f64,
    /// The derivative, from the argument and the value.
    pub slope: fn(f64, f64) -> f64,
}

/// A function of two numbers.
pub struct BinaryFunction {
    pub name: &'static str,
    pub value: fn(f64, f64) -> f64,
    /// The derivatives by either, from both and the value.
    pub slopes: fn(f64, f64, f64) -> [f64; 2],
}

impl PartialEq for UnaryFunction {
    fn eq(&self, other: &UnaryFunction) -> bool {
        self.name == other.name
    }
}

impl PartialEq for BinaryFunction {
    fn eq(&self, other: &BinaryFunction) -> bool {
        self.name == other.name
    }
}

impl fmt::Debug for UnaryFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl fmt::Debug for BinaryFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

const fn unary(
    name: &'static str,
    value: fn(f64) -> f64,
    slope: fn(f64, f64) -> f64,
) -> UnaryFunction {
    UnaryFunction { name, value, slope }
}

const fn binary(
    name: &'static str,
    value: fn(f64, f64) -> f64,
    slopes: fn(f64, f64, f64) -> [f64; 2],
) -> BinaryFunction {
    BinaryFunction {
        name,
        value,
        slopes,
    }
}

/// Functions of one number. `log` and `ln` are the natural logarithm.
pub static UNARY: [UnaryFunction; 17] = [
    unary("abs", f64::abs, |x, _| if x < 0.0 { -1.0 } else { 1.0 }),
    unary("sqrt", f64::sqrt, |_, y| 0.5 / y),
    unary("exp", f64::exp, |_, y| y),
    unary("ln", f64::ln, |x, _| 1.0 / x),
    unary("log", f64::ln, |x, _| 1.0 / x),
    unary("log10", f64::log10, |x, _| std::f64::consts::LOG10_E / x),
    unary("sin", f64::sin, |x, _| x.cos()),
    unary("cos", f64::cos, |x, _| -x.sin()),
    unary("tan", f64::tan, |_, y| 1.0 + y * y),
    unary("asin", f64::asin, |x, _| 1.0 / (1.0 - x * x).sqrt()),
    unary("acos", f64::acos, |x, _| -1.0 / (1.0 - x * x).sqrt()),
    unary("atan", f64::atan, |x, _| 1.0 / (1.0 + x * x)),
    unary("sinh", f64::sinh, |x, _| x.cosh()),
    unary("cosh", f64::cosh, |x, _| x.sinh()),
    unary("tanh", f64::tanh, |_, y| 1.0 - y * y),
    unary("asinh", f64::asinh, |x, _| 1.0 / x.hypot(1.0)),
    unary("atanh", f64::atanh, |x, _| 1.0 / (1.0 - x * x)),
];

/// Functions of two numbers.
pub static BINARY: [BinaryFunction; 5] = [
    // not f64::min and max: NaN stays NaN
    binary(
        "min",
        |a, b| {
            if a <= b {
                a
            } else if b < a {
                b
            } else {
                f64::NAN
            }
        },
        |a, b, _| {
            if a < b { [1.0, 0.0] } else { [0.0, 1.0] }
        },
    ),
    binary(
        "max",
        |a, b| {
            if a >= b {
                a
            } else if b > a {
                b
            } else {
                f64::NAN
            }
        },
        |a, b, _| {
            if a > b { [1.0, 0.0] } else { [0.0, 1.0] }
        },
    ),
    binary("hypot", f64::hypot, |a, b, y| [a / y, b / y]),
    binary("atan2", f64::atan2, |a, b, _| {
        let square = a * a + b * b;
        [b / square, -a / square]
    }),
    binary("pow", f64::powf, power_slopes),
];

pub static ADD: BinaryFunction = binary("+", |a, b| a + b, |_, _, _| [1.0, 1.0]);
pub static SUBTRACT: BinaryFunction = binary("-", |a, b| a - b, |_, _, _| [1.0, -1.0]);
pub static MULTIPLY: BinaryFunction = binary("*", |a, b| a * b, |a, b, _| [b, a]);
pub static DIVIDE: BinaryFunction = binary("/", |a, b| a / b, |_, b, y| [1.0 / b, -y / b]);
pub static POWER: BinaryFunction = binary("^", f64::powf, power_slopes);

fn power_slopes(a: f64, b: f64, y: f64) -> [f64; 2] {
    let by_base = if b == 0.0 { 0.0 } else { b * a.powf(b - 1.0) };
    let by_exponent = if y == 0.0 { 0.0 } else { y * a.ln() };
    [by_base, by_exponent]
}

/// Constants.
pub const CONSTANTS: [(&str, f64); 2] = [("pi", std::f64::consts::PI), ("e", std::f64::consts::E)];
