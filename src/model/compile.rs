//! Scene -> Model, as one pipeline: mesh and assemble, order for elimination, choose what is kept of the body, certify.

use super::body_model::BodyModel;
use super::condensed::Condensed;
use super::field::Field;
use super::full::Full;
use super::reduction::{Reduction, Synthesis, reduce};
use super::{LoadInput, Model, SolverSettings, Summary};
use crate::error::{Error, Result};
use crate::fem::Body;
use crate::friction::Law;
use crate::friction::fixed_point::FixedPoint;
use crate::linalg::SparseCholesky;
use crate::mesh::Mesh;
use crate::ports::{Ports, Shapes};
use crate::qvi::{Tableau, certify, strain_weights};
use crate::scene::{FrictionSolver, LoadKind, ModelKind, Run, Scene};
use std::sync::Arc;
use xxhash_rust::xxh3::xxh3_64;

/// Distinguishes models whose states or steps are not interchangeable although their scenes are equal.
const MODEL_FORMAT: &str = "stickslip model 1:";

/// Compiles a scene.
///
/// # Errors
/// [`Error::Scene`] and [`Error::Body`] for a scene without a usable body, [`Error::ReductionInaccurate`] when the
/// reduction asked for is out of reach.
pub fn compile(scene: &Scene) -> Result<Arc<Model>> {
    Compilation::new(scene).map(|c| c.model)
}

/// A compiled scene together with the body it was made from, for pictures and files.
pub struct Compilation {
    pub model: Arc<Model>,
    pub body: Body,
    cholesky: SparseCholesky,
    synthesis: Option<Synthesis>,
}

impl Compilation {
    /// Compiles a scene on the mesh it describes.
    ///
    /// # Errors
    /// Those of [`compile`].
    pub fn new(scene: &Scene) -> Result<Compilation> {
        Compilation::on_mesh(scene, Mesh::generate(&scene.mesh)?)
    }

    /// Compiles a scene on a mesh of the caller, which has the parts the scene names.
    ///
    /// # Errors
    /// Those of [`compile`].
    pub fn on_mesh(scene: &Scene, mesh: Mesh) -> Result<Compilation> {
        let body = Body::assemble_on(scene, mesh)?;
        let operators = &body.operators;
        let cholesky =
            SparseCholesky::new(&operators.col_ptr, &operators.row_idx, body.contact_len())?;

        let kept = keep(scene, &body, &cholesky)?;
        let law = Law::from_scene(&scene.contact.friction);
        let tableau = Tableau::of(scene.time.scheme);
        let theta_k = tableau.theta() * scene.time.step;
        let certificate = certify(&body, &cholesky, law.lipschitz(), theta_k)?;

        let model = Model {
            summary: summary(scene, &body, &kept),
            body: kept.model,
            contact: body.contact.clone(),
            loads: body
                .loads
                .iter()
                .map(|l| LoadInput {
                    start: l.start,
                    measure: l.measure,
                })
                .collect(),
            interpolations: body.loads.iter().map(|l| l.interpolation).collect(),
            probes: body.probes.len(),
            ports: ports(scene, &body, law),
            law,
            tableau,
            start: scene.time.start,
            largest_step: scene.time.step,
            solver: solver(scene),
            has_multiplicity_test: scene.fidelity.multiplicity_test,
            strain_weights: strain_weights(&body),
            history_capacity: scene.history.capacity as usize,
            certificate,
            fingerprint: fingerprint(scene),
        };
        Ok(Compilation {
            model: Arc::new(model),
            body,
            cholesky,
            synthesis: kept.synthesis,
        })
    }

    /// Values at the free dofs of a displacement or velocity of the body (`State::displacement`, `State::velocity`).
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`]; not for a body that could be compiled.
    pub fn field(&self, states: &[f64]) -> Result<Vec<f64>> {
        match &self.synthesis {
            Some(synthesis) => synthesis.field(&self.body, &self.cholesky, states),
            None => Ok(states.to_vec()),
        }
    }
}

/// What is kept of the body, and how its field comes back.
struct Kept {
    kind: ModelKind,
    model: Box<dyn BodyModel>,
    reduction: Option<super::ReductionRecord>,
    synthesis: Option<Synthesis>,
}

fn keep(scene: &Scene, body: &Body, cholesky: &SparseCholesky) -> Result<Kept> {
    let whole = |kind, model| Kept {
        kind,
        model,
        reduction: None,
        synthesis: None,
    };
    let condensed = || -> Result<Kept> {
        let model = Box::new(Condensed(Field::new(body)?));
        Ok(whole(ModelKind::Condensed, model))
    };
    let reduced = |reduction: Reduction| Kept {
        kind: ModelKind::Reduced,
        model: Box::new(reduction.reduced),
        reduction: Some(reduction.record),
        synthesis: Some(reduction.synthesis),
    };
    let tolerance = scene.fidelity.tolerance;
    match scene.fidelity.model {
        ModelKind::Full => Ok(whole(ModelKind::Full, Box::new(Full(Field::new(body)?)))),
        ModelKind::Condensed => condensed(),
        ModelKind::Reduced => Ok(reduced(reduce(body, cholesky, tolerance)?)),
        ModelKind::Auto => match reduce(body, cholesky, tolerance) {
            Ok(reduction) if is_reduction_cheaper(&reduction, body, cholesky) => {
                Ok(reduced(reduction))
            }
            Ok(_) | Err(Error::ReductionInaccurate { .. }) => condensed(),
            Err(error) => Err(error),
        },
    }
}

/// Compares the multiplications of a step: two passes over the port matrix, or over the factor and once over B.
fn is_reduction_cheaper(reduction: &Reduction, body: &Body, cholesky: &SparseCholesky) -> bool {
    let reduced = &reduction.reduced;
    let ports = reduced.contact.ncols() + reduced.outputs.ncols();
    2 * ports * reduced.rates.len() < 2 * (cholesky.len() + body.operators.row_idx.len())
}

fn summary(scene: &Scene, body: &Body, kept: &Kept) -> Summary {
    let mesh = &body.mesh;
    let d = mesh.dimension;
    Summary {
        name: scene.name.clone(),
        dimension: d,
        mesh_nodes: mesh.nodes.len(),
        mesh_cells: mesh.cell_count(),
        dofs_with_multipliers: d * mesh.nodes.len() + d * body.contact.faces,
        free_dofs: body.len(),
        kind: kept.kind,
        reduction: kept.reduction.clone(),
        rates: body.element_rates,
        bytes: kept.model.bytes(),
    }
}

fn ports(scene: &Scene, body: &Body, law: Law) -> Ports {
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
        dimension: body.mesh.dimension,
        nodes: body.contact.nodes.len(),
        components: body.contact.components,
        loads: &loads,
        probes: &probes,
        law,
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
            stop,
            max_iterations: max_iterations as usize,
        }),
    }
}

/// Of everything that shapes a step or a state: the scene without what only the command line reads.
fn fingerprint(scene: &Scene) -> u64 {
    let scene = Scene {
        run: Run::default(),
        ..scene.clone()
    };
    xxh3_64(format!("{MODEL_FORMAT}{}", scene.to_json()).as_bytes())
}
