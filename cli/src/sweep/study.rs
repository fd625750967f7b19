//! One sweep: the scene, its plan, and the models that its runs need.
//!
//! Most runs need no compilation: coefficients of friction are parameters of the model, and the run of a scene is not in it. What
//! changes time integration or solver shares the body; only the rest is compiled anew, once for all runs with these values.

use super::plan::Plan;
use super::record::Record;
use super::refuse;
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use stickslip::ports::Causality;
use stickslip::scene::Signal;
use stickslip::{Compilation, Files, Model, Result, Scene};

/// What a change at a path asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Effect {
    /// Setting a parameter of the model.
    Parameter(u32),
    /// Another run.
    Run,
    /// Another model of the same body.
    Model,
    /// Another body.
    Body,
}

type Models = HashMap<Vec<String>, Arc<OnceLock<Result<Arc<Model>>>>>;

/// A scene that is varied.
pub struct Study {
    scene: Scene,
    text: String,
    source_name: String,
    files: Box<dyn Files + Send + Sync>,
    pub plan: Plan,
    pub record: Record,
    effects: Vec<Effect>,
    base: Arc<Compilation>,
    /// What was compiled, or why not, by the values of the axes that it depends on; as long as runs need it.
    models: Mutex<Models>,
}

impl Study {
    /// Compiles the scene and checks that the runs with the ends of all axes are valid scenes.
    ///
    /// # Errors
    /// [`stickslip::Error::Scene`] for a value that the scene does not allow, and for an array that is recorded while the mesh
    /// changes; those of [`stickslip::compile_from`] and for a record of nothing.
    pub fn new(
        scene: &Scene,
        source_name: &str,
        files: Box<dyn Files + Send + Sync>,
        plan: Plan,
        record: &[String],
    ) -> Result<Study> {
        let text = scene.to_json();
        let axes = 0..plan.paths.len();
        let mut checked: Vec<usize> = axes.flat_map(|axis| extremes(&plan, axis)).collect();
        checked.sort_unstable();
        checked.dedup();
        for run in checked {
            let changes = plan.paths.iter().zip(&plan.points[run]);
            let changes: Vec<_> = changes.map(|(p, v)| (p.clone(), v.clone())).collect();
            Scene::with_overrides(&text, source_name, &changes)?;
        }
        let base = Compilation::with(scene, files.as_ref(), &mut |_| ControlFlow::Continue(()))?;
        let record = Record::new(record, &base.model)?;
        let effects: Vec<_> = plan.paths.iter().map(|p| effect(p, &base.model)).collect();
        if effects.contains(&Effect::Body) && !record.is_scalar() {
            let allowed =
                "scalar ports, where the body is varied: arrays may have another length there";
            return Err(refuse("record", "an array", allowed));
        }
        let columns = record.columns();
        if let Some(path) = plan.paths.iter().find(|path| columns.contains(path)) {
            return Err(refuse("record", path, "what is not varied"));
        }
        Ok(Study {
            scene: base.scene.clone(),
            text: base.scene.to_json(),
            source_name: source_name.to_owned(),
            files,
            plan,
            record,
            effects,
            base: Arc::new(base),
            models: Mutex::default(),
        })
    }

    /// The scene as JSON.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What errors call the scene.
    pub fn source_name(&self) -> &str {
        &self.source_name
    }

    /// The values of an axis in all runs: numbers, or the texts where they are not all numbers.
    ///
    /// # Errors
    /// The texts.
    pub fn axis(&self, axis: usize) -> std::result::Result<Vec<f64>, Vec<String>> {
        let texts = || self.plan.points.iter().map(|point| &point[axis]);
        let numbers: Option<Vec<f64>> = texts().map(|text| text.parse().ok()).collect();
        numbers.ok_or_else(|| texts().cloned().collect())
    }

    /// Runs in the order in which they are best taken: those that share a model follow each other.
    pub fn order(&self, mut runs: Vec<usize>) -> Vec<usize> {
        let mut first = HashMap::new();
        for run in &runs {
            first.entry(self.key(*run)).or_insert(*run);
        }
        runs.sort_by_cached_key(|run| (first[&self.key(*run)], *run));
        runs
    }

    /// Values of the axes that the model of a run depends on.
    pub fn key(&self, run: usize) -> Vec<String> {
        let axes = self.effects.iter().zip(&self.plan.points[run]);
        axes.filter(|(effect, _)| matches!(effect, Effect::Body | Effect::Model))
            .map(|(_, value)| value.clone())
            .collect()
    }

