//! The ports: every variable a host can touch, declared once. C, FMU and CSV read this list.

mod derivatives;
mod list;
pub(crate) mod readout;

pub use derivatives::Slope;
pub(crate) use derivatives::Tangent;

use crate::contact::law::ContactLaw;
use crate::error::{Error, Result};
use crate::fem::{ContactPart, ContactPatch};
use crate::material::FreeNumber;
use std::ops::Range;

/// What a port is to a master.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Set before a step: the value at its end, unless the simulator is told otherwise.
    Input,
    /// Read after a step.
    Output,
    /// Set before initialization or between steps.
    Parameter,
}

/// What a port means; the number is the input, load, driven direction, motion of the foundation, probe or coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    Input(usize),
    TangentialStress,
    SlipRate,
    Slip,
    AccumulatedSlip,
    SlipMemory,
    Stick,
    ContactForce,
    Pressure,
    Gap,
    Status,
    NormalForce,
    OpenFraction,
    FrictionState,
    MaxSlipRate,
    StickFraction,
    MeanTangentialStress,
    MeanSlipRate,
    MeanPressure,
    LoadDisplacement(usize),
    LoadVelocity(usize),
    ProbeDisplacement(usize),
    ProbeVelocity(usize),
    DriveDisplacement(usize),
    DriveVelocity(usize),
    DriveForce(usize),
    FoundationForce(usize),
    ExternalWork,
    ElasticEnergy,
    ViscousDissipation,
    FrictionDissipation,
    BalanceError,
    Iterations,
    Residual,
    Solutions,
    SolutionGap,
    Uniqueness,
    UniquenessMargin,
    ErrorEstimate,
    LostDigits,
    Coefficient(usize),
    /// A number of a material that stays free.
    Material(usize),
}

/// One variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Port {
    /// Reference: the place in the list.
    pub reference: u32,
    /// Name, as a master writes it.
    pub name: String,
    /// SI unit; `1` for a number.
    pub unit: &'static str,
    pub causality: Causality,
    /// Shape: empty for a scalar, `[nodes]` or `[nodes, components]` over the contact (components inner), `[dimension]`,
    /// `[points]` of a curve.
    pub shape: Vec<usize>,
    pub quantity: Quantity,
    /// The contact of a quantity over the contact, by its place in the scene; `None` where it is over all of them, or over none.
    pub contact: Option<usize>,
    /// One sentence with sign and frame.
    pub description: String,
}

impl Port {
    /// Number of values.
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// The contact nodes that a quantity over the contact is of.
    pub(crate) fn nodes(&self, contact: &ContactPatch) -> Range<usize> {
        match self.contact {
            Some(part) => contact.parts[part].nodes.clone(),
            None => 0..contact.node_count(),
        }
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// All ports of a model, in the order of their references.
#[derive(Debug, Clone, PartialEq)]
pub struct Ports {
    list: Vec<Port>,
}

/// An input that moves something.
pub(crate) struct DrivenPort {
    pub name: String,
    pub is_rotation: bool,
    pub is_displacement: bool,
}

/// A motion of the foundation.
pub(crate) struct FoundationPort {
    pub name: String,
    pub is_rotation: bool,
    pub is_approach: bool,
}

/// What the list is made from.
pub(crate) struct Shapes<'a> {
    pub dimension: usize,
    pub contacts: &'a [ContactPart],
    pub components: usize,
    /// Whether the contact has a normal component.
    pub has_normal: bool,
    /// Whether steps have means apart from the values at their ends.
    pub has_means: bool,
    /// Name and unit of the intensity, in the order of the scene.
    pub loads: &'a [(String, &'static str)],
    pub driven: &'a [DrivenPort],
    pub foundation: &'a [FoundationPort],
    pub probes: &'a [String],
    pub friction: &'a ContactLaw,
    /// Whether steps say whether they have one solution.
    pub asks_uniqueness: bool,
    /// Whether the error in time is estimated.
    pub has_error_estimate: bool,
    /// Whether its steps may lose digits.
    pub can_lose_digits: bool,
    /// Numbers of a material that stays free.
    pub free_numbers: &'a [FreeNumber],
}

impl Ports {
    /// All ports.
    pub fn all(&self) -> &[Port] {
        &self.list
    }

    /// The outputs, in the order of their references.
    pub fn outputs(&self) -> impl Iterator<Item = &Port> {
        self.list
            .iter()
            .filter(|p| p.causality == Causality::Output)
    }

    /// Number of values of all outputs together.
    pub fn output_len(&self) -> usize {
        self.outputs().map(Port::len).sum()
    }

    /// The port of that name.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    pub fn find(&self, name: &str) -> Result<&Port> {
        self.list
            .iter()
            .find(|p| p.name == name)
            .ok_or_else(|| Error::Unknown {
                what: "port",
                found: name.into(),
            })
    }

    /// The port with that reference.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    pub fn get(&self, reference: u32) -> Result<&Port> {
        self.list
            .get(reference as usize)
            .ok_or_else(|| Error::Unknown {
                what: "port reference",
                found: reference.to_string(),
            })
    }
}
