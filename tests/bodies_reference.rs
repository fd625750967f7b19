//! The trajectories of `tests/reference/bodies`, computed by an independent solver (numpy/scipy, its own assembly and friction
//! algorithm) on meshes of Gmsh, against the models: regions, anisotropy, memory, curved contact, what a body starts with.
//!
//! A case is a line of [`CASES`]; a file needs no more. Contact nodes are matched by their places, vectors compared in global axes.

mod common;

use common::{larger, largest};
use serde_json::{Map, Value, json};
use std::ops::ControlFlow;
use std::path::PathBuf;
use stickslip::simulator::drive::Drive;
use stickslip::{Compilation, Folder, Scene, Simulator};

/// A trajectory, the models that it is compared with, the largest error relative to the largest value of a field, and the tolerance
/// of the reduction.
struct Case {
    name: &'static str,
    models: &'static [&'static str],
    error: f64,
    reduction: f64,
}

const ALL: &[&str] = &["full", "condensed", "reduced"];

const CASES: &[Case] = &[
    case("paper_u0_bodyforce"),
    case("plate_hole_orthotropic_p2"),
    case("plate_hole_regions"),
    // its cells are bent, and the file's points of integration are others: 1e-6 in stress
    Case {
        error: 5e-6,
        ..case("shell3d_p2")
    },
    case("shoe_arc"),
    case("shoe_arc_p2"),
    case("paper_prony"),
    case("paper_prony_u0_be"),
    case("pad_prony"),
    case("pad3d_orthotropic_prony"),
    case("plate_hole_graded"),
    whole("plate_hole_von_mises"),
    whole("two_feet_carreau"),
];

/// All models, to seven digits.
const fn case(name: &'static str) -> Case {
    Case {
        name,
        models: ALL,
        error: 1e-7,
        reduction: 1e-9,
    }
}

/// The models that keep the whole mesh.
const fn whole(name: &'static str) -> Case {
    Case {
        models: &["full", "condensed"],
        ..case(name)
    }
}

fn folder() -> PathBuf {
    let root = env!("CARGO_MANIFEST_DIR");
    PathBuf::from(format!("{root}/tests/reference/bodies"))
}

