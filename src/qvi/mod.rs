//! History-dependent quasivariational inequalities in finite dimension: the class of the paper (Kazmi, Barboteu, Han, Sofonea,
//! ESAIM: M2AN 48 (2014) 919-942), of which the contact of a body is one instance ([`contact`]).
//!
//! Find `u(t) in K` such that for all `v in K`
//!
//! ```text
//! (A u, v - u) + phi(S u, v) - phi(S u, u) + j(u, v) - j(u, u) >= (f, v - u)                     (2.1)
//! S v(t) = R(t) ( int_0^t q(t, s) v(s) ds + a )                                                  (2.9)
//! ```
//!
//! A is strongly monotone and Lipschitz ([`Operator`]), phi and j are convex in v ([`Functional`]), K is closed and convex ([`Set`]),
//! S a history operator ([`HistoryOperator`]) with a kernel ([`Kernel`]) that a quadrature ([`Quadrature`]) sums. An [`Inequality`] holds
//! the data, an [`Evolution`] solves it point by point, a [`Record`] says which conditions of the theory held.
//!
//! ```
//! use nalgebra::DVector;
//! use stickslip::qvi::*;
//!
//! // m u + kappa (1/2 + int u) = f with m = 2, kappa = 3 and the solution u = cos 2t + t
//! let exact = |t: f64| (2.0 * t).cos() + t;
//! let load = move |t: f64| {
//!     let integral = 0.5 + (2.0 * t).sin() / 2.0 + t * t / 2.0;
//!     DVector::from_element(1, 2.0 * exact(t) + 3.0 * integral)
//! };
//! let mut problem = Inequality::new(Space::euclidean(1), Matrix::multiple(1, 2.0), load);
//! problem.histories = vec![HistoryOperator::new(Kernel::constant(1.0), DVector::from_element(1, 0.5))];
//! problem.phi = Box::new(LinearPhi(vec![Some(Matrix::multiple(1, 3.0))]));
//!
//! let settings = Settings::new(Solver::Direct);
//! let run = solve(&problem, &Quadrature::Trapezoid, (1.0, 40), settings)?;
//! let errors = run.times.iter().zip(&run.u).map(|(t, u)| (u[0] - exact(*t)).abs());
//! assert!(errors.fold(0.0, f64::max) < 1e-4);
//! # Ok::<(), SolveError>(())
//! ```
//!
//! [`examples`] has inequalities with exact solutions; docs/qvi.md goes from strong forms to code.
//!
//! A library beside the component: dense matrices of the order of the unknowns where eigenvalues or condensation ask for
//! them, allocation while it steps. It does not print and keeps nothing between calls.

mod conditions;
mod constants;
pub mod contact;
mod elliptic;
mod error;
mod evolution;
pub mod examples;
mod functional;
mod history_operator;
mod inequality;
mod kernel;
mod matrix;
mod operator;
mod prox;
mod quadrature;
mod sampling;
mod set;
mod settings;
mod space;
mod trajectory;

pub use conditions::{Conditions, Record, Verdict, Warning};
pub use constants::{Constant, Constants, Origin};
pub use error::SolveError;
pub use evolution::Evolution;
pub use functional::{
    Coefficients, Functional, Linear, LinearPhi, Norm, Nothing, Part, PositivePart, Shape, Sum,
};
pub use history_operator::{HistoryOperator, Integrand, MapOfVectors};
pub use inequality::Inequality;
pub use kernel::{ExponentialTerm, Kernel, Own, SeparableTerm, fractional_kernel};
pub use matrix::{Matrix, SparseSymmetric};
pub use operator::{NonlinearOperator, Operator};
pub use quadrature::{Quadrature, Weights};
pub use sampling::Sampler;
pub use set::{Bounds, Cone, HalfSpace, Projection, Restricted, Set, Whole};
pub use settings::{Iterations, Settings, Solver};
pub use space::Space;
pub use trajectory::{Trajectory, solve};
