//! What acts on the body: contact and loads; and where it is observed.

use super::{Condition, Foundation, Friction};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most contacts of a scene.
pub const MAX_CONTACTS: usize = 16;

/// Name of a contact that has none of its own. The ports of all contacts together begin with it.
pub(crate) const CONTACT: &str = "contact";

fn contact_name() -> String {
    CONTACT.to_owned()
}

fn is_contact_name(name: &String) -> bool {
    name == CONTACT
}

/// Contact with a rigid foundation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Name, as for loads, and different from them: that of its ports. Default: `contact`, for the only one of a scene.
    #[serde(default = "contact_name", skip_serializing_if = "is_contact_name")]
    pub name: String,
    /// Name of the part in contact; not clamped, not driven, not loaded.
    pub part: String,
    /// What holds between body and foundation along the normal. Default: `bilateral`.
    #[serde(default, skip_serializing_if = "Condition::is_default")]
    pub condition: Condition,
    /// Friction law.
    pub friction: Friction,
    /// First tangential direction (projected on the contact plane). Default: the direction in which x grows, or y
    /// where the contact is normal to x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tangent: Option<Vec<f64>>,
    /// How the foundation moves; each motion is an input of the component. Default: it is at rest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub foundation: Vec<Foundation>,
    /// Whether the pressure is an output, also where neither condition nor friction asks for it. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub pressure: bool,
}

/// A load; its intensity is an input, its work-conjugate displacement and velocity are outputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Name of the input: a letter or underscore, then letters, digits and underscores; not `contact`, `energy`,
    /// `solver` or `time`, which begin the names of other ports.
    pub name: String,
    /// Where it acts.
    pub kind: LoadKind,
    /// Name of the part a traction acts on; absent for a body force.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// Direction, one component per dimension; not zero, its length does not matter.
    pub direction: Vec<f64>,
    /// Intensity at the start: Pa for a traction, N/m^3 for a body force. Default: 0.
    #[serde(default)]
    pub start: f64,
    /// Course of the input within a communication step. Default: `linear`.
    #[serde(default)]
    pub interpolation: Interpolation,
}

/// Where a load acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LoadKind {
    /// Force per area on a part of the boundary.
    Traction,
    /// Force per volume on the whole body.
    BodyForce,
}

/// Course of an input within a communication step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Linear between the values at the two ends of the step.
    #[default]
    Linear,
    /// The new value from the beginning of the step (a jump when it differs from the last one).
    Hold,
}

/// A point of the body whose displacement and velocity are outputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// Name of the probe; as for loads, and different from them.
    pub name: String,
    /// Coordinates, m, one per dimension; inside the body.
    pub at: Vec<f64>,
}
