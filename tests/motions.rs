//! Inputs that move something: the power balance in every combination, displacements as inputs, derivatives against differences,
//! rollback and bytes.

mod common;

use common::{scene, value, values};
use serde_json::{Value, json};
use stickslip::simulator::drive::Drive;
use stickslip::{Model, Simulator, compile};

/// What the scenes have: condition and friction.
const PRESSED: [&str; 7] = [
    "bound",
    "bilateral",
    "unilateral",
    "compliance",
    "relaxing",
    "rotation",
    "rate_and_state",
];

fn text(kind: &str, model: &str, scheme: &str, input: &str) -> Value {
    let condition = match kind {
        "unilateral" | "rate_and_state" => json!({"kind": "unilateral", "gap": 0.001}),
        "compliance" => json!({"kind": "compliance", "stiffness": 40.0, "exponent": 1.5}),
        "relaxing" => json!({"kind": "compliance", "stiffness": 20.0, "exponent": 1.5, "memory": {
            "kernel": [{"weight": 3.0, "tau": 0.05}, {"weight": 1.0, "tau": 4.0}]}}),
        _ => json!({"kind": "bilateral"}),
    };
    let friction = match kind {
        "rate_and_state" => json!({"law": "coulomb", "coefficient": {
            "kind": "rate_and_state", "coefficient": 0.4, "a": 0.02, "b": 0.015, "rate": 0.001, "distance": 0.02, "evolution": "aging"}}),
        "bound" => json!({"law": "exponential", "a": 0.05, "b": 0.03, "alpha": 3.0}),
        _ => {
            json!({"law": "coulomb", "coefficient": {"kind": "exponential", "static": 0.4, "kinetic": 0.3, "decay": 0.8}})
        }
    };
    let mut foundation = match kind {
        "rotation" => vec![json!({"kind": "rotation", "name": "disc", "centre": [0.5, -1.0]})],
        _ => vec![json!({"kind": "sliding", "name": "disc", "direction": [2, 0]})],
    };
    if kind != "bound" {
        foundation.push(json!({"kind": "approach", "name": "rise"}));
    }
    // two parts that move apart strain the body: columns of their own; a part that is driven along one direction is free otherwise
    let driven = match kind {
        "bound" => json!([{"part": "top", "input": input, "directions": {"left_x": [3, 0]}}]),
        _ => json!([
            {"part": "left", "input": input, "directions": {"left_x": [1, 0], "left_y": [0, 1]}},
            {"part": "right", "input": input, "directions": {"right_x": [-2, 0], "turn": {"centre": [1.0, 0.5]}}},
        ]),
    };
    json!({"schema_version": 1, "name": kind,
        "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [8, 4]},
        "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                     "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"}},
        "driven": driven,
        "contact": {"part": "bottom", "condition": condition, "friction": friction, "foundation": foundation},
        "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": [0, -1]}],
        "probes": [{"name": "middle", "at": [0.5, 0.25]}],
        "time": {"scheme": scheme, "step": 0.02, "force": true},
        "fidelity": {"model": model, "tolerance": 1e-9, "friction_tolerance": 1e-13}})
}

fn inputs_at(model: &Model, t: f64) -> Vec<f64> {
    let inputs = model
        .ports()
        .all()
        .iter()
        .filter(|p| p.causality == stickslip::ports::Causality::Input);
    inputs
        .map(|port| match port.name.as_str() {
            "press" => 0.3 + 0.1 * (3.0 * t).sin(),
            "disc" => 0.2 * (4.0 * t).cos(),
            "rise" => 0.004 * t,
            "left_x" => 0.04 * (5.0 * t).sin(),
            "left_y" => -0.02 * (2.0 * t).sin(),
            "right_x" => 0.03 * (3.0 * t).sin(),
            "turn" => 0.05 * (2.0 * t).sin(),
            other => panic!("{other}"),
        })
        .collect()
}

fn run(text: &Value, steps: u32) -> Simulator {
    let scene = scene(text);
    let mut sim = Simulator::new(compile(&scene).unwrap());
    let model = sim.model().clone();
    sim.set_inputs(&inputs_at(&model, 0.0)).unwrap();
    sim.init(0.0).unwrap();
    let k = 0.02;
    for i in 0..steps {
        let t = f64::from(i) * k;
        sim.set_inputs(&inputs_at(&model, t + k)).unwrap();
        sim.do_step(t, k).unwrap();
    }
    sim
}

