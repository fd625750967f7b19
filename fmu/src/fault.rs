//! Why a call is refused, as an importer sees it.

use stickslip::Error;

/// Status values, the same in FMI 2 and FMI 3.
pub const OK: i32 = 0;
pub const WARNING: i32 = 1;
pub const DISCARD: i32 = 2;
pub const ERROR: i32 = 3;

/// A refused call; the instance is as it was before.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Whether other values, or a smaller step, may succeed: FMI 3 then answers Discard.
    pub is_discard: bool,
    pub message: String,
}

/// Result of a call of the lifecycle.
pub type Outcome<T = ()> = Result<T, Fault>;

impl Fault {
    pub fn error(message: impl Into<String>) -> Fault {
        Fault {
            is_discard: false,
            message: message.into(),
        }
    }

    pub fn discard(message: impl Into<String>) -> Fault {
        Fault {
            is_discard: true,
            message: message.into(),
        }
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Fault {
        Fault {
            is_discard: matches!(error, Error::NotConverged { .. }),
            message: error.to_string(),
        }
    }
}
