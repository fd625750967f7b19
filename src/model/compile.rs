//! Scene -> Model, as one pipeline: pick the setting for a target, mesh and assemble, order for elimination, choose what is
//! kept of the body, certify.

use super::certificate::{
    Constants, LawConstants, MaterialConstants, certify, constants_of, constants_of_compliance,
    factored_constants,
};
use super::free::FreeMaterial;
use super::keep::{Kept, KeptModel, keep};
use super::memory::Sizes;
use super::motions::Motions;
use super::parts::Parts;
use super::selection::Selection;
use super::start::InitialState;
use crate::body::nonlinear::Nonlinear;
use crate::error::{Error, Result};
use crate::fem::{Body, StrainNorm};
use crate::files::{Files, Keeper, MemoryFiles};
use crate::linalg::SparseCholesky;
use crate::mesh::Mesh;
use crate::model::Model;
use crate::progress::{Phase, Watch};
use crate::scene::Scene;
use crate::state::State;
use crate::time::scheme::Tableau;
use std::ops::{ControlFlow, Range};
use std::sync::Arc;

/// A compiled scene together with the body it was made from, for pictures and files.
pub struct Compilation {
    pub model: Arc<Model>,
    /// The scene, with the setting that was picked for `fidelity.target_error` in place of it.
    pub scene: Scene,
    pub body: Body,
    files: MemoryFiles,
    cholesky: SparseCholesky,
    kept: Kept,
}

impl Compilation {
    /// Compiles a scene on the mesh it describes; its setting is final.
    ///
    /// # Errors
    /// Those of [`crate::compile`].
    pub(crate) fn resolved(
        scene: Scene,
        files: &dyn Files,
        selection: Option<Selection>,
        watch: &mut Watch,
    ) -> Result<Compilation> {
        watch.report(Phase::Assembly, 0.0)?;
        if let Some(sizes) = Sizes::of_scene(&scene) {
            sizes.check(&scene)?;
        }
        let keeper = Keeper::new(files);
        let mesh = Mesh::read(&scene.mesh, &keeper)?;
        let files = keeper.into_files();
        if scene.mesh.file().is_some() {
            Sizes::of_file(&scene, &mesh).check(&scene)?;
        }
        Compilation::of(scene, files, mesh, selection, watch)
    }

    /// Compiles a scene on a mesh of the caller, which has the parts the scene names.
    ///
    /// # Errors
    /// Those of [`crate::compile`]; [`Error::Scene`] for a scene with `fidelity.target_error`, which would change the mesh.
    pub fn on_mesh(scene: &Scene, mesh: Mesh) -> Result<Compilation> {
        if let Some(target) = scene.fidelity.target_error {
            return Err(Error::Scene {
                source_name: scene.name.clone(),
                path: "fidelity.target_error".to_owned(),
                found: crate::message::number(target).to_string(),
                allowed: "nothing on a mesh that is given".to_owned(),
            });
        }
        let mut silent = |_| ControlFlow::Continue(());
        let files = MemoryFiles::default();
        Compilation::of(
            scene.clone(),
            files,
            mesh,
            None,
            &mut Watch::new(&mut silent),
        )
    }

    fn of(
        mut scene: Scene,
        files: MemoryFiles,
        mesh: Mesh,
        selection: Option<Selection>,
        watch: &mut Watch,
    ) -> Result<Compilation> {
        watch.report(Phase::Assembly, 0.05)?;
        scene.element.get_or_insert(mesh.element.kind);
        scene.validate_in(mesh.dimension)?;
        let body = Body::assemble_on(&scene, mesh)?;
        if let Some(free) = &body.free_motion {
            return Err(free.clone());
        }
        // before the work of an hour: whether coefficients fit the contact nodes
        scene.friction_on(&body.contact.points, ranges(&body))?;
        watch.report(Phase::Assembly, 0.1)?;
        let operators = &body.operators;
        let cholesky = SparseCholesky::new(
            &operators.col_ptr,
            &operators.row_idx,
            &body.interior_places(),
        )?;
        refuse_unstable(&scene, &body)?;
        let sizes = Sizes::of_body(&scene, &body, cholesky.len());
        sizes.check(&scene)?;
        watch.report(Phase::Reduction, 0.2)?;
        let kept = keep(&scene, &body, &cholesky, &sizes, watch)?;
        watch.report(Phase::Certificate, 0.85)?;
        let model = finish(&scene, &files, &body, &cholesky, &kept, selection)?;
        watch.report(Phase::Certificate, 1.0)?;
        Ok(Compilation {
            model: Arc::new(model),
            scene,
            files,
            body,
            cholesky,
            kept,
        })
    }

