//! What a model holds that its scene does not say: the compiled numbers. Together with the scene they make the model,
//! whether they were compiled a moment ago or read from bytes.

use super::certificate::Certificate;
use super::free::FreeMaterial;
use super::motions::Motions;
use super::selection::Selection;
use super::start::InitialState;
use super::{BodyModel, Model, ReductionRecord, SolverSettings, Summary};
use crate::body::digits::can_lose_in_steps;
use crate::contact::law::ContactLaw;
use crate::contact::relaxing::{Branch, RelaxingFoundation, RelaxingPart};
use crate::contact::solve::fixed_point::FixedPoint;
use crate::error::Result;
use crate::fem::ContactPatch;
use crate::files::MemoryFiles;
use crate::ports::{DrivenPort, FoundationPort, Ports, Shapes};
use crate::scene::{
    Condition, DrivenDirection, DrivenInput, FixedPointStop, Foundation, FrictionSolver,
    Interpolation, LoadKind, ModelKind, Run, Scene,
};
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
    pub motions: Motions,
    pub initial: Option<InitialState>,
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
    /// The numbers of a material that stays free, with `body`.
    pub free: Option<FreeMaterial>,
    /// The files that the scene names.
    pub files: MemoryFiles,
}

impl Model {
    /// The model of a scene with its compiled numbers; what only the command line reads of the scene is dropped.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for coefficients that do not fit the contact nodes.
    pub(super) fn new(scene: &Scene, parts: Parts) -> Result<Model> {
        let ranges = parts.contact.parts.iter().map(|part| part.nodes.clone());
        let friction = scene.friction_on(&parts.contact.points, ranges)?;
        let mut model = Model {
            summary: summary(scene, &parts),
            ports: ports(scene, &parts, &friction),
            starts: scene.inputs().map(|(_, start)| start).collect(),
            interpolations: interpolations(scene, &parts.motions),
            measures: parts.measures,
            motions: parts.motions,
            initial: parts.initial,
            probes: scene.probes.len(),
            friction,
            conditions: scene.each_contact().map(|c| c.condition.clone()).collect(),
            relaxing: relaxing(scene, &parts.contact),
            tableau: Tableau::of(scene.scheme()),
            start: scene.time.start,
            largest_step: scene.time.step,
            solver: solver(scene),
            has_multiplicity_test: scene.fidelity.multiplicity_test,
            asks_uniqueness: scene.fidelity.uniqueness,
            history_capacity: scene.history.capacity as usize,
            body: parts.body,
            free: parts.free,
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

/// The contacts whose foundation remembers penetration.
fn relaxing(scene: &Scene, contact: &ContactPatch) -> Vec<RelaxingPart> {
    let mut parts = Vec::new();
    let mut first = 0;
    for (index, (of, part)) in scene.each_contact().zip(&contact.parts).enumerate() {
        let Condition::Compliance {
            stiffness,
            exponent,
            memory: Some(memory),
            ..
        } = &of.condition
        else {
            continue;
        };
        let branches = memory.kernel.iter().map(|term| Branch {
            weight: term.weight,
            tau: term.tau,
        });
        let foundation = RelaxingFoundation {
            stiffness: *stiffness,
            exponent: *exponent,
            branches: branches.collect(),
        };
        let numbers = first..first + part.nodes.len() * foundation.numbers();
        first = numbers.end;
        parts.push(RelaxingPart {
            foundation,
            contact: index,
            nodes: part.nodes.clone(),
            numbers,
        });
    }
    parts
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

/// The course of every input within a communication step.
fn interpolations(scene: &Scene, motions: &Motions) -> Vec<Interpolation> {
    let loads = scene.loads.iter().map(|load| load.interpolation);
    let others = motions.inputs() - motions.loads();
    loads
        .chain(std::iter::repeat_n(Interpolation::Linear, others))
        .collect()
}

fn ports(scene: &Scene, parts: &Parts, friction: &ContactLaw) -> Ports {
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
    let driven = scene.driven.iter().flat_map(|driven| {
        driven
            .directions
            .iter()
            .map(|(name, direction)| DrivenPort {
                name: name.clone(),
                is_rotation: matches!(direction, DrivenDirection::Rotation(_)),
                is_displacement: driven.input == DrivenInput::Displacement,
            })
    });
    let motions = scene.each_contact().flat_map(|contact| &contact.foundation);
    let foundation = motions.map(|motion| FoundationPort {
        name: motion.name().to_owned(),
        is_rotation: matches!(motion, Foundation::Rotation { .. }),
        is_approach: matches!(motion, Foundation::Approach { .. }),
    });
    Ports::new(&Shapes {
        has_normal: parts.contact.has_normal,
        contacts: &parts.contact.parts,
        has_means: !Tableau::of(scene.scheme()).ends_with_stage(),
        driven: &driven.collect::<Vec<_>>(),
        foundation: &foundation.collect::<Vec<_>>(),
        dimension: parts.dimension,
        components: parts.contact.components,
        loads: &loads,
        probes: &probes,
        friction,
        asks_uniqueness: scene.fidelity.uniqueness,
        has_error_estimate: scene.time.estimates_error(),
        can_lose_digits: can_lose_in_steps(
            scene,
            &Tableau::of(scene.scheme()),
            // the list of ports is that of all materials
            match parts.free {
                Some(_) => f64::INFINITY,
                None => parts.rates[1],
            },
            scene.time.step,
        ),
        free_numbers: parts.free.as_ref().map_or(&[], |free| &free.numbers),
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
