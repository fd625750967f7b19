//! The fixed parameters: values of the scene that an importer may change before the initialization ends, each named by
//! its path in the scene. Changing one compiles the scene anew.

use serde_json::Value;
use stickslip::Scene;
use stickslip::material::{self, ParameterKind};
use stickslip::scene::Inputs;

/// What values a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number with its SI unit; `1` for a number.
    Real(&'static str),
    /// A positive number that the scene need not have; 0 when it has none.
    Optional(&'static str),
    /// One of the words of [`choices`]; its value is the place of the word, from 1.
    Choice(usize),
}

/// One fixed parameter.
#[derive(Debug, Clone)]
pub struct Parameter {
    pub path: String,
    pub kind: Kind,
    /// Value where the scene has none.
    absent: f64,
    pub description: &'static str,
}

/// An enumeration type.
#[derive(Debug, Clone, Copy)]
pub struct Choices {
    pub name: &'static str,
    pub words: &'static [&'static str],
}

const SCHEME: Choices = Choices {
    name: "Scheme",
    words: &["trapezoid", "rectangle", "backward_euler", "tr_bdf2"],
};
const START: Choices = Choices {
    name: "Start",
    words: &["consistent", "zero"],
};
const MODEL: Choices = Choices {
    name: "Model",
    words: &["full", "condensed", "reduced", "auto"],
};
const INPUTS: Choices = Choices {
    name: "Inputs",
    words: &["end_of_step", "hold", "continue"],
};

/// Enumeration types, in the words of the scene: those of the integration, of the material laws, of the inputs.
pub fn choices() -> Vec<Choices> {
    let of_materials = material::CHOICES.iter().map(|choice| Choices {
        name: choice.name,
        words: choice.words,
    });
    [SCHEME, START, MODEL]
        .into_iter()
        .chain(of_materials)
        .chain([INPUTS])
        .collect()
}

/// Place of an enumeration type among all.
fn choice(name: &str) -> Kind {
    let place = choices().iter().position(|choice| choice.name == name);
    Kind::Choice(place.unwrap_or_default())
}

/// Meanings of inputs, in the order of their words.
const MEANINGS: [Inputs; 3] = [Inputs::EndOfStep, Inputs::Hold, Inputs::Continue];
/// What inputs mean in an FMU of a scene that does not say: importers set them at the beginning of a step.
const MEANING: f64 = 3.0;

fn parameter(path: &str, kind: Kind, description: &'static str) -> Parameter {
    Parameter {
        path: path.to_owned(),
        kind,
        absent: match kind {
            Kind::Real(_) => f64::NAN,
            Kind::Optional(_) | Kind::Choice(_) => 0.0,
        },
        description,
    }
}

/// The fixed parameters of a scene: the numbers first, then the choices, last what nothing is compiled from.
#[derive(Debug, Clone)]
pub struct Parameters {
    list: Vec<Parameter>,
}

impl Parameters {
    /// Those of every scene, and the values of its materials.
    pub fn of(scene: &Scene) -> Parameters {
        let mut list = vec![
            parameter(
                "time.step",
                Kind::Real("s"),
                "Largest internal step; a communication step is cut into equal internal steps no larger than this.",
            ),
            parameter(
                "time.tolerance",
                Kind::Optional("1"),
                "Error in time aimed at, of the slip rate relative to its largest norm so far: internal steps are then as \
                 small as it asks for. 0: they are equal.",
            ),
            parameter(
                "fidelity.tolerance",
                Kind::Real("1"),
                "Relative error of the reduced body seen through its ports; a smaller one keeps more states.",
            ),
            parameter(
                "fidelity.friction_tolerance",
                Kind::Real("1"),
                "Force by which the friction law may be violated at a contact node, relative to the bound there.",
            ),
        ];
        let mut chosen = vec![
            parameter("time.scheme", choice(SCHEME.name), "Time scheme."),
            parameter("time.start", choice(START.name), "Velocity at the start."),
            parameter(
                "fidelity.model",
                choice(MODEL.name),
                "What is kept of the body.",
            ),
        ];
        for (path, declared) in scene.material_parameters() {
            match declared.kind {
                ParameterKind::Number(unit) => {
                    list.push(parameter(&path, Kind::Real(unit), declared.text));
                }
                ParameterKind::Choice(of) => {
                    chosen.push(parameter(&path, choice(of.name), declared.text));
                }
            }
        }
        list.append(&mut chosen);
        list.push(Parameter {
            absent: MEANING,
            ..parameter(
                "time.inputs",
                choice(INPUTS.name),
                "What an input set before a step is: the load at the end of the step (for importers that know it there, or \
                 iterate with rollback), the load at its beginning, held, or the same continued with its last slope.",
            )
        });
        Parameters { list }
    }

    pub fn all(&self) -> &[Parameter] {
        &self.list
    }

