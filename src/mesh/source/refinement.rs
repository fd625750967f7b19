//! Places at which a mesh of triangles is made finer.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Every triangle that touches a box is bisected until its longest side has at most a given length; its neighbours are
/// bisected as far as the mesh needs to conform, so that the triangles grow steadily with the distance from the box. This
/// puts unknowns where they matter: a corner at the end of a clamped or contact part, where the stress concentrates (a
/// corner costs some four triangles for every halving of `size`), or the piece of the contact where slip turns into stick.
/// Not together with `periodic`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Refinement {
    /// Corner of the box with the smaller coordinates, m.
    pub from: [f64; 2],
    /// Corner of the box with the larger coordinates, m. Default: `from`, a point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<[f64; 2]>,
    /// Longest side that the triangles there may have, m; at least 1e-7 of the longer side of the body.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub size: f64,
}

impl Refinement {
    /// The corner of the box with the larger coordinates, m.
    pub(super) fn upper(&self) -> [f64; 2] {
        self.to.unwrap_or(self.from)
    }

    /// Nodes that a filled box takes: right triangles with this longest side, two for each node.
    pub(super) fn nodes(&self) -> f64 {
        let (from, to) = (self.from, self.upper());
        2.0 * (to[0] - from[0]) * (to[1] - from[1]) / (self.size * self.size)
    }
}