    /// The model of a run. Who asks first compiles it, and the others wait.
    ///
    /// # Errors
    /// Why there is none.
    pub fn model(&self, run: usize) -> Result<Arc<Model>> {
        let key = self.key(run);
        if key.is_empty() {
            return Ok(Arc::clone(&self.base.model));
        }
        let shared = Arc::clone(self.models().entry(key).or_default());
        shared.get_or_init(|| self.compile(run)).clone()
    }

    /// No run that is to come needs the model of this one.
    pub fn forget(&self, run: usize) {
        self.models().remove(&self.key(run));
    }

    fn models(&self) -> MutexGuard<'_, Models> {
        self.models.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn compile(&self, run: usize) -> Result<Arc<Model>> {
        let is_compiled = |effect| matches!(effect, Effect::Body | Effect::Model);
        let scene = self.changed(run, is_compiled)?;
        if self.effects.contains(&Effect::Body) {
            return stickslip::compile_from(&scene, self.files.as_ref());
        }
        self.base.restepped(&scene)
    }

    /// The scene whose run is taken.
    ///
    /// # Errors
    /// [`stickslip::Error::Scene`].
    pub fn course(&self, run: usize) -> Result<Scene> {
        let mut scene = self.scene.clone();
        let mut has_all = true;
        for (path, value) in self.changes(run, |effect| effect == Effect::Run) {
            let number = value.parse::<f64>().ok().filter(|v| v.is_finite());
            match (path.as_str(), path.strip_prefix("run.signals."), number) {
                ("run.until", _, Some(until)) if until > 0.0 => scene.run.until = until,
                ("run.step", _, Some(step)) if step > 0.0 => scene.run.step = Some(step),
                (_, Some(name), Some(value)) if scene.inputs().any(|(known, _)| known == name) => {
                    let signal = Signal::Constant(value);
                    scene.run.signals.insert(name.to_owned(), signal);
                }
                _ => has_all = false,
            }
        }
        match has_all {
            true => Ok(scene),
            false => self.changed(run, |effect| effect == Effect::Run),
        }
    }

    /// References and values of the parameters that are set for a run.
    ///
    /// # Errors
    /// [`stickslip::Error::Scene`] for what is no number.
    pub fn parameters(&self, run: usize, model: &Model) -> Result<(Vec<u32>, Vec<f64>)> {
        let (mut references, mut values) = (Vec::new(), Vec::new());
        let axes = self.effects.iter().zip(&self.plan.paths);
        for ((effect, path), text) in axes.zip(&self.plan.points[run]) {
            let Effect::Parameter(reference) = effect else {
                continue;
            };
            let value = text.parse::<f64>();
            let value = value.map_err(|_| refuse(path, text, "a number"))?;
            let len = model.ports().get(*reference)?.len();
            references.push(*reference);
            values.extend(std::iter::repeat_n(value, len));
        }
        Ok((references, values))
    }

    fn changes(&self, run: usize, is_meant: impl Fn(Effect) -> bool) -> Vec<(String, String)> {
        let axes = self.effects.iter().zip(&self.plan.paths);
        let axes = axes.zip(&self.plan.points[run]);
        axes.filter(|((effect, _), _)| is_meant(**effect))
            .map(|((_, path), value)| (path.clone(), value.clone()))
            .collect()
    }

    fn changed(&self, run: usize, is_meant: impl Fn(Effect) -> bool) -> Result<Scene> {
        let changes = self.changes(run, is_meant);
        Scene::with_overrides(&self.text, &self.source_name, &changes)
    }
}

/// What a change at a path asks for.
fn effect(path: &str, model: &Model) -> Effect {
    let port = model.ports().find(path).ok();
    if let Some(port) = port.filter(|port| port.causality == Causality::Parameter) {
        return Effect::Parameter(port.reference);
    }
    let is_in = |prefix: &str| path == prefix || path.starts_with(&format!("{prefix}."));
    let of_model = ["time", "fidelity.solver", "fidelity.friction_tolerance"];
    if is_in("run") {
        Effect::Run
    } else if of_model.iter().any(|prefix| is_in(prefix)) {
        Effect::Model
    } else {
        Effect::Body
    }
}

/// Runs with the least and the largest number of an axis, and the first ones with each text.
fn extremes(plan: &Plan, axis: usize) -> Vec<usize> {
    let mut ends: Option<[(f64, usize); 2]> = None;
    let mut texts = HashMap::new();
    for (run, point) in plan.points.iter().enumerate() {
        let Ok(number) = point[axis].parse::<f64>() else {
            texts.entry(&point[axis]).or_insert(run);
            continue;
        };
        let [least, largest] = ends.get_or_insert([(number, run); 2]);
        if number < least.0 {
            *least = (number, run);
        }
        if number > largest.0 {
            *largest = (number, run);
        }
    }
    let ends = ends.into_iter().flatten().map(|(_, run)| run);
    ends.chain(texts.into_values()).collect()
}
