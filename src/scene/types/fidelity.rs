//! Time integration, and speed against accuracy.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Time integration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Scheme. Default: `auto`.
    #[serde(default)]
    pub scheme: Scheme,
    /// Velocity at the start. Default: `consistent`.
    #[serde(default)]
    pub start: Start,
    /// Largest internal step, s; a communication step is cut into equal internal steps no larger than this.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub step: f64,
    /// Error in time aimed at: of the slip rate of the contact, relative to its largest norm so far. Internal steps are then as
    /// small as it asks for, and `step` or smaller; the error is of this size, not below it for certain. Default: none, all
    /// internal steps of a communication step are equal. Not with the explicit scheme `rectangle`.
    #[schemars(range(min = 1e-9, max = 1e-1))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Whether the accumulated error in time is estimated (output `solver.error_estimate`), by a second solution: with half
    /// the step, which makes a step three times as costly; with `tolerance` twice the step, half as costly again. It does
    /// not change the results. Default: true with `tolerance`, false without. Not with the explicit scheme `rectangle`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_estimate: Option<bool>,
    /// What the value of an input means in time, for loads whose `interpolation` is `linear`. Default: `end_of_step` in C, Rust
    /// and the command; `continue` in an FMU, whose importers set inputs at the beginning of a step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inputs: Option<Inputs>,
    /// Takes a scheme that is otherwise refused: the explicit `rectangle` beyond its stability limit (errors then grow from step to
    /// step without bound), the trapezoid where contact opens, closes or gives way (the pressure then rings). Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub force: bool,
}

impl Time {
    /// Whether the error in time is estimated.
    pub fn estimates_error(&self) -> bool {
        self.error_estimate.unwrap_or(self.tolerance.is_some())
    }
}

/// What the value of an input that is set before a communication step means.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Inputs {
    /// The load at the end of the step; within it the load goes linearly from its last value. Exact where the load is linear
    /// over the step; for hosts that know it there, or iterate with rollback.
    #[default]
    EndOfStep,
    /// The load at the beginning of the step, held over it: first order in the communication step, exact for loads that jump
    /// at communication points. Every change is a jump and takes one more solution of the friction problem.
    Hold,
    /// The load at the beginning of the step, continued with the slope of the last steps (at most twice the slope before it, and
    /// none where the two differ in sign, so that a jump is held): second order where the load is smooth. The same cost
    /// as `hold`.
    Continue,
}

