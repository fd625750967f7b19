//! The fixed parameters: values of the scene that an importer may change before the initialization ends, each named by
//! its path in the scene. Changing one compiles the scene anew.

use serde_json::Value;
use stickslip::Scene;
use stickslip::scene::Inputs;

/// What values a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number with its SI unit; `1` for a number.
    Real(&'static str),
    /// A positive number that the scene need not have; 0 when it has none.
    Optional(&'static str),
    /// One of the words of [`CHOICES`]; its value is the place of the word, from 1.
    Choice(usize),
}

/// One fixed parameter.
#[derive(Debug)]
pub struct Parameter {
    pub path: &'static str,
    pub kind: Kind,
    /// Value where the scene has none.
    absent: f64,
    pub description: &'static str,
}

/// An enumeration type.
#[derive(Debug)]
pub struct Choices {
    pub name: &'static str,
    pub words: &'static [&'static str],
}

/// Enumeration types, in the words of the scene.
pub const CHOICES: [Choices; 5] = [
    Choices {
        name: "Scheme",
        words: &["trapezoid", "rectangle", "backward_euler", "tr_bdf2"],
    },
    Choices {
        name: "Start",
        words: &["consistent", "zero"],
    },
    Choices {
        name: "Model",
        words: &["full", "condensed", "reduced", "auto"],
    },
    Choices {
        name: "Convention",
        words: &[
            "kazmi2014",
            "plane_strain",
            "plane_stress",
            "three_dimensional",
        ],
    },
    Choices {
        name: "Inputs",
        words: &["end_of_step", "hold", "continue"],
    },
];

/// Number of the parameters that the model is compiled from: the first ones.
pub const COMPILED: usize = PARAMETERS.len() - 1;

/// Meanings of inputs, in the order of their words.
const MEANINGS: [Inputs; 3] = [Inputs::EndOfStep, Inputs::Hold, Inputs::Continue];
/// What inputs mean in an FMU of a scene that does not say: importers set them at the beginning of a step.
const MEANING: f64 = 3.0;

const fn parameter(path: &'static str, kind: Kind, description: &'static str) -> Parameter {
    Parameter {
        path,
        kind,
        absent: match kind {
            Kind::Real(_) => f64::NAN,
            Kind::Optional(_) | Kind::Choice(_) => 0.0,
        },
        description,
    }
}

