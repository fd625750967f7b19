//! Errors of the library as exceptions `stickslip.Error`, with their numbers as attributes.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;
use std::collections::BTreeMap;
use stickslip::{Error, ErrorCode};

/// What an error is about, as far as it says: a place, what was found there, what is allowed.
#[derive(Default)]
struct Details {
    path: Option<String>,
    found: Option<Found>,
    allowed: Option<Found>,
}

/// A value in an error.
#[derive(IntoPyObject)]
enum Found {
    Text(String),
    Number(f64),
    Count(u64),
}

impl Details {
    fn of(error: &Error) -> Details {
        let text = |text: &str| Some(Found::Text(text.to_owned()));
        let number = |number: f64| Some(Found::Number(number));
        let count = |count: usize| Some(Found::Count(count as u64));
        let details = |path: &str, found, allowed| Details {
            path: Some(path.to_owned()),
            found,
            allowed,
        };
        match error {
            Error::Scene {
                path,
                found,
                allowed,
                ..
            } => details(path, text(found), text(allowed)),
            Error::Value {
                what,
                found,
                allowed,
            } => details(what, number(*found), text(allowed)),
            Error::Step {
                what,
                expected,
                found,
            } => details(what, number(*found), number(*expected)),
            Error::Length {
                what,
                expected,
                found,
            } => details(what, count(*found), count(*expected)),
            Error::Unknown { what, found } => details(what, text(found), None),
            Error::CallOrder { call, expected } => details(call, None, text(expected)),
            Error::Fingerprint { expected, found } => Details {
                found: Some(Found::Count(*found)),
                allowed: Some(Found::Count(*expected)),
                path: None,
            },
            Error::ReductionInaccurate {
                achieved,
                tolerance,
                ..
            } => details("fidelity.tolerance", number(*achieved), number(*tolerance)),
            Error::LostDigits { lost, tolerance } => {
                details("fidelity.tolerance", number(*lost), number(*tolerance))
            }
            Error::NotConverged {
                residual,
                tolerance,
                ..
            } => details(
                "fidelity.friction_tolerance",
                number(*residual),
                number(*tolerance),
            ),
            Error::BodyNotConverged {
                residual,
                tolerance,
                ..
            } => details(
                "fidelity.friction_tolerance",
                number(*residual),
                number(*tolerance),
            ),
            Error::Unstable { step, limit } => details("time.step", number(*step), number(*limit)),
            Error::ToleranceOutOfReach {
                excess, tolerance, ..
            } => details(
                "time.tolerance",
                number(excess * tolerance),
                number(*tolerance),
            ),
            Error::NotHeld { closed, needed, .. } => Details {
                found: Some(Found::Count(*closed as u64)),
                allowed: Some(Found::Count(*needed as u64)),
                path: None,
            },
            Error::Body { .. }
            | Error::NotPositiveDefinite { .. }
            | Error::Bytes { .. }
            | Error::Cancelled { .. }
            | Error::Overflow { .. }
            | Error::Null { .. }
            | Error::Poisoned { .. } => Details::default(),
        }
    }
}

fn name(code: ErrorCode) -> String {
    code.name().to_string_lossy().into_owned()
}

/// The class, which is written in Python: an exception of a limited interface cannot be one of Rust.
fn class(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    CLASS.import(py, "stickslip._error", "Error")
}

/// The exception of an error.
pub fn raised(error: Error) -> PyErr {
    raised_with(error, None)
}

/// The same; `prefix` says in the message which of several things it is about.
pub fn raised_with(error: Error, prefix: Option<String>) -> PyErr {
    Python::attach(|py| {
        let details = Details::of(&error);
        let message = format!("{}{error}", prefix.unwrap_or_default());
        let arguments = (
            message,
            error.code() as i32,
            details.path,
            details.found,
            details.allowed,
        );
        match class(py).and_then(|class| class.call1(arguments)) {
            Ok(exception) => PyErr::from_value(exception),
            Err(failure) => failure,
        }
    })
}

/// Numbers of the error codes by name.
#[pyfunction]
pub fn error_codes() -> BTreeMap<String, i32> {
    let all = ErrorCode::ALL.iter();
    all.map(|code| (name(*code), *code as i32)).collect()
}
