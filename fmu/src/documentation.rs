//! `documentation/index.html`: what the FMU is, a picture of the body, the scene, the variables, what it needs.

mod drawing;
mod picture;

use crate::description::FmiVersion;
use crate::variables::{Role, Variables};
use serde_json::Value;
use std::fmt::Write;
use stickslip::{Compilation, Model};

/// What the documentation says about the shared library.
pub struct LibraryNotes {
    /// Newest glibc version that it asks for, where that was found.
    pub glibc: Option<String>,
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:62em;margin:2em auto;padding:0 1em;color:#222}\
figure{margin:1em 0}figcaption span{display:inline-block;margin-right:1.6em}figcaption i{display:inline-block;width:.8em;\
height:.8em;margin-right:.4em}table{border-collapse:collapse}td,th{border-bottom:1px solid #ccc;padding:.2em .7em;\
text-align:left;vertical-align:top}.n{white-space:nowrap}svg{max-width:100%;height:auto}code{background:#f3f3f3}";

/// The page; `start` holds the values of a fresh instance, in the order of the variables.
pub fn page(
    compilation: &Compilation,
    start: &[f64],
    version: FmiVersion,
    is_scalar: bool,
    library: &LibraryNotes,
) -> String {
    let model = &compilation.model;
    let (scene, summary) = (model.scene(), model.summary());
    let title = escaped(&scene.name);
    let mut html = String::new();
    let _ = write!(
        html,
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title><style>{STYLE}</style>\
         </head><body>\n<h1>{title}</h1>\n<p>Quasistatic frictional contact of a viscoelastic body (Kelvin-Voigt) with a rigid \
         foundation, as an FMI {} Co-Simulation FMU, made by stickslip {}. All units are SI.</p>\n",
        match version {
            FmiVersion::Fmi2 => "2.0",
            FmiVersion::Fmi3 => "3.0",
        },
        env!("CARGO_PKG_VERSION")
    );
    html.push_str("<figure>\n");
    html.push_str(&picture::svg(&compilation.body.mesh, model));
    html.push_str(&legend(model));
    html.push_str("</figure>\n");
    let contact = model.contact().node_count();
    let _ = writeln!(
        html,
        "<p>{} cells, {} nodes, {} free displacement components; {} contact node{}, in the order of all arrays over the contact. \
         Kept of the body: {:?}, {} states.</p>",
        summary.mesh_cells,
        summary.mesh_nodes,
        summary.free_dofs,
        contact,
        if contact == 1 { "" } else { "s" },
        summary.kind,
        model.states(),
    );
    html.push_str(&scene_table(model));
    html.push_str(USE);
    html.push_str(&variables_table(
        &Variables::new(model),
        start,
        version,
        is_scalar,
    ));
    let needs = match &library.glibc {
        Some(version) => format!("It needs glibc {version} or newer"),
        None => "It needs the system libraries it was built with".to_owned(),
    };
    let _ = write!(
        html,
        "<h2>Requirements</h2>\n<p>The shared library is for {} on {}. {needs} and nothing else: no tool, no licence, \
         no environment variable, no file outside the FMU. It makes no threads and prints nothing.</p>\n</body></html>\n",
        std::env::consts::OS,
        std::env::consts::ARCH
    );
    html
}

fn legend(model: &Model) -> String {
    let scene = model.scene();
    let mut html = "<figcaption>".to_owned();
    let mut entry = |colour: &str, words: &str| {
        let words = escaped(words);
        let _ = write!(
            html,
            "<span><i style=\"background:{colour}\"></i>{words}</span>"
        );
    };
    let contacts = scene.contacts();
    let parts: Vec<&str> = contacts.iter().map(|c| c.part.as_str()).collect();
    let contact = format!(
        "contact: {}, first and last node numbered",
        parts.join(", ")
    );
    entry(picture::CONTACT, &contact);
    if !scene.clamped.is_empty() {
        let words = format!("clamped: {}", scene.clamped.join(", "));
        entry(picture::CLAMPED, &words);
    }
    if !scene.rollers.is_empty() {
        let words = format!("on rollers: {}", scene.rollers.join(", "));
        entry(picture::CLAMPED, &words);
    }
    if !scene.driven.is_empty() {
        let parts: Vec<&str> = scene.driven.iter().map(|d| d.part.as_str()).collect();
        let words = format!(
            "driven, the arrow along a positive value: {}",
            parts.join(", ")
        );
        entry(picture::DRIVEN, &words);
    }
    if contacts.iter().any(|c| !c.foundation.is_empty()) {
        let words = "motions of the foundation, the arrow along a positive value";
        entry(picture::FOUNDATION, words);
    }
    if !scene.loads.is_empty() {
        entry(picture::LOAD, "loads, the arrow along a positive value");
    }
    if !scene.probes.is_empty() {
        entry(picture::PROBE, "probes");
    }
    html + "</figcaption>\n"
}

/// A value of the scene in one line: what kind it is, then `name = value`.
fn words_of(value: &Value) -> String {
    match value {
        Value::Object(map) => {
            let is_kind = |key: &str| key == "law" || key == "kind";
            let is_empty = |value: &Value| value.as_array().is_some_and(Vec::is_empty);
            let entry = |(key, value): (&String, &Value)| match value {
                _ if is_kind(key) => words_of(value),
                Value::Object(_) => format!("{key} ({})", words_of(value)),
                _ => format!("{key} = {}", words_of(value)),
            };
            let entries = map.iter().filter(|(_, value)| !is_empty(value));
            let (kind, others): (Vec<_>, Vec<_>) = entries.partition(|(key, _)| is_kind(key));
            let all: Vec<String> = kind.into_iter().chain(others).map(entry).collect();
            all.join(", ")
        }
        Value::Array(list) => {
            let words: Vec<String> = list.iter().map(words_of).collect();
            match list.first() {
                Some(Value::String(_)) => words.join(", "),
                _ => format!("({})", words.join(", ")),
            }
        }
        Value::String(word) => word.clone(),
        _ => value.to_string().trim_end_matches(".0").to_owned(),
    }
}

/// What the scene says of the body, the contact, the loads and the probes.
fn scene_table(model: &Model) -> String {
    let scene = serde_json::to_value(model.scene()).unwrap_or_default();
    let mut html = "<h2>Scene</h2>\n<table>".to_owned();
    let mut row = |name: &str, value: &Value| {
        let value = escaped(&words_of(value));
        let _ = writeln!(
            html,
            "<tr><th class=\"n\">{}</th><td>{value}</td></tr>",
            escaped(name)
        );
    };
    for (name, path) in [
        ("Mesh", "/mesh"),
        ("Viscosity", "/material/viscosity"),
        ("Elasticity", "/material/elasticity"),
        ("Clamped", "/clamped"),
        ("Contact", "/contact"),
    ] {
        match scene.pointer(path) {
            None if name == "Contact" => {}
            value => row(name, value.unwrap_or(&Value::Null)),
        }
    }
    for (kind, list) in [
        ("Contact", "contacts"),
        ("Load", "loads"),
        ("Probe", "probes"),
    ] {
        for item in scene[list].as_array().into_iter().flatten() {
            let mut item = item.clone();
            let name = item["name"].as_str().unwrap_or_default().to_owned();
            if let Some(map) = item.as_object_mut() {
                map.remove("name");
            }
            row(&format!("{kind} {name}"), &item);
        }
    }
    for (name, path) in [("Time", "/time"), ("Fidelity", "/fidelity")] {
        row(name, scene.pointer(path).unwrap_or(&Value::Null));
    }
    html + "</table>\n"
}

const USE: &str = "<h2>Use</h2>\n<ul>\
<li>An input that is set before a step is the load at its beginning. Within the step it goes on with the slope of the last \
steps (and is held after a jump), or, with <code>time.inputs</code> = hold and for loads declared with <code>hold</code>, stays as it is; \
with FMI 2 input derivatives it is the value that was set plus the derivative times the time since the beginning of the step. \
With <code>time.inputs</code> = end_of_step it is the load at the end of the step, for importers that know that or iterate.</li>\
<li>A step of any positive size is cut into internal steps no larger than <code>time.step</code>: equal ones, or, when \
<code>time.tolerance</code> is not 0, as small as that asks for.</li>\
<li>States can be saved, restored and serialized at any time; a restored run continues bit for bit, in another process too.</li>\
<li>Directional (and in FMI 3 adjoint) derivatives are those of the outputs at the end of the last step by its inputs, whatever \
they mean. Where a contact node changes between stick and slip it is the derivative of the branch on which the step ended. Without a \
last step (in initialization mode, before the first step, after a restored state) they are those of the outputs by the loads of \
the same instant.</li>\
<li>Output derivatives of order 1 are exact for displacements and slips, and 0 (not known) for other outputs.</li>\
<li>Fixed parameters may change until the initialization ends; the scene that the FMU carries is then compiled anew (not for \
<code>time.inputs</code>). Friction coefficients may change between steps, in any order: they are checked as a set by the next step.</li>\
<li>A stop time that the importer defines is kept: a step past it is an error.</li>\
<li>A step whose friction does not converge leaves the state as it was (FMI 3: Discard; FMI 2: Error); try a smaller one.</li>\
</ul>\n";

fn variables_table(
    variables: &Variables,
    start: &[f64],
    version: FmiVersion,
    is_scalar: bool,
) -> String {
    let is_fmi2 = version == FmiVersion::Fmi2;
    let mut html = "<h2>Variables</h2>\n<table><tr><th>Name</th><th>Unit</th><th>Kind</th><th>Size</th><th>Start</th>\
                    <th>Meaning</th></tr>\n"
        .to_owned();
    // FMI 2 Co-Simulation has no variable of time
    let listed = variables.all().iter();
    for variable in listed.filter(|v| !(is_fmi2 && v.role == Role::Time)) {
        let kind = match variable.role {
            Role::Time => "time",
            Role::Input => "input",
            Role::Output => "output",
            Role::Tunable => "tunable parameter",
            Role::Fixed => "fixed parameter",
        };
        let begin = match variable.role {
            Role::Time | Role::Output => String::new(),
            _ if variable.shape.is_empty() => words_of(&Value::from(start[variable.first])),
            _ => words_of(&Value::from(&start[variable.range()])),
        };
        let size: Vec<String> = variable.shape.iter().map(usize::to_string).collect();
        let names = match (is_fmi2 || is_scalar, variable.element_names().as_slice()) {
            (true, [first, .., last]) => format!("{first} ... {last}"),
            _ => variable.name.clone(),
        };
        let mut meaning = escaped(&variable.description);
        if let Some(choice) = variable.choice {
            let words = Variables::words(choice).iter().enumerate();
            let list: Vec<String> = words.map(|(i, word)| format!("{} {word}", i + 1)).collect();
            let _ = write!(meaning, " Choices: {}.", list.join(", "));
        }
        let _ = writeln!(
            html,
            "<tr><td class=\"n\"><code>{}</code></td><td>{}</td><td class=\"n\">{kind}</td><td class=\"n\">{}</td><td>{begin}</td>\
             <td>{meaning}</td></tr>",
            escaped(&names),
            variable.unit,
            size.join(" &times; "),
        );
    }
    html + "</table>\n"
}
