//! The laws of all contacts of a scene, each on its own range of contact nodes and with its own numbers in one list.
//!
//! With one contact everything is that of its law.

use super::{ChosenLaw, LawBounds, Memory, MemoryPath, Place, PressedLaw, SlipStage};
use crate::contact::bounds::Bounds;
use crate::contact::evaluation::{Evaluation, NodalLaw, Nodes, SlipPath};
use crate::contact::pressed::{PressedBound, PressedBounds};
use crate::error::Result;
use std::ops::Range;

/// State of the nodes of a law without memory where others have one, s: it stays as it is.
const NO_STATE: f64 = 1.0;

/// The law of one contact.
#[derive(Debug, Clone, PartialEq)]
pub struct LawPart {
    pub law: ChosenLaw,
    /// Its nodes among all contact nodes.
    pub nodes: Range<usize>,
    /// Its numbers in the list of all.
    pub numbers: Range<usize>,
    /// What it remembers of slip among the numbers of all: the terms of its kernel, node by node.
    pub slip_memory: Range<usize>,
    has_memory: bool,
}

/// The laws of all contacts, in the order of the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLaw {
    parts: Vec<LawPart>,
    places: Vec<Place>,
    start: Vec<f64>,
}

impl ContactLaw {
    /// The laws with their nodes, which follow each other.
    pub fn new(laws: impl IntoIterator<Item = (ChosenLaw, Range<usize>)>) -> ContactLaw {
        let (mut places, mut start) = (Vec::new(), Vec::new());
        let mut parts = Vec::new();
        let mut remembered = 0;
        for (law, nodes) in laws {
            let first = start.len();
            places.extend(law.places().iter().map(|place| place.shifted(first)));
            start.extend_from_slice(law.start());
            let slip_memory = remembered..remembered + nodes.len() * law.kernel().terms().len();
            remembered = slip_memory.end;
            parts.push(LawPart {
                nodes,
                numbers: first..start.len(),
                slip_memory,
                has_memory: law.has_memory(),
                law,
            });
        }
        ContactLaw {
            parts,
            places,
            start,
        }
    }

    /// The laws that remember slip by a kernel.
    pub fn with_kernels(&self) -> impl Iterator<Item = &LawPart> {
        let parts = self.parts.iter();
        parts.filter(|part| !part.law.kernel().is_empty())
    }

    /// How many numbers remember slip.
    pub fn slip_memory_len(&self) -> usize {
        self.parts.last().map_or(0, |part| part.slip_memory.end)
    }

    /// The laws, each with its nodes and numbers.
    pub fn parts(&self) -> &[LawPart] {
        &self.parts
    }

    /// The law of a node.
    fn of_node(&self, node: usize) -> &LawPart {
        let later = self.parts.iter().rev();
        later
            .clone()
            .find(|part| node >= part.nodes.start)
            .unwrap_or(&self.parts[0])
    }

    /// Where the numbers of every coefficient of every law stand in the list of all.
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// The law of a coefficient, by its place among those of all laws, and its place among those of that law.
    pub fn coefficient(&self, coefficient: usize) -> (&LawPart, usize) {
        let mut own = coefficient;
        for part in &self.parts {
            let count = part.law.places().len();
            if own < count {
                return (part, own);
            }
            own -= count;
        }
        (&self.parts[0], own)
    }

    /// The numbers of the scene.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// Whether a law is a formula; see [`ChosenLaw::has_formula`].
    pub fn has_formula(&self) -> bool {
        self.parts.iter().any(|part| part.law.has_formula())
    }

    /// Whether the nodes of a law have a state; then all have one.
    pub fn has_memory(&self) -> bool {
        self.parts.iter().any(|part| part.has_memory)
    }

    /// State of a node at the start, s, positive; see [`ChosenLaw::initial_state`].
    pub fn initial_state(&self, values: &[f64], node: usize) -> f64 {
        let part = self.of_node(node);
        let state = part
            .law
            .initial_state(&values[part.numbers.clone()], node - part.nodes.start);
        state.unwrap_or(NO_STATE)
    }

    /// State of a node after a stage; see [`ChosenLaw::advance`].
    pub fn advance(&self, values: &[f64], node: usize, path: MemoryPath, rate: f64) -> f64 {
        let part = self.of_node(node);
        let values = &values[part.numbers.clone()];
        part.law
            .advance(values, node - part.nodes.start, path, rate)
    }

