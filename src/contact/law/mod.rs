//! Friction laws: the bound of the tangential stress, or the coefficient of friction, as a function of slip rate and accumulated
//! slip.
//!
//! A law is one file of this folder and one line of [`LAWS`] or [`KINDS`]. It declares its coefficients; the schema of scenes,
//! their validation, the ports and the variables of an FMU follow from the declaration. Coefficients are fields over the contact
//! nodes, a number being the constant field. A kind serves two uses ([`Role`]): as a bound g in Pa, and as the coefficient mu of
//! Coulomb's law, which multiplies the pressure; its units follow.
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
//!
//! and in Coulomb's law the same of mu, with the bound `g = min(cap, cohesion + mu(r, s) P)`, P the pressure (`coulomb`).

mod chosen;
mod coefficients;
mod coulomb;
mod exponential;
mod expression;
mod formula;
mod frictionless;
mod memory;
mod misfit;
mod named;
mod pressed;
mod rate_and_state;
mod several;
mod slip_memory;
mod slip_weakening;
mod stribeck;
mod surface;
mod table;
mod tresca;

pub use chosen::{ChosenLaw, LawBounds};
pub use coefficients::{
    Coefficient, Coefficients, Extent, Field, Given, Omitted, Place, Range, Unit,
};
pub use memory::{Memory, MemoryPath};
pub use misfit::{Misfit, Wrong};
pub use named::{Law, Role};
pub use pressed::PressedLaw;
pub use several::{ContactBounds, ContactLaw, LawPart, PressedBoundsOf};
pub use slip_memory::{KernelTerm, SlipKernel, SlipStage};

use super::evaluation::{Evaluation, NodalLaw, Nodes, SlipPath};
use std::fmt;

/// Laws with keys of their own in scenes: `{"law": name, coefficients}`.
pub const LAWS: &[&dyn FrictionLaw] = &[
    &frictionless::Frictionless,
    &tresca::Tresca,
    &exponential::OF_THE_PAPER,
];

/// Kinds of a bound, `{"law": "bound", "bound": {"kind": name, coefficients}}`, and of the coefficient of Coulomb's law,
/// `{"law": "coulomb", "coefficient": {"kind": name, coefficients}}`.
pub const KINDS: &[&dyn FrictionLaw] = &[
    &exponential::KIND,
    &stribeck::Stribeck,
    &slip_weakening::SlipWeakening,
    &table::Table,
    &rate_and_state::RateAndState,
    &expression::Expression,
];

/// What a number in the place of a kind is.
pub const CONSTANT: &dyn FrictionLaw = &tresca::Tresca;

/// Where the coefficients stand in a scene with one contact.
pub const PATH: &str = "contact.friction";

/// One node at which a law is evaluated.
#[derive(Debug, Clone, Copy)]
pub struct At<'a> {
    /// Slip rate, m/s, >= 0.
    pub rate: f64,
    /// Accumulated slip along the stage.
    pub slip: SlipPath,
    pub coefficients: Coefficients<'a>,
    pub node: usize,
    /// Pressure that bounds the friction, Pa, >= 0.
    pub pressure: f64,
    /// The state of a law with memory along the stage.
    pub memory: MemoryPath,
}

impl At<'_> {
    /// A coefficient here, by its place in the declaration.
    #[inline(always)]
    pub fn coefficient(&self, coefficient: usize) -> f64 {
        self.coefficients.at(coefficient, self.node)
    }
}

/// What a law says at one node where its potential is not asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// The bound, Pa, or the coefficient of friction.
    pub value: f64,
    /// Its slope along the stage.
    pub by_rate: f64,
    /// Its derivative by the pressure, 1/Pa times its own unit.
    pub by_pressure: f64,
}

impl Value {
    pub fn new(value: f64, by_rate: f64) -> Value {
        Value {
            value,
            by_rate,
            by_pressure: 0.0,
        }
    }
}

/// A friction law. Coefficients are named by their place in the declaration; they satisfy their ranges and [`check`]
/// wherever a law is evaluated.
///
/// [`check`]: FrictionLaw::check
pub trait FrictionLaw: Sync {
    /// Name in scenes.
    fn name(&self) -> &'static str;

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

    /// Whether the law has a potential. One without is solved as bounds under normal forces are, also where it knows no pressure.
    fn has_potential(&self) -> bool {
        true
    }

    /// Whether the value depends on the slip: only then a kernel of the slip means something.
    fn depends_on_slip(&self, _coefficients: Coefficients) -> bool {
        false
    }

    /// State of a node at the start, s, positive; `None` for a law without memory.
    fn initial_state(&self, _coefficients: Coefficients, _node: usize) -> Option<f64> {
        None
    }

    /// State of a node at the end of a stage with this slip rate, s.
    fn advance(
        &self,
        _coefficients: Coefficients,
        _node: usize,
        path: MemoryPath,
        _rate: f64,
    ) -> f64 {
        path.state
    }

    /// Slip rate, m/s, up to which a stage at steady slip resists more the faster it is, at a node: one of `length` seconds in which
    /// the rate that moves the state has this share of the stage's own (see [`MemoryPath`]). Beyond it the bound of the stage falls
    /// with its rate. Infinite for a law without memory.
    fn steady_limit(&self, _: Coefficients, _node: usize, _length: f64, _rate_share: f64) -> f64 {
        f64::INFINITY
    }

    /// Bound, slope along the stage and potential at one node; the potential of a law without is NaN.
    fn evaluate(&self, at: &At) -> Evaluation;

    /// The value where it is none that a solution may have; `None` where it is right, as in laws of numbers everywhere.
    fn fault(&self, _at: &At) -> Option<f64> {
        None
    }

    /// Bound and slope of [`FrictionLaw::evaluate`], with less work where a law has a costly potential.
    fn value(&self, at: &At) -> Value {
        let all = self.evaluate(at);
        Value::new(all.bound, all.slope)
    }

    /// Bound at rest, Pa: that of [`FrictionLaw::evaluate`] at the slip rate 0, with less work where a law knows it.
    fn at_rest(&self, at: &At) -> f64 {
        self.evaluate(&At { rate: 0.0, ..*at }).bound
    }

    /// Partial derivative of the bound by the accumulated slip `slip.base` at fixed slip rate, Pa/m; 0 for a law without memory.
    fn slip_slope(&self, _at: &At) -> f64 {
        0.0
    }

    /// L at a node, Pa s/m: the largest rate at which the bound decreases with the slip rate, 0 where it never does. Over all slip
    /// rates and accumulated slips; `at` gives the node, how much the slip grows with the rate, and the memory. May be above the
    /// largest rate where that has no closed form.
    fn weakening(&self, at: &At) -> f64;

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
                pressure: 0.0,
                memory: MemoryPath::NONE,
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
                pressure: 0.0,
                memory: MemoryPath::NONE,
            };
            weight * self.at_rest(&at)
        });
        bounds.fold(0.0, f64::max)
    }
}

impl fmt::Debug for dyn FrictionLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
