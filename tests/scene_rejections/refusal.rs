//! What a refused scene must say.

use stickslip::scene::example;
use stickslip::{Error, Scene};

pub fn text_of(name: &str) -> &'static str {
    example(name).expect("embedded example")
}

/// Asserts that the text is refused at `path`, with these substrings of what was found and what is allowed.
pub fn assert_refused(text: &str, (path, found, allowed): (&str, &str, &str)) {
    assert_scene_error(Scene::from_json(text, "test.json"), path, found, allowed);
}

pub fn assert_scene_error(result: stickslip::Result<Scene>, at: &str, was: &str, may: &str) {
    match result {
        Err(Error::Scene {
            source_name,
            path,
            found,
            allowed,
        }) => {
            assert_eq!(source_name, "test.json");
            assert_eq!(path, at, "found {found}, allowed {allowed}");
            assert!(found.contains(was), "{path}: found {found:?} lacks {was:?}");
            assert!(
                allowed.contains(may),
                "{path}: allowed {allowed:?} lacks {may:?}"
            );
        }
        Err(other) => panic!("{at}: {other:?}"),
        Ok(_) => panic!("{at}: accepted"),
    }
}

/// Replaces in an example the one occurrence of `old` by `new`, for every row, and asserts the refusal.
pub fn assert_edits_refused(name: &str, rows: &[(&str, &str, &str, &str, &str)]) {
    let text = text_of(name);
    for (old, new, path, found, allowed) in rows {
        assert_eq!(text.matches(old).count(), 1, "{old:?} must occur once");
        assert_refused(&text.replace(old, new), (path, found, allowed));
    }
}
