//! Why a value of a scene is refused, before the name of its source is known.

use crate::Error;
use crate::message::cut;
use serde_json::Value;
use std::fmt::Display;

/// The first mistake of a scene: its JSON path, what was found there and what is allowed.
#[derive(Debug)]
pub(crate) struct Refusal {
    path: String,
    found: String,
    allowed: String,
}

/// Nothing, or the first mistake.
pub(crate) type Verdict = Result<(), Refusal>;

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

/// Refuses unless `holds`.
pub(crate) fn ensure(holds: bool, refusal: impl FnOnce() -> Refusal) -> Verdict {
    if holds { Ok(()) } else { Err(refusal()) }
}

/// An error about the value at `path` of a scene whose name the caller does not know.
pub(crate) fn scene_error(path: &str, found: String, allowed: String) -> Error {
    Refusal::new(path, found, allowed).of("scene")
}

/// A value on one line, cut where it becomes too long to read.
pub(crate) fn shown(value: &Value) -> String {
    cut(&value.to_string())
}

/// A value as the scene writes it.
pub(crate) fn json(value: &(impl serde::Serialize + ?Sized)) -> String {
    serde_json::to_value(value).map_or_else(|error| error.to_string(), |value: Value| shown(&value))
}
