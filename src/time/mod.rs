//! Time: the schemes, one step as a sequence of stages, the parts of a master's step, and its tangents.
//!
//! `step` is the algorithm of a step; what it calls stands beside it: `stage` solves one implicit stage, `record`
//! integrates what a stage adds, `sizes` cuts a step into parts, `control` chooses part sizes by `estimate`, and
//! `tangent` differentiates a step.

pub(crate) mod companion;
pub(crate) mod control;
pub(crate) mod estimate;
pub(crate) mod finite;
pub(crate) mod input_course;
pub(crate) mod lost_digits;
pub(crate) mod memory;
pub(crate) mod pressed;
pub(crate) mod record;
pub mod scheme;
pub(crate) mod second;
pub(crate) mod sizes;
pub(crate) mod stage;
pub(crate) mod step;
mod tangent;
pub(crate) mod workspace;
