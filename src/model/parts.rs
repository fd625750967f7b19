//! What a model holds that its scene does not say: the compiled numbers. Together with the scene they make the model,
//! whether they were compiled a moment ago or read from bytes.

use super::certificate::Certificate;
use super::selection::Selection;
use super::{BodyModel, LoadInput, Model, ReductionRecord, SolverSettings, Summary};
use crate::body::digits::can_lose_in_steps;
use crate::contact::law::ChosenLaw;
use crate::contact::solve::fixed_point::FixedPoint;
use crate::error::Result;
use crate::fem::ContactPatch;
use crate::files::MemoryFiles;
use crate::ports::{Ports, Shapes};
use crate::refusal::scene_error;
use crate::scene::{FixedPointStop, FrictionSolver, LoadKind, ModelKind, Run, Scene};
use crate::state::State;
use crate::time::scheme::Tableau;
use std::sync::Arc;

/// The compiled numbers of a scene.
pub(super) struct Parts {
    pub kind: ModelKind,
    pub body: Arc<dyn BodyModel>,
    pub reduction: Option<ReductionRecord>,
    pub contact: ContactPatch,
    /// Area or volume of every load.
    pub measures: Vec<f64>,
    pub certificate: Certificate,
    pub strain_weights: Option<(f64, f64)>,
    pub dimension: usize,
    pub mesh_nodes: usize,
    pub mesh_cells: usize,
    pub free_dofs: usize,
    /// Slowest and fastest relaxation rate of the material, 1/s.
    pub rates: [f64; 2],
    pub selection: Option<Selection>,
    /// Why `auto` kept the whole mesh.
    pub fallback: Option<String>,
    /// Relative error by rounding.
    pub lost_digits: f64,
    /// The files that the scene names.
    pub files: MemoryFiles,
}

impl Model {
    /// The model of a scene with its compiled numbers; what only the command line reads of the scene is dropped.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for coefficients that do not fit the contact nodes.
    pub(super) fn new(scene: &Scene, parts: Parts) -> Result<Model> {
        let friction = scene.friction_on(parts.contact.node_count())?;
        if friction.needs_pressure() {
            return Err(scene_error(
                "contact.friction.law",
                "a bound that depends on the pressure".into(),
                "a bound in Pa: bound, exponential, frictionless, tresca".into(),
            ));
        }
        let mut model = Model {
            summary: summary(scene, &parts),
            ports: ports(scene, &parts, &friction),
            loads: scene
                .loads
                .iter()
                .zip(&parts.measures)
                .map(|(load, &measure)| LoadInput {
                    start: load.start,
                    measure,
                })
                .collect(),
            interpolations: scene.loads.iter().map(|l| l.interpolation).collect(),
            probes: scene.probes.len(),
            friction,
            tableau: Tableau::of(scene.time.scheme),
            start: scene.time.start,
            largest_step: scene.time.step,
            solver: solver(scene),
            has_multiplicity_test: scene.fidelity.multiplicity_test,
            history_capacity: scene.history.capacity as usize,
            body: parts.body,
            contact: parts.contact,
            strain_weights: parts.strain_weights,
            certificate: parts.certificate,
            files: parts.files,
            scene: Scene {
                run: Run::default(),
                ..scene.clone()
            },
            fingerprint: 0,
            state_bytes: 0,
        };
        model.fingerprint = model.compute_fingerprint();
        model.state_bytes = State::byte_len_of(&model);
        Ok(model)
    }
}

fn summary(scene: &Scene, parts: &Parts) -> Summary {
    // the first node of a contact is not counted, as at the clamped end of the paper's example
    let multipliers = scene.element_in(parts.dimension).order * parts.contact.faces;
    Summary {
        name: scene.name.clone(),
        dimension: parts.dimension,
        mesh_nodes: parts.mesh_nodes,
        mesh_cells: parts.mesh_cells,
        dofs_with_multipliers: parts.dimension * (parts.mesh_nodes + multipliers),
        free_dofs: parts.free_dofs,
        kind: parts.kind,
        reduction: parts.reduction.clone(),
        fallback: parts.fallback.clone(),
        lost_digits: parts.lost_digits,
        rates: parts.rates,
        selection: parts.selection.clone(),
        bytes: parts.body.bytes(),
    }
}

fn ports(scene: &Scene, parts: &Parts, friction: &ChosenLaw) -> Ports {
    let unit = |kind| match kind {
        LoadKind::Traction => "Pa",
        LoadKind::BodyForce => "N/m3",
    };
    let loads: Vec<_> = scene
        .loads
        .iter()
        .map(|l| (l.name.clone(), unit(l.kind)))
        .collect();
    let probes: Vec<_> = scene.probes.iter().map(|p| p.name.clone()).collect();
    Ports::new(&Shapes {
        dimension: parts.dimension,
        nodes: parts.contact.nodes.len(),
        components: parts.contact.components,
        loads: &loads,
        probes: &probes,
        friction,
        has_error_estimate: scene.time.estimates_error(),
        can_lose_digits: can_lose_in_steps(
            scene,
            &Tableau::of(scene.time.scheme),
            parts.rates[1],
            scene.time.step,
        ),
    })
}

fn solver(scene: &Scene) -> SolverSettings {
    match scene.fidelity.solver {
        FrictionSolver::Newton { max_iterations } => SolverSettings::Newton {
            tolerance: scene.fidelity.friction_tolerance,
            max_iterations: max_iterations as usize,
        },
        FrictionSolver::FixedPoint {
            tolerance,
            stop,
            max_iterations,
        } => SolverSettings::FixedPoint(FixedPoint {
            tolerance,
            watches_forces: stop != FixedPointStop::Displacement,
            max_iterations: max_iterations as usize,
        }),
    }
}
