//! The types of `scene.json`. All quantities are in SI units (2D scenes are per metre of depth).
//!
//! The JSON Schema is generated from these types, so every doc comment here is what a user reads there.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A viscoelastic body in bilateral frictional contact with a rigid foundation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// Name of the scene.
    pub name: String,
    /// Mesh of the body.
    pub mesh: MeshSpec,
    /// Finite element.
    #[serde(default)]
    pub element: ElementKind,
    /// Material of the body.
    pub material: Material,
    /// Names of the parts on which the body is clamped (velocity and displacement zero).
    #[serde(default)]
    pub clamped: Vec<String>,
    /// Contact with the foundation.
    pub contact: Contact,
    /// Loads; each is an input of the component.
    #[serde(default)]
    pub loads: Vec<Load>,
    /// Points whose displacement and velocity are outputs.
    #[serde(default)]
    pub probes: Vec<Probe>,
    /// Time integration.
    pub time: Time,
    /// Speed against accuracy.
    #[serde(default)]
    pub fidelity: Fidelity,
    /// Recorded past of the contact.
    #[serde(default)]
    pub history: History,
    /// What `stickslip run` does with the scene.
    #[serde(default)]
    pub run: Run,
}

/// Mesh of the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum MeshSpec {
    /// `(0, size[0]) x (0, size[1])`, cut into cells, each cell into four triangles by both diagonals. Parts: left,
    /// right (x), bottom, top (y).
    Rectangle {
        /// Lengths along x and y, m.
        size: [f64; 2],
        /// Number of cells along x and y.
        cells: [u32; 2],
        /// Axes along which the body is periodic (the two opposite sides move together).
        #[serde(default)]
        periodic: Vec<Axis>,
    },
    /// `(0, size[0]) x (0, size[1]) x (0, size[2])`: the criss-cross of `rectangle` in the x-y plane, extruded along
    /// z; every prism is cut into three tetrahedra that conform with their neighbours. Parts: left, right (x), bottom,
    /// top (y), back, front (z).
    Box {
        /// Lengths along x, y and z, m.
        size: [f64; 3],
        /// Number of cells along x, y and z.
        cells: [u32; 3],
        /// Axes along which the body is periodic (the two opposite sides move together).
        #[serde(default)]
        periodic: Vec<Axis>,
    },
}

impl MeshSpec {
    /// Space dimension, 2 or 3.
    pub fn dimension(&self) -> usize {
        match self {
            MeshSpec::Rectangle { .. } => 2,
            MeshSpec::Box { .. } => 3,
        }
    }
}

/// A coordinate axis.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    X,
    Y,
    Z,
}

/// Finite element.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ElementKind {
    /// Linear simplex.
    #[default]
    P1,
}

/// Kelvin-Voigt material: `sigma = A eps(u') + B eps(u)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Viscosity operator A.
    pub viscosity: Viscosity,
    /// Elasticity operator B.
    pub elasticity: Elasticity,
}

/// Viscosity operator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case", deny_unknown_fields)]
pub enum Viscosity {
    /// `A tau = mu1 tr(tau) I + mu2 tau`.
    Isotropic {
        /// Coefficient of the trace, Pa s.
        mu1: f64,
        /// Coefficient of the strain rate, Pa s; positive.
        mu2: f64,
    },
}

/// Elasticity operator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case", deny_unknown_fields)]
pub enum Elasticity {
    /// `B tau = lambda tr(tau) I + E/(1 + kappa) tau`, with lambda by the convention.
    Isotropic {
        /// Young's modulus E, Pa; positive.
        young: f64,
        /// Poisson's ratio kappa, in (-1, 0.5).
        poisson: f64,
        /// Coefficient of the trace.
        convention: Convention,
    },
}

/// How lambda follows from Young's modulus E and Poisson's ratio kappa.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Convention {
    /// `E kappa / ((1 - kappa)(1 - 2 kappa))`, as printed in Kazmi et al. 2014.
    Kazmi2014,
    /// `E kappa / ((1 + kappa)(1 - 2 kappa))`; 2D only.
    PlaneStrain,
    /// `E kappa / (1 - kappa^2)`; 2D only.
    PlaneStress,
    /// `E kappa / ((1 + kappa)(1 - 2 kappa))`; 3D only.
    ThreeDimensional,
}

/// Bilateral contact with a rigid foundation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Name of the part in contact.
    pub part: String,
    /// Friction law.
    pub friction: Friction,
    /// First tangential direction (projected on the contact plane). Default: the direction in which x grows, or y
    /// where the contact is normal to x.
    #[serde(default)]
    pub tangent: Option<Vec<f64>>,
}

/// Friction bound g as a function of the slip rate r >= 0 (m/s).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case", deny_unknown_fields)]
pub enum Friction {
    /// No tangential stress.
    Frictionless {},
    /// Constant bound `g = bound`.
    Tresca {
        /// Bound, Pa; not negative.
        bound: f64,
    },
    /// `g(r) = (a - b) exp(-alpha r) + b`.
    Exponential {
        /// Static bound, Pa; `a >= b`.
        a: f64,
        /// Kinetic bound, Pa; not negative.
        b: f64,
        /// Decay, s/m; not negative.
        alpha: f64,
    },
}

/// A load; its intensity is an input, its work-conjugate displacement and velocity are outputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Name of the input.
    pub name: String,
    /// Where it acts.
    pub kind: LoadKind,
    /// Name of the part a traction acts on; absent for a body force.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// Direction; its length does not matter.
    pub direction: Vec<f64>,
    /// Intensity at the start: Pa for a traction, N/m^3 for a body force.
    #[serde(default)]
    pub start: f64,
    /// Course of the input within a communication step.
    #[serde(default)]
    pub interpolation: Interpolation,
}

