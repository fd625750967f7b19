//! What is recorded, and what `stickslip run` does.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Recorded past of the contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct History {
    /// Number of internal steps kept (slip rate, slip and tangential stress of every contact node); part of the state.
    /// Default: 16.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub capacity: u32,
}

impl Default for History {
    fn default() -> Self {
        History { capacity: 16 }
    }
}

/// What `stickslip run` does with the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Run {
    /// End of the run, s. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub until: f64,
    /// Communication step, s; default: `time.step`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
    /// Course of every load; default: its start value.
    pub signals: BTreeMap<String, Signal>,
}

impl Default for Run {
    fn default() -> Self {
        Run {
            until: 1.0,
            step: None,
            signals: BTreeMap::new(),
        }
    }
}

/// Course of a load in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Signal {
    /// The same value at all times.
    Constant(f64),
    /// Pairs of time and value, linear between them, constant outside; times increase. A time that stands twice is a jump: the
    /// first value holds up to it, the second from it on.
    Table(#[schemars(length(min = 1))] Vec<[f64; 2]>),
}

impl Signal {
    /// Value up to time `t`: the one before the jump where there is one.
    pub fn before(&self, t: f64) -> f64 {
        match self {
            Signal::Constant(value) => *value,
            Signal::Table(points) => {
                let from = points.partition_point(|p| p[0] < t);
                match points.get(from) {
                    Some(point) if point[0] == t => point[1],
                    _ => self.at(t),
                }
            }
        }
    }

    /// The times at which the value jumps, in their order.
    pub fn jumps(&self) -> impl Iterator<Item = f64> {
        let points = match self {
            Signal::Constant(_) => &[],
            Signal::Table(points) => points.as_slice(),
        };
        let pairs = points.windows(2).filter(|p| p[0][0] == p[1][0]);
        pairs.filter(|p| p[0][1] != p[1][1]).map(|p| p[0][0])
    }

    /// Value from time `t` on: the one after the jump where there is one.
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Signal::Constant(value) => *value,
            Signal::Table(points) => {
                let after = points.partition_point(|p| p[0] <= t);
                match (
                    after.checked_sub(1).and_then(|i| points.get(i)),
                    points.get(after),
                ) {
                    (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (t - a[0]) / (b[0] - a[0]),
                    (Some(a), None) => a[1],
                    (None, Some(b)) => b[1],
                    (None, None) => 0.0,
                }
            }
        }
    }
}
