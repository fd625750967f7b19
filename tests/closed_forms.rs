//! Closed forms on a periodic column, clamped on top and in contact at the bottom, whose elasticity is `r` times its
//! viscosity: `A (w + r u) = F - E Lambda` relaxes at the single rate r, whatever the mesh.
//!
//! With the drag `f` (force per volume along x) switched on at t = 0 and a constant contact stress `-g`, linearity gives
//! `w(t) = e^{-r t} A^-1 (F - E g)` and `u(t) = (1 - e^{-r t}) / r  A^-1 (F - E g)`. By the symmetry of the mesh about the
//! middle, a held bottom carries half of the drag.

mod common;

use common::{largest, scene, start, steps, value, values};
use serde_json::{Value, json};

/// Relaxation rate, 1/s.
const RATE: f64 = 2.4;

/// mu1 = 0.5, mu2 = 2 and r = 2.4: two_mu_B = 4.8 = E / (1 + kappa), lambda_B = 1.2 = E kappa / ((1 + kappa)(1 - 2 kappa)),
/// so kappa / (1 - 2 kappa) = 1/4, kappa = 1/6, E = 5.6.
fn column(cells: [u32; 2], drag: f64, friction: Value, step: f64) -> Value {
    json!({
        "schema_version": 1, "name": "column",
        "mesh": {"kind": "rectangle", "size": [1.0, 1.0], "cells": cells, "periodic": ["x"]},
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 0.5, "mu2": 2.0},
            "elasticity": {"law": "isotropic", "young": 5.6, "poisson": 1.0 / 6.0, "convention": "plane_strain"}
        },
        "clamped": ["top"],
        "contact": {"part": "bottom", "friction": friction},
        "loads": [{"name": "drag", "kind": "body_force", "direction": [1, 0], "start": drag}],
        "time": {"step": step},
        "fidelity": {"model": "full", "friction_tolerance": 1e-13}
    })
}

fn frictionless() -> Value {
    json!({"law": "frictionless"})
}

fn assert_near(found: f64, expected: f64, relative: f64) {
    assert!(
        (found - expected).abs() <= relative * expected.abs(),
        "found {found:e}, expected {expected:e}"
    );
}

#[test]
fn relaxation_without_friction() {
    let k = 0.05;
    for model in ["full", "condensed", "reduced"] {
        let mut value_of_scene = column([1, 4], 0.7, frictionless(), k);
        value_of_scene["fidelity"]["model"] = json!(model);
        let mut simulator = start(&scene(&value_of_scene));
        let first_rate = value(&simulator, "contact.slip_rate");
        // the trapezoid multiplies the velocity of a mode of rate r by this in every step
        let factor = (1.0 - 0.5 * k * RATE) / (1.0 + 0.5 * k * RATE);
        for n in 1..=40 {
            steps(&mut simulator, k, 1);
            let decayed = factor.powi(n);
            assert_near(
                value(&simulator, "contact.slip_rate"),
                first_rate * decayed,
                1e-10,
            );
            let slip = first_rate / RATE * (1.0 - decayed);
            assert_near(value(&simulator, "contact.slip"), slip, 1e-10);
            assert_near(
                decayed,
                (-RATE * k * f64::from(n)).exp(),
                3e-3 * f64::from(n),
            );
        }
        assert_near(
            value(&simulator, "contact.accumulated_slip"),
            value(&simulator, "contact.slip"),
            1e-12,
        );
    }
}

