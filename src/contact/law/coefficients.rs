//! Coefficients of friction laws: how a law declares them, and their values as fields over the contact nodes.

use super::formula::{Formula, field};
use super::misfit::{Misfit, Wrong};
use crate::message::number;
use std::borrow::Cow;

/// Values that a coefficient may have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Least value.
    pub least: f64,
    /// Whether the least value itself is excluded.
    pub is_open: bool,
    /// The range in words, for errors.
    pub allowed: &'static str,
}

impl Range {
    pub const NOT_NEGATIVE: Range = Range {
        least: 0.0,
        is_open: false,
        allowed: "a finite number >= 0",
    };
    pub const POSITIVE: Range = Range {
        least: 0.0,
        is_open: true,
        allowed: "a finite number > 0",
    };

    /// Whether a number is in the range.
    pub fn contains(&self, value: f64) -> bool {
        let is_inside = if self.is_open {
            value > self.least
        } else {
            value >= self.least
        };
        is_inside && value.is_finite()
    }
}

/// What the numbers of a coefficient belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// To the contact nodes: one number for all, or one per node.
    Nodes,
    /// To the points of a curve, at least one: the same at all nodes.
    Points,
    /// To the points of a curve, or to those of a surface in rows of equal length.
    Grid,
    /// To nothing: one of these words, which is no port.
    Choice(&'static [&'static str]),
    /// To nothing: a formula, which is no port.
    Formula,
}

/// Unit of a coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// SI unit, whatever the law is used for; `1` for a number.
    Own(&'static str),
    /// One unit in a bound of the stress, another in a coefficient of friction.
    OfUse {
        bound: &'static str,
        coefficient: &'static str,
    },
}

impl Unit {
    /// Unit of the law's value itself.
    pub const VALUE: Unit = Unit::OfUse {
        bound: "Pa",
        coefficient: "1",
    };
    /// Unit of the value over a slip rate.
    pub const VALUE_PER_RATE: Unit = Unit::OfUse {
        bound: "Pa.s/m",
        coefficient: "s/m",
    };

    /// The unit in a bound.
    pub fn in_bound(self) -> &'static str {
        match self {
            Unit::Own(unit) | Unit::OfUse { bound: unit, .. } => unit,
        }
    }

    /// The unit in a coefficient of friction.
    pub fn in_coefficient(self) -> &'static str {
        match self {
            Unit::Own(unit)
            | Unit::OfUse {
                coefficient: unit, ..
            } => unit,
        }
    }
}

/// What it means that a scene leaves a coefficient out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Omitted {
    /// A mistake.
    Refused,
    /// This number.
    Means(f64),
    /// The law without it, which has no such port.
    Without,
}

/// A coefficient as its law declares it; the schema of scenes, validation, ports and FMU variables follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficient {
    /// Key in scenes, last part of the name of the port.
    pub name: &'static str,
    pub unit: Unit,
    /// What every value must be, whatever the other coefficients are.
    pub range: Range,
    pub extent: Extent,
    pub omitted: Omitted,
    /// Meaning, unit and default, one sentence; `{}` stands for the unit.
    pub text: &'static str,
}

impl Coefficient {
    /// A coefficient that must be given, one for all nodes or one per node.
    pub const fn new(
        name: &'static str,
        unit: Unit,
        range: Range,
        text: &'static str,
    ) -> Coefficient {
        Coefficient {
            name,
            unit,
            range,
            extent: Extent::Nodes,
            omitted: Omitted::Refused,
            text,
        }
    }
}

/// A coefficient as a scene gives it.
#[derive(Debug, Clone, PartialEq)]
pub enum Given {
    /// One number for all nodes.
    Number(f64),
    /// One number per contact node.
    Nodes(Vec<f64>),
    /// A formula of x, y, z, which gives one number per contact node.
    Expression(String),
    /// The points of a curve.
    Points(Vec<f64>),
    /// The points of a surface row by row, and how many each row has, at least one.
    Rows(Vec<f64>, Vec<usize>),
    /// A word, by its place among those that may be chosen.
    Choice(usize),
    /// A formula of the law.
    Formula(String),
    /// Nothing: the law without it ([`Omitted::Without`]).
    Absent,
}

impl Given {
    /// The numbers on contact nodes with these coordinates; of an expression one NaN where the nodes are not known.
    pub(super) fn values(
        &self,
        coefficient: usize,
        points: Option<&[[f64; 3]]>,
    ) -> Result<Cow<'_, [f64]>, Misfit> {
        Ok(match self {
            Given::Number(value) => Cow::Borrowed(std::slice::from_ref(value)),
            Given::Nodes(values) | Given::Points(values) | Given::Rows(values, _) => {
                Cow::Borrowed(values)
            }
            Given::Expression(text) => {
                let nowhere: &[[f64; 3]] = &[[f64::NAN; 3]];
                Cow::Owned(field(text, coefficient, points.unwrap_or(nowhere))?)
            }
            Given::Choice(_) | Given::Formula(_) | Given::Absent => Cow::Borrowed(&[]),
        })
    }

    /// Whether there is one number per contact node.
    pub(super) fn is_nodal(&self) -> bool {
        matches!(self, Given::Nodes(_) | Given::Expression(_))
    }

    /// The first row that is not as long as the first one.
    pub(super) fn unequal_rows(&self, coefficient: usize) -> Option<Misfit> {
        let Given::Rows(_, lengths) = self else {
            return None;
        };
        let first = *lengths.first()?;
        let row = lengths.iter().position(|length| *length != first)?;
        Some(Misfit {
            coefficient,
            wrong: Wrong::Row(row),
            found: lengths[row] as f64,
            rule: "rows of equal length",
            allowed: format!("as many as in the first row: {first}"),
            beside: None,
            words: None,
        })
    }
}

