//! Finite elements for the Kelvin-Voigt body of (5.13)-(5.14): small strains, constant coefficients.
//!
//! From a scene and a mesh to what the numerics need: the two symmetric matrices A (viscosity) and B (elasticity) on the
//! free displacements, the contact nodes with their frames and weights, one column per load and one row per probe output.

mod body;
mod dofs;
mod element;
mod loads;
mod material;
mod operators;

pub use body::{Body, ContactPatch};
pub use dofs::DofMap;
pub use element::{Element, IsotropicForm, Simplex};
pub use loads::{LoadColumn, ProbeRows};
pub use operators::OperatorPair;
