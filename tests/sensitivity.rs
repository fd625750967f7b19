//! Derivatives of a step against central differences through rollback, in stick, slip and mixed regimes.

use serde_json::{Value, json};
use stickslip::{Error, ErrorCode, Scene, Simulator, compile};

const PLANE_BOUND: [(&str, f64); 3] = [("stick", 10.0), ("slip", 1e-4), ("mixed", 0.02)];

fn plane(model: &str, scheme: &str, interpolation: &str, friction: Value) -> Value {
    json!({"schema_version": 1, "name": "plane",
        "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [8, 4]},
        "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                     "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "kazmi2014"}},
        "clamped": ["left"], "contact": {"part": "bottom", "friction": friction},
        "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": [0, 1], "start": -0.3,
                   "interpolation": interpolation},
                  {"name": "pull", "kind": "traction", "part": "right", "direction": [1, 0], "start": 0.05}],
        "probes": [{"name": "tip", "at": [1.0, 0.0]}],
        "time": {"scheme": scheme, "step": 0.02},
        "fidelity": {"model": model, "friction_tolerance": 1e-14}})
}

fn space(model: &str, scheme: &str, bound: f64) -> Value {
    json!({"schema_version": 1, "name": "space",
        "mesh": {"kind": "box", "size": [1.0, 0.25, 0.5], "cells": [4, 1, 2]},
        "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                     "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "three_dimensional"}},
        "clamped": ["top"],
        "contact": {"part": "bottom", "friction": {"law": "exponential", "a": bound, "b": 0.6 * bound, "alpha": 3.0}},
        "loads": [{"name": "drag", "kind": "traction", "part": "left", "direction": [1, 0, 0], "start": 0.1},
                  {"name": "sway", "kind": "traction", "part": "back", "direction": [0, 0, 1], "start": 0.04}],
        "probes": [{"name": "edge", "at": [0.0, 0.0, 0.25]}],
        "time": {"scheme": scheme, "step": 0.02},
        "fidelity": {"model": model, "friction_tolerance": 1e-14}})
}

/// Steps a scene, compares both derivatives with differences, returns the share of the contact that sticks.
fn check(scene: Value, inputs: [f64; 2]) -> f64 {
    check_and_count(scene, inputs, [1.0; 2], [1.1, 0.9]).0
}

/// The same for two first steps with the inputs multiplied by `approach` and a last one with `change`; also how many pairs of steps were refused in it.
fn check_and_count(
    scene: Value,
    inputs: [f64; 2],
    approach: [f64; 2],
    change: [f64; 2],
) -> (f64, u64) {
    let label = format!(
        "{} {} {}",
        scene["name"], scene["fidelity"]["model"], scene["time"]["scheme"]
    );
    let scene = Scene::from_json(&scene.to_string(), "test").unwrap();
    let mut sim = Simulator::new(compile(&scene).unwrap());
    sim.init(0.0).unwrap();
    // the last of the internal steps is not the only one: 0.05 is cut into three
    for ((t, h), factor) in [(0.0, 0.05), (0.05, 0.03)].into_iter().zip(approach) {
        sim.set_inputs(&inputs.map(|v| factor * v)).unwrap();
        sim.do_step(t, h).unwrap();
    }
    let (t, h, last) = (0.08, 0.05, [change[0] * inputs[0], change[1] * inputs[1]]);
    let mut before = sim.new_state();
    sim.save(&mut before).unwrap();
    let mut at = |inputs: [f64; 2]| {
        sim.restore(&before).unwrap();
        let refused = sim.refused_pairs();
        sim.set_inputs(&inputs).unwrap();
        sim.do_step(t, h).unwrap();
        let mut out = vec![0.0; sim.output_len()];
        sim.get_outputs(&mut out).unwrap();
        let stick = sim.get_by_name("contact.stick").unwrap();
        (
            out,
            (stick, sim.internal_steps(), sim.refused_pairs() - refused),
        )
    };
    let mut differences = Vec::new();
    for i in 0..2 {
        let d = 1e-5 * inputs[i].abs();
        let (mut up, mut down) = (last, last);
        up[i] += d;
        down[i] -= d;
        let ((plus, stick), (minus, stick_below)) = (at(up), at(down));
        assert_eq!(
            stick, stick_below,
            "{label}: a kink was met or a step refused, choose another step"
        );
        let column: Vec<f64> = (0..plus.len())
            .map(|j| (plus[j] - minus[j]) / (2.0 * d))
            .collect();
        differences.push(column);
    }
    let (_, (_, _, refused)) = at(last);
    let end = sim.state().clone();
    let seed = [0.7, -0.4];
    let mut tangent = vec![0.0; sim.output_len()];
    sim.directional_derivative(&seed, &mut tangent).unwrap();
    assert_eq!(*sim.state(), end, "the derivative changes nothing");

    let model = sim.model().clone();
    let mut offset = 0;
    for port in model.ports().outputs() {
        let range = offset..offset + port.len();
        offset += port.len();
        if port.name.starts_with("solver.") {
            assert!(tangent[range].iter().all(|v| *v == 0.0));
            continue;
        }
        let expected: Vec<f64> = range
            .clone()
            .map(|j| seed[0] * differences[0][j] + seed[1] * differences[1][j])
            .collect();
        let scale = expected.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        for (found, expected) in tangent[range].iter().zip(&expected) {
            assert!(
                (found - expected).abs() <= 3e-6 * scale + 2e-9,
                "{label}: {}: tangent {found}, difference {expected}",
                port.name
            );
        }
    }

    // <y, J x> = <J^T y, x>
    let y: Vec<f64> = (0..tangent.len()).map(|j| (j as f64).sin()).collect();
    let mut adjoint = [0.0; 2];
    sim.adjoint_derivative(&y, &mut adjoint).unwrap();
    let left: f64 = y.iter().zip(&tangent).map(|(y, t)| y * t).sum();
    let right = adjoint[0] * seed[0] + adjoint[1] * seed[1];
    assert!(
        (left - right).abs() <= 1e-11 * left.abs().max(1e-3),
        "{label}: {left} {right}"
    );
    let stuck = sim.get_by_name("contact.stick_fraction").unwrap()[0];
    (stuck, refused)
}

