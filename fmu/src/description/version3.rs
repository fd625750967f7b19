//! The model description of FMI 3.0: one variable per array, or one per element for importers without arrays.

use super::{
    MODEL_IDENTIFIER, Source, When, depends, kinds, write_default_experiment, write_log_categories,
    write_units,
};
use crate::parameters::choices;
use crate::variables::{Role, Variable, Variables};
use crate::xml::Xml;

/// A variable as it is declared.
struct Declared<'a> {
    variable: &'a Variable,
    name: String,
    reference: u32,
    /// Whether it stands for the whole array.
    is_array: bool,
    place: usize,
}

fn declared<'a>(source: &'a Source) -> Vec<Declared<'a>> {
    let mut list = Vec::new();
    for (number, variable) in source.variables.all().iter().enumerate() {
        let place = variable.first;
        if variable.shape.is_empty() || !source.is_scalar {
            let (name, reference) = (variable.name.clone(), variable.reference(number));
            let is_array = !variable.shape.is_empty();
            list.push(Declared {
                variable,
                name,
                reference,
                is_array,
                place,
            });
        } else {
            for (i, name) in variable.element_names().into_iter().enumerate() {
                let reference = (place + i) as u32;
                list.push(Declared {
                    variable,
                    name,
                    reference,
                    is_array: false,
                    place: place + i,
                });
            }
        }
    }
    list
}

pub fn write(source: &Source) -> String {
    let mut xml = Xml::new();
    xml.open(
        "fmiModelDescription",
        &[
            ("fmiVersion", "3.0"),
            ("modelName", &source.scene.name),
            ("instantiationToken", &source.token),
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
            ("canBeInstantiatedOnlyOncePerProcess", "false"),
            ("canGetAndSetFMUState", "true"),
            ("canSerializeFMUState", "true"),
            ("providesDirectionalDerivatives", "true"),
            ("providesAdjointDerivatives", "true"),
            ("providesPerElementDependencies", "false"),
            ("canHandleVariableCommunicationStepSize", "true"),
            ("maxOutputDerivativeOrder", "1"),
            ("providesIntermediateUpdate", "false"),
            ("mightReturnEarlyFromDoStep", "true"),
            ("canReturnEarlyAfterIntermediateUpdate", "false"),
            ("hasEventMode", "true"),
        ],
    );
    write_units(&mut xml, &source.variables);
    xml.open("TypeDefinitions", &[]);
    for choices in &choices() {
        xml.open("EnumerationType", &[("name", choices.name)]);
        for (i, word) in choices.words.iter().enumerate() {
            xml.empty("Item", &[("name", word), ("value", &(i + 1).to_string())]);
        }
        xml.close();
    }
    xml.close();
    write_log_categories(&mut xml);
    write_default_experiment(&mut xml, source);
    let list = declared(source);
    xml.open("ModelVariables", &[]);
    for item in &list {
        write_variable(&mut xml, source, item);
    }
    xml.close();
    write_structure(&mut xml, &list);
    xml.finish()
}

fn write_variable(xml: &mut Xml, source: &Source, item: &Declared) {
    let variable = item.variable;
    let (causality, variability, initial) = match variable.role {
        Role::Time => ("independent", "continuous", None),
        Role::Input => ("input", "continuous", None),
        Role::Output => ("output", "continuous", Some("calculated")),
        Role::Tunable => ("parameter", "tunable", Some("exact")),
        Role::Fixed => ("parameter", "fixed", Some("exact")),
    };
    let reference = item.reference.to_string();
    let mut attributes = vec![
        ("name", item.name.as_str()),
        ("valueReference", &reference),
        ("description", &variable.description),
        ("causality", causality),
        ("variability", variability),
    ];
    attributes.extend(initial.map(|initial| ("initial", initial)));
    let has_start = matches!(variable.role, Role::Input | Role::Tunable | Role::Fixed);
    if let Some(choice) = variable.choice {
        let start = (source.start[item.place] as i64).to_string();
        attributes.push(("declaredType", Variables::choice_name(choice)));
        attributes.push(("start", &start));
        xml.empty("Enumeration", &attributes);
        return;
    }
    let len = if item.is_array { variable.len } else { 1 };
    let start = source.start_of(item.place, len);
    if variable.unit != "1" {
        attributes.push(("unit", variable.unit));
    }
    if has_start {
        attributes.push(("start", &start));
    }
    if !item.is_array {
        xml.empty("Float64", &attributes);
        return;
    }
    xml.open("Float64", &attributes);
    for size in &variable.shape {
        xml.empty("Dimension", &[("start", &size.to_string())]);
    }
    xml.close();
}

/// Outputs and what they depend on at the same instant.
fn write_structure(xml: &mut Xml, list: &[Declared]) {
    xml.open("ModelStructure", &[]);
    for (element, when) in [("Output", When::Stepping), ("InitialUnknown", When::Start)] {
        for output in list
            .iter()
            .filter(|item| item.variable.role == Role::Output)
        {
            let known = list
                .iter()
                .filter(|item| depends(output.variable, item.variable, when));
            let references: Vec<String> = known.map(|item| item.reference.to_string()).collect();
            let attributes = [
                ("valueReference", output.reference.to_string()),
                ("dependencies", references.join(" ")),
                ("dependenciesKind", kinds(references.len())),
            ];
            xml.empty(
                element,
                &attributes
                    .each_ref()
                    .map(|(name, value)| (*name, value.as_str())),
            );
        }
    }
    xml.close();
}
