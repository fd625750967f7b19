//! Finite elements for the viscoelastic body of (5.13)-(5.14), with memory or without: small strains, coefficients constant in
//! every cell.
//!
//! From a scene and a mesh to what the numerics need: the two symmetric matrices A (viscosity) and B (elasticity) on the
//! free displacements, the contact nodes with their frames and weights, one column per load and one row per probe output.

mod bent;
mod body;
mod cell;
mod contact;
mod direction;
mod dofs;
mod driven;
mod face;
mod forms;
mod foundation;
mod held;
mod initial;
mod loads;
mod memory;
mod operators;
mod pieces;
mod rigid;
mod rollers;
#[cfg(test)]
mod solids;
mod strain;
mod surface;

pub use body::Body;
pub use cell::{Cell, Simplex};
pub use contact::{ContactPart, ContactPatch};
pub use dofs::DofMap;
pub use driven::Drives;
pub use forms::Forms;
pub use initial::InitialDisplacement;
pub use loads::{LoadColumn, ProbeRows};
pub use operators::{BranchOperator, OperatorPair};
pub use rigid::Pin;
pub use strain::StrainNorm;
