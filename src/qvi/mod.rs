//! The paper's abstract scheme: the quadratures of the history and the certificate of unique solvability.

mod certificate;
mod scheme;

pub use certificate::{
    Certificate, certify, sharp_constant, sharp_constant_of_compliance, strain_weights,
};
pub use scheme::{MAX_STAGES, Stage, Tableau};