/// All fixed parameters: the numbers first, then the choices, last what nothing is compiled from.
pub const PARAMETERS: [Parameter; 13] = [
    parameter(
        "time.step",
        Kind::Real("s"),
        "Largest internal step; a communication step is cut into equal internal steps no larger than this.",
    ),
    parameter(
        "time.tolerance",
        Kind::Optional("1"),
        "Error in time aimed at, of the slip rate relative to its largest norm so far: internal steps are then as small as it \
         asks for. 0: they are equal.",
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
    parameter(
        "material.viscosity.mu1",
        Kind::Real("Pa.s"),
        "Viscosity: coefficient of the trace.",
    ),
    parameter(
        "material.viscosity.mu2",
        Kind::Real("Pa.s"),
        "Viscosity: coefficient of the strain rate.",
    ),
    parameter(
        "material.elasticity.young",
        Kind::Real("Pa"),
        "Young's modulus.",
    ),
    parameter(
        "material.elasticity.poisson",
        Kind::Real("1"),
        "Poisson's ratio.",
    ),
    parameter("time.scheme", Kind::Choice(0), "Time scheme."),
    parameter("time.start", Kind::Choice(1), "Velocity at the start."),
    parameter(
        "fidelity.model",
        Kind::Choice(2),
        "What is kept of the body.",
    ),
    parameter(
        "material.elasticity.convention",
        Kind::Choice(3),
        "How the coefficient of the trace follows from Young's modulus and Poisson's ratio.",
    ),
    Parameter {
        path: "time.inputs",
        kind: Kind::Choice(4),
        absent: MEANING,
        description: "What an input set before a step is: the load at the end of the step (for importers that know it there, or \
                      iterate with rollback), the load at its beginning, held, or the same continued with its last slope.",
    },
];

/// Values of all parameters in a scene; choices by their place from 1 (0 for a word that is not among them).
pub fn values(scene: &Scene) -> Vec<f64> {
    let json = serde_json::to_value(scene).unwrap_or(Value::Null);
    let value_at = |parameter: &Parameter| {
        let found = json.pointer(&format!("/{}", parameter.path.replace('.', "/")));
        match parameter.kind {
            Kind::Real(_) | Kind::Optional(_) => found.and_then(Value::as_f64),
            Kind::Choice(list) => {
                let word = found.and_then(Value::as_str).unwrap_or("");
                let place = CHOICES[list].words.iter().position(|w| *w == word);
                place.map(|p| (p + 1) as f64)
            }
        }
        .unwrap_or(parameter.absent)
    };
    PARAMETERS.iter().map(value_at).collect()
}

/// What inputs mean with these values of the parameters.
pub fn inputs_meaning(values: &[f64]) -> Inputs {
    let place = values[COMPILED] as usize;
    MEANINGS[place.clamp(1, MEANINGS.len()) - 1]
}

/// Whether two sets of values give different models.
pub fn is_other_model(a: &[f64], b: &[f64]) -> bool {
    a[..COMPILED] != b[..COMPILED]
}

/// Place of a parameter among all, by its path in the scene.
pub fn place(path: &str) -> Option<usize> {
    PARAMETERS.iter().position(|p| p.path == path)
}

/// Whether a choice has a word at this place.
pub fn is_choice(parameter: usize, value: i64) -> bool {
    match PARAMETERS.get(parameter).map(|p| p.kind) {
        Some(Kind::Choice(list)) => value >= 1 && value as usize <= CHOICES[list].words.len(),
        _ => false,
    }
}

/// The changes of the model that lead from one set of values to another, as overrides of a scene.
pub fn overrides(from: &[f64], to: &[f64]) -> Vec<(String, String)> {
    let changed = PARAMETERS[..COMPILED]
        .iter()
        .zip(from.iter().zip(to))
        .filter(|(_, (a, b))| a != b);
    changed
        .map(|(parameter, (_, value))| {
            let text = match parameter.kind {
                Kind::Optional(_) if *value == 0.0 => "null".to_owned(),
                Kind::Real(_) | Kind::Optional(_) => format!("{value:?}"),
                Kind::Choice(list) => {
                    let words = CHOICES[list].words;
                    let word = words.get((*value as usize).wrapping_sub(1));
                    format!("\"{}\"", word.copied().unwrap_or_default())
                }
            };
            (parameter.path.to_owned(), text)
        })
        .collect()
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
        let before = values(&scene);
        for (value, parameter) in before.iter().zip(&PARAMETERS) {
            let is_absent = matches!(parameter.kind, Kind::Optional(_)) && *value == 0.0;
            assert!(is_absent || *value > 0.0, "{parameter:?}: {value}");
        }
        for (i, parameter) in PARAMETERS[..COMPILED].iter().enumerate() {
            let Kind::Choice(list) = parameter.kind else {
                assert!(i < 8, "numbers come first");
                continue;
            };
            for place in 1..=CHOICES[list].words.len() {
                let mut after = before.clone();
                after[i] = place as f64;
                if CHOICES[list].words[place - 1] == "three_dimensional" {
                    continue; // refused in 2D
                }
                let changed =
                    Scene::with_overrides(paper(), "kazmi2014", &overrides(&before, &after));
                assert_eq!(values(&changed.expect("a valid scene")), after);
            }
        }
    }

    /// Inputs mean the beginning of a step unless the scene says otherwise; every word is one of the scene.
    #[test]
    fn inputs_mean_what_the_scene_says() {
        let meaning_of = |scene: stickslip::Result<Scene>| {
            inputs_meaning(&values(&scene.expect("a valid scene")))
        };
        let silent = Scene::from_json(paper(), "kazmi2014");
        assert_eq!(meaning_of(silent), Inputs::Continue);
        for (word, meaning) in CHOICES[4].words.iter().zip(MEANINGS) {
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
        let before = values(&scene(&[]));
        let place = PARAMETERS.iter().position(|p| p.path == "time.tolerance");
        let place = place.expect("a parameter");
        assert_eq!(before[place], 0.0);
        let mut after = before.clone();
        after[place] = 1e-4;
        let changed = scene(&overrides(&before, &after));
        assert_eq!(changed.time.tolerance, Some(1e-4));
        assert_eq!(values(&changed), after);
        let back = scene(&[overrides(&before, &after), overrides(&after, &before)].concat());
        assert_eq!(back.time.tolerance, None);
    }
}
