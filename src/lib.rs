//! stickslip: an embeddable co-simulation component for frictional contact of a viscoelastic body.

mod bytes;
#[cfg(feature = "capi")]
pub mod capi;
pub mod error;
pub mod fem;
pub mod friction;
pub mod linalg;
pub mod mesh;
pub mod model;
pub mod ports;
pub mod qvi;
mod readout;
pub mod scene;
mod sensitivity;
mod simulator;
mod state;
mod step;
mod workspace;

pub use error::{Error, ErrorCode, Result};
pub use model::{Compilation, Model, compile};
pub use scene::Scene;
pub use simulator::{Past, Simulator};
pub use state::State;
