//! Contact with friction that follows the normal force: the solver alone, on matrices of real bodies.

#![allow(unsafe_code)] // a counting allocator

#[path = "../common/random.rs"]
#[allow(dead_code)]
mod random;

mod body;
mod cases;
mod chatter;
mod check;
mod course;
mod extremes;
mod hard;
mod laws;
mod limits;
mod node;
mod space;
mod work;