#[test]
fn the_tangent_is_the_derivative_in_the_plane() {
    for scheme in ["trapezoid", "rectangle", "backward_euler", "tr_bdf2"] {
        for model in ["reduced", "condensed", "full"] {
            for interpolation in ["linear", "hold"] {
                for (regime, a) in PLANE_BOUND {
                    let friction =
                        json!({"law": "exponential", "a": a, "b": 0.5 * a, "alpha": 2.0});
                    let scene = plane(model, scheme, interpolation, friction);
                    let stuck = check(scene, [-0.3, 0.05]);
                    let is_as_named = match regime {
                        "stick" => stuck == 1.0,
                        "slip" => stuck == 0.0,
                        _ => stuck > 0.0 && stuck < 1.0,
                    };
                    assert!(is_as_named, "{regime} {scheme} {model}: {stuck} sticks");
                }
            }
        }
        for friction in [
            json!({"law": "frictionless"}),
            json!({"law": "tresca", "bound": 0.02}),
        ] {
            check(plane("reduced", scheme, "linear", friction), [-0.3, 0.05]);
        }
    }
}

/// Bounds that fall and rise with the slip rate, and differ from node to node, in all regimes.
#[test]
fn the_tangent_is_the_derivative_for_every_law() {
    let field = |a: f64| -> Vec<f64> { (0..8).map(|i| a * (1.0 + 0.1 * f64::from(i))).collect() };
    let mut stick = Vec::new();
    for scheme in ["trapezoid", "backward_euler", "tr_bdf2"] {
        for model in ["full", "reduced"] {
            for (_, a) in PLANE_BOUND {
                let stribeck = |exponent: f64, at_rest: Value| {
                    json!({"kind": "stribeck", "static": at_rest, "kinetic": 0.6 * a, "velocity": 0.1,
                           "exponent": exponent, "viscous": 0.02})
                };
                for bound in [
                    stribeck(1.0, json!(a)),
                    stribeck(1.7, json!(a)),
                    stribeck(2.0, json!({ "nodes": field(a) })),
                    json!({"kind": "table", "rate": [0.0, 0.033, 0.41], "value": [a, 0.8 * a, 1.3 * a]}),
                    json!({"kind": "table", "rate": [0.21], "value": [1.0], "scale": {"nodes": field(a)}}),
                ] {
                    let friction = json!({"law": "bound", "bound": bound});
                    stick.push(check(
                        plane(model, scheme, "linear", friction),
                        [-0.3, 0.05],
                    ));
                }
            }
        }
    }
    assert!(stick.contains(&1.0) && stick.contains(&0.0));
    assert!(stick.iter().any(|share| *share > 0.0 && *share < 1.0));
}

