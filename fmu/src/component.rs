//! What the instances of an FMU share: the scene with its parameters, the compiled model, the variables.

use crate::fault::{Fault, Outcome};
use crate::parameters::is_other_model;
use crate::variables::Variables;
use std::path::Path;
use std::sync::Arc;
use stickslip::{Model, Scene, compile_from};
use xxhash_rust::xxh3::{xxh3_64, xxh3_128};

/// Name of the scene in the resources of an FMU.
pub const SCENE_FILE: &str = "scene.json";
/// Name of the compiled model in the resources of an FMU.
pub const MODEL_FILE: &str = "model.bin";

/// Gives the component of a key, made by the function when no instance of the process has it.
pub type Share = fn(u64, &mut dyn FnMut() -> Outcome<Component>) -> Outcome<Arc<Component>>;

/// A compiled scene, immutable and shared.
pub struct Component {
    /// The scene of the FMU, before parameters were changed.
    scene_text: String,
    pub model: Arc<Model>,
    pub variables: Variables,
    /// Values of the fixed parameters that it was compiled with; what inputs mean belongs to each instance.
    pub parameters: Vec<f64>,
    /// Values of the fixed parameters of the FMU.
    origin: Vec<f64>,
}

impl Component {
    /// Of a scene text and its model.
    pub fn new(scene_text: String, model: Arc<Model>) -> Component {
        let variables = Variables::new(&model);
        let parameters = variables.parameters().values(model.scene());
        Component {
            scene_text,
            variables,
            origin: parameters.clone(),
            parameters,
            model,
        }
    }

    /// From the resources of an FMU.
    pub fn load(resources: &Path, token_expected: &str, share: Share) -> Outcome<Arc<Component>> {
        let read = |name: &str| {
            let path = resources.join(name);
            std::fs::read(&path).map_err(|e| Fault::error(format!("{}: {e}", path.display())))
        };
        let text = String::from_utf8(read(SCENE_FILE)?)
            .map_err(|_| Fault::error(format!("{SCENE_FILE} in the resources is not UTF-8")))?;
        let token = token(&text);
        if token_expected != token {
            return Err(Fault::error(format!(
                "the FMU was asked for as {token_expected:?}, but this is {token:?}: model description and resources do \
                 not belong together"
            )));
        }
        let bytes = read(MODEL_FILE)?;
        share(xxh3_64(&bytes), &mut || {
            let model = Arc::new(Model::from_bytes(&bytes)?);
            Ok(Component::new(text.clone(), model))
        })
    }

    /// The numbers of a material that stays free, where no other fixed parameter than these differs from those of the FMU.
    pub fn free_values(&self, values: &[f64]) -> Option<Vec<f64>> {
        let parameters = self.variables.parameters();
        let numbers = self.model.free_numbers().iter();
        let places: Vec<usize> = numbers
            .map(|number| parameters.place(&number.path))
            .collect::<Option<_>>()?;
        let mut others = values.to_vec();
        for place in &places {
            others[*place] = self.origin[*place];
        }
        let is_free = !places.is_empty() && !is_other_model(&others, &self.origin);
        is_free.then(|| places.iter().map(|place| values[*place]).collect())
    }

    /// The same FMU with other values of the fixed parameters.
    pub fn with_parameters(&self, values: &[f64], share: Share) -> Outcome<Arc<Component>> {
        let mut changes = self.variables.parameters().overrides(&self.origin, values);
        // the variables of an FMU do not change: an output that follows from a parameter stays as it was packed
        let has_estimate = self.model.scene().time.estimates_error();
        changes.push(("time.error_estimate".into(), has_estimate.to_string()));
        let mut key = self.scene_text.clone();
        for (path, value) in &changes {
            key.push_str(path);
            key.push_str(value);
        }
        let of_material = self.free_values(values);
        share(xxh3_64(key.as_bytes()), &mut || {
            if let Some(numbers) = &of_material {
                return Ok(Component {
                    scene_text: self.scene_text.clone(),
                    variables: Variables::new(&self.model),
                    parameters: values.to_vec(),
                    origin: self.origin.clone(),
                    model: self.model.with_material(numbers)?,
                });
            }
            let scene = Scene::with_overrides(&self.scene_text, SCENE_FILE, &changes)?;
            // with the files that it carries
            let model = compile_from(&scene, self.model.files())?;
            Ok(Component {
                scene_text: self.scene_text.clone(),
                variables: Variables::new(&model),
                parameters: values.to_vec(),
                origin: self.origin.clone(),
                model,
            })
        })
    }
}

/// Token of the FMU of a scene text: a hash of the text and of the version of this library, written as a UUID.
pub fn token(scene_text: &str) -> String {
    let text = format!("stickslip {} {scene_text}", env!("CARGO_PKG_VERSION"));
    let hex = format!("{:032x}", xxh3_128(text.as_bytes()));
    let (a, b, c, d, e) = (
        &hex[..8],
        &hex[8..12],
        &hex[12..16],
        &hex[16..20],
        &hex[20..],
    );
    format!("{{{a}-{b}-{c}-{d}-{e}}}")
}
