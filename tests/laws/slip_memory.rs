//! Friction with a fading memory of slip.

use crate::common::{column, largest, relative, scene, start, value, values};
use serde_json::{Value, json};
use stickslip::{ErrorCode, Scene, Simulator, compile};

const TAU: f64 = 0.2;
const SCHEMES: [&str; 5] = [
    "trapezoid",
    "midpoint",
    "rectangle",
    "backward_euler",
    "tr_bdf2",
];

fn weakening(memory: Option<Value>) -> Value {
    let mut friction = json!({"law": "bound", "bound":
        {"kind": "slip_weakening", "static": 0.3, "dynamic": 0.1, "distance": 0.02}});
    if let Some(memory) = memory {
        friction["memory"] = memory;
    }
    friction
}

fn fading() -> Value {
    json!({"kernel": [{"weight": 1.0, "tau": TAU}, {"weight": 0.5, "tau": 0.02}]})
}

/// Pulls for half a second, then holds still, to and fro.
fn drag(t: f64) -> f64 {
    1.0 * (7.0 * t).sin() * f64::from(u8::from(t < 0.5))
}

fn block(friction: Value, scheme: &str, k: f64) -> Simulator {
    let time = json!({"scheme": scheme, "step": k, "start": "consistent"});
    start(&scene(&column(friction, time)))
}

/// The outputs at every step until `end`.
fn run(simulator: &mut Simulator, k: f64, steps: usize) -> Vec<Vec<f64>> {
    let first = (simulator.time() / k).round() as usize;
    (first..first + steps)
        .map(|n| {
            simulator.set_inputs(&[drag((n + 1) as f64 * k)]).unwrap();
            simulator.do_step(n as f64 * k, k).unwrap();
            let mut out = vec![0.0; simulator.output_len()];
            simulator.get_outputs(&mut out).unwrap();
            out
        })
        .collect()
}

#[test]
fn a_kernel_that_does_not_fade_is_the_accumulated_slip() {
    for scheme in SCHEMES {
        let k = 0.01;
        let mut without = block(weakening(None), scheme, k);
        let kernel = json!({"kernel": [{"weight": 0.25}, {"weight": 0.75}]});
        let mut with = block(weakening(Some(kernel)), scheme, k);
        for n in 0..60 {
            let slip = [&mut without, &mut with].map(|simulator| {
                run(simulator, k, 1);
                values(simulator, "contact.slip")
            });
            let rate = [&without, &with].map(|s| values(s, "contact.slip_rate"));
            // these two integrate the slip itself by other weights
            let tolerance = match scheme {
                "rectangle" | "tr_bdf2" => 1e-2,
                _ => 1e-9,
            };
            assert!(
                (slip[0][0] - slip[1][0]).abs() < tolerance * 0.1,
                "{scheme} {n}"
            );
            assert!((rate[0][0] - rate[1][0]).abs() < tolerance, "{scheme} {n}");
            let remembered = value(&with, "contact.slip_memory");
            let accumulated = value(&with, "contact.accumulated_slip");
            assert!((remembered - accumulated).abs() < 1e-3 * accumulated.max(0.1));
        }
        assert!(value(&with, "contact.accumulated_slip") > 0.02, "{scheme}");
    }
}

#[test]
fn what_is_remembered_fades_at_rest_and_the_bound_with_it() {
    let k = 0.01;
    let kernel = json!({"kernel": [{"weight": 1.0, "tau": TAU}]});
    let mut simulator = block(weakening(Some(kernel)), "trapezoid", k);
    let outputs = run(&mut simulator, k, 50);
    assert!(largest(&outputs[20]) > 0.0);
    let slipped = value(&simulator, "contact.slip_memory");
    assert!(slipped > 0.005 && slipped < value(&simulator, "contact.accumulated_slip"));
    // until it sticks again
    while value(&simulator, "contact.stick") == 0.0 {
        run(&mut simulator, k, 1);
    }
    run(&mut simulator, k, 1);
    let before = value(&simulator, "contact.slip_memory");
    run(&mut simulator, k, 30);
    assert_eq!(value(&simulator, "contact.stick"), 1.0);
    let after = value(&simulator, "contact.slip_memory");
    let expected = before * (-30.0 * k / TAU).exp();
    assert!((after / expected - 1.0).abs() < 1e-12, "{after} {expected}");
}

#[test]
fn the_memory_is_that_of_its_integral_and_of_second_order() {
    // the kernel against a sum over the slip rates of a fine run
    let rate_of = |k: f64, steps: usize, port: &str| -> Vec<f64> {
        let mut simulator = block(weakening(Some(fading())), "trapezoid", k);
        (0..steps)
            .map(|_| {
                run(&mut simulator, k, 1);
                value(&simulator, port)
            })
            .collect()
    };
    let fine = 1600;
    let k = 0.4 / f64::from(fine);
    let rates = rate_of(k, fine as usize, "contact.slip_rate");
    let kernel = |lag: f64| (-lag / TAU).exp() + 0.5 * (-lag / 0.02).exp();
    let sum: f64 = rates
        .iter()
        .rev()
        .enumerate()
        .map(|(i, rate)| {
            let weight = if i == 0 { 0.5 } else { 1.0 };
            weight * k * kernel(i as f64 * k) * rate.abs()
        })
        .sum();
    let memories = rate_of(k, fine as usize, "contact.slip_memory");
    let exact = memories[fine as usize - 1];
    assert!((sum / exact - 1.0).abs() < 1e-4, "{sum} {exact}");
    let errors = [25, 50, 100].map(|steps| {
        let memories = rate_of(
            0.4 / f64::from(steps),
            steps as usize,
            "contact.slip_memory",
        );
        (memories[steps as usize - 1] - exact).abs() / exact
    });
    let order = (errors[0] / errors[2]).log2() / 2.0;
    assert!(order > 1.5, "{errors:?}");
}

