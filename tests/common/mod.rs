//! Scenes and runs shared by the tests.
#![allow(dead_code)] // every test binary uses its own part

use serde_json::{Value, json};
use std::sync::Arc;
use stickslip::{Compilation, Model, Scene, Simulator, compile};

/// The paper's example with `cells` along x (half as many along y) and the given overrides, as JSON paths.
pub fn paper(cells: u32, overrides: &[(&str, &str)]) -> Scene {
    let text = stickslip::scene::example("kazmi2014").expect("an embedded scene");
    let mut all = vec![(
        "mesh.cells".to_string(),
        format!("[{cells}, {}]", (cells / 2).max(1)),
    )];
    all.extend(
        overrides
            .iter()
            .map(|(p, v)| (p.to_string(), v.to_string())),
    );
    Scene::with_overrides(text, "kazmi2014", &all).expect("a valid scene")
}

/// A scene from its JSON value.
pub fn scene(value: &Value) -> Scene {
    Scene::from_json(&value.to_string(), "test scene").expect("a valid scene")
}

/// A simulator of a freshly compiled scene, initialized at 0.
pub fn start(scene: &Scene) -> Simulator {
    started(compile(scene).expect("a scene that compiles"))
}

/// A simulator of a model, initialized at 0.
pub fn started(model: Arc<Model>) -> Simulator {
    let mut simulator = Simulator::new(model);
    simulator.init(0.0).expect("a start that converges");
    simulator
}

/// `count` steps of size `k` from the current time.
pub fn steps(simulator: &mut Simulator, k: f64, count: usize) {
    for _ in 0..count {
        simulator
            .do_step(simulator.time(), k)
            .expect("a step that converges");
    }
}

/// One value of a scalar port.
pub fn value(simulator: &Simulator, port: &str) -> f64 {
    simulator.get_by_name(port).expect("a known port")[0]
}

/// Values of a port.
pub fn values(simulator: &Simulator, port: &str) -> Vec<f64> {
    simulator.get_by_name(port).expect("a known port")
}

pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// Largest difference relative to the largest reference value.
pub fn relative(found: &[f64], reference: &[f64]) -> f64 {
    assert_eq!(found.len(), reference.len());
    let difference: Vec<f64> = found.iter().zip(reference).map(|(a, b)| a - b).collect();
    largest(&difference) / largest(reference).max(f64::MIN_POSITIVE)
}

/// Strain norm of a nodal field on the body of a compilation.
pub fn strain_norm(compilation: &Compilation, field: &[f64]) -> f64 {
    let (x, y) = stickslip::qvi::strain_weights(&compilation.body);
    let (a, b) = compilation.body.operators.product(field, field);
    (x * a + y * b).sqrt()
}

/// A block `length` x `height`, one cell wide and periodic along x, clamped on top, in contact at the bottom: simple
/// shear, one contact node.
pub fn column(friction: Value, time: Value) -> Value {
    json!({
        "schema_version": 1, "name": "column",
        "mesh": {"kind": "rectangle", "size": [1.0, 1.0], "cells": [1, 1], "periodic": ["x"]},
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 0.5, "mu2": 2.0},
            "elasticity": {"law": "isotropic", "young": 6.0, "poisson": 0.25, "convention": "plane_strain"}
        },
        "clamped": ["top"],
        "contact": {"part": "bottom", "friction": friction},
        "loads": [{"name": "drag", "kind": "body_force", "direction": [1, 0]}],
        "time": time,
        "fidelity": {"model": "full", "friction_tolerance": 1e-13}
    })
}
