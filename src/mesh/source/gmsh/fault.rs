//! What is wrong with a mesh file.

use std::fmt::Display;

/// The first mistake of a file: where it stands and what was found there, and what is allowed instead.
#[derive(Debug)]
pub(super) struct Fault {
    pub found: String,
    pub allowed: String,
}

pub(super) type Outcome<T> = Result<T, Fault>;

impl Fault {
    pub fn new(found: impl Display, allowed: impl Display) -> Fault {
        Fault {
            found: found.to_string(),
            allowed: allowed.to_string(),
        }
    }
}
