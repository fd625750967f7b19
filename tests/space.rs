//! Three dimensions: plane strain equals the plane run, and the law does not prefer an axis.

mod common;

use common::{relative, scene, start, started, steps, value, values};
use serde_json::{Value, json};
use std::sync::Arc;
use stickslip::mesh::Mesh;
use stickslip::{Compilation, Simulator};

fn slab(mesh: Value, convention: &str, up: Value, fidelity: &Value) -> Value {
    json!({
        "schema_version": 1, "name": "slab", "mesh": mesh,
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
            "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": convention}
        },
        "clamped": ["left"],
        "contact": {"part": "bottom", "friction": {"law": "exponential", "a": 0.003, "b": 0.001, "alpha": 100.0}},
        "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": up, "start": -0.3}],
        "time": {"step": 0.0625}, "fidelity": fidelity
    })
}

/// A slab one cell thick and periodic along z is in plane strain: the run in the plane, with nothing along z.
#[test]
fn plane_strain_equals_the_plane_run() {
    let thickness = 0.7;
    for model in ["full", "condensed", "reduced"] {
        let fidelity = json!({"model": model, "tolerance": 1e-9, "friction_tolerance": 1e-12});
        let plane = slab(
            json!({"kind": "rectangle", "size": [1.0, 0.5], "cells": [16, 8]}),
            "plane_strain",
            json!([0, 1]),
            &fidelity,
        );
        let space = slab(
            json!({"kind": "box", "size": [1.0, 0.5, thickness], "cells": [16, 8, 1], "periodic": ["z"]}),
            "three_dimensional",
            json!([0, 1, 0]),
            &fidelity,
        );
        let (mut plane, mut space) = (start(&scene(&plane)), start(&scene(&space)));
        for _ in 0..16 {
            steps(&mut plane, 0.0625, 1);
            steps(&mut space, 0.0625, 1);
            for (port, tolerance) in [
                ("slip_rate", 1e-9),
                ("slip", 1e-9),
                ("tangential_stress", 1e-7),
            ] {
                let port = format!("contact.{port}");
                let both = values(&space, &port);
                let along: Vec<f64> = both.iter().step_by(2).copied().collect();
                let across: Vec<f64> = both.iter().skip(1).step_by(2).copied().collect();
                let expected = values(&plane, &port);
                assert!(relative(&along, &expected) < tolerance, "{model}, {port}");
                let scale = common::largest(&expected);
                assert!(
                    common::largest(&across) < tolerance * scale,
                    "{model}, {port} across"
                );
            }
        }
        let (plane, space) = (
            value(&plane, "press.displacement"),
            value(&space, "press.displacement"),
        );
        assert!((space / plane - 1.0).abs() < 1e-9);
    }
}

fn block(push: Value, tangent: Value) -> Value {
    json!({
        "schema_version": 1, "name": "block",
        "mesh": {"kind": "box", "size": [1.0, 0.5, 0.6], "cells": [6, 3, 4]},
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
            "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "three_dimensional"}
        },
        "clamped": ["left"],
        "contact": {
            "part": "bottom", "tangent": tangent,
            "friction": {"law": "exponential", "a": 0.02, "b": 0.01, "alpha": 20.0}
        },
        "loads": [{"name": "push", "kind": "traction", "part": "top", "direction": push, "start": 0.1}],
        "time": {"step": 0.05}, "fidelity": {"model": "condensed", "friction_tolerance": 1e-12}
    })
}

/// Rotates the mesh about y by a quarter turn: (x, y, z) -> (z, y, -x).
fn quarter_turn(mesh: &Mesh) -> Mesh {
    let mut turned = mesh.clone();
    for [x, _, z] in &mut turned.nodes {
        (*x, *z) = (*z, -*x);
    }
    turned
}

fn run(value: &Value, turn: bool) -> Simulator {
    let scene = scene(value);
    let mesh = Mesh::generate(&scene.mesh).unwrap();
    let mesh = if turn { quarter_turn(&mesh) } else { mesh };
    let compilation = Compilation::on_mesh(&scene, mesh).unwrap();
    let mut simulator = started(Arc::clone(&compilation.model));
    steps(&mut simulator, 0.05, 20);
    simulator
}

/// A vector at a contact node, in global axes.
fn vectors(simulator: &Simulator, port: &str) -> Vec<([f64; 3], [f64; 3])> {
    let contact = simulator.model().contact();
    let flat = values(simulator, port);
    contact
        .points
        .iter()
        .zip(&contact.tangents)
        .zip(flat.chunks_exact(2))
        .map(|((point, [t1, t2]), v)| {
            (*point, std::array::from_fn(|i| v[0] * t1[i] + v[1] * t2[i]))
        })
        .collect()
}

/// The body, its load and its mesh turned by a quarter about the contact normal: the same slip, turned.
#[test]
fn turned_body_slips_alike() {
    // a push oblique to the axes, so that both components slip and the direction changes along the contact
    let straight = run(&block(json!([2, -1, 1]), json!([1, 0, 0])), false);
    // (2, -1, 1) turned is (1, -1, -2); the frame stays along the axes, so the components change places
    let turned = run(&block(json!([1, -1, -2]), json!([1, 0, 0])), true);
    for port in [
        "contact.slip_rate",
        "contact.slip",
        "contact.tangential_stress",
    ] {
        let (a, b) = (vectors(&straight, port), vectors(&turned, port));
        let scale = common::largest(&values(&straight, port));
        assert!(scale > 0.0);
        for (point, v) in a {
            let image = [point[2], point[1], -point[0]];
            let (_, w) = b
                .iter()
                .find(|(p, _)| (0..3).all(|i| (p[i] - image[i]).abs() < 1e-12))
                .expect("the turned mesh has the turned nodes");
            let expected = [v[2], v[1], -v[0]];
            for i in 0..3 {
                assert!(
                    (w[i] - expected[i]).abs() < 1e-8 * scale,
                    "{port} at {point:?}: {w:?} {expected:?}"
                );
            }
        }
    }
}

/// The first tangent may be named: the same physics in other components.
#[test]
fn named_tangent_only_renames_components() {
    let straight = run(&block(json!([2, -1, 1]), json!([1, 0, 0])), false);
    let oblique = run(&block(json!([2, -1, 1]), json!([1, 0, 2])), false);
    for port in ["contact.slip_rate", "contact.tangential_stress"] {
        let scale = common::largest(&values(&straight, port));
        let (a, mut b) = (vectors(&straight, port), vectors(&oblique, port));
        for (point, v) in a {
            let at = b
                .iter()
                .position(|(p, _)| *p == point)
                .expect("the same nodes");
            let (_, w) = b.swap_remove(at);
            for i in 0..3 {
                assert!((w[i] - v[i]).abs() < 1e-8 * scale, "{port} at {point:?}");
            }
        }
    }
    let slips = values(&straight, "contact.slip_rate")
        .chunks_exact(2)
        .any(|v| v[0] * v[1] != 0.0);
    assert!(slips, "the push must make both components slip");
}
