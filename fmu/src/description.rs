//! `modelDescription.xml` of both versions, and the terminals: written from the variables and from a fresh simulator, so
//! that start values are those of a fresh instance.

mod version2;
mod version3;

use crate::component::token;
use crate::log::Category;
use crate::variables::{Follows, Role, Variable, Variables};
use crate::xml::Xml;
use std::collections::BTreeSet;
use std::sync::Arc;
use stickslip::simulator::course::Points;
use stickslip::{Model, Scene, Simulator};

/// Name of the shared library, without prefix and suffix.
pub const MODEL_IDENTIFIER: &str = "stickslip_fmu";

/// Version of FMI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FmiVersion {
    Fmi2,
    Fmi3,
}

/// Units that others are products of, by their base units: name, exponents of [`BASES`].
const UNITS: [(&str, [i32; 4]); 6] = [
    ("s", [0, 0, 1, 0]),
    ("m", [0, 1, 0, 0]),
    ("rad", [0, 0, 0, 1]),
    ("Pa", [1, -1, -2, 0]),
    ("N", [1, 1, -2, 0]),
    ("J", [1, 2, -2, 0]),
];
const BASES: [&str; 4] = ["kg", "m", "s", "rad"];

/// Exponents of [`BASES`] of a unit: factors with dots between them, a digit after a factor that is a power, after a slash
/// those that divide. `None` where it has a factor that is not known.
fn exponents(unit: &str) -> Option<[i32; 4]> {
    let mut sum = [0; 4];
    for (sign, factors) in [1, -1].into_iter().zip(unit.split('/')) {
        for factor in factors.split('.') {
            // a unit that only divides
            if factor == "1" && unit != "1" {
                continue;
            }
            let name = factor.trim_end_matches(|c: char| c.is_ascii_digit());
            let power = factor[name.len()..].parse().unwrap_or(1);
            let (_, known) = UNITS.iter().find(|(known, _)| *known == name)?;
            for (sum, exponent) in sum.iter_mut().zip(known) {
                *sum += sign * power * exponent;
            }
        }
    }
    Some(sum)
}

/// What a description is written from.
struct Source<'a> {
    /// With its own run.
    scene: &'a Scene,
    variables: Variables,
    /// Values of a fresh instance.
    start: Vec<f64>,
    token: String,
    date: &'a str,
    /// FMI 3: one scalar per element.
    is_scalar: bool,
}

impl Source<'_> {
    /// Start values of the places from `first` on, with blanks between them.
    fn start_of(&self, first: usize, len: usize) -> String {
        let values = self.start[first..first + len].iter();
        let values: Vec<String> = values.map(|value| format!("{value:?}")).collect();
        values.join(" ")
    }
}

/// Values of a fresh instance, in the order of the variables.
pub fn start_values(model: &Arc<Model>, variables: &Variables) -> stickslip::Result<Vec<f64>> {
    let simulator = Simulator::new(Arc::clone(model));
    let mut start = vec![0.0; variables.len()];
    for variable in variables.all() {
        if let Some(port) = variable.port {
            simulator.get(port, &mut start[variable.range()])?;
        }
    }
    start[variables.first_parameter()..]
        .copy_from_slice(&variables.parameters().values(model.scene()));
    Ok(start)
}

/// The model description of an FMU of this model; `scene` is what it was compiled from, with its run, which becomes the default
/// experiment; `date` is an ISO 8601 time.
pub fn model_description(
    model: &Arc<Model>,
    scene: &Scene,
    version: FmiVersion,
    is_scalar: bool,
    date: &str,
) -> stickslip::Result<String> {
    let variables = Variables::new(model);
    let start = start_values(model, &variables)?;
    let source = Source {
        scene,
        variables,
        start,
        token: token(&scene.to_json()),
        date,
        is_scalar,
    };
    Ok(match version {
        FmiVersion::Fmi2 => version2::write(&source),
        FmiVersion::Fmi3 => version3::write(&source),
    })
}

fn write_units(xml: &mut Xml, variables: &Variables) {
    xml.open("UnitDefinitions", &[]);
    let units: BTreeSet<&str> = variables.all().iter().map(|v| v.unit).collect();
    for name in units {
        // a pure number has none
        let Some(exponents) = exponents(name) else {
            continue;
        };
        xml.open("Unit", &[("name", name)]);
        let exponents = exponents.map(|e| e.to_string());
        let nonzero: Vec<_> = BASES
            .into_iter()
            .zip(exponents.iter().map(String::as_str))
            .filter(|(_, e)| *e != "0")
            .collect();
        xml.empty("BaseUnit", &nonzero);
        xml.close();
    }
    xml.close();
}