    /// Compiles a scene that differs from the one of this compilation in nothing that the body depends on (time, friction
    /// solver, history, run), and shares the body with it.
    ///
    /// # Errors
    /// Those of [`crate::compile`].
    pub(crate) fn again(&self, scene: &Scene) -> Result<Arc<Model>> {
        refuse_unstable(scene, &self.body)?;
        finish(
            scene,
            &self.files,
            &self.body,
            &self.cholesky,
            &self.kept,
            None,
        )
        .map(Arc::new)
    }

    /// The model of a scene that differs from that of this compilation in `time`, `history`, `run`, the friction solver and its
    /// tolerance alone: the body is shared, and nothing of it is compiled again.
    ///
    /// # Errors
    /// [`Error::Scene`] for a scene that differs in more; those of [`crate::compile`].
    pub fn restepped(&self, scene: &Scene) -> Result<Arc<Model>> {
        let own = &self.scene;
        let mut same = Scene {
            time: own.time.clone(),
            history: own.history.clone(),
            run: own.run.clone(),
            ..scene.clone()
        };
        same.fidelity.solver = own.fidelity.solver.clone();
        same.fidelity.friction_tolerance = own.fidelity.friction_tolerance;
        same.fidelity.multiplicity_test = own.fidelity.multiplicity_test;
        same.fidelity.uniqueness = own.fidelity.uniqueness;
        // a solver that measures strains has a norm of its own in the body
        let measures = |scene: &Scene| scene.fidelity.solver.measures_strains();
        if same != *own || measures(scene) != measures(own) {
            return Err(Error::Scene {
                source_name: scene.name.clone(),
                path: "$".to_owned(),
                found: "another body".to_owned(),
                allowed: "other values of time, history, run, fidelity.solver of the same kind, \
                    fidelity.friction_tolerance and fidelity.multiplicity_test"
                    .to_owned(),
            });
        }
        self.again(scene)
    }

    /// Displacements of all nodes in a state, m, global axes (z = 0 in 2D); driven parts have moved as they were driven.
    ///
    /// # Errors
    /// Those of [`Compilation::field`].
    pub fn nodal_displacement(&self, state: &State) -> Result<Vec<[f64; 3]>> {
        let mut field = self.field(state.displacement())?;
        if let Some(initial) = &self.body.initial {
            let start = initial.field.iter();
            field.iter_mut().zip(start).for_each(|(u, u0)| *u += u0);
        }
        Ok(self.nodal(field, |drive| state.drive_displacement[drive]))
    }

    /// Velocities of all nodes in a state, m/s, as [`Compilation::nodal_displacement`].
    ///
    /// # Errors
    /// Those of [`Compilation::field`].
    pub fn nodal_velocity(&self, state: &State) -> Result<Vec<[f64; 3]>> {
        let field = self.field(state.velocity())?;
        let velocities = &state.main.instant.drive_velocity;
        Ok(self.nodal(field, |drive| velocities[drive]))
    }

    /// Vectors at all nodes of a field of free components and of the motions of driven parts.
    fn nodal(&self, mut field: Vec<f64>, drive: impl Fn(usize) -> f64) -> Vec<[f64; 3]> {
        let drives = &self.body.drives;
        for (i, shape) in drives.shapes.iter().enumerate() {
            let by = drive(i);
            for (value, unit) in field.iter_mut().zip(shape) {
                *value += by * unit;
            }
        }
        let mut nodal = self.body.displacement(&field);
        for (i, given) in drives.fields.iter().enumerate() {
            let by = drive(i);
            for (node, unit) in given {
                for (value, unit) in nodal[*node as usize].iter_mut().zip(unit) {
                    *value += by * unit;
                }
            }
        }
        nodal
    }

