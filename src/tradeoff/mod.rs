//! Speed against accuracy, measured: settings of a scene, run on its own signals, against a reference that is better than
//! any of them.
//!
//! A [`Setting`] is what a user passes as `--set`: paths and values. A [`Study`] compiles settings of one scene (bodies are
//! shared where only time or friction differ) and runs them to the end of `run`; a [`Sample`] holds what a master sees at the
//! instants that all settings share, and the work of the run, counted in multiplications. A [`Reference`] refines mesh and
//! step until its levels agree and says what is left in it; a [`Verdict`] is a run judged by it. `fidelity.target_error` picks the
//! cheapest setting for `fidelity.target_error`.
//!
//! Nothing here looks at a clock: the same scene gives the same errors, the same work and the same pick. What it does not
//! do: it says nothing of the model itself (materials, friction law, the bilateral contact), and where the solution of the
//! continuous problem is not unique the reference is one of its solutions.

mod errors;
mod family;
mod reference;
mod selection;
mod setting;
mod study;
mod surface;
mod trajectory;

pub use crate::model::Selection;
pub use errors::{Errors, Quantity};
pub use family::{Family, GRADINGS, cells, elements, grading};
pub use reference::{Level, MARGIN, Measured, Reference, Refinement, Verdict};
pub(crate) use selection::resolve;
pub use setting::Setting;
pub use study::{Candidate, Sample, Study, loosest_reduction};
pub use trajectory::{Instant, Trajectory, Work};
