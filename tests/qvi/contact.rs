//! The contact of the component as an instance of the class: the same trajectory, step by step.

use crate::common::{largest, relative, scene, started};
use serde_json::{Value, json};
use std::sync::Arc;
use stickslip::Compilation;
use stickslip::qvi::contact::of_scene;
use stickslip::qvi::{Evolution, Quadrature, Record, Settings, SolveError, Solver, Verdict};

fn pad(friction: Value, scheme: &str, mesh: Value) -> Value {
    let is_box = mesh["kind"] == "box";
    let [convention, direction] = match is_box {
        true => [json!("three_dimensional"), json!([0.3, -1.0, 0.2])],
        false => [json!("plane_strain"), json!([0.3, -1.0])],
    };
    json!({
        "schema_version": 1, "name": "pad", "mesh": mesh,
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
            "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": convention}
        },
        "clamped": ["left"],
        "contact": {"part": "bottom", "friction": friction},
        "loads": [{"name": "pull", "kind": "traction", "part": "top", "direction": direction, "start": 0.2}],
        "time": {"scheme": scheme, "start": "consistent", "step": 0.0625},
        "fidelity": {"model": "full", "friction_tolerance": 1e-13}
    })
}

/// Load that goes up, turns round and comes back.
fn load(t: f64) -> f64 {
    0.2 * (4.0 * t).cos() + 0.1 * t
}

/// Steps both and compares them; the instance and how many nodes slipped in how many steps.
fn compare(value: &Value, rule: &Quadrature) -> usize {
    let compilation = Compilation::new(&scene(value)).unwrap();
    let problem = of_scene(&compilation, |t| vec![load(t)]).unwrap();
    let k = 0.0625;
    let mut settings = Settings::new(Solver::Direct);
    settings.most_iterations = 20_000;
    let mut run = Evolution::new(&problem, rule, k, settings).unwrap();
    let mut simulator = started(Arc::clone(&compilation.model));
    let contact = compilation.body.contact.node_count();
    let (mut slipping, mut moved) = (0, 0.0_f64);
    for n in 0..=16 {
        let w = run.advance().unwrap().clone();
        if n > 0 {
            simulator.set_inputs(&[load(n as f64 * k)]).unwrap();
            simulator.do_step((n - 1) as f64 * k, k).unwrap();
        }
        // behind the body come the branches of a memory
        let own = |field: &[f64]| field[..w.len()].to_vec();
        let state = simulator.state();
        assert!(
            relative(w.as_slice(), &own(state.velocity())) < 1e-10,
            "step {n}"
        );
        if n > 0 {
            let [displacement, slip, ..] = run.histories() else {
                panic!("two histories and more")
            };
            let initial = compilation.body.initial.as_ref();
            let initial = initial.map_or(vec![0.0; w.len()], |initial| initial.field.clone());
            let displaced = own(state.displacement());
            let fields = displaced.iter().zip(&initial);
            let of_simulator: Vec<f64> = fields.map(|(u, start)| u + start).collect();
            let off = relative(displacement.as_slice(), &of_simulator);
            assert!(off < 1e-10, "displacement of step {n}: {off:e}");
            let port = match value["contact"]["friction"]["memory"].is_null() {
                true => "contact.accumulated_slip",
                false => "contact.slip_memory",
            };
            let of_simulator = simulator.get_by_name(port).unwrap();
            let off = relative(slip.as_slice(), &of_simulator);
            assert!(off < 1e-10, "slip of step {n}: {off:e}");
            moved = moved.max(largest(&of_simulator));
        }
        let stick = simulator.get_by_name("contact.stick").unwrap();
        slipping += stick.iter().filter(|stick| **stick == 0.0).count();
    }
    assert!(moved > 1e-3);
    assert!(slipping > 0 && slipping < 17 * contact, "{slipping}");
    let end = (1.0, k);
    let record = Record::of(&problem, end, Solver::Direct, run.iterations()).unwrap();
    let certificate = compilation.model.certificate();
    // the constants of the class are those of the certificate, sharpened to the finite element space
    let m = record.constants.m.value;
    assert!(m >= certificate.m_a * (1.0 - 1e-9), "{m}");
    let is_unique = certificate.is_theorem_satisfied();
    assert!(!is_unique || record.conditions.uniqueness == Verdict::Holds);
    slipping
}

fn rectangle() -> Value {
    json!({"kind": "rectangle", "size": [1.0, 0.5], "cells": [8, 4]})
}

#[test]
fn friction_of_the_slip_rate_is_an_instance() {
    let friction = json!({"law": "exponential", "a": 0.05, "b": 0.02, "alpha": 2.0});
    compare(
        &pad(friction.clone(), "trapezoid", rectangle()),
        &Quadrature::Trapezoid,
    );
    compare(
        &pad(friction, "backward_euler", rectangle()),
        &Quadrature::RightRectangle,
    );
}

#[test]
fn friction_of_the_slip_history_is_an_instance() {
    let friction = json!({"law": "bound", "bound":
        {"kind": "slip_weakening", "static": 0.05, "dynamic": 0.03, "distance": 0.03}});
    compare(
        &pad(friction, "trapezoid", rectangle()),
        &Quadrature::Trapezoid,
    );
}

