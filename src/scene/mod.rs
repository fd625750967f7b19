//! A scene: the validated content of `scene.json`, plain data without mathematics.
//!
//! Text becomes a [`Scene`] in three steps, each of which refuses the first mistake it meets with the JSON path, what
//! was found there and what is allowed:
//! 1. `parse`: text to JSON value (syntax, finite numbers, duplicate keys);
//! 2. `structure`: keys, types, names and ranges, against the JSON Schema generated from the types;
//! 3. `validate`: the rules that tie several values together.

mod examples;
mod friction;
mod overrides;
mod parse;
mod path;
mod structure;
mod types;
mod validate;

pub use crate::mesh::MAX_NODES;
pub use examples::{ExampleFiles, example, example_names};
pub use types::*;

use crate::Result;
use crate::refusal::Refusal;
use serde::Deserialize;
use structure::Structure;

impl Scene {
    /// Reads and validates a scene; `source_name` (a file name, or `scene`) is what errors call it. A byte-order mark is
    /// skipped, `"$schema"` at the top is allowed and dropped, and 32.0 is an integer.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) for the first mistake.
    pub fn from_json(text: &str, source_name: &str) -> Result<Scene> {
        Scene::with_overrides(text, source_name, &[])
    }

    /// Reads a scene after replacing values in it: pairs of a path (`contact.friction.alpha`, `loads[0].start`) and a
    /// value, which is JSON if it parses and a string otherwise. Applied in order.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) for the first mistake; also for a path that leads through something that is not there.
    pub fn with_overrides(
        text: &str,
        source_name: &str,
        overrides: &[(String, String)],
    ) -> Result<Scene> {
        let named = |refusal: Refusal| refusal.of(source_name);
        let structure = Structure::of_scenes();
        let mut value = parse::parse(text).map_err(named)?;
        for (path, new) in overrides {
            overrides::apply(&mut value, &structure, path, new).map_err(named)?;
        }
        structure.check(&value).map_err(named)?;
        structure::write_integers(&mut value);
        if let Some(members) = value.as_object_mut() {
            members.remove(structure::SCHEMA_KEY);
        }
        let mut scene = Scene::deserialize(&value).map_err(|error| {
            named(Refusal::new(
                "$",
                error,
                "what the JSON Schema of scenes allows",
            ))
        })?;
        if scene.mesh.file().is_none() {
            scene.element.get_or_insert_default();
        }
        validate::check(&scene).map_err(named)?;
        Ok(scene)
    }

    /// Validates a scene that was built or changed in Rust. A number that is not finite is reported as null.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) for the first mistake.
    pub fn validate(&self, source_name: &str) -> Result<()> {
        let check = || {
            let value = serde_json::to_value(self)
                .map_err(|error| Refusal::new("$", error, "a scene that JSON can express"))?;
            Structure::of_scenes().check(&value)?;
            validate::check(self)
        };
        check().map_err(|refusal: Refusal| refusal.of(source_name))
    }

    /// The rules that need the dimension of the mesh, for a scene that does not say it itself.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene).
    pub(crate) fn validate_in(&self, dimension: usize) -> Result<()> {
        let named = |refusal: Refusal| refusal.of("scene");
        match self.mesh.dimension() {
            None => validate::check_in(self, Some(dimension)).map_err(named),
            Some(_) => Ok(()),
        }
    }

    /// The scene as pretty JSON, defaults written out, keys in the order of the documentation. Reads back equal.
    pub fn to_json(&self) -> String {
        // Strings as map keys and a writer in memory: there is nothing here that can fail.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}

/// The JSON Schema of scenes, pretty; made from the types, so it is what parsing enforces, except for the rules that
/// tie several values together.
pub fn json_schema() -> String {
    format!("{:#}", Structure::of_scenes().schema())
}
