//! A study of one scene: settings compiled, run and compared.

use super::errors::{Errors, errors};
use super::setting::Setting;
use super::surface::Surface;
use super::trajectory::{Trajectory, run};
use crate::error::{Error, Result};
use crate::files::NoFiles;
use crate::model::{Compilation, Model};
use crate::progress::Watch;
use crate::scene::{Fidelity, History, Interpolation, Run, Scene, Scheme, Signal, Start, Time};
use crate::simulator::course::Points;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::{Arc, Weak};

/// Exponent of the tightest tolerance of the reduction that is tried.
const TIGHTEST: i32 = -10;
/// Communication steps of the scene that the coarsest setting joins to one.
const COARSENING: u64 = 4;

/// A scene whose settings are compared at common instants.
pub struct Study {
    scene: Scene,
    /// Time between two instants, s.
    interval: f64,
    /// The bodies that some candidate still holds.
    bodies: BTreeMap<String, Weak<Body>>,
}

/// A compiled body and its contact surface, shared by all settings that do not change it.
struct Body {
    compilation: Compilation,
    surface: Arc<Surface>,
}

/// A setting, compiled. Its body is shared with the candidates that are compiled while this one lives.
#[derive(Clone)]
pub struct Candidate {
    pub scene: Scene,
    pub model: Arc<Model>,
    body: Arc<Body>,
    stride: u64,
}

/// A run of a setting.
#[derive(Clone)]
pub struct Sample {
    pub trajectory: Trajectory,
    surface: Arc<Surface>,
}

impl Study {
    /// A study of a scene on its own signals; a target in it plays no part.
    ///
    /// # Errors
    /// [`Error::Scene`] for a coefficient of friction that is given per contact node, which belongs to one mesh, and for a mesh from a
    /// file.
    pub fn new(scene: &Scene) -> Result<Study> {
        if let Some(path) = scene.nodal_coefficient() {
            return Err(Error::Scene {
                source_name: "scene".into(),
                path,
                found: "one number per contact node, which belongs to one mesh".into(),
                allowed: "a number, in scenes whose meshes are compared".into(),
            });
        }
        if scene.mesh.grid().is_none() {
            return Err(Error::Scene {
                source_name: "scene".into(),
                path: "mesh.kind".into(),
                found: "a mesh from a file, whose cells cannot be varied".into(),
                allowed: "\"rectangle\" or \"box\", in scenes whose meshes are compared".into(),
            });
        }
        let mut scene = scene.clone();
        scene.fidelity.target_error = None;
        let step = Points::of(&scene).step;
        let coarsening = match has_free_communication(&scene) {
            true => COARSENING,
            false => 1,
        };
        Ok(Study {
            scene,
            interval: step * coarsening as f64,
            bodies: BTreeMap::new(),
        })
    }

    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Longest internal step worth trying, s: the time between two instants.
    pub fn interval(&self) -> f64 {
        self.interval
    }

    /// Communication step of the scene, s.
    pub fn communication_step(&self) -> f64 {
        Points::of(&self.scene).step
    }

    /// Compiles a setting; a body that another candidate holds is not compiled again.
    ///
    /// # Errors
    /// Those of [`crate::compile`], and [`Error::Step`] for a communication step that does not divide the interval.
    pub fn compile(&mut self, setting: &Setting) -> Result<Candidate> {
        let scene = setting.apply(&self.scene)?;
        let step = Points::of(&scene).step;
        let stride = (self.interval / step).round().max(1.0);
        if (stride * step / self.interval - 1.0).abs() > 1e-9 {
            return Err(Error::Step {
                what: "communication step (must divide the time between compared instants)",
                expected: self.interval,
                found: step,
            });
        }
        let key = body_key(&scene);
        self.bodies.retain(|_, body| body.strong_count() > 0);
        let (body, model) = match self.bodies.get(&key).and_then(Weak::upgrade) {
            Some(body) => {
                let model = body.compilation.again(&scene)?;
                (body, model)
            }
            None => {
                let silent = &mut |_| ControlFlow::Continue(());
                let compilation =
                    Compilation::resolved(scene.clone(), &NoFiles, None, &mut Watch::new(silent))?;
                let surface = Arc::new(Surface::of(&scene, &compilation.body)?);
                let model = Arc::clone(&compilation.model);
                let body = Arc::new(Body {
                    compilation,
                    surface,
                });
                self.bodies.insert(key, Arc::downgrade(&body));
                (body, model)
            }
        };
        Ok(Candidate {
            model,
            body,
            stride: stride as u64,
            scene,
        })
    }

