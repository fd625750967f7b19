//! Friction laws: the bound of the tangential stress as a function of slip rate and accumulated slip.
//!
//! A law is one file of this folder and one line of [`LAWS`]. It declares its coefficients; the schema of scenes, their
//! validation, the ports and the variables of an FMU follow from the declaration. Coefficients are fields over the contact
//! nodes, a number being the constant field.
//!
//! With `r >= 0` the slip rate of a node and `s` its accumulated slip, a law says
//!
//! ```text
//! g(r, s) >= 0         bound of the tangential stress, Pa; the stress of a node at rest is at most g(0, s)
//! dg/dr                its slope along the stage, in which s = s_base + theta k r (`SlipPath`)
//! G(r) = int_0^r g     its potential, W/m^2: part of the step energy that Newton's method decreases
//! L = sup_r max(0, -dg/dr)    how fast it weakens (one-sided Lipschitz constant): a stage has one solution where L is below
//!                      the smallest eigenvalue of the body's resistance; a bound that rises only helps
//! ```

mod chosen;
mod coefficients;
mod exponential;
mod frictionless;
mod stribeck;
mod table;
mod tresca;

pub use chosen::{ChosenLaw, LawBounds};
pub use coefficients::{
    Coefficient, Coefficients, Extent, Field, Given, Misfit, Place, Range, Wrong,
};

use super::evaluation::{Evaluation, NodalLaw, Nodes, SlipPath};
use crate::error::{Error, Result};
use std::fmt;

/// All laws that a scene can name.
pub const LAWS: &[Law] = &[
    Law(&frictionless::Frictionless),
    Law(&tresca::Tresca),
    Law(&exponential::OF_THE_PAPER),
    Law(&exponential::KIND),
    Law(&stribeck::Stribeck),
    Law(&table::Table),
];

/// What a law with one number may also be written as in a scene: `{"law": "bound", "bound": 8e4}`.
pub const CONSTANT: Law = Law(&tresca::Tresca);

/// Where the coefficients stand in a scene.
pub const PATH: &str = "contact.friction";

/// The word and the key of laws that are kinds of a bound.
pub const BOUND: &str = "bound";

/// How a scene writes a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// `{"law": name, coefficients}`.
    Law,
    /// `{"law": "bound", "bound": {"kind": name, coefficients}}`.
    Kind,
}

/// One node at which a law is evaluated.
#[derive(Debug, Clone, Copy)]
pub struct At<'a> {
    /// Slip rate, m/s, >= 0.
    pub rate: f64,
    /// Accumulated slip along the stage.
    pub slip: SlipPath,
    pub coefficients: Coefficients<'a>,
    pub node: usize,
}

impl At<'_> {
    /// A coefficient here, by its place in the declaration.
    #[inline(always)]
    pub fn coefficient(&self, coefficient: usize) -> f64 {
        self.coefficients.at(coefficient, self.node)
    }
}

/// A friction law. Coefficients are named by their place in the declaration; they satisfy their ranges and [`check`]
/// wherever a law is evaluated.
///
/// [`check`]: FrictionLaw::check
pub trait FrictionLaw: Sync {
    /// Name in scenes.
    fn name(&self) -> &'static str;

    /// How a scene writes it.
    fn form(&self) -> Form {
        Form::Kind
    }

    /// Formula, for the schema of scenes.
    fn text(&self) -> &'static str;

    fn coefficients(&self) -> &'static [Coefficient];

    /// The rules between coefficients, asked when a set of them is complete.
    ///
    /// # Errors
    /// The first coefficient that does not fit the others.
    fn check(&self, _coefficients: Coefficients) -> std::result::Result<(), Misfit> {
        Ok(())
    }

    /// Bound, slope along the stage and potential at one node.
    fn evaluate(&self, at: &At) -> Evaluation;

    /// Bound at rest, Pa: that of [`FrictionLaw::evaluate`] at the slip rate 0, with less work where a law knows it.
    fn at_rest(&self, at: &At) -> f64 {
        self.evaluate(&At { rate: 0.0, ..*at }).bound
    }

