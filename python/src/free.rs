//! Long work: without the lock of the interpreter, and with the floating-point environment that the library computes in. Packages that
//! are compiled for speed alone may leave another one behind in the process.

use pyo3::prelude::*;
use stickslip::float_environment::DefaultEnvironment;

/// Does it, while other threads of Python run.
pub fn freely<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| {
        let _environment = DefaultEnvironment::enter();
        work()
    })
}
