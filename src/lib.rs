//! stickslip: an embeddable co-simulation component for frictional contact of a viscoelastic body.
//!
//! # The problem
//!
//! A Kelvin-Voigt body, clamped on a part of its boundary, pressed and dragged by tractions and body forces, is in
//! bilateral contact with a rigid foundation under friction whose bound depends on the slip rate (Kazmi, Barboteu, Han,
//! Sofonea, ESAIM: M2AN 48 (2014) 919-942; equation numbers in this crate are the paper's):
//!
//! ```text
//! sigma = A eps(u') + B eps(u),   Div sigma + f0 = 0                                             (5.13)-(5.14)
//! u_nu = 0,   |sigma_tau| <= g(|u'_tau|),
//! -sigma_tau = g(|u'_tau|) u'_tau / |u'_tau|   where u'_tau != 0                                 (5.6)
//! ```
//!
//! Discretised in space, with `w = u'`: `A w + B u + E Lambda = F f`, `Lambda_i in omega_i g d|w_i|` at every contact node.
//! Units are SI, per metre of depth in 2D. `slip_rate` and `slip` are those of the body relative to the foundation;
//! `tangential_stress` acts on the body and opposes the slip rate.
//!
//! # Four roles
//!
//! [`Scene`] (plain data) is compiled into a [`Model`] (immutable, shared); a [`Simulator`] holds a [`State`] (all that the
//! future depends on) and scratch, and is stepped by its master:
//!
//! ```
//! use stickslip::{Scene, Simulator, compile};
//!
//! let text = stickslip::scene::example("kazmi2014").unwrap();
//! let scene = Scene::from_json(text, "kazmi2014")?;
//! let mut simulator = Simulator::new(compile(&scene)?);
//! simulator.init(0.0)?;
//! for n in 0..32 {
//!     let time = f64::from(n) / 32.0;
//!     simulator.set_inputs(&[-0.3])?; // the load at the end of the step, Pa
//!     simulator.do_step(time, 1.0 / 32.0)?;
//! }
//! let tip = simulator.get_by_name("tip.displacement")?;
//! assert!((tip[0] - 0.1186).abs() < 1e-4); // the paper's example: u_x(1, 0) at t = 1
//! # Ok::<(), stickslip::Error>(())
//! ```
//!
//! Nothing here prints, exits, starts a thread, reads the environment or keeps global state, and a step of a reduced
//! model allocates nothing.

pub mod body;
mod bytes;
#[cfg(feature = "capi")]
pub mod capi;
mod compile;
pub mod contact;
pub mod element;
pub mod error;
pub mod expression;
pub mod fem;
pub mod files;
pub mod float_environment;
pub mod linalg;
pub mod material;
pub mod mesh;
pub mod message;
pub mod model;
pub mod ports;
mod progress;
pub mod qvi;
mod refusal;
pub mod scene;
pub mod simulator;
mod state;
pub mod time;
pub mod tradeoff;

pub use compile::{compile, compile_from, compile_with};
pub use contact::solve::newton::Work;
pub use error::{Error, ErrorCode, Result};
pub use files::{Files, Folder, MemoryFiles, NoFiles};
pub use model::{Compilation, Model};
pub use scene::Scene;
pub use simulator::{Past, Simulator};
pub use state::State;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeExamples;

#[cfg(doctest)]
#[doc = include_str!("../docs/qvi.md")]
struct InequalityPage;