    /// Values of all parameters in a scene; choices by their place from 1 (0 for a word that is not among them).
    pub fn values(&self, scene: &Scene) -> Vec<f64> {
        let json = serde_json::to_value(scene).unwrap_or(Value::Null);
        let choices = choices();
        let value_at = |parameter: &Parameter| {
            let found = json.pointer(&pointer(&parameter.path));
            match parameter.kind {
                Kind::Real(_) | Kind::Optional(_) => found.and_then(Value::as_f64),
                Kind::Choice(list) => {
                    let word = found.and_then(Value::as_str).unwrap_or("");
                    let place = choices[list].words.iter().position(|w| *w == word);
                    place.map(|p| (p + 1) as f64)
                }
            }
            .unwrap_or(parameter.absent)
        };
        self.list.iter().map(value_at).collect()
    }

    /// Place of a parameter among all, by its path in the scene.
    pub fn place(&self, path: &str) -> Option<usize> {
        self.list.iter().position(|p| p.path == path)
    }

    /// Whether a choice has a word at this place.
    pub fn is_choice(&self, parameter: usize, value: i64) -> bool {
        match self.list.get(parameter).map(|p| p.kind) {
            Some(Kind::Choice(list)) => value >= 1 && value as usize <= choices()[list].words.len(),
            _ => false,
        }
    }

    /// The changes of the model that lead from one set of values to another, as overrides of a scene.
    pub fn overrides(&self, from: &[f64], to: &[f64]) -> Vec<(String, String)> {
        let choices = choices();
        let compiled = &self.list[..self.list.len() - 1];
        let changed = compiled
            .iter()
            .zip(from.iter().zip(to))
            .filter(|(_, (a, b))| a != b);
        changed
            .map(|(parameter, (_, value))| {
                let text = match parameter.kind {
                    Kind::Optional(_) if *value == 0.0 => "null".to_owned(),
                    Kind::Real(_) | Kind::Optional(_) => format!("{value:?}"),
                    Kind::Choice(list) => {
                        let words = choices[list].words;
                        let word = words.get((*value as usize).wrapping_sub(1));
                        format!("\"{}\"", word.copied().unwrap_or_default())
                    }
                };
                (parameter.path.clone(), text)
            })
            .collect()
    }
}

/// JSON pointer of a path: `materials[1].viscosity` is `/materials/1/viscosity`.
fn pointer(path: &str) -> String {
    let keys = path.replace(']', "").replace(['.', '['], "/");
    format!("/{keys}")
}

/// What inputs mean with these values of the parameters: the last one.
pub fn inputs_meaning(values: &[f64]) -> Inputs {
    let place = values.last().map_or(0, |value| *value as usize);
    MEANINGS[place.clamp(1, MEANINGS.len()) - 1]
}