#[test]
fn friction_with_a_memory_of_slip_is_an_instance() {
    let friction = json!({"law": "bound",
        "bound": {"kind": "slip_weakening", "static": 0.05, "dynamic": 0.03, "distance": 0.03},
        "memory": {"kernel": [{"weight": 1.0, "tau": 0.3}, {"weight": 0.5, "tau": 0.02}]}});
    compare(
        &pad(friction, "trapezoid", rectangle()),
        &Quadrature::Trapezoid,
    );
}

#[test]
fn a_body_that_starts_displaced_is_an_instance() {
    let friction = json!({"law": "exponential", "a": 0.05, "b": 0.02, "alpha": 2.0});
    let mut value = pad(friction, "trapezoid", rectangle());
    let component = |text: &str| json!({ "expression": text });
    value["initial"]["displacement"] = json!([component("0.02 * x"), component("0.01 * x * y")]);
    compare(&value, &Quadrature::Trapezoid);
}

#[test]
fn a_material_with_memory_is_an_instance() {
    let friction = json!({"law": "exponential", "a": 0.05, "b": 0.02, "alpha": 2.0});
    let mut value = pad(friction, "trapezoid", rectangle());
    value["material"]["memory"] = json!([
        {"tau": 0.05, "law": "isotropic", "shear": 0.3, "bulk": 0.5},
        {"tau": 0.8, "law": "isotropic", "shear": 0.2, "bulk": 0.1}]);
    compare(&value, &Quadrature::Trapezoid);
    value["time"]["scheme"] = json!("tr_bdf2");
    let compilation = Compilation::new(&scene(&value)).unwrap();
    let refused = of_scene(&compilation, |_| vec![0.0]);
    assert!(matches!(refused.err(), Some(SolveError::Scene { .. })));
}

#[test]
fn friction_in_three_dimensions_is_an_instance() {
    let mesh = json!({"kind": "box", "size": [1.0, 0.5, 0.5], "cells": [3, 2, 2]});
    let friction = json!({"law": "tresca", "bound": 0.05});
    compare(&pad(friction, "trapezoid", mesh), &Quadrature::Trapezoid);
}

#[test]
fn scenes_of_another_form_are_refused() {
    let mut value = pad(
        json!({"law": "coulomb", "coefficient": 0.3}),
        "trapezoid",
        rectangle(),
    );
    value["loads"][0]["direction"] = json!([0.0, -1.0]);
    let compilation = Compilation::new(&scene(&value)).unwrap();
    let refused = of_scene(&compilation, |_| vec![0.0]);
    assert!(matches!(refused.err(), Some(SolveError::Scene { .. })));
}

#[test]
fn contacts_with_kernels_of_their_own_are_an_instance() {
    let friction = |bound: f64, kernel: Value| {
        json!({"law": "bound", "memory": {"kernel": kernel},
            "bound": {"kind": "slip_weakening", "static": bound, "dynamic": 0.5 * bound, "distance": 0.02}})
    };
    let mut value = pad(Value::Null, "trapezoid", rectangle());
    value.as_object_mut().unwrap().remove("contact");
    value["loads"][0]["part"] = json!("right");
    let kernels = [
        json!([{"weight": 1.0, "tau": 0.3}, {"weight": 0.5, "tau": 0.02}]),
        json!([{"weight": 2.0, "tau": 0.1}]),
    ];
    value["contacts"] = json!([
        {"name": "lower", "part": "bottom", "friction": friction(0.05, kernels[0].clone())},
        {"name": "upper", "part": "top", "friction": friction(0.03, kernels[1].clone())},
    ]);
    let compilation = Compilation::new(&scene(&value)).unwrap();
    let problem = of_scene(&compilation, |t| vec![load(t)]).unwrap();
    let k = 0.0625;
    let mut settings = Settings::new(Solver::Direct);
    settings.most_iterations = 20_000;
    let mut run = Evolution::new(&problem, &Quadrature::Trapezoid, k, settings).unwrap();
    run.advance().unwrap();
    let mut simulator = started(Arc::clone(&compilation.model));
    for n in 0..16 {
        let w = run.advance().unwrap().clone();
        simulator.set_inputs(&[load(f64::from(n + 1) * k)]).unwrap();
        simulator.do_step(f64::from(n) * k, k).unwrap();
        let off = relative(w.as_slice(), simulator.state().velocity());
        assert!(off < 1e-10, "step {n}: {off:e}");
        for (name, history) in ["lower", "upper"].iter().zip(&run.histories()[1..]) {
            let remembered = simulator
                .get_by_name(&format!("{name}.slip_memory"))
                .unwrap();
            assert!(largest(&remembered) > 0.0 || n < 2, "{name}: step {n}");
            let off = relative(history.as_slice(), &remembered);
            assert!(off < 1e-10, "{name}, step {n}: {off:e}");
        }
    }
    assert!(simulator.get_by_name("contact.slip_memory").is_err());
}