/// A body that starts displaced relaxes at its one rate: slip, outputs and energies begin with what it starts with, and the balance is
/// closed.
#[test]
fn an_initial_displacement_relaxes() {
    let k = 0.05;
    for model in ["full", "condensed", "reduced"] {
        let mut value_of_scene = column([1, 4], 0.0, frictionless(), k);
        value_of_scene["fidelity"]["model"] = json!(model);
        value_of_scene["initial"] =
            json!({"displacement": [{"expression": "0.01 * (1 - y)"}, 0.0]});
        value_of_scene["probes"] = json!([{"name": "middle", "at": [0.5, 0.5]}]);
        let scene = scene(&value_of_scene);
        let mut simulator = start(&scene);
        // G gamma^2 / 2
        let energy = 2.4 * 0.01_f64.powi(2) / 2.0;
        let factor = (1.0 - 0.5 * k * RATE) / (1.0 + 0.5 * k * RATE);
        for n in 0..=40 {
            let decayed = factor.powi(n);
            for (port, expected) in [
                ("contact.slip", 0.01 * decayed),
                ("contact.slip_rate", -RATE * 0.01 * decayed),
                ("middle.displacement", 0.005 * decayed),
                ("drag.displacement", 0.005 * decayed),
                ("energy.elastic", energy * decayed * decayed),
                (
                    "energy.viscous_dissipation",
                    energy * (1.0 - decayed * decayed),
                ),
            ] {
                // differences of the energy that it starts with
                let rounding = if port.starts_with("energy") {
                    1e-12 * energy
                } else {
                    0.0
                };
                let found = value(&simulator, port);
                assert!(
                    (found - expected).abs() <= 1e-10 * expected.abs() + rounding,
                    "{model} {n} {port}: {found:e} {expected:e}"
                );
            }
            assert!(value(&simulator, "energy.balance_error").abs() < 1e-12 * energy);
            steps(&mut simulator, k, 1);
        }
        // a start over, the model from its bytes, and derivatives, which know nothing of a constant
        let seen = |simulator: &stickslip::Simulator| {
            let mut all = vec![0.0; simulator.output_len()];
            simulator.get_outputs(&mut all).expect("outputs");
            all
        };
        let after = seen(&simulator);
        let bytes = simulator.model().to_bytes();
        let model = stickslip::Model::from_bytes(&bytes).expect("a model");
        assert_eq!(model.to_bytes(), bytes);
        let mut again = stickslip::Simulator::new(model.into());
        again.init(0.0).expect("a start");
        steps(&mut again, k, 41);
        assert_eq!(seen(&again), after);
        simulator.reset();
        simulator.init(0.0).expect("a start");
        steps(&mut simulator, k, 41);
        assert_eq!(seen(&simulator), after);
    }
}

/// Steps are affine in the load: the derivative of a body that starts displaced is the difference of two runs.
#[test]
fn derivatives_do_not_see_what_the_body_starts_with() {
    for model in ["full", "reduced"] {
        let mut scene_value = column([2, 4], 0.3, frictionless(), 0.05);
        scene_value["fidelity"]["model"] = json!(model);
        scene_value["initial"] = json!({"displacement": [{"expression": "0.01 * (1 - y)"}, 0.0]});
        let scene = scene(&scene_value);
        let run = |drag: f64| {
            let mut simulator = start(&scene);
            simulator.set_inputs(&[drag]).expect("a load");
            steps(&mut simulator, 0.05, 1);
            simulator
        };
        let (mut low, high) = (run(0.3), run(0.5));
        let outputs = |simulator: &stickslip::Simulator| {
            let mut all = vec![0.0; simulator.output_len()];
            simulator.get_outputs(&mut all).expect("outputs");
            all
        };
        let mut derivative = vec![0.0; low.output_len()];
        low.directional_derivative(&[1.0], &mut derivative)
            .expect("a derivative");
        let difference: Vec<f64> = outputs(&high)
            .iter()
            .zip(&outputs(&low))
            .map(|(b, a)| (b - a) / 0.2)
            .collect();
        let ports: Vec<_> = low.model().ports().outputs().cloned().collect();
        let mut at = 0;
        let mut seen = 0;
        for port in ports {
            let range = at..at + port.len();
            at = range.end;
            // energies are quadratic in the load, the rest is linear
            if port.name.starts_with("energy") || port.name.starts_with("solver") {
                continue;
            }
            for i in range {
                assert!(
                    (derivative[i] - difference[i]).abs() < 1e-11,
                    "{} {model}",
                    port.name
                );
                seen += usize::from(difference[i] != 0.0);
            }
        }
        assert!(seen > 4);
        // the mean of the two derivatives is the slope between them, for what is quadratic
        let mut high = high;
        let mut other = vec![0.0; low.output_len()];
        high.directional_derivative(&[1.0], &mut other)
            .expect("a derivative");
        let place = |name: &str| {
            let mut at = 0;
            for port in low.model().ports().outputs() {
                if port.name == name {
                    return at;
                }
                at += port.len();
            }
            panic!("{name}")
        };
        for name in ["energy.elastic", "energy.balance_error"] {
            let at = place(name);
            let mean = 0.5 * (derivative[at] + other[at]);
            assert!(
                (mean - difference[at]).abs() < 1e-12,
                "{name}: {mean} {}",
                difference[at]
            );
        }
        assert!(derivative[place("energy.elastic")].abs() > 1e-4);
    }
}

/// `G u'' = -f`, `u(1) = 0`, `u'(0) = 0`: the bottom comes to rest at `f / (2 G)`, `G = two_mu_B / 2`; linear elements give
/// it exactly at the nodes.
#[test]
fn final_slip_without_friction_is_that_of_the_continuous_column() {
    for cells in [[1, 1], [1, 4], [4, 8]] {
        let mut simulator = start(&scene(&column(cells, 0.7, frictionless(), 0.25)));
        steps(&mut simulator, 0.25, 100);
        for slip in values(&simulator, "contact.slip") {
            assert_near(slip, 0.7 / 4.8, 1e-11);
        }
    }
}