fn load(name: &str) -> Value {
    let path = folder().join(format!("{name}.json"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn numbers(value: &Value) -> Vec<f64> {
    list(value).iter().map(|v| v.as_f64().unwrap()).collect()
}

fn rows(value: &Value) -> Vec<Vec<f64>> {
    list(value).iter().map(numbers).collect()
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Materials by region; the keys of laws are those of the file.
fn materials(file: &Value) -> Vec<Value> {
    let all = file["materials"].as_object().unwrap();
    let of_region = |(region, material): (&String, &Value)| {
        let mut material = material.clone();
        material["region"] = json!(region);
        material
    };
    all.iter().map(of_region).collect()
}

/// Directions of a scene are unit vectors, those of the files have their length: it goes into the signal.
fn signal(signal: &Value, length: f64) -> Value {
    match signal.as_f64() {
        Some(value) => json!(value * length),
        None => {
            let points = rows(signal).into_iter();
            points.map(|p| json!([p[0], p[1] * length])).collect()
        }
    }
}

fn contact_of(part: &Value) -> Value {
    let friction = match part["a"] == part["b"] {
        true => json!({"law": "tresca", "bound": part["a"]}),
        false => {
            json!({"law": "exponential", "a": part["a"], "b": part["b"], "alpha": part["alpha"]})
        }
    };
    json!({"part": part["part"], "friction": friction})
}

/// The same with a name of its own.
fn named_contact(part: &Value) -> Value {
    let mut contact = contact_of(part);
    let name = part["part"].as_str().unwrap().replace(' ', "_");
    contact["name"] = json!(name);
    contact
}

/// The displacement that the body starts with, per component.
fn initial(file: &Value) -> Option<Value> {
    let given = file["initial_displacement"].as_object()?;
    assert_eq!(given["kind"], "quadratic");
    let place = |key: &str| given[key].as_u64().unwrap() as usize;
    let axis = ["x", "y", "z"][place("axis")];
    let (amplitude, origin) = (&given["amplitude"], &given["origin"]);
    let mut components = vec![json!(0.0); file["dimension"].as_u64().unwrap() as usize];
    components[place("component")] =
        json!({"expression": format!("{amplitude} * ({axis} - {origin})^2")});
    Some(json!({ "displacement": components }))
}

fn scene_of(file: &Value, model: &str, reduction: f64) -> Scene {
    let mut mesh = file["mesh"].clone();
    if mesh["kind"] == "gmsh" {
        mesh = json!({"kind": "gmsh", "file": mesh["file"]});
    }
    let mut loads = Vec::new();
    let mut signals = Map::new();
    for load in list(&file["loads"]) {
        let mut load = load.clone();
        let name = load["name"].as_str().unwrap().to_owned();
        let length = norm(&numbers(&load["direction"]));
        signals.insert(name.clone(), signal(&file["signals"][&name], length));
        load["name"] = json!(name);
        loads.push(load);
    }
    let probe = |p: &Value| json!({"name": p["name"], "at": p["at"]});
    let (steps, k) = (
        file["steps"].as_f64().unwrap(),
        file["step_size"].as_f64().unwrap(),
    );
    let parts = list(&file["contact_parts"]);
    let (key, contact) = match parts {
        [one] => ("contact", contact_of(one)),
        several => ("contacts", several.iter().map(named_contact).collect()),
    };
    let mut scene = json!({
        "schema_version": 1, "name": file["name"], "mesh": mesh, "element": file["element"],
        "materials": materials(file), "clamped": file["clamped"],
        "loads": loads, "probes": list(&file["probes_at"]).iter().map(probe).collect::<Vec<_>>(),
        "time": {"scheme": file["scheme"], "start": file["start"], "step": k},
        "fidelity": {"model": model, "tolerance": reduction, "friction_tolerance": 1e-13},
        "run": {"until": steps * k, "signals": signals},
    });
    scene[key] = contact;
    if let Some(initial) = initial(file) {
        scene["initial"] = initial;
    }
    Scene::from_json(&scene.to_string(), "reference").unwrap_or_else(|error| panic!("{error}"))
}

/// Components along the tangents of a node (one after the other, three numbers each or two in the plane) as a vector in global axes.
fn global(components: &[f64], tangents: &[f64]) -> [f64; 3] {
    let dimension = tangents.len() / components.len();
    let mut out = [0.0; 3];
    for (value, tangent) in components.iter().zip(tangents.chunks(dimension)) {
        for (out, t) in out.iter_mut().zip(tangent) {
            *out += value * t;
        }
    }
    out
}

/// For every contact node of the library the one of the file that stands there.
fn matched(file: &Value, simulator: &Simulator) -> Vec<usize> {
    let contact = simulator.model().contact();
    let points = rows(&file["contact_points"]);
    assert_eq!(points.len(), contact.node_count());
    let weights = numbers(&file["weights"]);
    let of_node = |(at, weight): (&[f64; 3], &f64)| {
        let distance = |p: &Vec<f64>| {
            let apart: Vec<f64> = p.iter().zip(at).map(|(a, b)| a - b).collect();
            norm(&apart)
        };
        let found = points.iter().position(|p| distance(p) < 1e-12).unwrap();
        assert!((weights[found] / weight - 1.0).abs() < 1e-8, "{at:?}");
        found
    };
    let nodes: Vec<usize> = contact
        .points
        .iter()
        .zip(&contact.weights)
        .map(of_node)
        .collect();
    for node in 0..points.len() {
        assert!(nodes.contains(&node), "every node once");
    }
    nodes
}

/// Largest error and largest value of a field, by its name.
#[derive(Default)]
struct Errors(Vec<(String, [f64; 2])>);

impl Errors {
    fn add(&mut self, name: &str, found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len());
        let place = self.0.iter().position(|(known, _)| known == name);
        let place = place.unwrap_or_else(|| {
            self.0.push((name.to_owned(), [0.0; 2]));
            self.0.len() - 1
        });
        let [error, scale] = &mut self.0[place].1;
        let apart: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
        *error = larger(*error, largest(&apart));
        *scale = scale.max(largest(expected));
    }

    fn add_contact(&mut self, file: &Value, sample: &Value, nodes: &[usize], at: &Simulator) {
        let contact = at.model().contact();
        let (c, tangents) = (contact.components, rows(&file["tangents"]));
        for field in ["slip_rate", "slip", "tangential_stress"] {
            // in space the components of a node are a list of their own
            let theirs = match sample[field][0].is_array() {
                true => rows(&sample[field]).concat(),
                false => numbers(&sample[field]),
            };
            let ours = common::values(at, &format!("contact.{field}"));
            let (mut found, mut expected) = (Vec::new(), Vec::new());
            for (node, other) in nodes.iter().enumerate() {
                let own: Vec<f64> = contact.tangents[node][..c].concat();
                found.extend(global(&ours[node * c..(node + 1) * c], &own));
                expected.extend(global(
                    &theirs[other * c..(other + 1) * c],
                    &tangents[*other],
                ));
            }
            self.add(field, &found, &expected);
        }
    }

    fn add_ports(&mut self, file: &Value, sample: &Value, compiled: &Compilation, at: &Simulator) {
        for probe in list(&file["probes_at"]) {
            let name = probe["name"].as_str().unwrap();
            let direction = numbers(&probe["direction"]);
            for field in ["displacement", "velocity"] {
                let ours = common::values(at, &format!("{name}.{field}"));
                let along = ours.iter().zip(&direction).map(|(a, b)| a * b).sum();
                let expected = sample["probes"][name][field].as_f64().unwrap();
                self.add(&format!("{name}.{field}"), &[along], &[expected]);
            }
        }
        for (load, own) in list(&file["loads"]).iter().zip(&compiled.body.loads) {
            let name = load["name"].as_str().unwrap();
            // that of the file is the work conjugate, ours a mean along the unit direction
            let measure = own.measure * norm(&numbers(&load["direction"]));
            for field in ["displacement", "velocity"] {
                let ours = common::value(at, &format!("{name}.{field}")) * measure;
                let expected = sample["loads"][name][field].as_f64().unwrap();
                self.add(&format!("{name}.{field}"), &[ours], &[expected]);
            }
        }
        let elastic = common::value(at, "energy.elastic");
        let expected = sample["free_energy"].as_f64().unwrap();
        self.add("free energy", &[elastic], &[expected]);
    }
}

fn compare(case: &Case, model: &str) -> Errors {
    let file = load(case.name);
    let scene = scene_of(&file, model, case.reduction);
    let compiled = Compilation::with(
        &scene,
        &Folder(folder()),
        &mut |_| ControlFlow::Continue(()),
    );
    let compiled = compiled.unwrap_or_else(|error| panic!("{}, {model}: {error}", case.name));
    assert_eq!(
        compiled.body.mesh.cell_count() as u64,
        file["cells"].as_u64().unwrap()
    );
    assert_eq!(
        compiled.body.len() as u64,
        file["free_dofs"].as_u64().unwrap()
    );
    let mut simulator = Simulator::new(compiled.model.clone());
    let nodes = matched(&file, &simulator);
    let mut drive = Drive::start(&scene, &mut simulator).unwrap();
    let k = file["step_size"].as_f64().unwrap();
    let mut errors = Errors::default();
    for sample in list(&file["samples"]) {
        let instant = sample["t"].as_f64().unwrap();
        while drive.simulator().time() < instant - 0.5 * k {
            drive.step().unwrap().expect("a sample within the run");
        }
        let at = drive.simulator();
        assert!((at.time() - instant).abs() < 1e-9);
        errors.add_contact(&file, sample, &nodes, at);
        errors.add_ports(&file, sample, &compiled, at);
    }
    let balance = common::value(drive.simulator(), "energy.balance_error");
    let work = common::value(drive.simulator(), "energy.external_work");
    println!(
        "{:26} {model:10} states {} balance {:.1e}",
        case.name,
        compiled.model.states(),
        balance / work
    );
    errors
}

#[test]
fn trajectories_are_those_of_another_solver() {
    for case in CASES {
        for model in case.models {
            for (field, [error, scale]) in compare(case, model).0 {
                println!(
                    "{:26} {model:10} {field:20} {:.1e} of {scale:.1e}",
                    case.name,
                    error / scale
                );
                assert!(scale > 0.0, "{}, {field}: nothing to compare", case.name);
                assert!(
                    error < case.error * scale,
                    "{}, {model}, {field}: {error:e} of {scale:e}",
                    case.name
                );
            }
        }
    }
}
