//! What the body starts with.

use crate::expression::PlaceValue;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the body starts with.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Initial {
    /// Displacement u0, m: one number or formula of the place per dimension, taken at the nodes. It vanishes on clamped and driven
    /// parts and does not leave a foundation that holds the body; branches of memory start relaxed at it. Default: none.
    #[serde(default)]
    pub displacement: Vec<PlaceValue>,
}

impl Initial {
    /// Whether it is the one of a scene that says nothing.
    pub(crate) fn is_default(&self) -> bool {
        self.displacement.is_empty()
    }
}
