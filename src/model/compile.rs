//! Scene -> Model, as one pipeline: pick the setting for a target, mesh and assemble, order for elimination, choose what is
//! kept of the body, certify.

use super::Model;
use super::body_model::BodyModel;
use super::condensed::Condensed;
use super::field::Field;
use super::full::Full;
use super::parts::Parts;
use super::reduced::Reduced;
use super::reduction::{Reduction, Synthesis, reduce};
use crate::error::{Error, Result};
use crate::fem::Body;
use crate::friction::Law;
use crate::linalg::SparseCholesky;
use crate::mesh::Mesh;
use crate::qvi::{Tableau, certify, sharp_constant, sharp_constant_of_compliance, strain_weights};
use crate::scene::{ModelKind, Scene};
use crate::tradeoff::{Selection, select};
use std::sync::Arc;

/// Compiles a scene.
///
/// # Errors
/// [`Error::Scene`] and [`Error::Body`] for a scene without a usable body, [`Error::ReductionInaccurate`] when the
/// reduction asked for is out of reach, [`Error::Scene`] at `fidelity.target_error` for a target out of reach.
pub fn compile(scene: &Scene) -> Result<Arc<Model>> {
    Compilation::new(scene).map(|c| c.model)
}

/// A compiled scene together with the body it was made from, for pictures and files.
pub struct Compilation {
    pub model: Arc<Model>,
    /// The scene, with the setting that was picked for `fidelity.target_error` in place of it.
    pub scene: Scene,
    pub body: Body,
    cholesky: SparseCholesky,
    kept: Kept,
}

impl Compilation {
    /// Compiles a scene on the mesh it describes, or on the one that is picked for its `fidelity.target_error`.
    ///
    /// # Errors
    /// Those of [`compile`].
    pub fn new(scene: &Scene) -> Result<Compilation> {
        let (scene, selection) = match scene.fidelity.target_error {
            Some(target) => select(scene, target).map(|(scene, found)| (scene, Some(found)))?,
            None => (scene.clone(), None),
        };
        let mesh = Mesh::generate(&scene.mesh)?;
        Compilation::of(scene, mesh, selection)
    }

    /// Compiles a scene on a mesh of the caller, which has the parts the scene names.
    ///
    /// # Errors
    /// Those of [`compile`]; [`Error::Scene`] for a scene with `fidelity.target_error`, which would change the mesh.
    pub fn on_mesh(scene: &Scene, mesh: Mesh) -> Result<Compilation> {
        if let Some(target) = scene.fidelity.target_error {
            return Err(Error::Scene {
                source_name: scene.name.clone(),
                path: "fidelity.target_error".to_owned(),
                found: crate::message::number(target).to_string(),
                allowed: "nothing on a mesh that is given".to_owned(),
            });
        }
        Compilation::of(scene.clone(), mesh, None)
    }

    fn of(scene: Scene, mesh: Mesh, selection: Option<Selection>) -> Result<Compilation> {
        let body = Body::assemble_on(&scene, mesh)?;
        let operators = &body.operators;
        let cholesky = SparseCholesky::new(
            &operators.col_ptr,
            &operators.row_idx,
            &body.interior_places(),
        )?;
        let kept = keep(&scene, &body, &cholesky)?;
        let model = finish(&scene, &body, &cholesky, &kept, selection)?;
        Ok(Compilation {
            model: Arc::new(model),
            scene,
            body,
            cholesky,
            kept,
        })
    }

    /// Compiles a scene that differs from the one of this compilation in nothing that the body depends on (time, friction
    /// solver, history, run), and shares the body with it.
    ///
    /// # Errors
    /// Those of [`compile`].
    pub(crate) fn again(&self, scene: &Scene) -> Result<Arc<Model>> {
        finish(scene, &self.body, &self.cholesky, &self.kept, None).map(Arc::new)
    }

    /// Values at the free dofs of a displacement or velocity of the body (`State::displacement`, `State::velocity`).
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`]; not for a body that could be compiled.
    pub fn field(&self, states: &[f64]) -> Result<Vec<f64>> {
        match &self.kept.synthesis {
            Some(synthesis) => synthesis.field(&self.body, &self.cholesky, states),
            None => Ok(states.to_vec()),
        }
    }
}

/// Certifies the step and puts the model together.
fn finish(
    scene: &Scene,
    body: &Body,
    cholesky: &SparseCholesky,
    kept: &Kept,
    selection: Option<Selection>,
) -> Result<Model> {
    let law = Law::from_scene(&scene.contact.friction);
    let tableau = Tableau::of(scene.time.scheme);
    let theta_k = tableau.theta() * scene.time.step;
    let certificate = certify(body, law.lipschitz(), theta_k, |x, y| match &kept.model {
        KeptModel::Reduced(reduced) => {
            sharp_constant_of_compliance(body, &reduced.compliance(x, y))
        }
        KeptModel::Whole(_) => sharp_constant(body, cholesky, (x, y)),
    })?;
    let parts = Parts {
        kind: kept.kind,
        reduction: kept.reduction.clone(),
        contact: body.contact.clone(),
        measures: body.loads.iter().map(|l| l.measure).collect(),
        certificate,
        strain_weights: strain_weights(body),
        dimension: body.mesh.dimension,
        mesh_nodes: body.mesh.nodes.len(),
        mesh_cells: body.mesh.cell_count(),
        free_dofs: body.len(),
        rates: body.element_rates,
        selection,
        body: kept.model.shared(),
    };
    Model::new(scene, parts)
}

/// The model that is kept; a reduced one also serves the certificate.
enum KeptModel {
    Reduced(Arc<Reduced>),
    Whole(Arc<dyn BodyModel>),
}

impl KeptModel {
    fn shared(&self) -> Arc<dyn BodyModel> {
        match self {
            KeptModel::Reduced(reduced) => Arc::clone(reduced) as Arc<dyn BodyModel>,
            KeptModel::Whole(whole) => Arc::clone(whole),
        }
    }
}

/// What is kept of the body, and how its field comes back.
struct Kept {
    kind: ModelKind,
    model: KeptModel,
    reduction: Option<super::ReductionRecord>,
    synthesis: Option<Synthesis>,
}

fn keep(scene: &Scene, body: &Body, cholesky: &SparseCholesky) -> Result<Kept> {
    let whole = |kind, model| Kept {
        kind,
        model: KeptModel::Whole(model),
        reduction: None,
        synthesis: None,
    };
    let condensed = || -> Result<Kept> {
        let model = Arc::new(Condensed(Field::new(body)?));
        Ok(whole(ModelKind::Condensed, model))
    };
    let reduced = |reduction: Reduction| Kept {
        kind: ModelKind::Reduced,
        model: KeptModel::Reduced(Arc::new(reduction.reduced)),
        reduction: Some(reduction.record),
        synthesis: Some(reduction.synthesis),
    };
    let reduction = || reduce(body, cholesky, &scene.fidelity);
    match scene.fidelity.model {
        ModelKind::Full => Ok(whole(ModelKind::Full, Arc::new(Full(Field::new(body)?)))),
        ModelKind::Condensed => condensed(),
        ModelKind::Reduced => Ok(reduced(reduction()?)),
        ModelKind::Auto => match reduction() {
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
