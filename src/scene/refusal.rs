//! Why a scene is refused, before the name of its source is known.

use crate::Error;
use crate::message::cut;
use serde_json::Value;
use std::fmt::Display;

/// The first mistake of a scene.
#[derive(Debug)]
pub(super) struct Refusal {
    path: String,
    found: String,
    allowed: String,
}

impl Refusal {
    pub fn new(path: impl Display, found: impl Display, allowed: impl Display) -> Refusal {
        Refusal {
            path: path.to_string(),
            found: found.to_string(),
            allowed: allowed.to_string(),
        }
    }

    /// The error that names the source of the scene.
    pub fn of(self, source_name: &str) -> Error {
        Error::Scene {
            source_name: source_name.to_owned(),
            path: self.path,
            found: self.found,
            allowed: self.allowed,
        }
    }
}

/// A value on one line, cut where it becomes too long to read.
pub(super) fn shown(value: &Value) -> String {
    cut(&value.to_string())
}