#[test]
fn the_memory_goes_through_rollback_and_bytes() {
    let k = 0.01;
    let mut simulator = block(weakening(Some(fading())), "tr_bdf2", k);
    run(&mut simulator, k, 20);
    let bytes = simulator.to_bytes();
    let mut saved = simulator.new_state();
    simulator.save(&mut saved).unwrap();
    let first = run(&mut simulator, k, 20);
    assert!(value(&simulator, "contact.slip_memory") > 0.0);
    simulator.restore(&saved).unwrap();
    assert_eq!(first, run(&mut simulator, k, 20));
    let mut other = block(weakening(Some(fading())), "tr_bdf2", k);
    other.restore_bytes(&bytes).unwrap();
    assert_eq!(first, run(&mut other, k, 20));
}

#[test]
fn coulomb_friction_remembers_too() {
    let body = |memory: Option<Value>| {
        let mut friction = json!({"law": "coulomb", "coefficient":
            {"kind": "expression", "formula": "0.2 + 0.2 * exp(-s / 0.1)"}});
        if let Some(memory) = memory {
            friction["memory"] = memory;
        }
        json!({"schema_version": 1, "name": "pad",
            "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [8, 4]},
            "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                         "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"}},
            "clamped": ["left"], "contact": {"part": "bottom", "friction": friction},
            "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": [1.0, -0.3], "start": 0.2}],
            "time": {"scheme": "trapezoid", "step": 0.02},
            "fidelity": {"model": "condensed", "friction_tolerance": 1e-12}})
    };
    let stresses = [
        body(None),
        body(Some(json!({"kernel": [{"weight": 1.0}]}))),
        body(Some(fading())),
    ]
    .map(|body| {
        let mut simulator = start(&scene(&body));
        for n in 0..40 {
            simulator.set_inputs(&[0.2 + 0.01 * f64::from(n)]).unwrap();
            simulator.do_step(0.02 * f64::from(n), 0.02).unwrap();
        }
        assert!(value(&simulator, "contact.stick_fraction") < 1.0);
        values(&simulator, "contact.tangential_stress")
    });
    assert!(relative(&stresses[1], &stresses[0]) < 1e-9);
    assert!(relative(&stresses[2], &stresses[0]) > 1e-3);
}

#[test]
fn a_memory_is_written_as_it_is_read() {
    let time = json!({"scheme": "trapezoid", "step": 0.01});
    let kernel = json!({"kernel": [{"weight": 0.5, "tau": 0.1}, {"weight": 2.0}]});
    let scene = scene(&column(weakening(Some(kernel.clone())), time));
    let text = serde_json::to_value(&scene).unwrap();
    assert_eq!(text["contact"]["friction"]["memory"], kernel);
    assert_eq!(Scene::from_json(&text.to_string(), "again").unwrap(), scene);
    // and travels in the bytes of a model
    let model = compile(&scene).unwrap();
    let again = stickslip::Model::from_bytes(&model.to_bytes()).unwrap();
    assert!(model.friction().slip_memory_len() > 0);
    assert_eq!(again.friction(), model.friction());
}

#[test]
fn memories_that_mean_nothing_are_refused() {
    let refusal = |friction: Value| {
        let time = json!({"scheme": "trapezoid", "step": 0.01});
        let text = column(friction, time).to_string();
        let error = Scene::from_json(&text, "test scene").unwrap_err();
        assert_eq!(error.code(), ErrorCode::Scene);
        error.to_string()
    };
    let constant = json!({"law": "bound", "bound": 0.3, "memory": fading()});
    assert!(refusal(constant).contains("contact.friction.memory"));
    let table = json!({"law": "bound", "memory": fading(),
        "bound": {"kind": "table", "rate": [0.0, 1.0], "value": [0.3, 0.2]}});
    assert!(refusal(table).contains("contact.friction.memory"));
    let no_slip = json!({"law": "bound", "memory": fading(),
        "bound": {"kind": "expression", "formula": "0.3 + r"}});
    assert!(refusal(no_slip).contains("contact.friction.memory"));
    for wrong in [
        json!({"kernel": [{"weight": -1.0, "tau": 0.1}]}),
        json!({"kernel": [{"weight": 1.0, "tau": 0.0}]}),
        json!({"kernel": [{"tau": 0.1}]}),
        json!({"kernel": [{"weight": 1.0, "time": 0.1}]}),
        json!({"kernel": []}),
        json!({}),
    ] {
        let text = refusal(weakening(Some(wrong)));
        assert!(text.contains("contact.friction"), "{text}");
    }
    let own = json!({"law": "tresca", "bound": 0.3, "memory": fading()});
    assert!(refusal(own).contains("contact.friction"));
}
