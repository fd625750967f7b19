//! The few dense and sparse operations the rest is written in, on one thread and without hidden allocations.

mod cholesky;
mod dense;
mod double;
mod elementary;
mod factorization;
mod gram;
pub mod lanes;
mod lu;
pub mod modal;
mod ordering;
mod products;
mod reordered;
mod single;
mod sparse;
mod stored;
mod substitution;
mod tiles;
mod triangle;

pub use cholesky::DenseCholesky;
pub use dense::{mirror_lower, pivoted_cholesky, symmetric_eigen, symmetric_eigenvalues};
pub use double::{add_scaled, dot};
pub use elementary::{exp_m1, exp_m1_and_exp, length};
pub use lu::DenseLu;
pub use products::{column, multiply, multiply_lower, multiply_transposed};
pub use sparse::SparseCholesky;
pub use stored::StoredMatrix;
