//! Solvers of the contact problem: Newton's method on the step energy, the fixed point of the paper's proof, the tangent of a
//! solution, and a search for a second solution.

pub mod fixed_point;
pub mod multiplicity;
pub mod newton;
pub(crate) mod tangent;
