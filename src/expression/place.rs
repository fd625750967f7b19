//! Formulas of the place, as a scene writes them.

use super::{Fault, Program};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The coordinates that formulas of the place know.
const VARIABLES: [&str; 3] = ["x", "y", "z"];

/// A formula of the place.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaceFormula {
    /// Formula of x, y, z (m), e.g. `1 + 0.5 * x`.
    pub expression: String,
}

impl PlaceFormula {
    /// Parses it.
    ///
    /// # Errors
    /// Those of [`Program::parse`].
    pub fn parse(&self) -> Result<PlaceProgram, Fault> {
        Program::parse(&self.expression, &VARIABLES).map(PlaceProgram)
    }
}

/// A parsed formula of the place.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceProgram(Program);

impl PlaceProgram {
    /// The value at a point, m.
    pub fn value(&self, at: &[f64; 3]) -> f64 {
        self.0.value(at)
    }
}

/// A number, or a formula of the place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum PlaceValue {
    /// The same everywhere.
    Number(f64),
    /// By its place.
    Formula(PlaceFormula),
}
