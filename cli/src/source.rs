//! Where a scene comes from: a file, an embedded example or standard input, with the values the command line replaces.

use crate::arguments::SceneChoice;
use crate::failure::Failure;
use crate::standard;
use std::path::Path;
use std::sync::Arc;
use stickslip::scene::ExampleFiles;
use stickslip::{Files, Folder, Scene};

/// Text of an embedded example.
pub fn embedded(name: &str) -> Result<&'static str, Failure> {
    stickslip::scene::example(name).ok_or_else(|| Failure::NoScene {
        name: name.to_owned(),
    })
}

/// The scene of the command line; `more` replaces values after those of `--set`.
pub fn scene(choice: &SceneChoice, more: &[(String, String)]) -> Result<Scene, Failure> {
    let name = choice.name();
    let path = Path::new(&choice.scene);
    let read;
    let text = match stickslip::scene::example(name) {
        Some(text) if !path.is_file() => text,
        None if !standard::is_meant(path) && !path.exists() => {
            return Err(Failure::NoScene { name: name.into() });
        }
        _ => {
            read = text_of(path).map_err(|why| Failure::File {
                path: name.into(),
                doing: "read",
                why,
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

/// Where the files are that the scene names: in its folder or where the command runs, and those of embedded examples.
pub fn files(choice: &SceneChoice) -> SceneFiles {
    let path = Path::new(&choice.scene);
    SceneFiles(match path.is_file() {
        true => Folder::of(path),
        false => Folder::default(),
    })
}

/// The files of a folder; what is not there may be that of an embedded example.
pub struct SceneFiles(Folder);

impl Files for SceneFiles {
    fn read(&self, name: &str) -> Result<Arc<[u8]>, String> {
        let found = self.0.read(name);
        found.or_else(|why| ExampleFiles.read(name).map_err(|_| why))
    }
}

/// The text of a file or of standard input, or why there is none.
fn text_of(path: &Path) -> Result<String, String> {
    let bytes = match standard::is_meant(path) {
        true => standard::read(),
        false => std::fs::read(path),
    };
    let bytes = bytes.map_err(|error| error.to_string())?;
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err("its byte-order mark says UTF-16, and a scene is UTF-8".to_owned());
    }
    String::from_utf8(bytes)
        .map_err(|error| format!("a scene is UTF-8 text; {}", error.utf8_error()))
}
