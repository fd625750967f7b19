//! The normal condition of the contact.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What holds between body and foundation along the normal.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Condition {
    /// The body stays on the foundation, which can pull.
    #[default]
    Bilateral,
    /// The body can open: either the gap is zero and the pressure not negative, or the gap is positive and the pressure zero.
    Unilateral {
        /// Gap of the undeformed body, m. Default: 0.
        #[serde(default)]
        gap: Gap,
    },
    /// The foundation gives way: the pressure is `stiffness` times the penetration (a negative gap) to the power of
    /// `exponent`, and zero where the gap is positive.
    Compliance {
        /// Pressure of a penetration of 1 m, Pa/m^exponent.
        #[schemars(extend("exclusiveMinimum" = 0))]
        stiffness: f64,
        /// Exponent, at least 1. Default: 1.
        #[schemars(range(min = 1, max = 100))]
        #[serde(default = "one")]
        exponent: f64,
        /// Gap of the undeformed body, m. Default: 0.
        #[serde(default)]
        gap: Gap,
        /// How a part of the pressure relaxes. Default: none does.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        memory: Option<PenetrationMemory>,
    },
}

/// Memory of a foundation that gives way: to the pressure of a penetration d it adds
/// `int_0^t sum weight exp(-(t - s)/tau) d'(s) ds`, and it never pulls.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PenetrationMemory {
    /// The terms of the kernel.
    #[schemars(length(min = 1, max = 64))]
    pub kernel: Vec<PenetrationTerm>,
}

/// A term of the kernel by which a foundation remembers penetration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PenetrationTerm {
    /// Stiffness that relaxes, Pa/m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub weight: f64,
    /// Time in which it relaxes, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub tau: f64,
}

fn one() -> f64 {
    1.0
}

impl Condition {
    /// Whether it is the one of a scene that says nothing.
    pub(crate) fn is_default(&self) -> bool {
        *self == Condition::Bilateral
    }

    /// The gap of the undeformed body, where contact can open.
    pub fn gap(&self) -> Option<&Gap> {
        match self {
            Condition::Bilateral => None,
            Condition::Unilateral { gap } | Condition::Compliance { gap, .. } => Some(gap),
        }
    }
}

/// Gap of the undeformed body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Gap {
    /// The same at all contact nodes, m.
    Uniform(f64),
    /// Node by node.
    Nodal(NodalGap),
    /// By a formula.
    Expression(GapExpression),
    /// That of the shape of the body.
    Shape(GapShape),
}

impl Default for Gap {
    fn default() -> Self {
        Gap::Uniform(0.0)
    }
}

/// A gap node by node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodalGap {
    /// One number per contact node, m.
    #[schemars(length(min = 1))]
    pub nodes: Vec<f64>,
}

/// A gap that depends on the place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GapExpression {
    /// Formula of x, y, z (coordinates of a contact node, m) for the gap there, m; evaluated when the scene is compiled.
    pub expression: String,
}

/// A gap that follows from the shape of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GapShape {
    /// The distance to the plane on which the undeformed body rests: normal to the mean normal of the contact part, through its
    /// outermost node.
    Geometry,
}
