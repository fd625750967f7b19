//! Formulas in texts of users: parsed once into a flat program, evaluated without allocation, differentiated exactly.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = sign { ("*" | "/") sign }
//! sign    = { "+" | "-" } power
//! power   = atom [ "^" sign ]            to the right: 2^3^2 = 2^9, -2^2 = -4
//! atom    = number | variable | constant | function "(" sum { "," sum } ")" | "(" sum ")"
//! ```
//!
//! Constants are `pi` and `e`; functions those of `function.rs`. Derivatives come from evaluation with dual numbers: exact but
//! for rounding. At a kink (`abs`, `min`, `max`) they are those of one of its sides.

mod dual;
mod function;
mod parse;
mod place;

pub use place::{PlaceFormula, PlaceProgram, PlaceValue};

use dual::{Dual, Number};
use function::{BinaryFunction, UnaryFunction};
use std::fmt;

/// Variables of a formula of the place alone: coordinates, m.
pub const COORDINATES: [&str; 3] = ["x", "y", "z"];
/// Longest text, bytes.
pub const LONGEST: usize = 2000;
/// Most operations of a program.
pub const MOST_OPERATIONS: usize = 400;
/// Most values that wait for their operation at once, and deepest nesting.
pub const DEEPEST: usize = 32;

/// What is wrong with a text, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// Place of the first character that is wrong, from 1 on, in characters.
    pub position: usize,
    /// What was found there.
    pub found: String,
    /// What is allowed there.
    pub allowed: String,
}

impl Fault {
    /// What was found, with its place.
    pub fn found_there(&self) -> String {
        format!("{} at character {}", self.found, self.position)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; allowed: {}", self.found_there(), self.allowed)
    }
}

/// An operation on a stack of values.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Operation {
    Constant(f64),
    Variable(usize),
    Negate,
    Unary(&'static UnaryFunction),
    Binary(&'static BinaryFunction),
}

/// A parsed formula.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    operations: Vec<Operation>,
}

impl Program {
    /// Parses a formula in these variables.
    ///
    /// # Errors
    /// The first character that no formula can have there; texts, programs and nestings that are too long.
    pub fn parse(text: &str, variables: &[&str]) -> Result<Program, Fault> {
        let operations = parse::parse(text, variables)?;
        Ok(Program { operations })
    }

    /// Whether a variable occurs, by its place.
    pub fn uses(&self, variable: usize) -> bool {
        self.operations.contains(&Operation::Variable(variable))
    }

    /// The value for these values of the variables.
    pub fn value(&self, variables: &[f64]) -> f64 {
        self.run(|variable| variables[variable])
    }

    /// The value, and its derivatives by the first N variables.
    pub fn derivatives<const N: usize>(&self, variables: &[f64]) -> (f64, [f64; N]) {
        let dual = self.run(|variable| Dual::<N>::variable(variables[variable], variable));
        (dual.value, dual.slopes)
    }

    fn run<T: Number>(&self, variable: impl Fn(usize) -> T) -> T {
        let mut stack = [T::constant(f64::NAN); DEEPEST];
        let mut top = 0;
        for operation in &self.operations {
            match operation {
                Operation::Constant(value) => {
                    stack[top] = T::constant(*value);
                    top += 1;
                }
                Operation::Variable(place) => {
                    stack[top] = variable(*place);
                    top += 1;
                }
                Operation::Negate => stack[top - 1] = stack[top - 1].negated(),
                Operation::Unary(function) => stack[top - 1] = stack[top - 1].unary(function),
                Operation::Binary(function) => {
                    top -= 1;
                    stack[top - 1] = stack[top - 1].binary(stack[top], function);
                }
            }
        }
        stack[0]
    }
}

#[cfg(test)]
mod tests;