/// Time scheme.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// `trapezoid` where contact is bilateral on a foundation that keeps its distance, `tr_bdf2` where it opens, closes or
    /// gives way.
    #[default]
    Auto,
    /// Trapezoidal quadrature of the history (3.2)-(3.4): second order; rings at very large steps. Refused where contact opens,
    /// closes or gives way, and where the foundation approaches: the pressure would ring from then on, undamped, whatever the step.
    Trapezoid,
    /// Implicit midpoint rule: second order, the most accurate pressure of rigid contact while steps are below the fastest
    /// relaxation time; alternates at larger ones. Unknowns are means over a step; values at its end take another solution.
    Midpoint,
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
    /// What is kept of the body. Default: `auto`.
    pub model: ModelKind,
    /// Relative error of the body seen through its ports. Default: 1e-8; in a reduced model a smaller one keeps more states. A body
    /// of which 64-bit numbers lose more is refused, whatever the model: one of very flat cells, or nearly incompressible.
    #[schemars(range(min = 1e-12, max = 1e-1))]
    pub tolerance: f64,
    /// Whether the numbers of the material stay free in the compiled model: moduli, viscosities and the branches of its memory are
    /// then parameters, named by their paths in the scene, that may be set until the initialization ends, without compiling again.
    /// For one isotropic material over the whole body (laws that do not vary, with a dashpot), and `model` `reduced` or `auto`; the
    /// ratio lambda / 2 mu of every stage within -0.25 to 1e4, for all of which `tolerance` holds; it keeps about half as many states
    /// again. Not with an initial displacement, motions that strain the body, or `target_error`. Default: false.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub free_material: bool,
    /// Precision in which a reduced model keeps its port matrix; only with `model` `reduced`. Default: `double`.
    pub precision: Precision,
    /// Force by which the friction law may be violated at a contact node, relative to the bound there: a tolerance of the
    /// stress. Default: 1e-10; costs few iterations.
    #[schemars(range(min = 1e-14, max = 1e-2))]
    pub friction_tolerance: f64,
    /// Relative error that the compilation is to meet, e.g. 0.01; default: none, and all settings are as given. The error
    /// is that of slip rate, displacement of loads and probes, and friction force, at every communication point of `run`
    /// on its own signals, against a reference ten times as accurate; the tangential stress is not bounded. Given, the
    /// compilation measures settings and picks the cheapest that meets it, by counted work; it takes seconds to minutes.
    /// It may change `mesh.cells`, `mesh.grading`, `element`, `time.step` and `fidelity.tolerance`, whatever the scene says of
    /// them, and nothing else: not geometry, material, loads, contact, scheme, start, kind of model or solver. The model
    /// carries the scene with what was picked, and says so in its summary.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target_error: Option<f64>,
    /// Most memory that compilation, model and one simulator may take by estimate, bytes; what needs more is refused with the
    /// estimate. Default: 8 GiB.
    #[schemars(extend("exclusiveMinimum" = 0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub memory_limit: Option<f64>,
    /// Most friction iterations of a communication step, for hosts that must not be late. They are shared evenly among the
    /// friction problems of the step (internal steps times stages); one that is not solved within its share ends at its best
    /// iterate: the step is taken, with a note, and `solver.residual` tells how well the friction law holds. An iteration is bounded: a
    /// few factorizations of the order of the contact at most, and some tens of products. The start is not limited. Default: none; a
    /// problem that is not solved is an error. Not with `time.tolerance`, whose number of steps has no bound, `target_error`,
    /// `multiplicity_test`, or the solver `fixed_point`.
    #[schemars(range(min = 1))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub work_limit: Option<u32>,
    /// Friction solver. Default: `newton`.
    pub solver: FrictionSolver,
    /// Looks, at every step, for a second solution from two sides: all-static and all-kinetic bounds, or where friction follows the
    /// pressure, all sticking and no friction; there the sign of a determinant tells of others too. Costs two to four more solves. It
    /// proves that there are several, never that there is one. Default: false.
    pub multiplicity_test: bool,
    /// Says at every step whether it has one solution: 1 proved, 0 not decided, -1 more than one, and by how much the proof holds
    /// (outputs `solver.uniqueness`, `solver.uniqueness_margin`). Where nothing is proved other solutions are looked for as by
    /// `multiplicity_test`. Default: false.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub uniqueness: bool,
}

impl Default for Fidelity {
    fn default() -> Self {
        Fidelity {
            model: ModelKind::Auto,
            tolerance: 1e-8,
            free_material: false,
            precision: Precision::Double,
            friction_tolerance: 1e-10,
            target_error: None,
            memory_limit: None,
            work_limit: None,
            solver: FrictionSolver::default(),
            multiplicity_test: false,
            uniqueness: false,
        }
    }
}

impl Fidelity {
    /// Most memory, bytes.
    pub fn memory_limit(&self) -> f64 {
        self.memory_limit.unwrap_or(8.0 * f64::from(1 << 30))
    }
}

/// Precision of numbers kept in memory.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    /// 64 bits.
    #[default]
    Double,
    /// 32 bits: half the memory, and half the memory traffic of a step; the reduction is then good to 1e-5 or so, and a smaller
    /// `tolerance` is refused. All arithmetic stays double.
    Single,
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
        /// Largest number of iterations in one solve. Default: 200.
        #[schemars(range(min = 1))]
        #[serde(default = "default_newton_iterations")]
        max_iterations: u32,
    },
    /// Problem 7.4 of the paper: the bound is frozen at the last iterate.
    FixedPoint {
        /// Relative change at which the iteration stops. Default: 1e-6.
        #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
        #[serde(default = "default_fixed_point_tolerance")]
        tolerance: f64,
        /// What the change is measured on. Default: `displacement_and_stress`.
        #[serde(default)]
        stop: FixedPointStop,
        /// Largest number of iterations in one solve. Default: 1000.
        #[schemars(range(min = 1))]
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

impl FrictionSolver {
    /// Whether its stop test measures displacements in the strain norm.
    pub(crate) fn measures_strains(&self) -> bool {
        matches!(self, FrictionSolver::FixedPoint { .. })
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
