//! The bounds of any law as nodal forces that may depend on the normal forces.

use super::coulomb::{Coulomb, pressing};
use super::{At, Coefficients, FrictionLaw, Memory, MemoryPath};
use crate::contact::evaluation::SlipPath;
use crate::contact::pressed::{PressedBound, PressedBounds};

/// A law with given coefficients in a stage: `B = omega g(r)`, or Coulomb's law.
#[derive(Debug, Clone, Copy)]
pub struct PressedLaw<'a> {
    kind: &'static dyn FrictionLaw,
    coefficients: Coefficients<'a>,
    /// `None` for a bound in Pa.
    coulomb: Option<Coulomb<'a>>,
    weights: &'a [f64],
    per_rate: f64,
    memory: Option<Memory<'a>>,
    /// What the slip of the contact problem is multiplied by.
    slip_scale: f64,
}

impl<'a> PressedLaw<'a> {
    pub(super) fn new(
        kind: &'static dyn FrictionLaw,
        coefficients: Coefficients<'a>,
        coulomb: Option<Coulomb<'a>>,
        weights: &'a [f64],
        per_rate: f64,
    ) -> PressedLaw<'a> {
        PressedLaw {
            kind,
            coefficients,
            coulomb,
            weights,
            per_rate,
            memory: None,
            slip_scale: 1.0,
        }
    }

    /// The law with the memory of a stage. A law with memory that is asked without one answers NaN.
    pub fn remembering(self, memory: Memory<'a>) -> PressedLaw<'a> {
        PressedLaw {
            memory: Some(memory),
            ..self
        }
    }

    /// The same in a contact problem whose slip is to be multiplied by this.
    pub fn scaled(self, slip_scale: f64) -> PressedLaw<'a> {
        PressedLaw { slip_scale, ..self }
    }

    /// The memory of a node.
    fn memory(&self, node: usize) -> MemoryPath {
        self.memory
            .as_ref()
            .map_or(MemoryPath::NONE, |memory| memory.path(node))
    }

    fn at(
        &self,
        node: usize,
        rate: f64,
        slip: SlipPath,
        (pressure, memory): (f64, MemoryPath),
    ) -> At<'_> {
        At {
            rate,
            slip: slip.scaled(self.slip_scale),
            coefficients: self.coefficients,
            node,
            pressure,
            memory,
        }
    }

    /// Pressure that bounds the friction of a node, and what [`pressing`] says of its normal force.
    fn pressure(&self, node: usize, force: f64) -> (f64, [f64; 2]) {
        let tension = self.coulomb.is_some_and(|coulomb| coulomb.tension);
        let [pressing, sign] = pressing(force, tension);
        let pressure = if pressing > 0.0 {
            pressing / self.weights[node]
        } else {
            0.0
        };
        (pressure, [pressing, sign])
    }

    /// The value of a formula at a node where it is none that a solution may have; see [`super::ChosenLaw::has_formula`].
    pub fn fault(&self, node: usize, rate: f64, force: f64, slip: SlipPath) -> Option<f64> {
        let (pressure, _) = self.pressure(node, force);
        let memory = self.memory(node);
        self.kind
            .fault(&self.at(node, rate, slip, (pressure, memory)))
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
        let weight = self.weights[node];
        let (pressure, [pressing, sign]) = self.pressure(node, force);
        let said = self
            .kind
            .value(&self.at(node, rate, slip, (pressure, memory)));
        match &self.coulomb {
            Some(coulomb) => coulomb.bound(node, weight, [pressing, sign], said),
            None => PressedBound {
                bound: weight * said.value,
                by_rate: weight * said.by_rate,
                by_force: sign * said.by_pressure,
            },
        }
    }
}

impl PressedBounds for PressedLaw<'_> {
    fn evaluate(&self, node: usize, rate: f64, force: f64, slip: SlipPath) -> PressedBound {
        self.evaluate_with(self.memory(node), node, rate, force, slip)
    }

    fn weakening(&self, node: usize, force: f64) -> f64 {
        let scale = match &self.coulomb {
            Some(coulomb) => pressing(force, coulomb.tension)[0],
            None => self.weights[node],
        };
        let slip = SlipPath {
            base: 0.0,
            per_rate: self.per_rate,
        };
        let memory = self.memory(node);
        scale
            * self
                .kind
                .weakening(&self.at(node, 0.0, slip, (0.0, memory)))
    }
}