/// Where a load acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LoadKind {
    /// Force per area on a part of the boundary.
    Traction,
    /// Force per volume on the whole body.
    BodyForce,
}

/// Course of an input within a communication step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Linear between the values at the two ends of the step.
    #[default]
    Linear,
    /// The new value from the beginning of the step (a jump when it differs from the last one).
    Hold,
}

/// A point of the body whose displacement and velocity are outputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// Name of the probe.
    pub name: String,
    /// Coordinates, m; inside the body.
    pub at: Vec<f64>,
}

/// Time integration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Scheme.
    #[serde(default)]
    pub scheme: Scheme,
    /// Velocity at the start.
    #[serde(default)]
    pub start: Start,
    /// Largest internal step, s; a communication step is cut into equal internal steps no larger than this.
    pub step: f64,
}

/// Time scheme.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// Trapezoidal quadrature of the history (3.2)-(3.4): second order; rings at very large steps.
    #[default]
    Trapezoid,
    /// Rectangle quadrature of the history (3.26): first order, explicit in the displacement, conditionally stable.
    Rectangle,
    /// Backward Euler: first order, L-stable.
    BackwardEuler,
    /// TR-BDF2: second order, L-stable, two friction problems per step.
    TrBdf2,
}

/// Velocity at the start.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// Solves the inequality at the first instant; needed for second order.
    #[default]
    Consistent,
    /// Zero velocity, the data of the paper; first order when the load does not start from zero.
    Zero,
}

/// Speed against accuracy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Fidelity {
    /// What is kept of the body.
    pub model: ModelKind,
    /// Relative error of the reduced body seen through its ports.
    pub tolerance: f64,
    /// Relative residual of the friction law at every contact node.
    pub friction_tolerance: f64,
    /// Friction solver.
    pub solver: FrictionSolver,
    /// Looks, at every step, for a second solution from all-static and all-kinetic bounds; costs two more solves.
    pub multiplicity_test: bool,
}

impl Default for Fidelity {
    fn default() -> Self {
        Fidelity {
            model: ModelKind::Auto,
            tolerance: 1e-8,
            friction_tolerance: 1e-10,
            solver: FrictionSolver::default(),
            multiplicity_test: false,
        }
    }
}

/// What is kept of the body.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ModelKind {
    /// The whole mesh: two sparse solves per step. The yardstick.
    Full,
    /// The whole mesh, eliminated onto the contact: one sparse solve per step.
    Condensed,
    /// The relaxation rates that the ports see, to `tolerance`.
    Reduced,
    /// The cheapest that the scene allows.
    #[default]
    Auto,
}

/// Friction solver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum FrictionSolver {
    /// Semismooth Newton, globalised by the decrease of the step energy.
    Newton {
        /// Largest number of iterations in one solve.
        #[serde(default = "default_newton_iterations")]
        max_iterations: u32,
    },
    /// Problem 7.4 of the paper: the bound is frozen at the last iterate.
    FixedPoint {
        /// Relative change at which the iteration stops.
        #[serde(default = "default_fixed_point_tolerance")]
        tolerance: f64,
        /// What the change is measured on.
        #[serde(default)]
        stop: FixedPointStop,
        /// Largest number of iterations in one solve.
        #[serde(default = "default_fixed_point_iterations")]
        max_iterations: u32,
    },
}

fn default_newton_iterations() -> u32 {
    200
}

fn default_fixed_point_tolerance() -> f64 {
    1e-6
}

fn default_fixed_point_iterations() -> u32 {
    1000
}

impl Default for FrictionSolver {
    fn default() -> Self {
        FrictionSolver::Newton {
            max_iterations: default_newton_iterations(),
        }
    }
}

/// What the stop test of the fixed point looks at.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FixedPointStop {
    /// Change of the displacement in the strain norm.
    Displacement,
    /// Change of the displacement in the strain norm and of the contact stress.
    #[default]
    DisplacementAndStress,
}

/// Recorded past of the contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct History {
    /// Number of internal steps kept (slip rate, slip and tangential stress of every contact node); part of the state.
    pub capacity: u32,
}

impl Default for History {
    fn default() -> Self {
        History { capacity: 16 }
    }
}

/// What `stickslip run` does with the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Run {
    /// End of the run, s.
    pub until: f64,
    /// Communication step, s; default: `time.step`.
    pub step: Option<f64>,
    /// Course of every load; default: its start value.
    pub signals: BTreeMap<String, Signal>,
}

impl Default for Run {
    fn default() -> Self {
        Run {
            until: 1.0,
            step: None,
            signals: BTreeMap::new(),
        }
    }
}

/// Course of a load in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Signal {
    /// The same value at all times.
    Constant(f64),
    /// Pairs of time and value, linear between them, constant outside; times increase strictly.
    Table(Vec<[f64; 2]>),
}

impl Signal {
    /// Value at time `t`.
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Signal::Constant(value) => *value,
            Signal::Table(points) => {
                let after = points.partition_point(|p| p[0] <= t);
                match (
                    after.checked_sub(1).and_then(|i| points.get(i)),
                    points.get(after),
                ) {
                    (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (t - a[0]) / (b[0] - a[0]),
                    (Some(a), None) => a[1],
                    (None, Some(b)) => b[1],
                    (None, None) => 0.0,
                }
            }
        }
    }
}
