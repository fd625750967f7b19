//! Where a scene comes from: a file or an embedded example, with the values the command line replaces.

use crate::arguments::SceneChoice;
use crate::failure::Failure;
use std::path::Path;
use stickslip::Scene;

/// Text of an embedded example.
pub fn embedded(name: &str) -> Result<&'static str, Failure> {
    stickslip::scene::example(name).ok_or_else(|| Failure::NoScene {
        name: name.to_owned(),
    })
}

/// The scene of the command line; `more` replaces values after those of `--set`.
pub fn scene(choice: &SceneChoice, more: &[(String, String)]) -> Result<Scene, Failure> {
    let name = &choice.scene;
    let path = Path::new(name);
    let read;
    let text = match stickslip::scene::example(name) {
        Some(text) if !path.is_file() => text,
        None if !path.exists() => return Err(Failure::NoScene { name: name.clone() }),
        _ => {
            read = std::fs::read_to_string(path).map_err(|error| Failure::File {
                path: path.to_owned(),
                doing: "read",
                why: error.to_string(),
            })?;
            &read
        }
    };
    let forced = choice
        .force
        .then(|| ("time.force".to_owned(), "true".to_owned()));
    let overrides: Vec<_> = choice
        .overrides
        .iter()
        .chain(more)
        .chain(&forced)
        .cloned()
        .collect();
    Scene::with_overrides(text, name, &overrides).map_err(Failure::of(name))
}
