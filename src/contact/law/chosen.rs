//! A law with numbers: the layout of its coefficients, and the bounds that they give at the contact nodes.

use super::coulomb::Coulomb;
use super::{At, Coefficients, FrictionLaw, Given, Law, Misfit, Place, PressedLaw, Role, Wrong};
use crate::contact::bounds::Bounds;
use crate::contact::evaluation::{Evaluation, NodalLaw, Nodes, SlipPath};
use crate::error::Result;

/// A law with the coefficients of a scene, and how the numbers of such coefficients stand in one list.
#[derive(Debug, Clone, PartialEq)]
pub struct ChosenLaw {
    law: Law,
    places: Vec<Place>,
    start: Vec<f64>,
}

impl ChosenLaw {
    /// The law with its coefficients, each within its range, on a contact of so many nodes; where that is not known yet, fields
    /// are only compared with each other.
    ///
    /// # Errors
    /// A field that has not one number per node, a coefficient that does not fit the others.
    pub fn new(
        law: Law,
        given: &[Given],
        nodes: Option<usize>,
    ) -> std::result::Result<ChosenLaw, Misfit> {
        let mut nodes = nodes;
        let (mut places, mut start) = (Vec::with_capacity(given.len()), Vec::new());
        for (coefficient, given) in given.iter().enumerate() {
            let count = given.values().len();
            if let Some(misfit) = given.unequal_rows(coefficient) {
                return Err(misfit);
            }
            if let Given::Nodes(_) = given
                && *nodes.get_or_insert(count) != count
            {
                return Err(Misfit {
                    coefficient,
                    wrong: Wrong::Count,
                    found: count as f64,
                    rule: "one number per contact node",
                    allowed: format!("one number per contact node: {}", nodes.unwrap_or_default()),
                    beside: None,
                });
            }
            places.push(Place::new(start.len(), given));
            start.extend_from_slice(given.values());
        }
        let chosen = ChosenLaw { law, places, start };
        law.kind().check(chosen.coefficients(&chosen.start))?;
        Ok(chosen)
    }

    /// The law.
    pub fn law(&self) -> Law {
        self.law
    }

    /// Where the numbers of every coefficient stand in the list of all.
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// The numbers of the scene.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    #[inline]
    fn coefficients<'a>(&'a self, values: &'a [f64]) -> Coefficients<'a> {
        Coefficients::new(self.law.kind().coefficients(), &self.places, values)
    }

    /// Whether the bounds depend on the normal forces: then [`ChosenLaw::pressed`] has them, and [`ChosenLaw::with`] only what
    /// the law says of its coefficient of friction.
    pub fn needs_pressure(&self) -> bool {
        matches!(self.law.role(), Role::Coulomb { .. })
    }

    /// The bounds that other numbers give, all of them in the order of [`ChosenLaw::places`].
    #[inline]
    pub fn with<'a>(&'a self, values: &'a [f64]) -> LawBounds<'a> {
        LawBounds {
            law: self.law.kind(),
            coefficients: self.coefficients(values),
        }
    }

    /// The bounds as nodal forces that may depend on the normal forces, with numbers as in [`ChosenLaw::with`], nodal contact
    /// weights, m^2 (m in 2D), in stages where the accumulated slip grows by `per_rate` times the slip rate, s.
    pub fn pressed<'a>(
        &'a self,
        values: &'a [f64],
        weights: &'a [f64],
        per_rate: f64,
    ) -> PressedLaw<'a> {
        let (kind, coefficients) = (self.law.kind(), self.coefficients(values));
        let coulomb = match self.law.role() {
            Role::Own | Role::Bound => None,
            Role::Coulomb { tension } => {
                let first = kind.coefficients().len();
                Some(Coulomb::new(tension, coefficients, first))
            }
        };
        PressedLaw::new(kind, coefficients, coulomb, weights, per_rate)
    }

    /// The bounds of the scene.
    pub fn bounds(&self) -> LawBounds<'_> {
        self.with(&self.start)
    }

    /// Refuses numbers that a simulator cannot go on with: out of range, or at odds with each other.
    ///
    /// # Errors
    /// [`crate::Error::Value`].
    pub fn check(&self, values: &[f64]) -> Result<()> {
        self.check_values(values)?;
        let misfit = self.law.kind().check(self.coefficients(values));
        misfit.map_err(|misfit| self.law.refusal(misfit))
    }

    /// Refuses numbers that are out of the ranges of their coefficients.
    ///
    /// # Errors
    /// [`crate::Error::Value`].
    pub fn check_values(&self, values: &[f64]) -> Result<()> {
        for (coefficient, place) in self.places.iter().enumerate() {
            for value in &values[place.range()] {
                self.law.check_value(coefficient, *value)?;
            }
        }
        Ok(())
    }
}

/// The bounds of a law with given coefficients.
#[derive(Debug, Clone, Copy)]
pub struct LawBounds<'a> {
    law: &'static dyn FrictionLaw,
    coefficients: Coefficients<'a>,
}

impl LawBounds<'_> {
    fn at(&self, node: usize, rate: f64, slip: SlipPath) -> At<'_> {
        At {
            rate,
            slip,
            coefficients: self.coefficients,
            node,
        }
    }

    /// L: the largest rate at which the bound of any node decreases with the slip rate, Pa s/m (5.16), in stages where the
    /// accumulated slip grows by `per_rate` times the rate, s.
    pub fn weakening(&self, per_rate: f64) -> f64 {
        let slip = SlipPath {
            base: 0.0,
            per_rate,
        };
        let nodes = self.coefficients.distinct_nodes();
        let all = nodes.map(|node| self.law.weakening(&self.at(node, 0.0, slip)));
        all.fold(0.0, f64::max)
    }

    /// Largest and smallest bound of a node over all slip rates, Pa; see [`super::FrictionLaw::extremes`].
    pub fn extremes(&self, node: usize) -> [f64; 2] {
        self.law.extremes(self.coefficients, node)
    }
}

impl Bounds for LawBounds<'_> {
    fn evaluate(&self, node: usize, rate: f64, slip: SlipPath) -> Evaluation {
        self.law.evaluate(&self.at(node, rate, slip))
    }

    fn at_rest(&self, node: usize, slip: SlipPath) -> f64 {
        self.law.at_rest(&self.at(node, 0.0, slip))
    }

    fn slip_slope(&self, node: usize, rate: f64, slip: SlipPath) -> f64 {
        self.law.slip_slope(&self.at(node, rate, slip))
    }

    fn fill(&self, nodes: Nodes, out: &mut NodalLaw) {
        self.law.fill(self.coefficients, nodes, out);
    }

    fn largest_at_rest(&self, nodes: Nodes) -> f64 {
        self.law.largest_at_rest(self.coefficients, nodes)
    }
}
