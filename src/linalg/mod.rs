//! The few dense and sparse operations the rest is written in, on one thread and without hidden allocations.

mod dense;
mod sparse;

pub use dense::{DenseCholesky, mirror_lower, multiply, multiply_transposed, symmetric_eigen};
pub use sparse::SparseCholesky;
