//! Numbers and names of the error codes.

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

/// Lists all codes with their names, which are those of the C constants without their prefix. A code that is missing here does
/// not compile.
macro_rules! names {
    ($( $code:ident $name:literal )*) => {
        impl ErrorCode {
            /// All codes.
            ///
            /// cbindgen:ignore
            pub const ALL: &[ErrorCode] = &[$( ErrorCode::$code, )*];

            /// Name of the C constant, without its prefix.
            pub fn name(self) -> &'static std::ffi::CStr {
                match self {
                    $( ErrorCode::$code => $name, )*
                }
            }
        }
    };
}

names! {
    Scene c"SCENE"
    Body c"BODY"
    ReductionInaccurate c"REDUCTION_INACCURATE"
    NotConverged c"NOT_CONVERGED"
    NotPositiveDefinite c"NOT_POSITIVE_DEFINITE"
    Step c"STEP"
    Length c"LENGTH"
    Value c"VALUE"
    Unknown c"UNKNOWN"
    CallOrder c"CALL_ORDER"
    Bytes c"BYTES"
    Fingerprint c"FINGERPRINT"
    Unstable c"UNSTABLE"
    Null c"NULL"
    Poisoned c"POISONED"
    ToleranceOutOfReach c"TOLERANCE_OUT_OF_REACH"
    Cancelled c"CANCELLED"
    Overflow c"OVERFLOW"
}
