//! Pressed contact in three dimensions: friction is the same in all directions, a turning disc takes the torque of its friction, a
//! held load stays at rest.

mod common;

use common::{largest, scene, value, values};
use serde_json::{Value, json};
use stickslip::simulator::drive::Drive;
use stickslip::{Simulator, compile};

fn pad(model: &str, tangent: Value, foundation: Value, signals: Value) -> Value {
    json!({"schema_version": 1, "name": "pad",
        "mesh": {"kind": "box", "size": [1.0, 0.5, 0.8], "cells": [4, 2, 3]},
        "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                     "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "three_dimensional"}},
        "driven": [{"part": "top", "directions": {"press": [0, -1, 0]}}],
        "clamped": [],
        "contact": {"part": "bottom", "tangent": tangent, "condition": {"kind": "unilateral", "gap": 0.001},
                    "friction": {"law": "coulomb", "coefficient": {"kind": "exponential", "static": 0.4, "kinetic": 0.3, "decay": 2.0}},
                    "foundation": foundation},
        "time": {"scheme": "tr_bdf2", "step": 0.02},
        "fidelity": {"model": model, "tolerance": 1e-9, "friction_tolerance": 1e-12},
        "run": {"until": 0.8, "signals": signals}})
}

/// Held in all directions from above.
fn held(mut text: Value) -> Value {
    text["driven"][0]["directions"] =
        json!({"press": [0, -1, 0], "hold_x": [1, 0, 0], "hold_z": [0, 0, 1]});
    text
}

fn end(text: &Value) -> Simulator {
    let scene = scene(text);
    let mut simulator = Simulator::new(compile(&scene).unwrap());
    let mut drive = Drive::start(&scene, &mut simulator).unwrap();
    while drive.step().unwrap().is_some() {}
    simulator
}

/// Vectors in global axes of a tangential field.
fn vectors(sim: &Simulator, port: &str) -> Vec<([f64; 3], [f64; 3])> {
    let contact = sim.model().contact();
    let field = values(sim, port);
    let nodes = field.chunks_exact(2).zip(&contact.tangents);
    let global = nodes.map(|(v, [t1, t2])| std::array::from_fn(|i| v[0] * t1[i] + v[1] * t2[i]));
    contact.points.iter().copied().zip(global).collect()
}

/// The frame in which tangential components are counted does not matter.
#[test]
fn friction_is_the_same_in_all_directions() {
    let signals = json!({"press": [[0, 0.02], [0.2, 0.02], [0.3, 0.0]], "belt": [[0, 0], [0.2, 0.3], [0.6, -0.2]]});
    let foundation = json!([{"kind": "sliding", "name": "belt", "direction": [2, 0, 1]}]);
    for model in ["condensed", "reduced"] {
        let run = |tangent: Value| {
            end(&held(pad(
                model,
                tangent,
                foundation.clone(),
                signals.clone(),
            )))
        };
        let (first, second) = (run(json!([1, 0, 0])), run(json!([-1, 0, 3])));
        for port in [
            "contact.slip",
            "contact.slip_rate",
            "contact.tangential_stress",
        ] {
            let (a, b) = (vectors(&first, port), vectors(&second, port));
            let mut size: f64 = 0.0;
            for (point, expected) in &a {
                let (_, found) = b.iter().find(|(p, _)| p == point).unwrap();
                size = size.max(largest(expected));
                let error: Vec<f64> = found.iter().zip(expected).map(|(x, y)| x - y).collect();
                assert!(
                    largest(&error) < 1e-9,
                    "{model} {port} {point:?}: {found:?} {expected:?}"
                );
            }
            assert!(size > 1e-3, "{model} {port}");
        }
        let stick = value(&first, "contact.stick_fraction");
        assert!(stick < 1.0);
        assert!((stick - value(&second, "contact.stick_fraction")).abs() < 1e-12);
    }
}

/// Where every node slides, the torque that turns the foundation is that of mu times the pressure.
#[test]
fn turning_disc_takes_the_torque_of_its_friction() {
    let centre = [0.5, 0.0, -1.0];
    let foundation =
        json!([{"kind": "rotation", "name": "disc", "centre": centre, "axis": [0, 1, 0]}]);
    let signals = json!({"press": [[0, 0.02], [0.2, 0.02], [0.3, 0.0]], "disc": 5.0});
    for model in ["full", "condensed", "reduced"] {
        let mut text = held(pad(
            model,
            json!([1, 0, 0]),
            foundation.clone(),
            signals.clone(),
        ));
        text["contact"]["friction"]["coefficient"] = json!(0.35);
        let sim = end(&text);
        // the leading corner lifts off
        assert_eq!(value(&sim, "contact.stick_fraction"), 0.0);
        assert!(value(&sim, "contact.open_fraction") < 0.1);
        let contact = sim.model().contact();
        let pressure = values(&sim, "contact.pressure");
        // the slip of a node is turned from that of the disc by what the body itself moves, slowly
        let mut expected = 0.0;
        for (node, point) in contact.points.iter().enumerate() {
            let radius = (point[0] - centre[0]).hypot(point[2] - centre[2]);
            expected += 0.35 * pressure[node] * contact.weights[node] * radius;
        }
        let torque = value(&sim, "disc.torque");
        assert!(
            expected > 1e-3 && (torque / expected - 1.0).abs() < 1e-3,
            "{model}: {torque} {expected}"
        );
        let power = torque * 5.0;
        assert!(power > 0.0);
    }
}

/// A load that friction holds is held: nothing creeps, and every step takes the same few iterations.
#[test]
fn held_load_stays_at_rest() {
    let text = json!({"schema_version": 1, "name": "held",
        "mesh": {"kind": "box", "size": [1.0, 0.5, 0.8], "cells": [3, 2, 2]},
        "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                     "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "three_dimensional"}},
        "clamped": ["left"],
        "contact": {"part": "bottom", "condition": {"kind": "unilateral"}, "friction": {"law": "coulomb", "coefficient": 0.6}},
        "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": [0, -1, 0], "start": 0.3},
                  {"name": "pull", "kind": "traction", "part": "top", "direction": [1, 0, 1], "start": 0.03}],
        "time": {"step": 0.1}, "fidelity": {"model": "reduced"}});
    let mut sim = Simulator::new(compile(&scene(&text)).unwrap());
    sim.init(0.0).unwrap();
    for i in 0..2000 {
        sim.do_step(f64::from(i) * 0.1, 0.1).unwrap();
    }
    let (slip, stress) = (
        values(&sim, "contact.slip"),
        values(&sim, "contact.tangential_stress"),
    );
    assert!(largest(&stress) > 0.01);
    let start = sim.internal_steps();
    let factorizations = sim.friction_work().factorizations;
    let mut most: f64 = 0.0;
    for i in 2000..200_000 {
        sim.do_step(f64::from(i) * 0.1, 0.1).unwrap();
        most = most.max(value(&sim, "solver.iterations"));
    }
    assert_eq!(sim.internal_steps() - start, 198_000);
    // no node changes what it does, so nothing is factored
    assert_eq!(sim.friction_work().factorizations, factorizations);
    // not a digit of the slip, and of the stress what rounding leaves in so many steps
    assert_eq!(values(&sim, "contact.slip"), slip);
    assert!(common::relative(&values(&sim, "contact.tangential_stress"), &stress) < 1e-8);
    // two stages a step
    assert!(most <= 4.0, "{most} iterations in a step at rest");
}