fn write_log_categories(xml: &mut Xml) {
    xml.open("LogCategories", &[]);
    for category in Category::ALL {
        let name = category.name().to_string_lossy();
        xml.empty(
            "Category",
            &[("name", &name), ("description", category.description())],
        );
    }
    xml.close();
}

fn write_default_experiment(xml: &mut Xml, source: &Source) {
    let points = Points::of(source.scene);
    let number = |value: f64| format!("{value:?}");
    let (start, stop) = (number(points.at(0)), number(points.until));
    let tolerance = source.scene.time.tolerance.map(number);
    let step = number(points.step);
    let mut attributes = vec![("startTime", start.as_str()), ("stopTime", &stop)];
    attributes.extend(tolerance.iter().map(|value| ("tolerance", value.as_str())));
    attributes.push(("stepSize", &step));
    xml.empty("DefaultExperiment", &attributes);
}

/// When dependencies are declared for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum When {
    /// At communication points.
    Stepping,
    /// At the end of the initialization.
    Start,
}

/// Whether an output depends on another variable at the same instant.
fn depends(output: &Variable, on: &Variable, when: When) -> bool {
    let follows = match when {
        When::Stepping => output.follows != Follows::Nothing,
        When::Start => output.follows == Follows::Loads,
    };
    let matters = match when {
        When::Stepping => on.role == Role::Input,
        When::Start => Variables::decides_start(on),
    };
    follows && matters
}

/// `dependent` as often as there are dependencies.
fn kinds(count: usize) -> String {
    vec!["dependent"; count].join(" ")
}

/// What the ports of all contacts together begin with.
const ALL_CONTACTS: &str = "contact";

/// Terminals of FMI 3: the contact patch, and one port of power per load.
pub fn terminals(model: &Model, is_scalar: bool) -> String {
    let variables = Variables::new(model);
    let names = |prefix: &str| -> Vec<String> {
        let members = variables
            .all()
            .iter()
            .filter(|v| v.name.starts_with(prefix) && v.role == Role::Output);
        let name = |v: &crate::variables::Variable| match is_scalar {
            true => v.element_names(),
            false => vec![v.name.clone()],
        };
        members.flat_map(name).collect()
    };
    let mut xml = Xml::new();
    xml.open("fmiTerminalsAndIcons", &[("fmiVersion", "3.0")]);
    xml.open("Terminals", &[]);
    let mut write =
        |terminal: &str, kind: &str, description: &str, members: &[String], prefix: usize| {
            let attributes = [
                ("name", terminal),
                ("matchingRule", "plug"),
                ("terminalKind", kind),
                ("description", description),
            ];
            xml.open("Terminal", &attributes);
            for name in members {
                let member = if name.len() > prefix {
                    &name[prefix..]
                } else {
                    "intensity"
                };
                let attributes = [
                    ("variableName", name.as_str()),
                    ("memberName", member),
                    ("variableKind", "signal"),
                ];
                xml.empty("TerminalMemberVariable", &attributes);
            }
            xml.close();
        };
    let text = "The contact patch, node by node.";
    let parts = model.contact().parts.iter().map(|part| part.name.as_str());
    let own = parts.filter(|name| *name != ALL_CONTACTS);
    for contact in [ALL_CONTACTS].into_iter().chain(own) {
        let prefix = format!("{contact}.");
        write(
            contact,
            "stickslip.contact_patch",
            text,
            &names(&prefix),
            prefix.len(),
        );
    }
    for load in variables.all().iter().filter(|v| v.role == Role::Input) {
        let mut members = vec![load.name.clone()];
        members.extend(names(&format!("{}.", load.name)));
        let text = "A load with its work-conjugate displacement and velocity.";
        write(
            &load.name,
            "stickslip.load",
            text,
            &members,
            load.name.len() + 1,
        );
    }
    xml.finish()
}

#[cfg(test)]
mod tests {
    use super::exponents;
    use stickslip::contact::law::Law;

    /// A unit that is not known would be named in the description and not defined there.
    #[test]
    fn every_unit_of_a_law_has_base_units() {
        assert_eq!(exponents("N/m3"), Some([1, -2, -2, 0]));
        assert_eq!(exponents("Pa.s/m"), Some([1, -2, -1, 0]));
        assert_eq!(exponents("rad/s"), Some([0, 0, -1, 1]));
        assert_eq!(exponents("N.m"), Some([1, 2, -2, 0]));
        assert_eq!(exponents("1/m"), Some([0, -1, 0, 0]));
        assert_eq!(exponents("1"), None);
        for law in Law::all() {
            for (i, declared) in law.coefficients().enumerate() {
                let unit = law.unit(i);
                assert!(
                    unit == "1" || exponents(unit).is_some(),
                    "{law:?} {declared:?}"
                );
            }
        }
    }
}
