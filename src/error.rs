//! The one error type: every failure carries the numbers that explain it.
//!
//! One list below makes the variants, their codes and their texts. [`ErrorCode`] gives the codes their numbers, from which the
//! C constants and the FMU log categories are made; numbers are negative, are never reused, and keep their meaning between
//! versions.

mod code;

pub use code::ErrorCode;

use crate::message::{Escaping, cut, number};
use std::fmt::{self, Write};

/// Declares the errors: `Variant { fields } => Code, "text", arguments of the text`.
macro_rules! errors {
    ($(
        $(#[$meta:meta])*
        $variant:ident { $($field:ident: $type:ty),* } => $code:ident, $($text:expr),+;
    )*) => {
        /// Why a call failed. The state of the caller is as it was before the call.
        #[derive(Debug, Clone, PartialEq)]
        pub enum Error {
            $( $(#[$meta])* $variant { $($field: $type),* }, )*
        }

        impl Error {
            /// The stable numeric code.
            pub fn code(&self) -> ErrorCode {
                match self {
                    $( Error::$variant { .. } => ErrorCode::$code, )*
                }
            }

            fn write(&self, f: &mut impl Write) -> fmt::Result {
                match self {
                    $( Error::$variant { $($field),* } => write!(f, $($text),+), )*
                }
            }
        }
    };
}

errors! {
    /// The scene text is not acceptable: `path` is the JSON path, `found` what stands there, `allowed` what may stand there.
    Scene { source_name: String, path: String, found: String, allowed: String } => Scene,
        "{source_name}: at {path}: found {found}; allowed: {allowed}";
    /// The assembled body cannot be used: the reason and the numbers behind it.
    Body { what: String } => Body,
        "the scene gives no usable body: {what}";
    /// The reduction stopped at a relative error above the tolerance asked for.
    ReductionInaccurate { achieved: f64, tolerance: f64, states: usize } => ReductionInaccurate,
        "reduction with {states} states reaches a relative error of {achieved:.1e}, not the {tolerance:.1e} of \
                 fidelity.tolerance; loosen it or use fidelity.model = \"condensed\"";
    /// The friction solver stopped with a residual above its tolerance.
    NotConverged { time: f64, residual: f64, tolerance: f64, iterations: usize, node: usize } => NotConverged,
        "friction did not converge at time {}: residual {residual:.3e} at contact node {node} after \
                 {iterations} iterations, tolerance {tolerance:.1e}",
                number(*time);
    /// Contact alone holds the body along its normals, and is closed at fewer nodes than it takes.
    NotHeld { time: f64, closed: usize, needed: usize, normal: [f64; 3], node: usize } => NotConverged,
        "nothing holds the body at time {}: contact is closed at {closed} nodes of at least {needed}, and the body can move as a \
                 whole along {normal:?} at contact node {node}",
                number(*time);
    /// The laws of the body, which are not linear, did not converge in a stage.
    BodyNotConverged { time: f64, residual: f64, tolerance: f64, iterations: usize } => NotConverged,
        "the nonlinear laws of the body did not converge at time {}: residual {residual:.3e} after {iterations} iterations, \
                 tolerance {tolerance:.1e}",
                number(*time);
    /// A matrix that must be positive definite is not (pivot index in the elimination order).
    NotPositiveDefinite { what: &'static str, pivot: usize } => NotPositiveDefinite,
        "{what} is not positive definite (pivot {pivot})";
    /// The communication step or the time of the call is unusable.
    Step { what: &'static str, expected: f64, found: f64 } => Step,
        "{what}: expected {}, found {}", number(*expected), number(*found);
    /// An array has the wrong length.
    Length { what: &'static str, expected: usize, found: usize } => Length,
        "{what}: expected {expected} values, found {found}";
    /// A number is not finite or is outside its range.
    Value { what: String, found: f64, allowed: &'static str } => Value,
        "{what}: found {}, allowed: {allowed}", number(*found);
    /// A name or a reference is unknown.
    Unknown { what: &'static str, found: String } => Unknown,
        "unknown {what}: {}", cut(found);
    /// The call is not allowed in this phase of the simulation.
    CallOrder { call: &'static str, expected: &'static str } => CallOrder,
        "{call} is not allowed now: {expected}";
    /// Bytes that are not a saved state or model of this version, or are damaged.
    Bytes { what: String } => Bytes,
        "unusable bytes: {what}";
    /// A saved state belongs to another model.
    Fingerprint { expected: u64, found: u64 } => Fingerprint,
        "the state belongs to another model: expected fingerprint {expected:016x}, found {found:016x}";
    /// An explicit scheme is beyond its stability limit.
    Unstable { step: f64, limit: f64 } => Unstable,
        "time.step = {} is beyond the stability limit {limit:.6} s of the explicit scheme \"rectangle\": take a \
                 smaller step or another scheme; time.force = true takes it all the same",
                number(*step);
    /// 64-bit numbers lose more of the response of the body than the tolerance allows: `lost` is its relative error, by estimate.
    LostDigits { lost: f64, tolerance: f64 } => ReductionInaccurate,
        "64-bit numbers give the response of this body to a relative error of {lost:.1e} only, not the {tolerance:.1e} of \
                 fidelity.tolerance: its cells are too flat (mesh.size, mesh.cells) or its material keeps its volume too nearly \
                 (poisson near 1/2, mu1 far above mu2); change that, or loosen fidelity.tolerance";
    /// The compilation was stopped by its observer.
    Cancelled { phase: &'static str } => Cancelled,
        "the compilation was stopped while it was at: {phase}";
    /// The smallest internal step still has `excess` times the error that `time.tolerance` allows.
    ToleranceOutOfReach { time: f64, step: f64, excess: f64, tolerance: f64 } => ToleranceOutOfReach,
        "time.tolerance = {tolerance:e} is out of reach at time {}: an internal step of {step:.3e} s still has \
                 {excess:.1} times the allowed error; loosen it",
                number(*time);
    /// A result is too large for a number: the quantity that is not finite.
    Overflow { what: String, time: f64 } => Overflow,
        "numbers overflow at time {}: {what} is not finite; loads, step or coefficients are out of proportion", number(*time);
    /// A pointer is NULL that must not be.
    Null { what: &'static str } => Null,
        "{what}: expected a pointer, found NULL";
    /// The library panicked in this call or in an earlier one with the same simulator, which can only be freed now.
    Poisoned { what: String } => Poisoned,
        "the simulator is unusable, free it: {what}";
}

impl fmt::Display for Error {
    /// One line; texts of users are cut and escaped, see [`crate::message`].
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write(&mut Escaping(f))
    }
}

impl std::error::Error for Error {}

/// Result of every fallible call of the crate.
pub type Result<T> = std::result::Result<T, Error>;
