//! stickslip: an embeddable co-simulation component for frictional contact of a viscoelastic body.

pub mod error;
pub mod fem;
pub mod mesh;
pub mod scene;

pub use error::{Error, ErrorCode, Result};
pub use scene::Scene;