    /// Partial derivative of the bound by the accumulated slip `slip.base` at fixed slip rate, Pa/m; 0 for a law without memory.
    fn slip_slope(&self, _at: &At) -> f64 {
        0.0
    }

    /// L at a node, Pa s/m: the largest rate at which the bound decreases with the slip rate, 0 where it never does.
    fn weakening(&self, coefficients: Coefficients, node: usize) -> f64;

    /// The largest and the smallest bound over all slip rates at a node, Pa: the contact then sticks as much as it can, or slips
    /// as much as it can. Infinite for a bound that rises without limit; the smallest may be below what is reached.
    fn extremes(&self, coefficients: Coefficients, node: usize) -> [f64; 2];

    /// The law at all nodes, times their weights: one virtual call for all of them. A law that has no branches overrides this
    /// with coefficients taken out of the loop, which is then vectorized.
    fn fill(&self, coefficients: Coefficients, nodes: Nodes, out: &mut NodalLaw) {
        out.fill(nodes, |node, rate, slip| {
            self.evaluate(&At {
                rate,
                slip,
                coefficients,
                node,
            })
        });
    }

    /// Largest bound at rest over the nodes, times their weights, N.
    fn largest_at_rest(&self, coefficients: Coefficients, nodes: Nodes) -> f64 {
        let bounds = nodes.weights.iter().enumerate().map(|(node, weight)| {
            let slip = SlipPath {
                base: nodes.slip_base[node],
                per_rate: nodes.per_rate,
            };
            let at = At {
                rate: 0.0,
                slip,
                coefficients,
                node,
            };
            weight * self.at_rest(&at)
        });
        bounds.fold(0.0, f64::max)
    }
}

/// One of [`LAWS`].
#[derive(Clone, Copy)]
pub struct Law(&'static dyn FrictionLaw);

impl std::ops::Deref for Law {
    type Target = dyn FrictionLaw;

    fn deref(&self) -> &(dyn FrictionLaw + 'static) {
        self.0
    }
}

impl PartialEq for Law {
    fn eq(&self, other: &Law) -> bool {
        (self.name(), self.form()) == (other.name(), other.form())
    }
}

impl fmt::Debug for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Law {
    /// The law that scenes write with this name in this form.
    pub fn find(form: Form, name: &str) -> Option<Law> {
        let mut laws = LAWS.iter().copied();
        laws.find(|law| law.form() == form && law.name() == name)
    }

    /// Where a scene has a coefficient, which is also the name of its port.
    pub fn path(&self, coefficient: usize) -> String {
        let name = self.coefficients()[coefficient].name;
        match self.form() {
            Form::Law => format!("{PATH}.{name}"),
            Form::Kind => format!("{PATH}.{BOUND}.{name}"),
        }
    }

    /// Refuses a value that the coefficient cannot have, whatever the other ones are.
    ///
    /// # Errors
    /// [`Error::Value`] when it is not finite or out of its range.
    pub fn check_value(&self, coefficient: usize, value: f64) -> Result<()> {
        let range = self.coefficients()[coefficient].range;
        if range.contains(value) {
            return Ok(());
        }
        Err(Error::Value {
            what: self.path(coefficient),
            found: value,
            allowed: range.allowed,
        })
    }

    /// What a simulator says of coefficients that do not fit each other.
    pub fn refusal(&self, misfit: Misfit) -> Error {
        let extent = self.coefficients()[misfit.coefficient].extent;
        let place = match (misfit.wrong, extent) {
            (Wrong::Number, _) => String::new(),
            (Wrong::Count, _) => ", its numbers".to_owned(),
            (Wrong::Entry(node), Extent::Nodes) => format!(" at contact node {node}"),
            (Wrong::Entry(point), Extent::Points) => format!(" at point {point}"),
        };
        let beside =
            |(other, value): (usize, f64)| format!(", where {} is {value:?}", self.path(other));
        Error::Value {
            what: format!(
                "{}{place}{}",
                self.path(misfit.coefficient),
                misfit.beside.map(beside).unwrap_or_default()
            ),
            found: misfit.found,
            allowed: misfit.rule,
        }
    }
}