/// Whether two sets of values give different models: the model is compiled from all but the last.
pub fn is_other_model(a: &[f64], b: &[f64]) -> bool {
    a[..a.len().saturating_sub(1)] != b[..b.len().saturating_sub(1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> &'static str {
        stickslip::scene::example("kazmi2014").expect("an embedded scene")
    }

    /// Each word of the enumerations is one that scenes accept, and each number is found in the scene.
    #[test]
    fn parameters_are_values_of_the_scene() {
        let scene = Scene::from_json(paper(), "kazmi2014").expect("a valid scene");
        let parameters = Parameters::of(&scene);
        let before = parameters.values(&scene);
        let choices = choices();
        assert_eq!(before.len(), 13);
        for (value, parameter) in before.iter().zip(parameters.all()) {
            let is_absent = matches!(parameter.kind, Kind::Optional(_)) && *value == 0.0;
            assert!(is_absent || *value > 0.0, "{parameter:?}: {value}");
        }
        for (i, parameter) in parameters.all()[..12].iter().enumerate() {
            let Kind::Choice(list) = parameter.kind else {
                assert!(i < 8, "numbers come first");
                continue;
            };
            for place in 1..=choices[list].words.len() {
                let mut after = before.clone();
                after[i] = place as f64;
                if choices[list].words[place - 1] == "three_dimensional" {
                    continue; // refused in 2D
                }
                let changed = Scene::with_overrides(
                    paper(),
                    "kazmi2014",
                    &parameters.overrides(&before, &after),
                );
                assert_eq!(parameters.values(&changed.expect("a valid scene")), after);
            }
        }
    }

    /// Inputs mean the beginning of a step unless the scene says otherwise; every word is one of the scene.
    #[test]
    fn inputs_mean_what_the_scene_says() {
        let meaning_of = |scene: stickslip::Result<Scene>| {
            let scene = scene.expect("a valid scene");
            inputs_meaning(&Parameters::of(&scene).values(&scene))
        };
        let silent = Scene::from_json(paper(), "kazmi2014");
        assert_eq!(meaning_of(silent), Inputs::Continue);
        for (word, meaning) in INPUTS.words.iter().zip(MEANINGS) {
            let change = [("time.inputs".to_owned(), format!("\"{word}\""))];
            let scene = Scene::with_overrides(paper(), "kazmi2014", &change);
            assert_eq!(meaning_of(scene), meaning);
        }
    }

    /// A number that the scene has not comes and goes.
    #[test]
    fn optional_parameters_are_set_and_removed() {
        let scene = |changes: &[(String, String)]| {
            Scene::with_overrides(paper(), "kazmi2014", changes).expect("a valid scene")
        };
        let parameters = Parameters::of(&scene(&[]));
        let values = |scene: &Scene| parameters.values(scene);
        let overrides = |from: &[f64], to: &[f64]| parameters.overrides(from, to);
        let before = values(&scene(&[]));
        let place = parameters.place("time.tolerance").expect("a parameter");
        assert_eq!(before[place], 0.0);
        let mut after = before.clone();
        after[place] = 1e-4;
        let changed = scene(&overrides(&before, &after));
        assert_eq!(changed.time.tolerance, Some(1e-4));
        assert_eq!(values(&changed), after);
        let back = scene(&[overrides(&before, &after), overrides(&after, &before)].concat());
        assert_eq!(back.time.tolerance, None);
    }

    /// Materials by region have parameters by their paths in the scene, numbers and choices apart.
    #[test]
    fn materials_by_region_have_parameters_of_their_own() {
        let mut json: Value = serde_json::from_str(paper()).expect("JSON");
        let material = json["material"].take();
        json.as_object_mut().expect("a scene").remove("material");
        json["mesh"]["regions"] =
            serde_json::json!([{"name": "low", "from": [0.0, 0.0], "to": [1.0, 0.25]}]);
        let of = |region: &str| {
            let mut material = material.clone();
            material["region"] = region.into();
            material
        };
        json["materials"] = [of("low"), of("body")].into_iter().collect();
        let text = json.to_string();
        let scene = Scene::from_json(&text, "two").expect("a valid scene");
        let parameters = Parameters::of(&scene);
        let before = parameters.values(&scene);
        assert_eq!(before.len(), 13 + 5);
        let mut after = before.clone();
        let place = |path: &str| parameters.place(path).expect("a parameter");
        after[place("materials[1].elasticity.young")] = 2.5;
        after[place("materials[0].elasticity.convention")] = 2.0;
        let changes = parameters.overrides(&before, &after);
        let changed = Scene::with_overrides(&text, "two", &changes).expect("a valid scene");
        assert_eq!(parameters.values(&changed), after);
        assert_eq!(changed.materials[0].viscosity, scene.materials[0].viscosity);
        assert_ne!(
            changed.materials[0].elasticity,
            scene.materials[0].elasticity
        );
    }

    /// Elements of lists are parameters of their own, named by their places.
    #[test]
    fn lists_of_a_material_have_a_parameter_per_element() {
        let mut json: Value = serde_json::from_str(paper()).expect("JSON");
        json["material"]["elasticity"] = serde_json::json!({
            "law": "orthotropic", "young": [4.0, 1.0, 2.0], "poisson": [0.3, 0.2, 0.4], "shear": [0.4, 0.7, 0.5],
            "angle_deg": 30.0, "convention": "plane_strain", "gradient": [0.1, 0.2],
        });
        json["material"]["viscosity"] = serde_json::json!({
            "law": "matrix", "matrix": [[0.3, 0.1, 0.0], [0.1, 0.2, 0.0], [0.0, 0.0, 0.1]],
        });
        let text = json.to_string();
        let scene = Scene::from_json(&text, "lists").expect("a valid scene");
        let parameters = Parameters::of(&scene);
        let before = parameters.values(&scene);
        assert!(before.iter().all(|value| value.is_finite()));
        let place = |path: &str| parameters.place(path).expect("a parameter");
        assert_eq!(before[place("material.elasticity.poisson[2]")], 0.4);
        let unit = |path: &str| parameters.all()[place(path)].kind;
        assert_eq!(unit("material.viscosity.matrix[0][1]"), Kind::Real("Pa.s"));
        assert_eq!(unit("material.elasticity.shear[0]"), Kind::Real("Pa"));
        let mut after = before.clone();
        for (path, value) in [
            ("material.elasticity.young[1]", 1.5),
            ("material.elasticity.angle_deg", -20.0),
            ("material.elasticity.gradient[0]", 0.3),
            ("material.elasticity.convention", 3.0),
            ("material.viscosity.matrix[0][1]", 0.05),
            ("material.viscosity.matrix[1][0]", 0.05),
        ] {
            after[place(path)] = value;
        }
        let changes = parameters.overrides(&before, &after);
        let changed = Scene::with_overrides(&text, "lists", &changes).expect("a valid scene");
        assert_eq!(parameters.values(&changed), after);
        assert_ne!(changed.material, scene.material);
    }
}
