//! A scene: the validated content of `scene.json`, plain data without mathematics.

mod types;

pub use types::*;
