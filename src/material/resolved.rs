//! What a memory comes down to: branches, and what they leave of the elasticity.

use super::memory::{Branch, IsotropicBranch};

/// Shear and bulk modulus, or viscosity, of an isotropic law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    pub shear: f64,
    pub bulk: f64,
}

impl Pair {
    /// Factors that change nothing.
    pub const WHOLE: Pair = Pair {
        shear: 1.0,
        bulk: 1.0,
    };
}

/// A memory as branches.
#[derive(Debug, Clone, PartialEq)]
pub struct Resolved {
    pub branches: Vec<Branch>,
    /// Factors of the moduli of the elasticity.
    pub left: Pair,
    /// Largest relative error of a fit, where there was one.
    pub error: Option<f64>,
}

/// A branch of these moduli.
pub fn branch(tau: f64, shear: f64, bulk: f64) -> Branch {
    Branch::Isotropic(IsotropicBranch { tau, shear, bulk })
}