/// Bounds and coefficients that remember slip through a kernel.
#[test]
fn the_tangent_is_the_derivative_with_a_memory_of_slip() {
    let memory = json!({"kernel": [{"weight": 1.0, "tau": 0.1}, {"weight": 0.5, "tau": 0.01}, {"weight": 0.2}]});
    let mut stick = Vec::new();
    for scheme in ["trapezoid", "midpoint", "backward_euler", "tr_bdf2"] {
        for (_, a) in PLANE_BOUND {
            let bound =
                json!({"kind": "slip_weakening", "static": a, "dynamic": 0.3 * a, "distance": 0.5});
            let friction = json!({"law": "bound", "bound": bound, "memory": memory});
            stick.push(check(
                plane("reduced", scheme, "linear", friction),
                [-0.3, 0.05],
            ));
        }
        let coefficient = json!({"kind": "expression", "formula": "0.1 + 0.2 * exp(-s / 0.1)"});
        let friction = json!({"law": "coulomb", "coefficient": coefficient, "memory": memory});
        stick.push(check(
            plane("condensed", scheme, "linear", friction),
            [-0.3, 0.05],
        ));
    }
    assert!(stick.contains(&1.0) && stick.contains(&0.0));
    assert!(stick.iter().any(|share| *share > 0.0 && *share < 1.0));
}

/// Whatever inputs mean: held from the beginning of the step; continued with their last slope, with twice the slope before it, or
/// not continued.
#[test]
fn the_tangent_is_the_derivative_for_every_meaning_of_inputs() {
    let mut stick = Vec::new();
    for scheme in ["trapezoid", "rectangle", "backward_euler", "tr_bdf2"] {
        for (meaning, change) in [
            ("hold", [1.0, 0.9]),
            ("continue", [1.0, 0.9]),
            ("continue", [1.3, 0.95]),
            ("continue", [0.8, 1.4]),
        ] {
            for (_, a) in PLANE_BOUND {
                let friction = json!({"law": "exponential", "a": a, "b": 0.5 * a, "alpha": 2.0});
                let mut scene = plane("reduced", scheme, "linear", friction);
                scene["time"]["inputs"] = json!(meaning);
                stick.push(check_and_count(scene, [-0.3, 0.05], [0.7, 0.85], change).0);
            }
        }
    }
    assert!(stick.contains(&1.0) && stick.contains(&0.0));
}

/// Without a step: velocities and forces follow the loads of the instant, displacements and energies do not.
#[test]
fn the_derivative_at_an_instant_is_that_of_the_consistent_start() {
    for (_, a) in PLANE_BOUND {
        let friction = json!({"law": "exponential", "a": a, "b": 0.5 * a, "alpha": 2.0});
        let scene = plane("reduced", "trapezoid", "linear", friction).to_string();
        let model = compile(&Scene::from_json(&scene, "test").unwrap()).unwrap();
        let at = |inputs: [f64; 2]| {
            let mut sim = Simulator::new(model.clone());
            sim.set_inputs(&inputs).unwrap();
            sim.init(0.0).unwrap();
            sim
        };
        let inputs = [-0.3, 0.05];
        let outputs = |sim: &Simulator| {
            let mut out = vec![0.0; sim.output_len()];
            sim.get_outputs(&mut out).unwrap();
            out
        };
        let (seed, d) = ([0.7, -0.4], 1e-6);
        let moved = |sign: f64| {
            let [x, y] = inputs;
            outputs(&at([x + sign * d * seed[0], y + sign * d * seed[1]]))
        };
        let (plus, minus) = (moved(1.0), moved(-1.0));
        let mut sim = at(inputs);
        let mut found = vec![0.0; sim.output_len()];
        sim.instant_derivative(&seed, &mut found).unwrap();
        let mut offset = 0;
        for port in model.ports().outputs() {
            let range = offset..offset + port.len();
            offset += port.len();
            if port.name.starts_with("solver.") || port.name.contains("stick") {
                continue;
            }
            let expected: Vec<f64> = range
                .clone()
                .map(|i| (plus[i] - minus[i]) / (2.0 * d))
                .collect();
            let scale = expected.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
            for (found, expected) in found[range].iter().zip(&expected) {
                let error = (found - expected).abs();
                // a node that sticks has the rate 0 but for rounding
                assert!(
                    error <= 1e-6 * scale + 1e-14,
                    "{}: {found} {expected}",
                    port.name
                );
            }
            let is_instant = ["slip_rate", "stress", "force", "velocity"];
            let is_instant = is_instant.iter().any(|word| port.name.ends_with(word));
            assert!(is_instant || scale == 0.0, "{}", port.name);
        }
        let weights: Vec<f64> = (0..found.len()).map(|j| (j as f64).sin()).collect();
        let mut adjoint = [0.0; 2];
        sim.instant_adjoint(&weights, &mut adjoint).unwrap();
        let direct: f64 = weights.iter().zip(&found).map(|(w, x)| w * x).sum();
        let back = adjoint[0] * seed[0] + adjoint[1] * seed[1];
        assert!((direct - back).abs() <= 1e-11 * direct.abs().max(1e-3));
    }
}

