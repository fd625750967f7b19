//! The friction solver at the extremes: steps from 1e-6 to 10, weakening from none to brutal, frictionless to fully stuck,
//! in the plane and in space. Every step must meet the residual of the friction law; none may fail or go on for long.

mod common;

use common::{largest, paper, scene, start, value, values};
use serde_json::{Value, json};
use stickslip::{Scene, Simulator};

/// Runs a few steps of size `k` and returns the most iterations of one step.
fn endure(scene: &Scene, k: f64, count: usize) -> f64 {
    let mut simulator = start(scene);
    let mut most: f64 = 0.0;
    for step in 0..count {
        // a load that swings makes the slip reverse
        let swing = -0.3 * (1.0 + 0.8 * (step as f64).sin());
        let inputs = vec![swing; simulator.model().input_count()];
        simulator.set_inputs(&inputs).unwrap();
        simulator
            .do_step(simulator.time(), k)
            .unwrap_or_else(|e| panic!("k = {k}, {:?}: {e}", scene.contacts()[0].friction));
        assert!(value(&simulator, "solver.residual") <= 1e-10);
        most = most.max(value(&simulator, "solver.iterations"));
        assert!(
            values(&simulator, "contact.slip_rate")
                .iter()
                .all(|v| v.is_finite())
        );
    }
    most
}

fn frictions() -> Vec<Value> {
    let mut all = vec![
        json!({"law": "frictionless"}),
        json!({"law": "tresca", "bound": 0.002}),
        json!({"law": "tresca", "bound": 1e9}),
        json!({"law": "exponential", "a": 1e-9, "b": 0.0, "alpha": 1e4}),
    ];
    for alpha in [0.0, 1.0, 100.0, 400.0, 1e3, 1e4] {
        all.push(json!({"law": "exponential", "a": 0.003, "b": 0.001, "alpha": alpha}));
        all.push(json!({"law": "exponential", "a": 0.3, "b": 0.0, "alpha": alpha}));
    }
    all
}

const STEPS: [f64; 8] = [1e-6, 1e-4, 1e-2, 0.03125, 0.25, 1.0, 3.0, 10.0];

#[test]
fn plane() {
    for scheme in ["trapezoid", "backward_euler", "tr_bdf2"] {
        let mut most: f64 = 0.0;
        for friction in frictions() {
            for k in STEPS {
                let scene = paper(
                    16,
                    &[
                        ("time.scheme", scheme),
                        ("time.step", &k.to_string()),
                        ("contact.friction", &friction.to_string()),
                    ],
                );
                most = most.max(endure(&scene, k, 12));
            }
        }
        assert!(most <= 60.0, "{scheme}: {most}");
    }
}

fn block(friction: &Value, scheme: &str, k: f64) -> Scene {
    scene(&json!({
        "schema_version": 1, "name": "block",
        "mesh": {"kind": "box", "size": [1.0, 0.5, 0.8], "cells": [5, 2, 4]},
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
            "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "three_dimensional"}
        },
        "clamped": ["left"],
        "contact": {"part": "bottom", "friction": friction},
        "loads": [
            {"name": "press", "kind": "traction", "part": "top", "direction": [0, 1, 0], "start": -0.3},
            {"name": "shear", "kind": "traction", "part": "right", "direction": [0, 0, 1], "start": 0.05}
        ],
        "time": {"scheme": scheme, "step": k}
    }))
}

#[test]
fn space() {
    for scheme in ["trapezoid", "tr_bdf2"] {
        let mut most: f64 = 0.0;
        for friction in frictions() {
            for k in STEPS {
                most = most.max(endure(&block(&friction, scheme, k), k, 8));
            }
        }
        assert!(most <= 60.0, "{scheme}: {most}");
    }
}

/// A bound far above the load: nothing moves at the contact, exactly.
#[test]
fn fully_stuck_is_exactly_at_rest() {
    let mut simulator = start(&block(
        &json!({"law": "tresca", "bound": 1e6}),
        "trapezoid",
        0.1,
    ));
    for _ in 0..5 {
        simulator.do_step(simulator.time(), 0.1).unwrap();
    }
    assert_eq!(largest(&values(&simulator, "contact.slip")), 0.0);
    assert_eq!(value(&simulator, "contact.stick_fraction"), 1.0);
}

/// Wild jumps of load and step from one step to the next.
#[test]
fn wild_loads_and_steps() {
    let mut simulator: Simulator = start(&paper(
        32,
        &[("contact.friction.alpha", "1000"), ("time.step", "10")],
    ));
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    for _ in 0..300 {
        let load = 2.0 * (random() - 0.5) * 10_f64.powf(6.0 * random() - 3.0);
        let k = 10_f64.powf(6.0 * random() - 5.0);
        simulator.set_inputs(&[load]).unwrap();
        simulator.do_step(simulator.time(), k).unwrap();
        assert!(value(&simulator, "solver.residual") <= 1e-10);
    }
}

/// An actuator that holds the tip on a course presses and relieves: most of the contact changes between stick and slip near
/// the end. Every step converges, whatever the communication step.
#[test]
fn controlled_actuator() {
    for inverse in [16_u32, 32, 64, 128, 256] {
        let mut simulator = Simulator::new(stickslip::compile(&paper(32, &[])).unwrap());
        simulator.set_inputs(&[0.0]).unwrap();
        simulator.init(0.0).unwrap();
        let h = 1.0 / f64::from(inverse);
        let (mut pressure, mut integral) = (0.0, 0.0);
        for i in 0..=2 * inverse {
            let t = f64::from(i) * h;
            let demand = 0.03 * (1.0 - (std::f64::consts::PI * t.min(1.0)).cos());
            let error = demand - value(&simulator, "tip.displacement");
            integral += h * error;
            let command = -error - 8.0 * integral;
            pressure = command + (pressure - command) * (-h / 0.05).exp();
            simulator.set_inputs(&[pressure]).unwrap();
            simulator
                .do_step(t, h)
                .unwrap_or_else(|e| panic!("step 1/{inverse}: {e}"));
            assert!(value(&simulator, "solver.residual") <= 1e-10);
        }
    }
}