/// What drives equals what is stored and dissipated: to rounding for the trapezoid and bilateral contact, with the numerical
/// dissipation of the scheme otherwise, which falls with the step.
#[test]
fn power_balance_is_closed() {
    for model in ["full", "condensed", "reduced"] {
        for kind in ["bound", "bilateral", "rotation"] {
            for input in ["velocity", "displacement"] {
                let mut scene = text(kind, model, "trapezoid", input);
                // the foundation at rest along its normal: a kink of its approach makes the trapezoid ring
                if kind != "bound" {
                    scene["contact"]["foundation"].as_array_mut().unwrap().pop();
                }
                let sim = run(&scene, 40);
                let work = value(&sim, "energy.external_work");
                let error = value(&sim, "energy.balance_error");
                let stored =
                    value(&sim, "energy.elastic") + value(&sim, "energy.friction_dissipation");
                assert!(
                    work.abs() > 1e-4 && stored > 1e-5,
                    "{kind}: {work} {stored}"
                );
                assert!(
                    error.abs() < 1e-12 * work.abs().max(stored),
                    "{kind} {model} {input}: {error:e} of {work:e}"
                );
            }
        }
        for kind in ["unilateral", "compliance", "relaxing"] {
            let balance = |step: f64| {
                let mut scene = text(kind, model, "tr_bdf2", "velocity");
                scene["time"]["step"] = json!(step);
                let sim = run(&scene, 40);
                value(&sim, "energy.balance_error") / value(&sim, "energy.external_work")
            };
            let errors = [0.02, 0.005, 0.00125, 0.0003125].map(balance);
            // nodes that close lose energy by the step
            assert!(errors[0].abs() < 0.05, "{kind} {model}: {errors:?}");
            assert!(
                errors[3].abs() < 0.1 * errors[0].abs(),
                "{kind} {model}: {errors:?}"
            );
        }
    }
}

/// A part whose displacement is given goes where the displacement of its velocity leads, at every communication point.
#[test]
fn displacements_are_reached_at_the_end_of_every_step() {
    let sim = run(
        &text("unilateral", "condensed", "tr_bdf2", "displacement"),
        30,
    );
    let model = sim.model().clone();
    let expected = inputs_at(&model, 0.6);
    let ports = model.ports().all();
    for name in ["left_x", "left_y", "right_x", "turn"] {
        let at = ports.iter().position(|p| p.name == name).unwrap();
        let found = value(&sim, &format!("{name}.displacement"));
        assert!(
            (found - expected[at]).abs() < 1e-15,
            "{name}: {found} {}",
            expected[at]
        );
    }
    let moved = values(&sim, "middle.displacement");
    assert!(moved.iter().all(|v| v.abs() > 1e-4));
}

/// Both derivatives of a step and of an instant by all inputs, against central differences through rollback.
#[test]
fn derivatives_are_those_of_differences() {
    let mut compared = 0;
    for kind in PRESSED {
        for scheme in ["tr_bdf2", "backward_euler", "midpoint"] {
            for model in ["condensed", "reduced"] {
                for input in ["velocity", "displacement"] {
                    compared += compare_derivatives(kind, scheme, model, input);
                }
            }
        }
    }
    assert!(compared > 5000, "{compared}");
}

fn compare_derivatives(kind: &str, scheme: &str, model: &str, input: &str) -> usize {
    let mut sim = run(&text(kind, model, scheme, input), 20);
    let label = format!("{kind} {scheme} {model} {input}");
    let compiled = sim.model().clone();
    let (t, h) = (sim.time(), 0.03);
    let at = inputs_at(&compiled, t + h);
    let mut saved = sim.new_state();
    sim.save(&mut saved).unwrap();
    let mut step = |inputs: &[f64]| {
        sim.restore(&saved).unwrap();
        sim.set_inputs(inputs).unwrap();
        sim.do_step(t, h).unwrap();
        let mut out = vec![0.0; sim.output_len()];
        sim.get_outputs(&mut out).unwrap();
        let marks = match kind {
            "bound" | "bilateral" | "rotation" => values(&sim, "contact.stick"),
            _ => values(&sim, "contact.status"),
        };
        (out, marks)
    };
    let count = at.len();
    let mut differences = Vec::new();
    for i in 0..count {
        let size = 1e-6 * at[i].abs().max(1e-3);
        let (mut up, mut down) = (at.clone(), at.clone());
        up[i] += size;
        down[i] -= size;
        let ((high, of_high), (low, of_low)) = (step(&up), step(&down));
        // a node that changes what it does makes a kink
        differences.push((of_high == of_low).then(|| {
            let pairs = high.iter().zip(&low);
            pairs
                .map(|(h, l)| (h - l) / (2.0 * size))
                .collect::<Vec<f64>>()
        }));
    }
    step(&at);
    // counts and figures of the solver have the derivative 0
    let mut is_smooth = Vec::new();
    for port in compiled.ports().outputs() {
        let smooth = ![
            "solver.",
            "contact.stick",
            "contact.status",
            "contact.open_fraction",
        ]
        .iter()
        .any(|p| port.name.starts_with(p));
        is_smooth.extend(std::iter::repeat_n((smooth, port.name.clone()), port.len()));
    }
    let mut compared = 0;
    let mut rows = vec![vec![0.0; sim.output_len()]; count];
    for i in 0..count {
        let mut seed = vec![0.0; count];
        seed[i] = 1.0;
        sim.directional_derivative(&seed, &mut rows[i]).unwrap();
        let Some(difference) = &differences[i] else {
            continue;
        };
        let size = common::largest(difference);
        for (j, (found, expected)) in rows[i].iter().zip(difference).enumerate() {
            if !is_smooth[j].0 {
                continue;
            }
            let error = (found - expected).abs();
            assert!(
                error < 2e-5 * size.max(1.0),
                "{label}: {} by input {i}: {found} {expected}",
                is_smooth[j].1
            );
            compared += 1;
        }
    }
    let mut adjoint = vec![0.0; count];
    let weights: Vec<f64> = (0..sim.output_len()).map(|j| (j as f64).cos()).collect();
    sim.adjoint_derivative(&weights, &mut adjoint).unwrap();
    for (row, found) in rows.iter().zip(&adjoint) {
        let expected: f64 = row.iter().zip(&weights).map(|(a, b)| a * b).sum();
        let size: f64 = row.iter().zip(&weights).map(|(a, b)| (a * b).abs()).sum();
        assert!(
            (found - expected).abs() < 1e-11 * size,
            "{label}: {found} {expected}"
        );
    }
    compared
}

