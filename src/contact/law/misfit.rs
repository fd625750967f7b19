//! Why the coefficients of a law are refused.

/// Where a coefficient is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wrong {
    /// The number that is that of all nodes.
    Number,
    /// The number of a node, or the point of a curve.
    Entry(usize),
    /// How many numbers there are.
    Count,
    /// How many rows there are.
    Rows,
    /// How many numbers a row has.
    Row(usize),
}

/// Why coefficients do not fit each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// The coefficient that is wrong.
    pub coefficient: usize,
    pub wrong: Wrong,
    /// The number, or how many there are.
    pub found: f64,
    /// The rule that is violated, as a formula.
    pub rule: &'static str,
    /// What it may be beside the others.
    pub allowed: String,
    /// The coefficient that it does not fit, and its value.
    pub beside: Option<(usize, f64)>,
    /// What was found, where it is not a number or one that needs words.
    pub words: Option<String>,
}
