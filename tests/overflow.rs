//! Numbers that are too large for their format end in an error with the state as it was, never in a result that is none.

mod common;

use common::{relative, scene};
use serde_json::{Value, json};
use stickslip::{Error, ErrorCode, Simulator, compile};

fn block(friction: Value, start: f64, overrides: &[(&str, Value)]) -> Value {
    let mut value = json!({
        "schema_version": 1, "name": "x",
        "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [6, 3]},
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
            "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"}},
        "clamped": ["left"],
        "contact": {"part": "bottom", "friction": friction},
        "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": [0, 1], "start": start}],
        "probes": [{"name": "tip", "at": [1.0, 0.0]}],
        "time": {"step": 0.02, "scheme": "trapezoid", "start": "consistent"},
        "fidelity": {"model": "reduced"}, "history": {"capacity": 4}
    });
    for (pointer, new) in overrides {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        value.pointer_mut(parent).unwrap()[key] = new.clone();
    }
    value
}

fn exponential() -> Value {
    json!({"law": "exponential", "a": 0.003, "b": 0.001, "alpha": 100.0})
}

fn outputs(simulator: &Simulator) -> Vec<f64> {
    let mut out = vec![0.0; simulator.output_len()];
    simulator.get_outputs(&mut out).unwrap();
    out
}

/// An error leaves the state as it was, success leaves finite outputs.
fn judge(simulator: &Simulator, before: &stickslip::State, result: &Result<(), Error>, what: &str) {
    let values = outputs(simulator);
    assert!(values.iter().all(|v| v.is_finite()), "{what}: {result:?}");
    if result.is_err() {
        assert!(simulator.state() == before, "{what} changed the state");
    }
}

/// A load of 1e200 Pa turns over more energy than a number can say.
#[test]
fn a_load_beyond_the_numbers_is_an_error() {
    let laws = [
        exponential(),
        json!({"law": "tresca", "bound": 0.01}),
        json!({"law": "frictionless"}),
    ];
    let settings: [&[(&str, Value)]; 7] = [
        &[],
        &[("/fidelity/model", json!("condensed"))],
        &[
            ("/fidelity/model", json!("full")),
            ("/time/scheme", json!("tr_bdf2")),
        ],
        &[("/time/tolerance", json!(1e-3))],
        &[("/time/error_estimate", json!(true))],
        &[
            ("/time/start", json!("zero")),
            ("/time/scheme", json!("backward_euler")),
        ],
        &[
            ("/mesh/cells", json!([1, 1])),
            ("/element", json!("p2")),
            ("/fidelity/model", json!("full")),
            ("/time/scheme", json!("backward_euler")),
        ],
    ];
    for friction in &laws {
        for changes in settings {
            let model = compile(&scene(&block(friction.clone(), 0.0, changes))).unwrap();
            for exponent in [150, 154, 160, 200, 250, 290, 300, 307] {
                for sign in [-1.0, 1.0] {
                    let load = sign * 10_f64.powi(exponent);
                    let what = format!("{friction} {changes:?} {load:e}");
                    // from the start, and in a step
                    let mut simulator = Simulator::new(model.clone());
                    simulator.set_inputs(&[load]).unwrap();
                    let before = simulator.state().clone();
                    let started = simulator.init(0.0);
                    judge(&simulator, &before, &started, &what);
                    let mut last = started;
                    for n in 0..4 {
                        if last.is_err() {
                            break;
                        }
                        let before = simulator.state().clone();
                        last = simulator.do_step(f64::from(n) * 0.02, 0.02);
                        judge(&simulator, &before, &last, &what);
                    }
                    let mut moving = Simulator::new(model.clone());
                    moving.init(0.0).unwrap();
                    moving.do_step(0.0, 0.02).unwrap();
                    moving.set_inputs(&[load]).unwrap();
                    let before = moving.state().clone();
                    let jumped = moving.do_step(0.02, 0.02);
                    judge(&moving, &before, &jumped, &what);
                    if exponent >= 160 {
                        let code = jumped.unwrap_err().code();
                        let expected = [
                            ErrorCode::Overflow,
                            ErrorCode::NotConverged,
                            ErrorCode::ToleranceOutOfReach,
                        ];
                        assert!(expected.contains(&code), "{what}: {code:?}");
                    }
                    // the same simulator goes on with a load that can be
                    moving.set_inputs(&[-0.1]).unwrap();
                    moving.do_step(moving.time(), 0.02).unwrap();
                    let values = outputs(&moving);
                    assert!(
                        values.iter().all(|v| v.is_finite()) && values.iter().any(|v| *v != 0.0)
                    );
                }
            }
        }
    }
}