/// Chosen internal steps are held while the inputs vary: so small a change of inputs does not change them either.
#[test]
fn the_tangent_is_the_derivative_with_chosen_steps() {
    let mut refusals = 0;
    for (scheme, tightest) in [
        ("trapezoid", 1e-6),
        ("backward_euler", 1e-3),
        ("tr_bdf2", 1e-6),
    ] {
        for interpolation in ["linear", "hold"] {
            for (_, a) in PLANE_BOUND {
                for tolerance in [1e-2, tightest] {
                    let friction =
                        json!({"law": "exponential", "a": a, "b": 0.5 * a, "alpha": 2.0});
                    let mut scene = plane("reduced", scheme, interpolation, friction);
                    scene["time"]["tolerance"] = json!(tolerance);
                    // the smallest steps cannot do 1e-14
                    scene["fidelity"]["friction_tolerance"] = json!(1e-13);
                    let change = [3.0, -2.0];
                    let (_, refused) = check_and_count(scene, [-0.3, 0.05], [1.0; 2], change);
                    refusals += refused;
                }
            }
        }
        let mut scene = space("reduced", scheme, 0.012);
        scene["time"]["tolerance"] = json!(1e-3);
        check(scene, [0.1, 0.04]);
    }
    assert!(refusals > 0, "no tangent was undone");
}

#[test]
fn the_tangent_is_the_derivative_in_space() {
    for scheme in ["trapezoid", "rectangle", "backward_euler", "tr_bdf2"] {
        for model in ["reduced", "condensed"] {
            for (regime, bound) in [("stick", 10.0), ("slip", 1e-4), ("mixed", 0.012)] {
                let stuck = check(space(model, scheme, bound), [0.1, 0.04]);
                let is_as_named = match regime {
                    "stick" => stuck == 1.0,
                    "slip" => stuck == 0.0,
                    _ => stuck > 0.0 && stuck < 1.0,
                };
                assert!(is_as_named, "{regime} {scheme} {model}: {stuck} sticks");
            }
        }
    }
}

#[test]
fn a_derivative_needs_a_step_and_fitting_arrays() {
    let friction = json!({"law": "tresca", "bound": 0.02});
    let scene = plane("reduced", "trapezoid", "linear", friction).to_string();
    let scene = Scene::from_json(&scene, "test").unwrap();
    let mut sim = Simulator::new(compile(&scene).unwrap());
    let mut out = vec![7.0; sim.output_len()];
    let code = |r: Result<(), Error>| r.unwrap_err().code();
    let order = ErrorCode::CallOrder;
    assert_eq!(
        code(sim.directional_derivative(&[1.0, 0.0], &mut out)),
        order
    );
    sim.init(0.0).unwrap();
    assert_eq!(
        code(sim.directional_derivative(&[1.0, 0.0], &mut out)),
        order
    );
    sim.do_step(0.0, 0.02).unwrap();
    assert_eq!(
        code(sim.directional_derivative(&[1.0], &mut out)),
        ErrorCode::Length
    );
    assert_eq!(
        code(sim.directional_derivative(&[1.0, 0.0], &mut out[1..])),
        ErrorCode::Length
    );
    assert_eq!(
        code(sim.directional_derivative(&[1.0, f64::NAN], &mut out)),
        ErrorCode::Value
    );
    assert!(
        out.iter().all(|v| *v == 7.0),
        "outputs untouched on failure"
    );
    let state = sim.state().clone();
    // a refused step leaves the derivative of the last one
    assert_eq!(code(sim.do_step(5.0, 0.02)), ErrorCode::Step);
    sim.directional_derivative(&[1.0, 0.0], &mut out).unwrap();
    sim.restore(&state).unwrap();
    assert_eq!(
        code(sim.directional_derivative(&[1.0, 0.0], &mut out)),
        order
    );
}
