//! Friction: the laws, and the solvers that see only the contact.
//!
//! One implicit stage of any time scheme leaves, on the tangential contact velocities `w` relative to the foundation,
//!
//! ```text
//! S w + Lambda = r,   Lambda_i in omega_i g_i(|w_i|) d|w_i|                                     (5.6), (7.1)
//! ```
//!
//! with `S` the condensed operator of the stage, `r` its load, `omega_i` the nodal contact weight and `g_i >= 0` the
//! bound. A solution is a critical point of the step energy
//!
//! ```text
//! W(w) = 1/2 w.S w - r.w + sum_i omega_i G_i(|w_i|),   G_i' = g_i
//! ```
//!
//! which is coercive, so one exists whatever the law and the step. Nothing here knows the body, the mesh or the time.

pub mod bounds;
pub mod evaluation;
pub mod law;
pub mod multiplicity;
mod plane;
pub mod point;
pub mod pressed;
pub mod problem;
pub mod relaxing;
pub mod solve;
mod space;

pub use bounds::Bounds;
pub use evaluation::SlipPath;
pub use law::{FrictionLaw, Law};
pub use problem::ContactProblem;
