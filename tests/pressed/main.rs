//! Contact with friction that follows the normal force: the solver alone, on matrices of real bodies.

#![allow(unsafe_code)] // a counting allocator

#[path = "../common/random.rs"]
#[allow(dead_code)]
mod random;

mod body;
mod cases;
mod check;
mod hard;
mod laws;
mod node;
