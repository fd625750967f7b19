//! The one error type: every failure carries the numbers that explain it.
//!
//! [`ErrorCode`] is the single list from which the C constants and the FMU log categories are made. Codes are
//! negative, are never reused, and keep their meaning between versions.

use crate::message::{Escaping, cut, number};
use std::fmt::{self, Write};

/// Why a call failed. The state of the caller is as it was before the call.
#[derive(Debug, Clone, PartialEq)]
pub enum Error {
    /// The scene text is not acceptable: `path` is the JSON path, `found` what stands there, `allowed` what may stand there.
    Scene {
        source_name: String,
        path: String,
        found: String,
        allowed: String,
    },
    /// The assembled body cannot be used: the reason and the numbers behind it.
    Body { what: String },
    /// The reduction stopped at a relative error above the tolerance asked for.
    ReductionInaccurate {
        achieved: f64,
        tolerance: f64,
        states: usize,
    },
    /// The friction solver stopped with a residual above its tolerance.
    NotConverged {
        time: f64,
        residual: f64,
        tolerance: f64,
        iterations: usize,
        node: usize,
    },
    /// A matrix that must be positive definite is not (pivot index in the elimination order).
    NotPositiveDefinite { what: &'static str, pivot: usize },
    /// The communication step or the time of the call is unusable.
    Step {
        what: &'static str,
        expected: f64,
        found: f64,
    },
    /// An array has the wrong length.
    Length {
        what: &'static str,
        expected: usize,
        found: usize,
    },
    /// A number is not finite or is outside its range.
    Value {
        what: String,
        found: f64,
        allowed: &'static str,
    },
    /// A name or a reference is unknown.
    Unknown { what: &'static str, found: String },
    /// The call is not allowed in this phase of the simulation.
    CallOrder {
        call: &'static str,
        expected: &'static str,
    },
    /// Bytes that are not a saved state or model of this version, or are damaged.
    Bytes { what: String },
    /// A saved state belongs to another model.
    Fingerprint { expected: u64, found: u64 },
    /// An explicit scheme is beyond its stability limit.
    Unstable { step: f64, limit: f64 },
    /// 64-bit numbers lose more of the response of the body than the tolerance allows: `lost` is its relative error, by estimate.
    LostDigits { lost: f64, tolerance: f64 },
    /// The compilation was stopped by its observer.
    Cancelled { phase: &'static str },
    /// The smallest internal step still has `excess` times the error that `time.tolerance` allows.
    ToleranceOutOfReach {
        time: f64,
        step: f64,
        excess: f64,
        tolerance: f64,
    },
    /// A result is too large for a number: the quantity that is not finite.
    Overflow { what: String, time: f64 },
    /// A pointer is NULL that must not be.
    Null { what: &'static str },
    /// The library panicked in this call or in an earlier one with the same simulator, which can only be freed now.
    Poisoned { what: String },
}

/// Why a call failed. A code is never reused and keeps its meaning between versions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum ErrorCode {
    /// The scene text is refused; the message names the JSON path.
    Scene = -1,
    /// The scene gives no usable body.
    Body = -2,
    /// The model does not reach `fidelity.tolerance`: the reduction does not, or 64-bit numbers lose more of the body.
    ReductionInaccurate = -3,
    /// The friction solver did not reach its tolerance.
    NotConverged = -4,
    /// A matrix that must be positive definite is not.
    NotPositiveDefinite = -5,
    /// The step is not positive, or the time does not continue the simulation.
    Step = -6,
    /// An array has the wrong length.
    Length = -7,
    /// A number is not finite or out of its range.
    Value = -8,
    /// A name, reference or index is unknown.
    Unknown = -9,
    /// The call is not allowed now.
    CallOrder = -10,
    /// Bytes that are no saved state or model of this version, or are damaged.
    Bytes = -11,
    /// The state belongs to another model.
    Fingerprint = -12,
    /// An explicit scheme is beyond its stability limit.
    Unstable = -13,
    /// A pointer is NULL that must not be.
    Null = -14,
    /// The library panicked; the simulator of the call can only be freed.
    Poisoned = -15,
    /// No step is small enough for `time.tolerance`.
    ToleranceOutOfReach = -16,
    /// The caller stopped the compilation.
    Cancelled = -17,
    /// A result is too large for a number.
    Overflow = -18,
}

impl ErrorCode {
    /// All codes.
    ///
    /// cbindgen:ignore
    pub const ALL: [ErrorCode; 18] = [
        ErrorCode::Scene,
        ErrorCode::Body,
        ErrorCode::ReductionInaccurate,
        ErrorCode::NotConverged,
        ErrorCode::NotPositiveDefinite,
        ErrorCode::Step,
        ErrorCode::Length,
        ErrorCode::Value,
        ErrorCode::Unknown,
        ErrorCode::CallOrder,
        ErrorCode::Bytes,
        ErrorCode::Fingerprint,
        ErrorCode::Unstable,
        ErrorCode::Null,
        ErrorCode::Poisoned,
        ErrorCode::ToleranceOutOfReach,
        ErrorCode::Cancelled,
        ErrorCode::Overflow,
    ];

    /// Name of the C constant, without its prefix.
    pub fn name(self) -> &'static std::ffi::CStr {
        match self {
            ErrorCode::Scene => c"SCENE",
            ErrorCode::Body => c"BODY",
            ErrorCode::ReductionInaccurate => c"REDUCTION_INACCURATE",
            ErrorCode::NotConverged => c"NOT_CONVERGED",
            ErrorCode::NotPositiveDefinite => c"NOT_POSITIVE_DEFINITE",
            ErrorCode::Step => c"STEP",
            ErrorCode::Length => c"LENGTH",
            ErrorCode::Value => c"VALUE",
            ErrorCode::Unknown => c"UNKNOWN",
            ErrorCode::CallOrder => c"CALL_ORDER",
            ErrorCode::Bytes => c"BYTES",
            ErrorCode::Fingerprint => c"FINGERPRINT",
            ErrorCode::Unstable => c"UNSTABLE",
            ErrorCode::Null => c"NULL",
            ErrorCode::Poisoned => c"POISONED",
            ErrorCode::ToleranceOutOfReach => c"TOLERANCE_OUT_OF_REACH",
            ErrorCode::Cancelled => c"CANCELLED",
            ErrorCode::Overflow => c"OVERFLOW",
        }
    }
}

impl Error {
    /// The stable numeric code.
    pub fn code(&self) -> ErrorCode {
        match self {
            Error::Scene { .. } => ErrorCode::Scene,
            Error::Body { .. } => ErrorCode::Body,
            Error::ReductionInaccurate { .. } => ErrorCode::ReductionInaccurate,
            Error::NotConverged { .. } => ErrorCode::NotConverged,
            Error::NotPositiveDefinite { .. } => ErrorCode::NotPositiveDefinite,
            Error::Step { .. } => ErrorCode::Step,
            Error::Length { .. } => ErrorCode::Length,
            Error::Value { .. } => ErrorCode::Value,
            Error::Unknown { .. } => ErrorCode::Unknown,
            Error::CallOrder { .. } => ErrorCode::CallOrder,
            Error::Bytes { .. } => ErrorCode::Bytes,
            Error::Fingerprint { .. } => ErrorCode::Fingerprint,
            Error::Unstable { .. } => ErrorCode::Unstable,
            Error::LostDigits { .. } => ErrorCode::ReductionInaccurate,
            Error::Cancelled { .. } => ErrorCode::Cancelled,
            Error::Null { .. } => ErrorCode::Null,
            Error::Poisoned { .. } => ErrorCode::Poisoned,
            Error::ToleranceOutOfReach { .. } => ErrorCode::ToleranceOutOfReach,
            Error::Overflow { .. } => ErrorCode::Overflow,
        }
    }
}

impl fmt::Display for Error {
    /// One line; texts of users are cut and escaped, see [`crate::message`].
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write(&mut Escaping(f))
    }
}

impl Error {
    fn write(&self, f: &mut impl Write) -> fmt::Result {
        match self {
            Error::Scene {
                source_name,
                path,
                found,
                allowed,
            } => write!(
                f,
                "{source_name}: at {path}: found {found}; allowed: {allowed}"
            ),
            Error::Body { what } => write!(f, "the scene gives no usable body: {what}"),
            Error::ReductionInaccurate {
                achieved,
                tolerance,
                states,
            } => write!(
                f,
                "reduction with {states} states reaches a relative error of {achieved:.1e}, not the {tolerance:.1e} of \
                 fidelity.tolerance; loosen it or use fidelity.model = \"condensed\""
            ),
            Error::NotConverged {
                time,
                residual,
                tolerance,
                iterations,
                node,
            } => write!(
                f,
                "friction did not converge at time {}: residual {residual:.3e} at contact node {node} after \
                 {iterations} iterations, tolerance {tolerance:.1e}",
                number(*time)
            ),
            Error::NotPositiveDefinite { what, pivot } => {
                write!(f, "{what} is not positive definite (pivot {pivot})")
            }
            Error::Step {
                what,
                expected,
                found,
            } => {
                let (expected, found) = (number(*expected), number(*found));
                write!(f, "{what}: expected {expected}, found {found}")
            }
            Error::Length {
                what,
                expected,
                found,
            } => write!(f, "{what}: expected {expected} values, found {found}"),
            Error::Value {
                what,
                found,
                allowed,
            } => write!(f, "{what}: found {}, allowed: {allowed}", number(*found)),
            Error::Overflow { what, time } => write!(
                f,
                "numbers overflow at time {}: {what} is not finite; loads, step or coefficients are out of proportion",
                number(*time)
            ),
            Error::Unknown { what, found } => write!(f, "unknown {what}: {}", cut(found)),
            Error::CallOrder { call, expected } => {
                write!(f, "{call} is not allowed now: {expected}")
            }
            Error::Bytes { what } => write!(f, "unusable bytes: {what}"),
            Error::Fingerprint { expected, found } => write!(
                f,
                "the state belongs to another model: expected fingerprint {expected:016x}, found {found:016x}"
            ),
            Error::Unstable { step, limit } => write!(
                f,
                "time.step = {} is beyond the stability limit {limit:.6} s of the explicit scheme \"rectangle\": take a \
                 smaller step or another scheme; time.force = true takes it all the same",
                number(*step)
            ),
            Error::LostDigits { lost, tolerance } => write!(
                f,
                "64-bit numbers give the response of this body to a relative error of {lost:.1e} only, not the {tolerance:.1e} of \
                 fidelity.tolerance: its cells are too flat (mesh.size, mesh.cells) or its material keeps its volume too nearly \
                 (poisson near 1/2, mu1 far above mu2); change that, or loosen fidelity.tolerance"
            ),
            Error::Cancelled { phase } => {
                write!(f, "the compilation was stopped while it was at: {phase}")
            }
            Error::ToleranceOutOfReach {
                time,
                step,
                excess,
                tolerance,
            } => write!(
                f,
                "time.tolerance = {tolerance:e} is out of reach at time {}: an internal step of {step:.3e} s still has \
                 {excess:.1} times the allowed error; loosen it",
                number(*time)
            ),
            Error::Null { what } => write!(f, "{what}: expected a pointer, found NULL"),
            Error::Poisoned { what } => write!(f, "the simulator is unusable, free it: {what}"),
        }
    }
}

impl std::error::Error for Error {}

/// Result of every fallible call of the crate.
pub type Result<T> = std::result::Result<T, Error>;
