//! Embedded example scenes, with the meshes that some of them name.

use crate::files::Files;
use std::sync::Arc;

/// Names and texts, the paper's example first.
const EXAMPLES: [(&str, &str); 10] = [
    ("kazmi2014", include_str!("examples/kazmi2014.json")),
    ("brake_pad_3d", include_str!("examples/brake_pad_3d.json")),
    (
        "sheared_column",
        include_str!("examples/sheared_column.json"),
    ),
    ("seal", include_str!("examples/seal.json")),
    ("disc_brake", include_str!("examples/disc_brake.json")),
    ("belt", include_str!("examples/belt.json")),
    ("fault", include_str!("examples/fault.json")),
    ("snap", include_str!("examples/snap.json")),
    ("brake_shoe", include_str!("examples/brake_shoe.json")),
    ("lip_seal", include_str!("examples/lip_seal.json")),
];

/// Names and contents of the files that they name.
const FILES: [(&str, &[u8]); 2] = [
    ("brake_shoe.msh", include_bytes!("examples/brake_shoe.msh")),
    ("lip_seal.msh", include_bytes!("examples/lip_seal.msh")),
];

/// The files that the embedded examples name.
#[derive(Debug, Clone, Copy, Default)]
pub struct ExampleFiles;

impl Files for ExampleFiles {
    fn read(&self, name: &str) -> Result<Arc<[u8]>, String> {
        let found = FILES.iter().find(|(known, _)| *known == name);
        let bytes = found.map(|(_, bytes)| Arc::from(*bytes));
        bytes.ok_or_else(|| "no embedded example has such a file".to_owned())
    }
}

/// Text of an embedded example; `None` for an unknown name.
pub fn example(name: &str) -> Option<&'static str> {
    EXAMPLES
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, text)| *text)
}

/// Names of the embedded examples.
pub fn example_names() -> impl Iterator<Item = &'static str> {
    EXAMPLES.iter().map(|(name, _)| *name)
}
