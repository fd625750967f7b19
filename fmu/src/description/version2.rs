//! The model description of FMI 2.0: every element of an array is a variable of its own, `name[i]`.

use super::{
    MODEL_IDENTIFIER, Source, When, depends, kinds, write_default_experiment, write_log_categories,
    write_units,
};
use crate::parameters::choices;
use crate::variables::{Role, Variable, Variables};
use crate::xml::Xml;

pub fn write(source: &Source) -> String {
    let mut xml = Xml::new();
    xml.open(
        "fmiModelDescription",
        &[
            ("fmiVersion", "2.0"),
            ("modelName", &source.scene.name),
            ("guid", &source.token),
            (
                "description",
                "Frictional contact of a viscoelastic body with a rigid foundation.",
            ),
            ("version", env!("CARGO_PKG_VERSION")),
            ("license", env!("CARGO_PKG_LICENSE")),
            (
                "generationTool",
                concat!("stickslip ", env!("CARGO_PKG_VERSION")),
            ),
            ("generationDateAndTime", source.date),
            ("variableNamingConvention", "structured"),
        ],
    );
    xml.empty(
        "CoSimulation",
        &[
            ("modelIdentifier", MODEL_IDENTIFIER),
            ("needsExecutionTool", "false"),
            ("canHandleVariableCommunicationStepSize", "true"),
            ("canInterpolateInputs", "true"),
            ("maxOutputDerivativeOrder", "1"),
            ("canRunAsynchronuously", "false"),
            ("canBeInstantiatedOnlyOncePerProcess", "false"),
            ("canNotUseMemoryManagementFunctions", "true"),
            ("canGetAndSetFMUstate", "true"),
            ("canSerializeFMUstate", "true"),
            ("providesDirectionalDerivative", "true"),
        ],
    );
    write_units(&mut xml, &source.variables);
    xml.open("TypeDefinitions", &[]);
    for choices in &choices() {
        xml.open("SimpleType", &[("name", choices.name)]);
        xml.open("Enumeration", &[]);
        for (i, word) in choices.words.iter().enumerate() {
            xml.empty("Item", &[("name", word), ("value", &(i + 1).to_string())]);
        }
        xml.close();
        xml.close();
    }
    xml.close();
    write_log_categories(&mut xml);
    write_default_experiment(&mut xml, source);
    // FMI 2 has no independent variable of Co-Simulation that masters ask for: place 0 of the list stays unnamed
    let listed: Vec<&Variable> = source
        .variables
        .all()
        .iter()
        .filter(|v| v.role != Role::Time)
        .collect();
    xml.open("ModelVariables", &[]);
    for variable in &listed {
        for (i, name) in variable.element_names().iter().enumerate() {
            write_variable(&mut xml, source, variable, name, variable.first + i);
        }
    }
    xml.close();
    write_structure(&mut xml, source, &listed);
    xml.finish()
}

fn write_variable(xml: &mut Xml, source: &Source, variable: &Variable, name: &str, place: usize) {
    let (causality, variability, initial) = match variable.role {
        Role::Input => ("input", "continuous", None),
        Role::Tunable => ("parameter", "tunable", Some("exact")),
        Role::Fixed => ("parameter", "fixed", Some("exact")),
        Role::Output | Role::Time => ("output", "continuous", Some("calculated")),
    };
    let reference = place.to_string();
    let mut attributes = vec![
        ("name", name),
        ("valueReference", &reference),
        ("description", &variable.description),
        ("causality", causality),
        ("variability", variability),
    ];
    attributes.extend(initial.map(|initial| ("initial", initial)));
    xml.open("ScalarVariable", &attributes);
    let start = source.start_of(place, 1);
    match variable.choice {
        Some(choice) => {
            let start = (source.start[place] as i64).to_string();
            let attributes = [
                ("declaredType", Variables::choice_name(choice)),
                ("start", start.as_str()),
            ];
            xml.empty("Enumeration", &attributes);
        }
        None => {
            let mut attributes = Vec::new();
            if variable.unit != "1" {
                attributes.push(("unit", variable.unit));
            }
            if variable.role != Role::Output {
                attributes.push(("start", start.as_str()));
            }
            xml.empty("Real", &attributes);
        }
    }
    xml.close();
}

/// Outputs and what they depend on at the same instant. Indices count from 1.
fn write_structure(xml: &mut Xml, source: &Source, listed: &[&Variable]) {
    // time is place 0 and is not listed, so that the index of a variable is its place
    let outputs = || listed.iter().filter(|v| v.role == Role::Output);
    debug_assert!(source.variables.len() > listed.len());
    xml.open("ModelStructure", &[]);
    for (element, when) in [
        ("Outputs", When::Stepping),
        ("InitialUnknowns", When::Start),
    ] {
        xml.open(element, &[]);
        for output in outputs() {
            let known = listed.iter().filter(|v| depends(output, v, when));
            let places: Vec<String> = known
                .flat_map(|v| v.range())
                .map(|place| place.to_string())
                .collect();
            let (list, kinds) = (places.join(" "), kinds(places.len()));
            for index in output.range() {
                let index = index.to_string();
                xml.empty(
                    "Unknown",
                    &[
                        ("index", &index),
                        ("dependencies", &list),
                        ("dependenciesKind", &kinds),
                    ],
                );
            }
        }
        xml.close();
    }
    xml.close();
}