    /// The least of all laws; see [`ChosenLaw::steady_limit`].
    pub fn steady_limit(&self, length: f64, rate_share: f64) -> f64 {
        let limits = self.parts.iter();
        let limits = limits.map(|part| part.law.steady_limit(length, rate_share));
        limits.fold(f64::INFINITY, f64::min)
    }

    /// The bounds that other numbers give; see [`ChosenLaw::with`].
    #[inline]
    pub fn with<'a>(&'a self, values: &'a [f64]) -> ContactBounds<'a> {
        self.in_stage(values, SlipStage::NONE)
    }

    /// The same in a stage.
    #[inline]
    pub fn in_stage<'a>(&'a self, values: &'a [f64], stage: SlipStage) -> ContactBounds<'a> {
        match &self.parts[..] {
            [part] => {
                let scale = stage.scale(part.law.kernel());
                ContactBounds::One(part.law.with(values).scaled(scale))
            }
            _ => ContactBounds::Several(self, values, stage),
        }
    }

    /// The bounds of the scene.
    pub fn bounds(&self) -> ContactBounds<'_> {
        self.with(&self.start)
    }

    /// The bounds as nodal forces; see [`ChosenLaw::pressed`].
    pub fn pressed<'a>(
        &'a self,
        values: &'a [f64],
        weights: &'a [f64],
        stage: SlipStage,
    ) -> PressedBoundsOf<'a> {
        match &self.parts[..] {
            [part] => PressedBoundsOf::One(of_stage(&part.law, values, weights, &stage)),
            _ => PressedBoundsOf::Several(SeveralPressed {
                laws: self,
                values,
                weights,
                stage,
                memory: None,
            }),
        }
    }

    /// Refuses numbers that a simulator cannot go on with; see [`ChosenLaw::check`].
    ///
    /// # Errors
    /// [`crate::Error::Value`].
    pub fn check(&self, values: &[f64]) -> Result<()> {
        let mut parts = self.parts.iter();
        parts.try_for_each(|part| part.law.check(&values[part.numbers.clone()]))
    }

    /// Refuses numbers that are out of the ranges of their coefficients.
    ///
    /// # Errors
    /// [`crate::Error::Value`].
    pub fn check_values(&self, values: &[f64]) -> Result<()> {
        let mut parts = self.parts.iter();
        parts.try_for_each(|part| part.law.check_values(&values[part.numbers.clone()]))
    }
}

/// The bounds of a law as nodal forces in a stage.
fn of_stage<'a>(
    law: &'a ChosenLaw,
    values: &'a [f64],
    weights: &'a [f64],
    stage: &SlipStage,
) -> PressedLaw<'a> {
    let scale = stage.scale(law.kernel());
    law.pressed(values, weights, stage.theta_k).scaled(scale)
}

/// The bounds of the laws of all contacts with given numbers.
#[derive(Debug, Clone, Copy)]
pub enum ContactBounds<'a> {
    /// Those of the only law.
    One(LawBounds<'a>),
    /// Those of several with the list of all their numbers, in a stage.
    Several(&'a ContactLaw, &'a [f64], SlipStage),
}

impl ContactBounds<'_> {
    /// Asks the bounds of the law of a node, with its place among the nodes of that law.
    fn ask<R>(&self, node: usize, of: impl Fn(&LawBounds, usize) -> R) -> R {
        match self {
            ContactBounds::One(bounds) => of(bounds, node),
            ContactBounds::Several(laws, values, stage) => {
                let part = laws.of_node(node);
                let bounds = part.law.with(&values[part.numbers.clone()]);
                let scale = stage.scale(part.law.kernel());
                of(&bounds.scaled(scale), node - part.nodes.start)
            }
        }
    }

    /// Largest and smallest bound of a node over all slip rates, Pa; see [`super::FrictionLaw::extremes`].
    pub fn extremes(&self, node: usize) -> [f64; 2] {
        self.ask(node, |bounds, node| bounds.extremes(node))
    }
}