/// Where the numbers of a coefficient stand in the list of all of them; `len` is 0 where the law is without it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    pub first: usize,
    pub len: usize,
    /// Whether it is an array: one number per node, or the points of a curve.
    pub is_array: bool,
    /// Length of its rows where it is a surface.
    pub columns: Option<usize>,
    /// The word that is chosen.
    choice: usize,
    /// Bits of a node's number that choose its entry: all, or none where one number is that of all nodes.
    mask: usize,
}

impl Place {
    /// Of a coefficient with so many numbers.
    pub fn new(first: usize, given: &Given, len: usize) -> Place {
        let is_array = given.is_nodal() || matches!(given, Given::Points(_) | Given::Rows(..));
        Place {
            first,
            len,
            is_array,
            columns: match given {
                Given::Rows(_, lengths) => lengths.first().copied(),
                _ => None,
            },
            choice: match given {
                Given::Choice(choice) => *choice,
                _ => 0,
            },
            mask: if is_array { usize::MAX } else { 0 },
        }
    }

    /// The same in a list in which the numbers begin further on.
    pub fn shifted(self, by: usize) -> Place {
        Place {
            first: self.first + by,
            ..self
        }
    }

    /// Places in the list of all numbers.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.len
    }

    /// Its shape as an array: none for one number.
    pub fn shape(&self) -> Vec<usize> {
        match self.columns {
            Some(columns) => vec![self.len / columns, columns],
            None if self.is_array => vec![self.len],
            None => Vec::new(),
        }
    }
}

/// A coefficient over the contact nodes.
#[derive(Debug, Clone, Copy)]
pub struct Field<'a> {
    values: &'a [f64],
    mask: usize,
}

impl Field<'_> {
    /// The value at a node.
    #[inline(always)]
    pub fn at(&self, node: usize) -> f64 {
        self.values[node & self.mask]
    }
}

/// All coefficients of a law. Beyond those that the law declares stand those of its role.
#[derive(Debug, Clone, Copy)]
pub struct Coefficients<'a> {
    declared: &'static [Coefficient],
    places: &'a [Place],
    values: &'a [f64],
    formula: Option<&'a Formula>,
}

impl<'a> Coefficients<'a> {
    pub fn new(
        declared: &'static [Coefficient],
        places: &'a [Place],
        values: &'a [f64],
        formula: Option<&'a Formula>,
    ) -> Coefficients<'a> {
        Coefficients {
            declared,
            places,
            values,
            formula,
        }
    }

    /// The formula of a law that is written out.
    pub fn formula(&self) -> Option<&'a Formula> {
        self.formula
    }

    /// The numbers of a coefficient, by its place in the declaration.
    pub fn values(&self, coefficient: usize) -> &'a [f64] {
        &self.values[self.places[coefficient].range()]
    }

    /// Where the numbers of a coefficient stand.
    pub fn place(&self, coefficient: usize) -> Place {
        self.places[coefficient]
    }

    /// A coefficient as a field.
    #[inline(always)]
    pub fn field(&self, coefficient: usize) -> Field<'a> {
        Field {
            values: self.values(coefficient),
            mask: self.places[coefficient].mask,
        }
    }

    /// A coefficient at a node.
    #[inline(always)]
    pub fn at(&self, coefficient: usize, node: usize) -> f64 {
        self.field(coefficient).at(node)
    }

    /// A coefficient at a node, unless the law is without it.
    pub fn get(&self, coefficient: usize, node: usize) -> Option<f64> {
        let is_there = self.places[coefficient].len > 0;
        is_there.then(|| self.at(coefficient, node))
    }

    /// The word that is chosen, by its place.
    pub fn choice(&self, coefficient: usize) -> usize {
        self.places[coefficient].choice
    }

    /// How many numbers each coefficient has that is given node by node.
    fn nodal_lengths(&self) -> impl Iterator<Item = usize> {
        let declared = self.declared.iter().zip(self.places);
        let nodal = declared.filter(|(c, place)| c.extent == Extent::Nodes && place.is_array);
        nodal.map(|(_, place)| place.len)
    }

    /// Whether the law is the same at all nodes.
    pub fn is_uniform(&self) -> bool {
        self.nodal_lengths().next().is_none()
    }

    /// Nodes at which the coefficients differ: the first one alone where the law is the same at all nodes.
    pub fn distinct_nodes(&self) -> std::ops::Range<usize> {
        let of_formula = self.formula.map_or(1, Formula::nodes);
        0..self.nodal_lengths().fold(of_formula, usize::max)
    }

    /// The rule that one coefficient is at least as large as another at every node; `rule` says so with their names.
    ///
    /// # Errors
    /// The first node where it is not.
    pub fn at_least(
        &self,
        larger: usize,
        smaller: usize,
        rule: &'static str,
    ) -> Result<(), Misfit> {
        let is_array = self.places[larger].is_array || self.places[smaller].is_array;
        for node in 0..self.places[larger].len.max(self.places[smaller].len) {
            let (found, least) = (self.at(larger, node), self.at(smaller, node));
            if found < least {
                let name = self.declared[smaller].name;
                return Err(Misfit {
                    coefficient: larger,
                    wrong: if is_array {
                        Wrong::Entry(node)
                    } else {
                        Wrong::Number
                    },
                    found,
                    rule,
                    allowed: format!("at least {name} = {}", number(least)),
                    beside: Some((smaller, least)),
                    words: None,
                });
            }
        }
        Ok(())
    }
}
