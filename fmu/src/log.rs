//! Messages to the importer: few categories. Errors are always told; of the others there is silence unless it asked for them.

use crate::fault::{Fault, Outcome};
use std::ffi::CStr;

/// Category of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Category {
    Error,
    Discard,
    Warning,
    Event,
}

impl Category {
    pub const ALL: [Category; 4] = [
        Category::Error,
        Category::Discard,
        Category::Warning,
        Category::Event,
    ];

    /// Name in the model description.
    pub fn name(self) -> &'static CStr {
        match self {
            Category::Error => c"logStatusError",
            Category::Discard => c"logStatusDiscard",
            Category::Warning => c"logStatusWarning",
            Category::Event => c"logEvents",
        }
    }

    pub fn description(self) -> &'static str {
        match self {
            Category::Error => "A call that was refused, with the reason; always logged.",
            Category::Discard => "Values or a step that were discarded; others may succeed.",
            Category::Warning => {
                "What accepted steps note: several solutions, a friction law that holds as well as rounding or the limit of work allows; when it begins \
                 and when it has ended."
            }
            Category::Event => {
                "Compilation of the scene with changed parameters; events of the contact, for importers that use event mode."
            }
        }
    }
}

/// Passes a message on: status, category, text.
pub type Sink = Box<dyn Fn(i32, Category, &str) + Send>;

/// Where messages go, and which.
pub struct Log {
    sink: Sink,
    is_on: [bool; Category::ALL.len()],
}

impl Log {
    pub fn new(sink: Sink, is_on: bool) -> Log {
        Log {
            sink,
            is_on: [is_on; Category::ALL.len()],
        }
    }

    /// Switches categories on or off; none named means all.
    pub fn switch(&mut self, is_on: bool, names: &[&CStr]) -> Outcome {
        let place = |name: &&CStr| {
            let found = Category::ALL.iter().position(|c| c.name() == *name);
            found.ok_or_else(|| {
                let known: Vec<_> = Category::ALL
                    .iter()
                    .map(|c| c.name().to_string_lossy())
                    .collect();
                Fault::error(format!(
                    "unknown log category {name:?}; known: {}",
                    known.join(", ")
                ))
            })
        };
        let places = names.iter().map(place).collect::<Outcome<Vec<usize>>>()?;
        if names.is_empty() {
            self.is_on.fill(is_on);
        }
        for place in places {
            self.is_on[place] = is_on;
        }
        Ok(())
    }

    pub fn is_on(&self, category: Category) -> bool {
        category == Category::Error || self.is_on[category as usize]
    }

    pub fn write(&self, status: i32, category: Category, message: &str) {
        if self.is_on(category) {
            (self.sink)(status, category, message);
        }
    }

    /// Writes an error of an instance that does not come to be.
    pub fn write_always(&self, status: i32, message: &str) {
        (self.sink)(status, Category::Error, message);
    }
}