impl Bounds for ContactBounds<'_> {
    fn evaluate(&self, node: usize, rate: f64, slip: SlipPath) -> Evaluation {
        self.ask(node, |bounds, node| bounds.evaluate(node, rate, slip))
    }

    fn at_rest(&self, node: usize, slip: SlipPath) -> f64 {
        self.ask(node, |bounds, node| bounds.at_rest(node, slip))
    }

    fn slip_slope(&self, node: usize, rate: f64, slip: SlipPath) -> f64 {
        self.ask(node, |bounds, node| bounds.slip_slope(node, rate, slip))
    }

    fn fill(&self, nodes: Nodes, out: &mut NodalLaw) {
        match self {
            ContactBounds::One(bounds) => bounds.fill(nodes, out),
            ContactBounds::Several(..) => {
                out.fill(nodes, |node, rate, slip| self.evaluate(node, rate, slip));
            }
        }
    }

    fn largest_at_rest(&self, nodes: Nodes) -> f64 {
        match self {
            ContactBounds::One(bounds) => bounds.largest_at_rest(nodes),
            ContactBounds::Several(..) => {
                let at = |node: usize| SlipPath {
                    base: nodes.slip_base[node],
                    per_rate: nodes.per_rate,
                };
                let all = nodes.weights.iter().enumerate();
                let bounds = all.map(|(node, weight)| weight * self.at_rest(node, at(node)));
                bounds.fold(0.0, f64::max)
            }
        }
    }
}

/// The bounds of the laws of all contacts as nodal forces that may depend on the normal forces.
#[derive(Debug, Clone, Copy)]
pub enum PressedBoundsOf<'a> {
    /// Those of the only law.
    One(PressedLaw<'a>),
    /// Those of several.
    Several(SeveralPressed<'a>),
}

/// Several laws with the list of all their numbers in a stage.
#[derive(Debug, Clone, Copy)]
pub struct SeveralPressed<'a> {
    laws: &'a ContactLaw,
    values: &'a [f64],
    weights: &'a [f64],
    stage: SlipStage,
    memory: Option<Memory<'a>>,
}

impl<'a> PressedBoundsOf<'a> {
    /// The laws with the memory of a stage; see [`PressedLaw::remembering`].
    pub fn remembering(self, memory: Memory<'a>) -> PressedBoundsOf<'a> {
        match self {
            PressedBoundsOf::One(law) => PressedBoundsOf::One(law.remembering(memory)),
            PressedBoundsOf::Several(several) => PressedBoundsOf::Several(SeveralPressed {
                memory: Some(memory),
                ..several
            }),
        }
    }

    /// Asks the law of a node, with its place among the nodes of that law.
    fn ask<R>(&self, node: usize, of: impl Fn(&PressedLaw, usize) -> R) -> R {
        let several = match self {
            PressedBoundsOf::One(law) => return of(law, node),
            PressedBoundsOf::Several(several) => several,
        };
        let part = several.laws.of_node(node);
        let (values, weights) = (
            &several.values[part.numbers.clone()],
            &several.weights[part.nodes.clone()],
        );
        let law = of_stage(&part.law, values, weights, &several.stage);
        let law = match several.memory {
            Some(memory) if part.has_memory => law.remembering(memory.of_nodes(&part.nodes)),
            _ => law,
        };
        of(&law, node - part.nodes.start)
    }

    /// The value of a formula at a node where it is none that a solution may have; see [`PressedLaw::fault`].
    pub fn fault(&self, node: usize, rate: f64, force: f64, slip: SlipPath) -> Option<f64> {
        self.ask(node, |law, node| law.fault(node, rate, force, slip))
    }

    /// The bound of a node with this memory; see [`PressedBounds::evaluate`].
    pub fn evaluate_with(
        &self,
        memory: MemoryPath,
        node: usize,
        rate: f64,
        force: f64,
        slip: SlipPath,
    ) -> PressedBound {
        self.ask(node, |law, node| {
            law.evaluate_with(memory, node, rate, force, slip)
        })
    }
}

impl PressedBounds for PressedBoundsOf<'_> {
    fn evaluate(&self, node: usize, rate: f64, force: f64, slip: SlipPath) -> PressedBound {
        self.ask(node, |law, node| law.evaluate(node, rate, force, slip))
    }

    fn weakening(&self, node: usize, force: f64) -> f64 {
        self.ask(node, |law, node| law.weakening(node, force))
    }
}