    /// Values at the free dofs of a displacement or velocity of the body (`State::displacement`, `State::velocity`), without what
    /// driven parts add to it, and without what the body starts with ([`Body::initial`]).
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`]; not for a body that could be compiled.
    pub fn field(&self, states: &[f64]) -> Result<Vec<f64>> {
        match &self.kept.synthesis {
            Some(synthesis) => {
                let body = self.kept.ends.as_deref().unwrap_or(&self.body);
                // the branches of the memory follow the displacement
                let own = &states[..synthesis.states().min(states.len())];
                synthesis.field(body, &self.cholesky, own)
            }
            // the fields of the memory follow the displacement
            None => Ok(states[..self.body.len().min(states.len())].to_vec()),
        }
    }
}

/// An explicit scheme beyond its stability limit gives numbers that mean nothing.
fn refuse_unstable(scene: &Scene, body: &Body) -> Result<()> {
    let step = scene.time.step;
    let limit = Tableau::of(scene.scheme()).stability_limit(body.element_rates[1]);
    match limit {
        Some(limit) if step > limit && !scene.time.force => Err(Error::Unstable { step, limit }),
        _ => Ok(()),
    }
}

/// Certifies the step and puts the model together.
fn finish(
    scene: &Scene,
    files: &MemoryFiles,
    body: &Body,
    cholesky: &SparseCholesky,
    kept: &Kept,
    selection: Option<Selection>,
) -> Result<Model> {
    let friction = scene.friction_on(&body.contact.points, ranges(body))?;
    let tableau = Tableau::of(scene.scheme());
    let theta_k = tableau.theta() * scene.time.step;
    let law = LawConstants::of(&friction, theta_k);
    let constants = |x: f64, y: f64| match &kept.model {
        KeptModel::Reduced(reduced) => {
            constants_of_compliance(&body.contact, &reduced.compliance(x, y))
        }
        KeptModel::Free(free) => constants_of_compliance(&body.contact, &free.compliance(x, y)),
        KeptModel::Whole(_) => factored_constants(body, cholesky, (x, y)),
    };
    let is_pinned = !body.contact.pins.is_empty();
    let of_strains = match (&kept.model, &body.strain) {
        // no strain measures a motion of the body as a whole
        _ if is_pinned => Constants::UNBOUNDED,
        (KeptModel::Free(free), _) => {
            constants_of_compliance(&body.contact, &free.strain_compliance())?
        }
        (_, StrainNorm::Combination(x, y)) => constants(*x, *y)?,
        (_, StrainNorm::Assembled(values)) => constants_of(body, cholesky, values)?,
    };
    let of_material = MaterialConstants::of(&body.forms, body.mesh.dimension);
    let mut certificate = certify(of_material, of_strains, law, theta_k, constants)?;
    // the operator of the contact without its pins has no inverse where that can open
    if is_pinned && !body.contact.gaps.is_empty() {
        certificate = certificate.without_proof();
    }
    let parts = Parts {
        kind: kept.kind,
        reduction: kept.reduction.clone(),
        contact: body.contact.clone(),
        measures: body.loads.iter().map(|l| l.measure).collect(),
        motions: Motions::of(scene, body),
        initial: InitialState::of(
            body,
            (kept.model.shared().nonlinear()).map_or(0.0, Nonlinear::start_potential),
        ),
        certificate,
        strain_weights: match (&kept.model, &body.strain) {
            (KeptModel::Free(_), _) | (_, StrainNorm::Assembled(_)) => None,
            (_, StrainNorm::Combination(x, y)) => Some((*x, *y)),
        },
        free: match &kept.model {
            KeptModel::Free(free) => FreeMaterial::new(scene, Arc::clone(free)),
            _ => None,
        },
        dimension: body.mesh.dimension,
        mesh_nodes: body.mesh.nodes.len(),
        mesh_cells: body.mesh.cell_count(),
        free_dofs: body.len(),
        rates: body.element_rates,
        selection,
        fallback: kept.fallback.clone(),
        lost_digits: kept.lost_digits,
        body: kept.model.shared(),
        files: files.clone(),
    };
    Model::new(scene, parts)
}

/// Nodes of every contact.
fn ranges(body: &Body) -> impl Iterator<Item = Range<usize>> {
    body.contact.parts.iter().map(|part| part.nodes.clone())
}
