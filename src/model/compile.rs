//! Scene -> Model, as one pipeline: mesh and assemble, order for elimination, choose what is kept of the body, certify.

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
use std::sync::Arc;

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
        let cholesky = SparseCholesky::new(
            &operators.col_ptr,
            &operators.row_idx,
            &body.interior_places(),
        )?;

        let kept = keep(scene, &body, &cholesky)?;
        let law = Law::from_scene(&scene.contact.friction);
        let tableau = Tableau::of(scene.time.scheme);
        let theta_k = tableau.theta() * scene.time.step;
        let certificate = certify(&body, law.lipschitz(), theta_k, |x, y| match &kept.model {
            KeptModel::Reduced(reduced) => {
                sharp_constant_of_compliance(&body, &reduced.compliance(x, y))
            }
            KeptModel::Whole(_) => sharp_constant(&body, &cholesky, (x, y)),
        })?;

        let parts = Parts {
            kind: kept.kind,
            reduction: kept.reduction,
            contact: body.contact.clone(),
            measures: body.loads.iter().map(|l| l.measure).collect(),
            certificate,
            strain_weights: strain_weights(&body),
            dimension: body.mesh.dimension,
            mesh_nodes: body.mesh.nodes.len(),
            mesh_cells: body.mesh.cell_count(),
            free_dofs: body.len(),
            rates: body.element_rates,
            body: kept.model.into_body(),
        };
        let model = Model::new(scene, parts)?;
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

/// The model that is kept; a reduced one also serves the certificate.
enum KeptModel {
    Reduced(Reduced),
    Whole(Box<dyn BodyModel>),
}

impl KeptModel {
    fn into_body(self) -> Box<dyn BodyModel> {
        match self {
            KeptModel::Reduced(reduced) => Box::new(reduced),
            KeptModel::Whole(whole) => whole,
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
        let model = Box::new(Condensed(Field::new(body)?));
        Ok(whole(ModelKind::Condensed, model))
    };
    let reduced = |reduction: Reduction| Kept {
        kind: ModelKind::Reduced,
        model: KeptModel::Reduced(reduction.reduced),
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
