//! The trajectories of `tests/reference/contact`, computed by an independent solver (numpy/scipy, its own mesh, assembly and contact
//! algorithm; Siconos agrees to 3e-12), against the three models: pressure, moving foundations, driven parts, opening contact.

mod common;

use common::{larger, largest};
use serde_json::{Value, json};
use stickslip::simulator::drive::Drive;
use stickslip::{Scene, Simulator, compile};

/// Largest error relative to the largest value of the field.
const TOLERANCE: f64 = 1e-8;
const MODELS: [&str; 3] = ["full", "condensed", "reduced"];

fn load(name: &str) -> Value {
    let root = env!("CARGO_MANIFEST_DIR");
    let path = format!("{root}/tests/reference/contact/{name}.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|v| v.as_f64().unwrap()).collect()
}

/// A number, or the same at every node.
fn field(value: &Value) -> Value {
    match value {
        Value::Array(_) => json!({ "nodes": value }),
        number => number.clone(),
    }
}

fn coefficient(law: &Value) -> Value {
    match law["law"].as_str().unwrap() {
        "exponential" => json!({
            "kind": "exponential",
            "static": field(&law["mu_s"]), "kinetic": field(&law["mu_k"]), "decay": field(&law["alpha"]),
        }),
        "stribeck" => json!({
            "kind": "stribeck",
            "static": law["mu_s"], "kinetic": law["mu_k"], "velocity": law["v_s"],
            "exponent": law["delta"], "viscous": law["c"],
        }),
        "slip_weakening" => json!({
            "kind": "slip_weakening",
            "static": law["mu_s"], "dynamic": law["mu_d"], "distance": law["D_c"],
        }),
        "rate_state" => json!({
            "kind": "rate_and_state",
            "coefficient": law["mu0"], "a": law["a"], "b": law["b"], "rate": law["V0"],
            "distance": law["D_c"], "evolution": law["evolution"],
        }),
        "table" => json!({"kind": "table", "rate": law["r"], "value": law["mu"]}),
        other => panic!("unknown law {other}"),
    }
}

fn coefficient_of(contact: &Value) -> Value {
    let mut law = coefficient(&contact["friction"]);
    if !contact["theta0"].is_null() {
        law["initial_state"] = contact["theta0"].clone();
    }
    law
}

fn condition(contact: &Value) -> Value {
    let gap = json!({"nodes": contact["gap0"]});
    match contact["normal"].as_str().unwrap() {
        "bilateral" => json!({"kind": "bilateral"}),
        "unilateral" => json!({"kind": "unilateral", "gap": gap}),
        "compliance" => json!({
            "kind": "compliance", "gap": gap, "stiffness": contact["c_n"], "exponent": contact["m"],
        }),
        other => panic!("unknown condition {other}"),
    }
}

fn scene_of(file: &Value, model: &str) -> Scene {
    let (p, inputs) = (&file["parameters"], &file["inputs"]);
    let scheme = match file["scheme"].as_str().unwrap() {
        "trap" => "trapezoid",
        "be" => "backward_euler",
        other => other,
    };
    let mut signals = serde_json::Map::new();
    let mut loads = Vec::new();
    for load in inputs["tractions"].as_array().unwrap() {
        let axis = load["axis"].as_str().unwrap();
        let direction = if axis == "x" { [1, 0] } else { [0, 1] };
        let name = format!("load_{axis}");
        signals.insert(name.clone(), load["signal"].clone());
        loads.push(json!({
            "name": name, "kind": "traction", "part": load["part"], "direction": direction,
        }));
    }
    let mut foundation = Vec::new();
    if inputs["foundation_velocity"] != json!(0.0) {
        signals.insert("belt".into(), inputs["foundation_velocity"].clone());
        foundation.push(json!({"kind": "sliding", "name": "belt", "direction": [1, 0]}));
    }
    if inputs["foundation_displacement"] != json!(0.0) {
        signals.insert("rise".into(), inputs["foundation_displacement"].clone());
        foundation.push(json!({"kind": "approach", "name": "rise"}));
    }
    let mut driven = Vec::new();
    for (i, clamp) in inputs["clamp_velocities"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
    {
        let (x, y) = (format!("x{i}"), format!("y{i}"));
        signals.insert(x.clone(), clamp["x"].clone());
        signals.insert(y.clone(), clamp["y"].clone());
        driven.push(json!({"part": clamp["part"], "directions": {x: [1, 0], y: [0, 1]}}));
    }
    let clamped = if driven.is_empty() {
        file["clamped"].clone()
    } else {
        json!([])
    };
    let steps = file["steps"].as_f64().unwrap();
    let k = file["step_size"].as_f64().unwrap();
    let contact = &file["contact"];
    let value = json!({
        "schema_version": 1, "name": file["name"],
        "mesh": {"kind": "rectangle", "size": [p["L1"], p["L2"]], "cells": file["cells"]},
        "material": {
            "viscosity": {"law": "isotropic", "mu1": p["mu1"], "mu2": p["mu2"]},
            "elasticity": {"law": "isotropic", "young": p["E"], "poisson": p["kappa"], "convention": "plane_strain"},
        },
        "clamped": clamped, "driven": driven, "loads": loads,
        "contact": {
            "part": contact["part"], "condition": condition(contact), "foundation": foundation,
            "friction": {
                "law": "coulomb", "coefficient": coefficient_of(contact),
                "tension": contact["bound_uses"] == "abs",
            },
        },
        // the trapezoid of the references rings where contact gives way, and is taken on purpose
        "time": {"scheme": scheme, "start": file["start"], "step": k, "force": scheme == "trapezoid"},
        "fidelity": {"model": model, "tolerance": 1e-9, "friction_tolerance": 1e-13},
        "run": {"until": steps * k, "signals": signals},
    });
    Scene::from_json(&value.to_string(), "reference").unwrap()
}

/// Largest error and largest value of every field of a file.
fn compare(file: &Value, model: &str, fields: &[(&str, &str)]) -> Vec<[f64; 2]> {
    let scene = scene_of(file, model);
    let mut simulator = Simulator::new(compile(&scene).unwrap());
    let mut drive = Drive::start(&scene, &mut simulator).unwrap();
    let mut found = vec![[0.0_f64; 2]; fields.len()];
    let k = file["step_size"].as_f64().unwrap();
    let clamps = file["clamped"].as_array().unwrap().len();
    let is_driven = !file["inputs"]["clamp_velocities"]
        .as_array()
        .unwrap()
        .is_empty();
    for sample in file["samples"].as_array().unwrap() {
        let instant = sample["t"].as_f64().unwrap();
        while drive.simulator().time() < instant - 0.5 * k {
            drive.step().unwrap().expect("a sample within the run");
        }
        let simulator = drive.simulator();
        assert!((simulator.time() - instant).abs() < 1e-12);
        for ((port, key), [error, scale]) in fields.iter().zip(&mut found) {
            let expected = numbers(&sample[*key]);
            let values = common::values(simulator, &format!("contact.{port}"));
            assert_eq!(values.len(), expected.len());
            let difference: Vec<f64> = values.iter().zip(&expected).map(|(a, b)| a - b).collect();
            *error = larger(*error, largest(&difference));
            *scale = scale.max(largest(&expected));
        }
        if is_driven {
            for i in 0..clamps {
                let part = file["clamped"][i].as_str().unwrap();
                let expected = numbers(&sample["reaction"][part]);
                for (axis, expected) in ["x", "y"].iter().zip(expected) {
                    let force = common::value(simulator, &format!("{axis}{i}.force"));
                    assert!(
                        (force - expected).abs() < TOLERANCE,
                        "{part} {axis}: {force} {expected}"
                    );
                }
            }
        }
    }
    found
}

const FIELDS: [(&str, &str); 4] = [
    ("slip_rate", "slip_rate"),
    ("slip", "slip"),
    ("tangential_stress", "tangential_stress"),
    ("pressure", "pressure"),
];

fn check(name: &str) {
    let file = load(name);
    let mut fields = FIELDS.to_vec();
    if file["contact"]["friction"]["law"] == "rate_state" {
        fields.push(("friction_state", "theta"));
    }
    if file["contact"]["normal"] != "bilateral" {
        fields.push(("gap", "gap"));
    }
    for model in MODELS {
        for ((field, _), [error, scale]) in fields.iter().zip(compare(&file, model, &fields)) {
            println!(
                "{name:34} {model:10} {field:18} {:.1e} of {scale:.1e}",
                error / scale
            );
            // where no node ever opens all gaps are zero
            let scale = if *field == "gap" {
                scale.max(1e-3)
            } else {
                scale
            };
            assert!(
                error < TOLERANCE * scale,
                "{name}, {model}, {field}: {error:e} of {scale:e}"
            );
        }
    }
}

#[test]
fn bilateral_on_a_belt() {
    check("coulomb_bilateral_belt");
}

#[test]
fn bilateral_that_pulls() {
    check("coulomb_bilateral_abs");
    check("coulomb_bilateral_compressive");
}

#[test]
fn bilateral_that_weakens() {
    check("coulomb_bilateral_exponential_h32");
}

#[test]
fn laws_of_the_slip_rate() {
    check("stribeck_viscous");
    check("table_law");
}

#[test]
fn law_of_the_accumulated_slip() {
    check("slip_weakening");
}

#[test]
fn laws_with_a_state_of_their_own() {
    check("rate_state_aging");
    check("rate_state_slip_law");
}

#[test]
fn map_of_friction() {
    check("friction_map");
}

#[test]
fn foundation_that_gives_way() {
    check("compliance_linear");
    check("compliance_quadratic");
    check("compliance_three_halves");
}

#[test]
fn gap_that_closes() {
    check("unilateral_closing_gap");
    check("unilateral_closing_gap_trbdf2");
    check("unilateral_lift_off");
}

/// Means over the step, and values at its end by an output solve.
#[test]
fn midpoint_rule() {
    let file = load("unilateral_closing_gap_midpoint");
    let fields = [
        ("mean_slip_rate", "slip_rate"),
        ("mean_tangential_stress", "tangential_stress"),
        ("mean_pressure", "pressure"),
        ("slip", "slip"),
        ("gap", "gap"),
        ("slip_rate", "slip_rate_end"),
        ("tangential_stress", "tangential_stress_end"),
        ("pressure", "pressure_end"),
    ];
    for model in MODELS {
        for ((field, _), [error, scale]) in fields.iter().zip(compare(&file, model, &fields)) {
            println!(
                "midpoint {model:10} {field:24} {:.1e} of {scale:.1e}",
                error / scale
            );
            assert!(
                error < TOLERANCE * scale,
                "{model}, {field}: {error:e} of {scale:e}"
            );
        }
    }
}

#[test]
fn parts_that_are_driven() {
    check("clamp_driven_block");
    check("two_clamps");
}