/// The scene of the report: an error that names what overflows.
#[test]
fn the_error_names_what_overflows() {
    for friction in [exponential(), json!({"law": "tresca", "bound": 0.01})] {
        let model = compile(&scene(&block(friction, 1e200, &[]))).unwrap();
        let mut simulator = Simulator::new(model);
        let mut error = simulator.init(0.0).err();
        let mut n = 0;
        while error.is_none() && n < 10 {
            error = simulator.do_step(f64::from(n) * 0.02, 0.02).err();
            n += 1;
        }
        let error = error.expect("an error");
        assert_eq!(error.code(), ErrorCode::Overflow, "{error}");
        assert_eq!(error.code() as i32, -18);
        let text = error.to_string();
        assert!(
            text.contains("overflow") && text.contains("is not finite"),
            "{text}"
        );
    }
}

/// Below that, sizes do not matter: loads and bounds times a power of two give motions and stresses times it.
#[test]
fn large_numbers_are_scaled_small_ones() {
    let run = |scale: f64| {
        let bound = json!({"law": "tresca", "bound": 0.004 * scale});
        let mut simulator = common::start(&scene(&block(bound, -0.3 * scale, &[])));
        let mut all = Vec::new();
        for n in 0..20 {
            let load = scale * (-0.3 + 0.02 * f64::from(n));
            simulator.set_inputs(&[load]).unwrap();
            simulator.do_step(f64::from(n) * 0.02, 0.02).unwrap();
            for name in [
                "contact.slip_rate",
                "contact.tangential_stress",
                "tip.displacement",
            ] {
                all.extend(
                    simulator
                        .get_by_name(name)
                        .unwrap()
                        .iter()
                        .map(|v| v / scale),
                );
            }
            let work = simulator.get_by_name("energy.external_work").unwrap()[0];
            all.push(work / scale / scale);
        }
        all
    };
    let expected = run(1.0);
    assert!(expected.iter().any(|v| *v != 0.0));
    for exponent in [-400, -200, 200, 400, 480] {
        let found = run(2.0_f64.powi(exponent));
        assert!(
            relative(&found, &expected) < 1e-9,
            "2^{exponent}: {}",
            relative(&found, &expected)
        );
    }
}

/// A derivative along a seed that is out of proportion is refused, and nothing is written.
#[test]
fn a_derivative_beyond_the_numbers_is_an_error() {
    let mut simulator = common::start(&scene(&block(exponential(), -0.3, &[])));
    simulator.do_step(0.0, 0.02).unwrap();
    let mut out = vec![7.0; simulator.output_len()];
    let error = simulator.directional_derivative(&[1e308], &mut out);
    match error {
        Ok(()) => assert!(out.iter().all(|v| v.is_finite())),
        Err(error) => {
            assert_eq!(error.code(), ErrorCode::Overflow);
            assert!(out.iter().all(|v| *v == 7.0));
        }
    }
    let mut seed = vec![f64::MAX; simulator.output_len()];
    seed[0] = -f64::MAX;
    let mut gradient = [7.0];
    let error = simulator
        .adjoint_derivative(&seed, &mut gradient)
        .unwrap_err();
    assert_eq!((error.code(), gradient), (ErrorCode::Overflow, [7.0]));
    simulator.directional_derivative(&[1.0], &mut out).unwrap();
}
