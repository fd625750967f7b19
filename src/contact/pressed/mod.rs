//! Contact that is pressed: friction bounds that follow the normal force, and nodes that open and close.
//!
//! One implicit stage leaves, on the contact velocities v relative to the foundation (tangential and normal),
//!
//! ```text
//! S v + [lam; -p] = r,   lam in B(|v_t|, p) d|v_t|,   gap = gap_base + gap_rate v_n
//! bilateral gap = 0;   unilateral 0 <= p, gap >= 0, p gap = 0;   compliance p = c max(0, -gap)^m
//! ```
//!
//! The unknowns are those of the normal map, `z = lam + rho_t v_t` and `y = p - rho_n gap`: given them, velocity and force of a
//! node follow from scalar equations with one solution each (`node`), and what remains is a system of piecewise smooth equations
//! (`newton`). It has a solution whatever the law; where friction is strong or weakens fast there may be several, and the warm start
//! says which one is found. Nothing here knows the body, the mesh or the time.
//!
//! After P. Alart and A. Curnier (CMAME 92, 1991) for the equations, S. M. Robinson (Math. Oper. Res. 17, 1992) for the normal map.

mod border;
mod chain;
mod direction;
mod energy;
mod entries;
mod linearisation;
mod multiplicity;
mod newton;
mod node;
mod point;
mod problem;
mod replaced;
mod residual;
mod solve;
mod sweep;
pub(crate) mod tangent;

pub use chain::PressedWork;
pub use linearisation::{PressedPoint, clear_points, is_plausible, points_len};
pub use multiplicity::PressedMultiplicity;
pub use problem::{NormalCondition, NormalConditions, PressedBound, PressedBounds, PressedProblem};
pub use solve::{PressedSolution, PressedWorkspace, index, solve};