#[test]
fn full_stick_carries_half_of_the_drag() {
    let mut simulator = start(&scene(&column(
        [1, 4],
        0.7,
        json!({"law": "tresca", "bound": 0.36}),
        0.1,
    )));
    for _ in 0..20 {
        steps(&mut simulator, 0.1, 1);
        assert_eq!(largest(&values(&simulator, "contact.slip_rate")), 0.0);
        assert_eq!(value(&simulator, "contact.stick"), 1.0);
        assert_near(value(&simulator, "contact.force"), -0.35, 1e-12);
        assert_near(value(&simulator, "contact.tangential_stress"), -0.35, 1e-12);
        assert_eq!(value(&simulator, "energy.friction_dissipation"), 0.0);
    }
}

/// One element, one contact node: the slip rate is that without friction times `1 - 2 g / f`, and decays at the rate r.
#[test]
fn constant_bound_slips_by_what_exceeds_it() {
    let k = 0.05;
    let start_rate = |friction: Value| {
        let simulator = start(&scene(&column([1, 1], 0.7, friction, k)));
        value(&simulator, "contact.slip_rate")
    };
    let free = start_rate(frictionless());
    for bound in [0.0, 0.1, 0.2, 0.34] {
        let friction = json!({"law": "tresca", "bound": bound});
        assert_near(
            start_rate(friction),
            free * (1.0 - 2.0 * bound / 0.7),
            1e-11,
        );
    }
    let mut simulator = start(&scene(&column(
        [1, 1],
        0.7,
        json!({"law": "tresca", "bound": 0.2}),
        k,
    )));
    let first_rate = value(&simulator, "contact.slip_rate");
    let factor: f64 = (1.0 - 0.5 * k * RATE) / (1.0 + 0.5 * k * RATE);
    for n in 1..=20 {
        steps(&mut simulator, k, 1);
        assert_near(
            value(&simulator, "contact.slip_rate"),
            first_rate * factor.powi(n),
            1e-10,
        );
        assert_near(value(&simulator, "contact.tangential_stress"), -0.2, 1e-11);
        let slip = value(&simulator, "contact.slip");
        assert_near(
            value(&simulator, "energy.friction_dissipation"),
            0.2 * slip,
            1e-10,
        );
    }
}

/// One contact node under the exponential law: `w + (2 c / f) g(w) = c` with c the slip rate without friction; solved here
/// by bisection.
#[test]
fn exponential_law_solves_its_scalar_equation() {
    let free = {
        let simulator = start(&scene(&column([1, 1], 0.7, frictionless(), 0.1)));
        value(&simulator, "contact.slip_rate")
    };
    for (a, b, alpha) in [
        (0.3, 0.1, 2.0),
        (0.3, 0.3, 5.0),
        (0.2, 0.0, 30.0),
        (0.34, 0.2, 1.0),
    ] {
        let friction = json!({"law": "exponential", "a": a, "b": b, "alpha": alpha});
        let simulator = start(&scene(&column([1, 1], 0.7, friction, 0.1)));
        let residual = |w: f64| {
            let g = (a - b) * (-alpha * w).exp() + b;
            w + 2.0 * free / 0.7 * g - free
        };
        let (mut low, mut high) = (0.0, free);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if residual(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        assert_near(value(&simulator, "contact.slip_rate"), low, 1e-10);
    }
}

/// The drag is reversed: the node slips back, its stress turns over, accumulated slip only grows.
#[test]
fn reversal_turns_the_stress_over() {
    let mut simulator = start(&scene(&column(
        [1, 1],
        0.7,
        json!({"law": "tresca", "bound": 0.1}),
        0.05,
    )));
    steps(&mut simulator, 0.05, 4);
    let (slip, path) = (
        value(&simulator, "contact.slip"),
        value(&simulator, "contact.accumulated_slip"),
    );
    assert_near(slip, path, 1e-12);
    simulator.set_inputs(&[-0.7]).unwrap();
    steps(&mut simulator, 0.05, 40);
    assert_near(value(&simulator, "contact.tangential_stress"), 0.1, 1e-11);
    assert!(value(&simulator, "contact.slip") < -slip);
    let travelled = value(&simulator, "contact.accumulated_slip");
    assert!(travelled > path + (slip - value(&simulator, "contact.slip")) * 0.999);
}
