//! The compiled scene: what a step needs, and no more. Immutable, shared between simulators and threads.

mod bytes;
pub mod certificate;
mod compile;
mod derived;
mod free;
mod keep;
mod memory;
pub(crate) mod motions;
mod parts;
mod selection;
mod settings;
mod start;

pub use crate::body::reduction::ReductionRecord;
pub use crate::body::{BodyModel, ModalMatrices};
pub use crate::progress::{Observer, Phase, Progress};
pub use compile::Compilation;
pub(crate) use memory::ensure_available;
pub use selection::Selection;

use crate::contact::law::ContactLaw;
use crate::contact::relaxing::RelaxingPart;
use crate::contact::solve::fixed_point::FixedPoint;
use crate::fem::ContactPatch;
use crate::files::MemoryFiles;
use crate::ports::Ports;
use crate::scene::{Condition, Interpolation, ModelKind, Scene, Start};
use crate::time::scheme::Tableau;
use certificate::Certificate;
use free::FreeMaterial;
use motions::Motions;
use start::InitialState;
use std::sync::Arc;

/// How the friction problem of a stage is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SolverSettings {
    Newton {
        tolerance: f64,
        max_iterations: usize,
    },
    FixedPoint(FixedPoint),
}

impl SolverSettings {
    /// The solver's own stop tolerance.
    pub fn tolerance(&self) -> f64 {
        match self {
            SolverSettings::Newton { tolerance, .. } => *tolerance,
            SolverSettings::FixedPoint(settings) => settings.tolerance,
        }
    }

    /// Most iterations of one solve.
    pub fn max_iterations(&self) -> usize {
        match self {
            SolverSettings::Newton { max_iterations, .. } => *max_iterations,
            SolverSettings::FixedPoint(settings) => settings.max_iterations,
        }
    }
}

/// What was built, for reports.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Name of the scene.
    pub name: String,
    /// Space dimension.
    pub dimension: usize,
    /// Nodes of the mesh.
    pub mesh_nodes: usize,
    /// Cells of the mesh.
    pub mesh_cells: usize,
    /// Displacement components at nodes plus as many multipliers per contact face (twice as many for its two nodes of a
    /// quadratic element), the count of Kazmi et al. 2014.
    pub dofs_with_multipliers: usize,
    /// Free displacement components.
    pub free_dofs: usize,
    /// What is kept of the body; never `Auto`.
    pub kind: ModelKind,
    /// Shifts and error of the reduction, where there is one.
    pub reduction: Option<ReductionRecord>,
    /// Why `auto` kept the whole mesh instead of a reduced model; `None` where it did not, or was not asked.
    pub fallback: Option<String>,
    /// Relative error that 64-bit numbers leave in the responses of the body, by estimate.
    pub lost_digits: f64,
    /// Slowest and fastest relaxation rate of the material, 1/s.
    pub rates: [f64; 2],
    /// What was picked for `fidelity.target_error`, where the scene had one.
    pub selection: Option<Selection>,
    /// Bytes held by the model of the body.
    pub bytes: usize,
}

/// A compiled scene.
pub struct Model {
    body: Arc<dyn BodyModel>,
    free: Option<FreeMaterial>,
    contact: ContactPatch,
    /// Area or volume of the part of every load, m^2 or m^3 (m or m^2 in 2D).
    measures: Vec<f64>,
    /// Inputs at the start.
    starts: Vec<f64>,
    interpolations: Vec<Interpolation>,
    probes: usize,
    motions: Motions,
    initial: Option<InitialState>,
    ports: Ports,
    friction: ContactLaw,
    conditions: Vec<Condition>,
    relaxing: Vec<RelaxingPart>,
    tableau: Tableau,
    start: Start,
    largest_step: f64,
    solver: SolverSettings,
    has_multiplicity_test: bool,
    asks_uniqueness: bool,
    /// `(x, y)` with `x A + y B` the strain norm; `None` where the body has it assembled.
    strain_weights: Option<(f64, f64)>,
    history_capacity: usize,
    certificate: Certificate,
    summary: Summary,
    scene: Scene,
    files: MemoryFiles,
    fingerprint: u64,
    state_bytes: usize,
}

impl Model {
    /// The ports, in the order of their references.
    pub fn ports(&self) -> &Ports {
        &self.ports
    }

    /// The contact nodes, in the order of all contact arrays.
    pub fn contact(&self) -> &ContactPatch {
        &self.contact
    }

    /// What was built.
    pub fn summary(&self) -> &Summary {
        &self.summary
    }

    /// What guarantees (or not) that every step has exactly one solution.
    pub fn certificate(&self) -> &Certificate {
        &self.certificate
    }

