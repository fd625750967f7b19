//! Small scenes, in which ports coincide or depend on each other: a probe at a contact node, several loads in one direction,
//! more ports than free displacements. Every one of them compiles under `auto`, and all models give one trajectory.

mod common;

use common::larger;
use common::random::Random;
use serde_json::{Value, json};
use stickslip::scene::ModelKind;
use stickslip::{Scene, Simulator, compile};

/// Steps of a trajectory; the loads ramp up in the first half, reverse in the second.
const STEPS: usize = 8;
const STEP: f64 = 0.05;

/// Sides of the axes, lower and upper.
const SIDES: [[&str; 2]; 3] = [["left", "right"], ["bottom", "top"], ["back", "front"]];

/// A random scene, plane or in space.
fn draw(random: &mut Random) -> Value {
    let dimension = if random.happens(0.7) { 2 } else { 3 };
    let cells: Vec<usize> = match dimension {
        2 => vec![1 + random.below(9), 1 + random.below(5)],
        _ => (0..3).map(|_| 1 + random.below(3)).collect(),
    };
    let size: Vec<f64> = (0..dimension)
        .map(|_| random.one_of(&[1.0, 0.5, 0.3, 2.0]))
        .collect();
    let axes = ["x", "y", "z"];
    let periodic: Vec<&str> = match random.happens(0.2) {
        true => vec![random.one_of(&axes[..dimension])],
        false => vec![],
    };
    let mut parts: Vec<&str> = (0..dimension)
        .filter(|axis| !periodic.contains(&axes[*axis]))
        .flat_map(|axis| SIDES[axis])
        .collect();
    let mut take = |random: &mut Random| parts.swap_remove(random.below(parts.len()));
    let contact = take(random);
    let clamped = take(random);
    let loads: Vec<Value> = (0..random.below(5))
        .map(|i| {
            let direction: Vec<f64> = match random.happens(0.5) {
                true => {
                    let along = random.below(dimension);
                    (0..dimension).map(|axis| f64::from(u8::from(axis == along))).collect()
                }
                false => (0..dimension).map(|_| random.between(-1.0, 1.0)).collect(),
            };
            if parts.is_empty() || random.happens(0.3) {
                json!({"name": format!("load{i}"), "kind": "body_force", "direction": direction})
            } else {
                let part = random.one_of(&parts);
                json!({"name": format!("load{i}"), "kind": "traction", "part": part, "direction": direction})
            }
        })
        .collect();
    let probes: Vec<Value> = (0..random.below(4))
        .map(|i| {
            let at: Vec<f64> = (0..dimension)
                .map(|axis| match random.below(3) {
                    0 => size[axis] * random.below(cells[axis] + 1) as f64 / cells[axis] as f64,
                    1 => size[axis] * random.one_of(&[0.0, 1.0]),
                    _ => size[axis] * random.unit(),
                })
                .collect();
            json!({"name": format!("probe{i}"), "at": at})
        })
        .collect();
    let kind = if dimension == 2 { "rectangle" } else { "box" };
    let convention = match dimension {
        2 => random.one_of(&["kazmi2014", "plane_strain", "plane_stress"]),
        _ => random.one_of(&["kazmi2014", "three_dimensional"]),
    };
    let element = if dimension == 2 && random.happens(0.3) {
        "p2"
    } else {
        "p1"
    };
    let friction = match random.below(2) {
        0 => json!({"law": "tresca", "bound": random.between(0.001, 0.05)}),
        _ => json!({"law": "exponential", "a": 0.004, "b": 0.002, "alpha": 5.0}),
    };
    json!({
        "schema_version": 1, "name": "small",
        "mesh": {"kind": kind, "size": size, "cells": cells, "periodic": periodic},
        "element": element,
        "material": {
            "viscosity": {"law": "isotropic", "mu1": random.one_of(&[0.05, 0.0, 0.2]), "mu2": 0.1},
            "elasticity": {"law": "isotropic", "young": 1.0, "poisson": random.one_of(&[0.0, 0.25, 0.3, 0.45]), "convention": convention}
        },
        "clamped": [clamped],
        "contact": {"part": contact, "friction": friction},
        "loads": loads,
        "probes": probes,
        "time": {"step": STEP, "scheme": random.one_of(&["trapezoid", "backward_euler", "tr_bdf2"])},
        "fidelity": {"friction_tolerance": 1e-12}
    })
}

