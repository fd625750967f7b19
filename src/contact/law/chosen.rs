//! A law with numbers: the layout of its coefficients, and the bounds that they give at the contact nodes.

use super::coulomb::Coulomb;
use super::formula::Formula;
use super::{
    At, Coefficients, FrictionLaw, Given, Law, MemoryPath, Misfit, PATH, Place, PressedLaw, Role,
    SlipKernel, Wrong,
};
use crate::contact::bounds::Bounds;
use crate::contact::evaluation::{Evaluation, NodalLaw, Nodes, SlipPath};
use crate::error::Result;
use crate::message::number;

/// A law with the coefficients of a scene, and how the numbers of such coefficients stand in one list.
#[derive(Debug, Clone, PartialEq)]
pub struct ChosenLaw {
    law: Law,
    places: Vec<Place>,
    start: Vec<f64>,
    formula: Option<Formula>,
    /// Where the coefficients stand in the scene.
    path: String,
    kernel: SlipKernel,
}

impl ChosenLaw {
    /// The law with its coefficients, each within its range, on contact nodes with these coordinates, m. Where the nodes are not
    /// known yet, fields are only compared with each other, and expressions, which are only parsed, are NaN.
    ///
    /// # Errors
    /// A field that has not one number per node, a text that is no formula or gives numbers out of the range, a coefficient that
    /// does not fit the others.
    pub fn new(
        law: Law,
        given: &[Given],
        points: Option<&[[f64; 3]]>,
    ) -> std::result::Result<ChosenLaw, Misfit> {
        let mut nodes = points.map(<[_]>::len);
        let (mut places, mut start) = (Vec::with_capacity(given.len()), Vec::new());
        let mut formula = None;
        for (coefficient, given) in given.iter().enumerate() {
            if let Some(misfit) = given.unequal_rows(coefficient) {
                return Err(misfit);
            }
            let values = given.values(coefficient, points)?;
            let count = values.len();
            match given {
                Given::Nodes(_) if *nodes.get_or_insert(count) != count => {
                    return Err(Misfit {
                        coefficient,
                        wrong: Wrong::Count,
                        found: count as f64,
                        rule: "one number per contact node",
                        allowed: format!(
                            "one number per contact node: {}",
                            nodes.unwrap_or_default()
                        ),
                        beside: None,
                        words: None,
                    });
                }
                Given::Expression(_) if points.is_some() => check_range(law, coefficient, &values)?,
                Given::Formula(text) => formula = Some(Formula::new(text, coefficient, points)?),
                _ => {}
            }
            places.push(match given {
                Given::Expression(_) if points.is_none() => {
                    Place::new(start.len(), &Given::Number(f64::NAN), 1)
                }
                _ => Place::new(start.len(), given, count),
            });
            start.extend_from_slice(&values);
        }
        let chosen = ChosenLaw {
            law,
            places,
            start,
            formula,
            path: PATH.to_owned(),
            kernel: SlipKernel::default(),
        };
        law.kind().check(chosen.coefficients(&chosen.start))?;
        Ok(chosen)
    }

    /// The same with its coefficients at another place of the scene.
    pub fn placed(self, path: String) -> ChosenLaw {
        ChosenLaw { path, ..self }
    }

    /// Where the scene has a coefficient, which is also the name of its port.
    pub fn path(&self, coefficient: usize) -> String {
        self.law.path_in(&self.path, coefficient)
    }

    /// The same with a fading memory of slip in place of the accumulated slip.
    pub fn with_kernel(self, kernel: SlipKernel) -> ChosenLaw {
        ChosenLaw { kernel, ..self }
    }

    /// The kernel of the slip; empty where the law takes the accumulated slip.
    pub fn kernel(&self) -> &SlipKernel {
        &self.kernel
    }

    /// Whether the law depends on the slip.
    pub fn depends_on_slip(&self) -> bool {
        let kind = self.law.kind();
        kind.depends_on_slip(self.coefficients(&self.start))
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
        let declared = self.law.kind().coefficients();
        Coefficients::new(declared, &self.places, values, self.formula.as_ref())
    }

    /// Whether the law is solved with normal forces: its bounds depend on them, or have no potential. Then [`ChosenLaw::pressed`]
    /// has the bounds, and [`ChosenLaw::with`] only what the law says of its coefficient of friction, or NaN.
    pub fn needs_pressure(&self) -> bool {
        self.is_coulomb() || !self.law.kind().has_potential()
    }

    /// Whether it is Coulomb's law.
    pub fn is_coulomb(&self) -> bool {
        matches!(self.law.role(), Role::Coulomb { .. })
    }

    /// Whether the law is a formula, whose value at a solution is to be checked with [`PressedLaw::fault`].
    pub fn has_formula(&self) -> bool {
        self.formula.is_some()
    }

    /// Whether every node has a state: then [`PressedLaw::remembering`] gives the bounds their memory.
    pub fn has_memory(&self) -> bool {
        self.initial_state(&self.start, 0).is_some()
    }