/// A restored state continues bit for bit, in the same simulator, another one and from bytes.
#[test]
fn rollback_is_exact() {
    for kind in PRESSED {
        for (scheme, model) in [
            ("tr_bdf2", "reduced"),
            ("midpoint", "condensed"),
            ("backward_euler", "full"),
        ] {
            let scene = scene(&text(kind, model, scheme, "velocity"));
            let compiled = compile(&scene).unwrap();
            let mut sim = Simulator::new(compiled.clone());
            sim.set_inputs(&inputs_at(&compiled, 0.0)).unwrap();
            sim.init(0.0).unwrap();
            let go = |sim: &mut Simulator, from: u32, to: u32| {
                for i in from..to {
                    let t = f64::from(i) * 0.02;
                    sim.set_inputs(&inputs_at(&compiled, t + 0.02)).unwrap();
                    sim.do_step(t, 0.02).unwrap();
                }
                sim.to_bytes()
            };
            go(&mut sim, 0, 10);
            let saved = sim.to_bytes();
            let first = go(&mut sim, 10, 25);
            let mut other = Simulator::new(compile(&scene).unwrap());
            other.restore_bytes(&saved).unwrap();
            assert!(
                go(&mut other, 10, 25) == first,
                "{kind} {scheme}: another simulator"
            );
            sim.restore_bytes(&saved).unwrap();
            assert!(
                go(&mut sim, 10, 25) == first,
                "{kind} {scheme}: the same simulator"
            );
            let model = Model::from_bytes(&compiled.to_bytes()).unwrap();
            assert_eq!(model.to_bytes(), compiled.to_bytes());
            let mut third = Simulator::new(std::sync::Arc::new(model));
            third.restore_bytes(&saved).unwrap();
            assert!(
                go(&mut third, 10, 25) == first,
                "{kind} {scheme}: a model from bytes"
            );
        }
    }
}

/// The run of a scene follows its signals between communication points too.
#[test]
fn signals_are_followed_within_steps() {
    let end = |step: f64| {
        let mut text = text("unilateral", "condensed", "tr_bdf2", "velocity");
        text["run"] = json!({"until": 0.4, "step": step, "signals": {
            "press": 0.3, "left_y": [[0, 0], [0.15, -0.02], [1, 0]], "disc": [[0, 0], [0.1, 0.3], [0.33, -0.2]], "rise": [[0, 0], [0.25, 0.004], [1, 0.0]]}});
        let scene = scene(&text);
        let mut sim = Simulator::new(compile(&scene).unwrap());
        let mut drive = Drive::start(&scene, &mut sim).unwrap();
        while drive.step().unwrap().is_some() {}
        values(&sim, "contact.slip")
    };
    let (fine, coarse) = (end(0.02), end(0.2));
    assert!(common::relative(&coarse, &fine) < 1e-12);
}

/// Inputs that jump show in no output before the next step, and in all of them after it.
#[test]
fn jumps_show_with_the_next_step() {
    for kind in ["bilateral", "unilateral", "compliance"] {
        let mut sim = run(&text(kind, "condensed", "tr_bdf2", "velocity"), 10);
        let model = sim.model().clone();
        let outputs = |sim: &Simulator| {
            let mut out = vec![0.0; sim.output_len()];
            sim.get_outputs(&mut out).unwrap();
            out
        };
        let before = outputs(&sim);
        let mut jumped = inputs_at(&model, sim.time());
        for (value, by) in jumped
            .iter_mut()
            .zip([0.2, 0.01, 0.01, 0.01, 0.01, 0.1, 0.001])
        {
            *value += by;
        }
        sim.jump_inputs(&jumped).unwrap();
        assert_eq!(outputs(&sim), before, "{kind}");
        sim.do_step(sim.time(), 0.02).unwrap();
        assert!(common::relative(&outputs(&sim), &before) > 1e-3);
    }
}