/// Values of every port over a trajectory.
type Seen = Vec<(String, Vec<f64>)>;

/// Contact and outputs of the body over a short trajectory: one list of values per port, and the model that was kept.
fn course(value: &Value, model: &str) -> Result<(Seen, ModelKind), String> {
    let mut value = value.clone();
    value["fidelity"]["model"] = json!(model);
    let scene = Scene::from_json(&value.to_string(), "small").map_err(|e| e.to_string())?;
    let model = compile(&scene).map_err(|e| e.to_string())?;
    let kind = model.summary().kind;
    let names: Vec<String> = model
        .ports()
        .all()
        .iter()
        .map(|port| port.name.clone())
        .filter(|name| {
            name.ends_with(".displacement")
                || name.ends_with(".velocity")
                || name == "contact.slip_rate"
                || name == "contact.tangential_stress"
                || name == "contact.slip"
        })
        .collect();
    let mut simulator = Simulator::new(model);
    let mut seen: Seen = names.into_iter().map(|n| (n, vec![])).collect();
    let load = |n: usize| {
        let along = n as f64 / STEPS as f64;
        let rising = if along <= 0.5 {
            along
        } else {
            1.0 - 1.7 * along
        };
        (0..scene.loads.len())
            .map(|i| rising * (0.2 + 0.1 * i as f64))
            .collect::<Vec<_>>()
    };
    simulator.init(0.0).map_err(|e| e.to_string())?;
    for n in 0..STEPS {
        simulator
            .set_inputs(&load(n + 1))
            .map_err(|e| e.to_string())?;
        simulator
            .do_step(simulator.time(), STEP)
            .map_err(|e| e.to_string())?;
        for (name, values) in &mut seen {
            values.extend(simulator.get_by_name(name).map_err(|e| e.to_string())?);
        }
    }
    Ok((seen, kind))
}

/// Largest difference of two courses, relative to the largest value of a port, and where; NaN where a value is none.
fn difference(a: &[(String, Vec<f64>)], b: &[(String, Vec<f64>)]) -> (f64, String) {
    let mut worst = (0.0, String::new());
    let of = |kind: &str| {
        let all = b.iter().filter(|(name, _)| name.ends_with(kind));
        all.flat_map(|(_, v)| v)
            .fold(0.0_f64, |m, v| m.max(v.abs()))
    };
    for ((name, a), (_, b)) in a.iter().zip(b) {
        let kind = name.rsplit('.').next().unwrap_or_default();
        let scale = match kind {
            "slip_rate" | "velocity" => of("velocity").max(of("slip_rate")),
            "slip" | "displacement" => of("displacement").max(of("slip")),
            // symmetric bodies have no tangential stress but rounding
            _ => of(kind).max(1e-3),
        };
        let off = a
            .iter()
            .zip(b)
            .fold(0.0_f64, |m, (a, b)| larger(m, (a - b).abs()));
        if off.is_nan() {
            return (off, name.clone());
        }
        if off > worst.0 * scale {
            worst = (off / scale, name.clone());
        }
    }
    worst
}

#[test]
fn no_small_scene_is_refused_and_all_models_agree() {
    let count: usize = std::env::var("SMALL_SCENES")
        .ok()
        .and_then(|c| c.parse().ok())
        .unwrap_or(150);
    let mut random = Random::new(7);
    let mut faults = Vec::new();
    let mut kinds = [0, 0];
    for n in 0..count {
        let value = draw(&mut random);
        if Scene::from_json(&value.to_string(), "small").is_err() {
            continue;
        }
        let (full, _) = match course(&value, "full") {
            Ok(full) => full,
            Err(e) => {
                faults.push(format!("{n} full: {e}\n{value}"));
                continue;
            }
        };
        for model in ["condensed", "auto", "reduced"] {
            match course(&value, model) {
                Ok((found, kind)) => {
                    kinds[usize::from(kind == ModelKind::Reduced)] += 1;
                    let (off, port) = difference(&found, &full);
                    if off > 1e-6 || off.is_nan() {
                        faults.push(format!(
                            "{n} {model} ({kind:?}): {port} off by {off:e}\n{value}"
                        ));
                    }
                }
                Err(e) => faults.push(format!("{n} {model}: {e}\n{value}")),
            }
        }
    }
    println!("{kinds:?}");
    for fault in &faults {
        println!("{fault}");
    }
    assert!(faults.is_empty(), "{} faults", faults.len());
}