    /// The scene it was compiled from, with the setting that was picked for `fidelity.target_error` in place of it; its
    /// `run` is the default one.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The files that its scene names, as they were read: with them the scene is compiled again.
    pub fn files(&self) -> &MemoryFiles {
        &self.files
    }

    /// Identifies the scene (its `run` apart) and the compiled numbers: states fit models with the same fingerprint.
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint
    }

    /// Length of a displacement of the body: dofs or modes.
    pub fn states(&self) -> usize {
        self.body.states()
    }

    /// The matrices of a reduced model, copied; `None` where the whole mesh is kept.
    pub fn matrices(&self) -> Option<ModalMatrices> {
        self.body.matrices()
    }

    /// Largest internal step, s.
    pub fn largest_step(&self) -> f64 {
        self.largest_step
    }

    /// Largest stable step for an explicit scheme, s.
    pub fn stability_limit(&self) -> Option<f64> {
        self.tableau.stability_limit(self.summary.rates[1])
    }

    /// Bytes that a simulator takes: three states, the factors of its last step sizes, matrices of contact order. An estimate.
    pub fn simulator_bytes(&self) -> usize {
        let contact = self.contact.force_len();
        let square = contact.saturating_mul(contact);
        let stages = self.sizes_kept().saturating_mul(
            square.saturating_add(self.body.factor_len() + self.body.tangent_len()),
        );
        let vectors = self.states().saturating_mul(20);
        let numbers = square
            .saturating_mul(6)
            .saturating_add(stages)
            .saturating_add(vectors);
        numbers
            .saturating_mul(8)
            .saturating_add(self.state_bytes.saturating_mul(3))
    }

    /// Bytes of a serialized state.
    pub fn state_bytes(&self) -> usize {
        self.state_bytes
    }

    /// The friction laws of all contacts with the coefficients of the scene.
    pub fn friction(&self) -> &ContactLaw {
        &self.friction
    }

    /// Number of inputs: loads, driven directions, motions of the foundation.
    pub fn input_count(&self) -> usize {
        self.starts.len()
    }

    /// Internal steps kept in the history of a state.
    pub fn history_capacity(&self) -> usize {
        self.history_capacity
    }

    /// Multiplications of one stage, friction iterations apart.
    pub fn stage_multiplications(&self) -> usize {
        self.body.stage_multiplications()
    }

    pub(crate) fn body(&self) -> &dyn BodyModel {
        self.body.as_ref()
    }

    pub(crate) fn tableau(&self) -> &Tableau {
        &self.tableau
    }

    pub(crate) fn start(&self) -> Start {
        self.start
    }

    pub(crate) fn solver(&self) -> &SolverSettings {
        &self.solver
    }

    /// Whether steps say whether they have one solution.
    pub(crate) fn asks_uniqueness(&self) -> bool {
        self.asks_uniqueness
    }

    pub(crate) fn has_multiplicity_test(&self) -> bool {
        self.has_multiplicity_test
    }

    pub(crate) fn interpolations(&self) -> &[Interpolation] {
        &self.interpolations
    }

    pub(crate) fn load_measure(&self, load: usize) -> f64 {
        self.measures[load]
    }

    /// Inputs at the start.
    pub(crate) fn starts(&self) -> &[f64] {
        &self.starts
    }

    pub(crate) fn motions(&self) -> &Motions {
        &self.motions
    }

    /// The initial displacement, where there is one.
    pub(crate) fn initial(&self) -> Option<&InitialState> {
        self.initial.as_ref()
    }

    /// The normal condition of every contact.
    pub(crate) fn conditions(&self) -> &[Condition] {
        &self.conditions
    }

    /// The contacts whose foundation remembers penetration.
    pub(crate) fn relaxing(&self) -> &[RelaxingPart] {
        &self.relaxing
    }

    /// Contact nodes, where a foundation remembers penetration.
    pub(crate) fn relaxing_nodes(&self) -> usize {
        match self.relaxing.is_empty() {
            true => 0,
            false => self.contact.node_count(),
        }
    }

    /// Linear outputs of the body: one per column of forces, then the components of the probes.
    pub(crate) fn output_count(&self) -> usize {
        self.motions.force_count() + self.probes * self.summary.dimension
    }

    /// `|eps(u)|` in L2 of a displacement or velocity of the body.
    pub(crate) fn strain_norm(&self, u: &[f64]) -> f64 {
        let squared = match self.strain_weights {
            Some((x, y)) => {
                let (a, b) = self.body.products(u);
                x * a + y * b
            }
            None => self.body.strain_square(u),
        };
        // the difference of two positive terms may round below zero
        squared.max(0.0).sqrt()
    }
}