    /// What tells bodies apart: equal for settings that share one.
    ///
    /// # Errors
    /// [`Error::Scene`] for a setting that the scene refuses.
    pub fn body_of(&self, setting: &Setting) -> Result<String> {
        setting.apply(&self.scene).map(|scene| body_key(&scene))
    }
}

/// The setting with the loosest tolerance of the reduction that will do, and what `compile` makes of it: every other power of
/// ten from `10^loosest` down is tried while `goes_on`, for a mesh may be reduced to a tighter one and not to a looser one.
///
/// # Errors
/// Those of `compile`, with the tolerance tried last where none will do.
pub fn loosest_reduction<T>(
    setting: &Setting,
    loosest: i32,
    goes_on: impl Fn() -> bool,
    mut compile: impl FnMut(&Setting) -> Result<T>,
) -> Result<(Setting, T)> {
    let mut exponent = loosest.clamp(TIGHTEST, -2);
    loop {
        let reduced = setting
            .clone()
            .with("fidelity.tolerance", format!("1e{exponent}"));
        match compile(&reduced) {
            Err(
                Error::ReductionInaccurate { .. } | Error::LostDigits { .. } | Error::Body { .. },
            ) if exponent > TIGHTEST && goes_on() => {
                exponent = (exponent - 2).max(TIGHTEST);
            }
            outcome => return outcome.map(|model| (reduced, model)),
        }
    }
}

impl Candidate {
    /// Multiplications of a run without any friction iteration and with the longest steps.
    pub fn least_multiplications(&self) -> f64 {
        let points = Points::of(&self.scene);
        // steps that a tolerance chooses come in pairs
        let at_once = self.model.tolerance().map_or(1.0, |_| 2.0);
        let parts = points.step / (at_once * self.model.largest_step()) * (1.0 - 1e-9);
        let stages = at_once * self.model.tableau().stages().len() as f64;
        let per_step = parts.ceil().max(1.0) * stages * self.model.stage_multiplications() as f64;
        points.count as f64 * per_step
    }

    /// Runs the setting to the end of the scene.
    ///
    /// # Errors
    /// Those of the simulator.
    pub fn run(&self) -> Result<Sample> {
        Ok(Sample {
            trajectory: run(&self.scene, &self.model, self.stride)?,
            surface: Arc::clone(&self.body.surface),
        })
    }
}

impl Sample {
    /// Errors against a better run of the same study.
    ///
    /// # Errors
    /// [`Error::Value`] for a run of another study.
    pub fn errors(&self, reference: &Sample) -> Result<Errors> {
        errors(
            (&self.trajectory, &self.surface),
            (&reference.trajectory, &reference.surface),
        )
    }
}

/// Whether longer communication steps leave the problem the same: the scene does not fix them, and no input is held over
/// them while it changes.
fn has_free_communication(scene: &Scene) -> bool {
    let changes = |name: &String| match scene.run.signals.get(name) {
        Some(Signal::Table(points)) => points.len() > 1,
        Some(Signal::Constant(_)) | None => false,
    };
    scene.run.step.is_none()
        && scene
            .loads
            .iter()
            .all(|l| l.interpolation == Interpolation::Linear || !changes(&l.name))
}

/// Equal for scenes that give the same body.
fn body_key(scene: &Scene) -> String {
    let mut key = scene.clone();
    key.time = Time {
        scheme: Scheme::default(),
        start: Start::default(),
        step: 1.0,
        tolerance: None,
        error_estimate: None,
        inputs: None,
        force: false,
    };
    let fidelity = Fidelity::default();
    key.fidelity.friction_tolerance = fidelity.friction_tolerance;
    key.fidelity.solver = fidelity.solver;
    key.fidelity.multiplicity_test = fidelity.multiplicity_test;
    key.fidelity.uniqueness = fidelity.uniqueness;
    key.fidelity.work_limit = fidelity.work_limit;
    key.history = History::default();
    key.run = Run::default();
    key.to_json()
}