    /// Slip rate, m/s, up to which a stage at steady slip resists more the faster it is, at every node and with the numbers of the
    /// scene; see [`super::FrictionLaw::steady_limit`]. Infinite for a law without memory.
    pub fn steady_limit(&self, length: f64, rate_share: f64) -> f64 {
        let coefficients = self.coefficients(&self.start);
        let limit = |node| {
            let kind = self.law.kind();
            kind.steady_limit(coefficients, node, length, rate_share)
        };
        let nodes = coefficients.distinct_nodes();
        nodes.map(limit).fold(f64::INFINITY, f64::min)
    }

    /// State of a node at the start, s, with numbers as in [`ChosenLaw::with`]; `None` for a law without memory.
    pub fn initial_state(&self, values: &[f64], node: usize) -> Option<f64> {
        let kind = self.law.kind();
        kind.initial_state(self.coefficients(values), node)
    }

    /// State of a node after a stage with this slip rate, m/s >= 0, s; without memory the one before. `path.mean_rate` moves it:
    /// for a whole step at a constant rate, a share of 1.
    pub fn advance(&self, values: &[f64], node: usize, path: MemoryPath, rate: f64) -> f64 {
        let kind = self.law.kind();
        kind.advance(self.coefficients(values), node, path, rate)
    }

    /// The bounds that other numbers give, all of them in the order of [`ChosenLaw::places`].
    #[inline]
    pub fn with<'a>(&'a self, values: &'a [f64]) -> LawBounds<'a> {
        LawBounds {
            law: self.law.kind(),
            coefficients: self.coefficients(values),
            slip_scale: 1.0,
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
        misfit.map_err(|misfit| self.law.refusal(&self.path, misfit))
    }

    /// Refuses numbers that are out of the ranges of their coefficients.
    ///
    /// # Errors
    /// [`crate::Error::Value`].
    pub fn check_values(&self, values: &[f64]) -> Result<()> {
        for (coefficient, place) in self.places.iter().enumerate() {
            for value in &values[place.range()] {
                self.check_value(coefficient, *value)?;
            }
        }
        Ok(())
    }

    /// Refuses a number that is out of the range of its coefficient.
    ///
    /// # Errors
    /// [`crate::Error::Value`].
    pub fn check_value(&self, coefficient: usize, value: f64) -> Result<()> {
        self.law.check_value(&self.path, coefficient, value)
    }
}

/// Refuses numbers of an expression that are out of the range of the coefficient.
fn check_range(law: Law, coefficient: usize, values: &[f64]) -> std::result::Result<(), Misfit> {
    let range = law.coefficient(coefficient).range;
    match values.iter().position(|value| !range.contains(*value)) {
        None => Ok(()),
        Some(node) => Err(Misfit {
            coefficient,
            wrong: Wrong::Number,
            found: values[node],
            rule: range.allowed,
            allowed: range.allowed.to_owned(),
            beside: None,
            words: Some(format!("{} at contact node {node}", number(values[node]))),
        }),
    }
}

/// The bounds of a law with given coefficients.
#[derive(Debug, Clone, Copy)]
pub struct LawBounds<'a> {
    law: &'static dyn FrictionLaw,
    coefficients: Coefficients<'a>,
    /// What the slip of the contact problem is multiplied by.
    slip_scale: f64,
}

impl LawBounds<'_> {
    /// The same in a contact problem whose slip is to be multiplied by this.
    pub fn scaled(self, slip_scale: f64) -> Self {
        LawBounds { slip_scale, ..self }
    }

    fn at(&self, node: usize, rate: f64, slip: SlipPath) -> At<'_> {
        At {
            rate,
            slip: slip.scaled(self.slip_scale),
            coefficients: self.coefficients,
            node,
            pressure: 0.0,
            memory: MemoryPath::NONE,
        }
    }

    /// L: the largest rate at which the bound of any node decreases with the slip rate, Pa s/m (5.16), in stages where the
    /// accumulated slip grows by `per_rate` times the rate, s, and memory begins as it does at the start.
    pub fn weakening(&self, per_rate: f64) -> f64 {
        let slip = SlipPath {
            base: 0.0,
            per_rate,
        };
        let nodes = self.coefficients.distinct_nodes();
        let all = nodes.map(|node| {
            let memory = match self.law.initial_state(self.coefficients, node) {
                Some(state) => MemoryPath {
                    state,
                    length: per_rate,
                    ..MemoryPath::NONE
                },
                None => MemoryPath::NONE,
            };
            let at = self.at(node, 0.0, slip);
            self.law.weakening(&At { memory, ..at })
        });
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
        self.slip_scale * self.law.slip_slope(&self.at(node, rate, slip))
    }

    fn fill(&self, nodes: Nodes, out: &mut NodalLaw) {
        if self.slip_scale == 1.0 {
            self.law.fill(self.coefficients, nodes, out);
        } else {
            out.fill(nodes, |node, rate, slip| self.evaluate(node, rate, slip));
        }
    }

    fn largest_at_rest(&self, nodes: Nodes) -> f64 {
        if self.slip_scale == 1.0 {
            return self.law.largest_at_rest(self.coefficients, nodes);
        }
        let bounds = nodes.weights.iter().enumerate().map(|(node, weight)| {
            let slip = SlipPath {
                base: nodes.slip_base[node],
                per_rate: nodes.per_rate,
            };
            weight * self.at_rest(node, slip)
        });
        bounds.fold(0.0, f64::max)
    }
}
