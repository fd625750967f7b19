//! The class of inequalities of the paper as a library: orders, solvers, conditions, kernels.

#[path = "../common/mod.rs"]
mod common;
mod conditions;
mod contact;
mod kernels;
mod orders;
mod penetration;
mod sets;
mod solvers;
