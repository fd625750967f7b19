//! The types of `scene.json`. All quantities are in SI units (2D scenes are per metre of depth).
//!
//! The JSON Schema is generated from these types, so every doc comment here is what a user reads there, and a range
//! written here (`#[schemars(...)]`) is the one that parsing enforces. Rules that tie several values together are in
//! `validate.rs`.

mod body;
mod boundary;
mod fidelity;
mod friction;
mod run;

pub use body::*;
pub use boundary::*;
pub use fidelity::*;
pub use friction::*;
pub use run::*;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A viscoelastic body in bilateral frictional contact with a rigid foundation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Version of this format: 1.
    #[schemars(extend("const" = 1))]
    pub schema_version: u32,
    /// Name of the scene.
    pub name: String,
    /// Mesh of the body.
    pub mesh: MeshSpec,
    /// Finite element. Default: `p1`.
    #[serde(default)]
    pub element: ElementKind,
    /// Material of the body.
    pub material: Material,
    /// Names of the parts on which the body is clamped (velocity and displacement zero). At least one: without it the
    /// body could slide rigidly along the foundation, and without inertia nothing would determine its motion.
    #[schemars(length(min = 1))]
    pub clamped: Vec<String>,
    /// Contact with the foundation.
    pub contact: Contact,
    /// Loads; each is an input of the component. Default: none.
    #[serde(default)]
    pub loads: Vec<Load>,
    /// Points whose displacement and velocity are outputs. Default: none.
    #[serde(default)]
    pub probes: Vec<Probe>,
    /// Time integration.
    pub time: Time,
    /// Speed against accuracy.
    #[serde(default)]
    pub fidelity: Fidelity,
    /// Recorded past of the contact.
    #[serde(default)]
    pub history: History,
    /// What `stickslip run` does with the scene.
    #[serde(default)]
    pub run: Run,
}
