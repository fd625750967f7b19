//! Embedded example scenes.

/// Names and texts, the paper's example first.
const EXAMPLES: [(&str, &str); 8] = [
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
];

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
