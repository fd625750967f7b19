//! The few dense and sparse operations the rest is written in, on one thread and without hidden allocations.

mod cholesky;
mod dense;
mod elementary;
mod gram;
mod kernel;
pub mod lanes;
pub mod modal;
mod ordering;
mod single;
mod sparse;
mod stored;
mod tiles;

pub use cholesky::DenseCholesky;
pub use dense::{mirror_lower, pivoted_cholesky, symmetric_eigen, symmetric_eigenvalues};
pub use elementary::exp_m1;
pub use kernel::{column, dot, multiply, multiply_transposed};
pub use sparse::SparseCholesky;
pub use stored::StoredMatrix;
