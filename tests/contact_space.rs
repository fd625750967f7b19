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

/// A slice of a long body, periodic along its axis, is the plane body under plane strain: pressure, slip, stress and the force of the
/// belt node by node, through closing, sticking, slipping and opening.
#[test]
fn plane_strain_is_a_slice_of_space() {
    let of = |mesh: Value, convention: &str, model: &str| {
        json!({"schema_version": 1, "name": "slice", "mesh": mesh,
            "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                         "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": convention}},
            "clamped": ["top"],
            "contact": {"part": "bottom", "condition": {"kind": "unilateral", "gap": 0.001},
                        "friction": {"law": "coulomb", "coefficient": {"kind": "exponential", "static": 0.4, "kinetic": 0.3, "decay": 2.0}},
                        "foundation": [{"kind": "approach", "name": "rise"}, {"kind": "sliding", "name": "belt", "direction": direction(convention)}]},
            "time": {"step": 0.02},
            "fidelity": {"model": model, "tolerance": 1e-9, "friction_tolerance": 1e-12},
            "run": {"until": 0.8, "signals": {"rise": [[0, 0], [0.3, 0.05], [0.5, 0.05], [0.8, 0.0]],
                                              "belt": [[0, 0], [0.1, 0.2], [0.5, -0.2], [0.8, -0.2]]}}})
    };
    let plane = json!({"kind": "rectangle", "size": [1.0, 0.5], "cells": [8, 4]});
    let space =
        json!({"kind": "box", "size": [1.0, 0.5, 1.0], "cells": [8, 4, 1], "periodic": ["z"]});
    for (model, tolerance) in [("full", 1e-10), ("condensed", 1e-10), ("reduced", 1e-7)] {
        let scenes = [
            of(plane.clone(), "plane_strain", model),
            of(space.clone(), "three_dimensional", model),
        ]
        .map(|text| scene(&text));
        let mut simulators = scenes
            .each_ref()
            .map(|scene| Simulator::new(compile(scene).unwrap()));
        let [first, second] = &mut simulators;
        let mut drives = [
            Drive::start(&scenes[0], first).unwrap(),
            Drive::start(&scenes[1], second).unwrap(),
        ];
        let (mut open, mut slips, mut sticks) = (0, 0, 0);
        loop {
            let [first, second] = &mut drives;
            let (Some(flat), Some(deep)) = (first.step().unwrap(), second.step().unwrap()) else {
                break;
            };
            for (port, size) in [
                ("contact.pressure", 0.1),
                ("contact.gap", 0.05),
                ("contact.slip", 0.1),
                ("contact.tangential_stress", 0.03),
                ("belt.force", 0.03),
            ] {
                let expected = values(flat, port);
                let found = values(deep, port);
                let components = found.len() / expected.len();
                for (i, expected) in expected.iter().enumerate() {
                    let own = &found[i * components..(i + 1) * components];
                    let error = (own[0] - expected).abs() / size;
                    assert!(error < tolerance, "{model} {port} {i}: {own:?} {expected}");
                    let across = own.get(1).copied().unwrap_or(0.0);
                    assert!(
                        across.abs() < tolerance * size,
                        "{model} {port} {i}: {across}"
                    );
                }
            }
            let status = values(flat, "contact.status");
            assert_eq!(status, values(deep, "contact.status"));
            open += status.iter().filter(|s| **s == 0.0).count();
            sticks += status.iter().filter(|s| **s == 1.0).count();
            slips += status.iter().filter(|s| **s == 2.0).count();
        }
        assert!(
            open > 20 && slips > 50 && sticks > 5,
            "{open} {slips} {sticks}"
        );
    }
}

fn direction(convention: &str) -> Value {
    match convention {
        "plane_strain" => json!([1, 0]),
        _ => json!([1, 0, 0]),
    }
}
