//! Time: the schemes, one step as a sequence of stages, the parts of a master's step, and its tangents.
//!
//! `step` is the algorithm of a step; what it calls stands beside it: `stage` solves one implicit stage (`contact` and `pressed` its
//! contact, `relative` what moves with the body or under it, `nonlinear` the laws of the body where they are not linear), `record` integrates what a stage adds, `sizes` cuts a step into parts,
//! `control` chooses part sizes by `estimate`, and `derivatives` differentiates a step by `tangent`.

mod body_newton;
pub(crate) mod companion;
mod contact;
pub(crate) mod control;
mod derivatives;
pub(crate) mod estimate;
pub(crate) mod finite;
mod foundation;
pub(crate) mod input_course;
mod limit;
mod linearised;
pub(crate) mod lost_digits;
pub(crate) mod memory;
pub(crate) mod nonlinear;
pub(crate) mod penetration;
mod pressed;
pub(crate) mod record;
pub(crate) mod relative;
pub mod scheme;
pub(crate) mod second;
pub(crate) mod sizes;
mod slip_memory;
pub(crate) mod stage;
pub(crate) mod step;
mod tangent;
mod tangent_step;
pub(crate) mod uniqueness;
pub(crate) mod velocity;
pub(crate) mod workspace;
