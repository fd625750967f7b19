//! The few dense and sparse operations the rest is written in, on one thread and without hidden allocations.

mod dense;
mod kernel;
mod ordering;
mod sparse;

pub use dense::{DenseCholesky, mirror_lower, symmetric_eigen, symmetric_eigenvalues};
pub use kernel::{column, dot, multiply, multiply_transposed};
pub use sparse::SparseCholesky;
