//! What moves: the foundation, and parts of the body that are driven.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A motion of the foundation. Its velocity, of an approach its displacement, is an input; the force or torque that is needed
/// for it is an output. Several motions add up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Foundation {
    /// It slides in its own surface. Input: velocity, m/s. Output: `force`, N.
    Sliding {
        /// Name of the input; as for loads, and different from them.
        name: String,
        /// Direction, one component per dimension; its length does not matter. Only what is tangential to the contact enters.
        direction: Vec<f64>,
        /// Velocity at the start, m/s. Default: 0.
        #[serde(default)]
        start: f64,
    },
    /// It turns about an axis that leaves its surface where it is: a disc, a drum. Input: angular velocity, rad/s. Output:
    /// `torque`, N m.
    Rotation {
        /// Name of the input; as for loads, and different from them.
        name: String,
        /// A point of the axis, m, one coordinate per dimension.
        centre: Vec<f64>,
        /// Direction of the axis, three components; in 2D it is z, and not written.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        axis: Option<Vec<f64>>,
        /// Angular velocity at the start, rad/s. Default: 0.
        #[serde(default)]
        start: f64,
    },
    /// It moves along its normal. Input: displacement towards the body, m. Output: `force`, N.
    Approach {
        /// Name of the input; as for loads, and different from them.
        name: String,
        /// Displacement towards the body at the start, m. Default: 0.
        #[serde(default)]
        start: f64,
    },
}

impl Foundation {
    /// Name of the input.
    pub fn name(&self) -> &str {
        match self {
            Foundation::Sliding { name, .. }
            | Foundation::Rotation { name, .. }
            | Foundation::Approach { name, .. } => name,
        }
    }

    /// Value at the start.
    pub fn start(&self) -> f64 {
        match self {
            Foundation::Sliding { start, .. }
            | Foundation::Rotation { start, .. }
            | Foundation::Approach { start, .. } => *start,
        }
    }
}

/// A part whose motion along some directions is given; along the others it stays free.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Driven {
    /// Name of the part; not clamped, not in contact, and without a node of another driven or clamped part.
    pub part: String,
    /// What its inputs are. Default: `velocity`.
    #[serde(default)]
    pub input: DrivenInput,
    /// Directions that are given, by the names of their inputs (as for loads, and different from them): a vector with one
    /// component per dimension, whose length does not matter, at right angles to the others of the part; or a rotation, which
    /// makes the part rigid.
    pub directions: BTreeMap<String, DrivenDirection>,
}

/// What the inputs of a driven part are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DrivenInput {
    /// Velocities, m/s (rad/s of a rotation).
    #[default]
    Velocity,
    /// Displacements, m (rad of a rotation): reached at the end of every step with a constant velocity.
    Displacement,
}

/// A motion of a driven part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum DrivenDirection {
    /// Along a direction.
    Translation(Vec<f64>),
    /// About an axis, by small angles.
    Rotation(RotationAxis),
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotationAxis {
    /// A point of the axis, m, one coordinate per dimension.
    pub centre: Vec<f64>,
    /// Direction of the axis, three components; in 2D it is z, and not written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<Vec<f64>>,
}
