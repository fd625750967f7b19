//! Several contacts: what the laws of each do is what one contact with the same numbers node by node does; names, derivatives,
//! coefficients, bytes; what is refused.

#[path = "../common/mod.rs"]
mod common;
mod refused;

use common::{started, values};
use serde_json::{Value, json};
use std::sync::Arc;
use stickslip::mesh::Mesh;
use stickslip::{Compilation, Model, Scene, Simulator};

/// A block on two feet: nodes of the bottom from 0.125 to 0.5 and from 0.625.
fn feet() -> Mesh {
    let spec = r#"{"kind": "rectangle", "size": [1.0, 0.5], "cells": [8, 4]}"#;
    let mut mesh = Mesh::generate(&serde_json::from_str(spec).unwrap()).unwrap();
    let bottom = mesh.parts["bottom"].clone();
    let nodes = mesh.nodes.clone();
    let place = |face: &[u32]| face.iter().map(|n| nodes[*n as usize][0]).sum::<f64>() / 2.0;
    let of = |is_in: &dyn Fn(f64) -> bool| -> Vec<u32> {
        let faces = bottom.chunks_exact(2).filter(|face| is_in(place(face)));
        faces.flatten().copied().collect()
    };
    mesh.parts.insert("a".into(), of(&|x| x > 0.125 && x < 0.5));
    mesh.parts.insert("b".into(), of(&|x| x > 0.625));
    mesh.parts
        .insert("both".into(), of(&|x| (x > 0.125 && x < 0.5) || x > 0.625));
    mesh.parts.insert("half".into(), of(&|x| x > 0.25));
    mesh
}

/// Contact nodes of each foot.
const NODES: usize = 4;

fn scene(contacts: Value, changes: &[(&str, Value)]) -> Value {
    let mut value = json!({"schema_version": 1, "name": "feet",
        "mesh": {"kind": "gmsh", "file": "part.msh"},
        "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                     "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"}},
        "clamped": ["left"],
        "loads": [{"name": "push", "kind": "traction", "part": "right", "direction": [1, 0]},
                  {"name": "press", "kind": "traction", "part": "top", "direction": [0, -1], "start": 0.05}],
        "probes": [{"name": "middle", "at": [0.5, 0.25]}],
        "time": {"step": 0.05, "scheme": "tr_bdf2"},
        "fidelity": {"model": "condensed", "friction_tolerance": 1e-12},
        "history": {"capacity": 3}});
    match contacts {
        Value::Array(_) => value["contacts"] = contacts,
        one => value["contact"] = one,
    }
    for (key, change) in changes {
        value[key] = change.clone();
    }
    value
}

fn read(value: &Value) -> stickslip::Result<Scene> {
    Scene::from_json(&value.to_string(), "feet")
}

fn compile(value: &Value) -> stickslip::Result<Arc<Model>> {
    Ok(Compilation::on_mesh(&read(value)?, feet())?.model)
}

fn set(simulator: &mut Simulator, name: &str, value: f64) {
    let reference = simulator.model().ports().find(name).unwrap().reference;
    simulator.set(reference, value).unwrap();
}

/// Loads that make feet stick, slip and turn back; foundations that move where there are any.
fn drive(simulator: &mut Simulator, step: usize, motions: &[(&str, f64)]) {
    let t = 0.05 * (step + 1) as f64;
    set(simulator, "push", 0.3 * (4.0 * t).sin());
    set(simulator, "press", 0.05 + 0.1 * t);
    for (name, factor) in motions {
        set(simulator, name, factor * t);
    }
    simulator.do_step(simulator.time(), 0.05).unwrap();
}

fn close(a: &[f64], b: &[f64], what: &str) {
    assert_eq!(a.len(), b.len(), "{what}");
    let size = a.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        assert!(
            (a - b).abs() <= 1e-9 * size + 1e-15,
            "{what} at {i}: {a:e} {b:e}"
        );
    }
}

fn nodal(a: f64, b: f64) -> Value {
    let values = [[a; NODES], [b; NODES]].concat();
    json!({ "nodes": values })
}

/// What a run of one contact with numbers node by node and one of two contacts have in common, at every step.
fn compare(one: &Value, two: &Value, motions: [&[(&str, f64)]; 2]) {
    let mut pair = [one, two].map(|v| started(compile(v).unwrap()));
    let mut slips = [false; 2];
    for step in 0..30 {
        for (simulator, motions) in pair.iter_mut().zip(motions) {
            drive(simulator, step, motions);
        }
        let [one, two] = &pair;
        for port in one.model().ports().outputs() {
            let name = &port.name;
            if name.starts_with("solver.") || two.model().ports().find(name).is_err() {
                continue;
            }
            close(
                &values(one, name),
                &values(two, name),
                &format!("{name} in step {step}"),
            );
        }
        // the ports of each contact are its share of those of all
        for name in [
            "slip_rate",
            "tangential_stress",
            "slip",
            "stick",
            "accumulated_slip",
        ] {
            let parts = ["a", "b"].map(|part| values(two, &format!("foot_{part}.{name}")));
            assert_eq!(parts.concat(), values(two, &format!("contact.{name}")));
        }
        for (i, part) in ["a", "b"].iter().enumerate() {
            let fastest = values(two, &format!("foot_{part}.max_slip_rate"))[0];
            slips[i] |= fastest > 0.01;
        }
        let force = ["a", "b"].map(|part| values(two, &format!("foot_{part}.force"))[0]);
        close(
            &[force[0] + force[1]],
            &values(two, "contact.force"),
            "force",
        );
        let past = |s: &Simulator| {
            let all = (0..2 * NODES).flat_map(|n| s.slip_history(n).unwrap());
            all.flat_map(|p| [p.slip_rate[0], p.tangential_stress[0]])
                .collect::<Vec<_>>()
        };
        close(&past(one), &past(two), "history");
    }
    assert_eq!(slips, [true; 2]);
}

#[test]
fn two_contacts_are_one_with_two_sets_of_numbers() {
    let of = |part: &str, name: &str, friction: Value| json!({"name": name, "part": part, "friction": friction});
    let exponential =
        |a: Value, b: Value| json!({"law": "exponential", "a": a, "b": b, "alpha": 3.0});
    let one =
        json!({"part": "both", "friction": exponential(nodal(0.02, 0.01), nodal(0.01, 0.01))});
    // the second foot has another law: a bound that does not depend on the rate
    let tresca = json!({"law": "tresca", "bound": 0.01});
    let two = json!([
        of("a", "foot_a", exponential(json!(0.02), json!(0.01))),
        of("b", "foot_b", tresca)
    ]);
    for model in ["full", "condensed", "reduced"] {
        let fidelity = json!({"model": model, "tolerance": 1e-11, "friction_tolerance": 1e-12});
        let changes = [("fidelity", fidelity)];
        compare(
            &scene(one.clone(), &changes),
            &scene(two.clone(), &changes),
            [&[], &[]],
        );
    }
    let fixed = json!({"model": "condensed", "solver": {"kind": "fixed_point", "tolerance": 1e-12, "max_iterations": 2000}});
    let changes = [
        ("fidelity", fixed),
        ("time", json!({"step": 0.05, "scheme": "trapezoid"})),
    ];
    compare(&scene(one, &changes), &scene(two, &changes), [&[], &[]]);
}

#[test]
fn pressed_contacts_have_their_own_conditions_and_foundations() {
    let coulomb = |mu: Value| json!({"law": "coulomb", "coefficient": {"kind": "exponential", "static": mu, "kinetic": 0.1, "decay": 2.0}});
    let condition = json!({"kind": "unilateral", "gap": 0.001});
    let of = |part: &str, motions: [&str; 2], condition: &Value, friction: Value| {
        json!({"name": format!("foot_{part}"), "part": part, "condition": condition, "friction": friction,
               "foundation": [{"kind": "sliding", "name": motions[0], "direction": [1, 0]}, {"kind": "approach", "name": motions[1]}]})
    };
    let mut one = of(
        "both",
        ["belt", "rise"],
        &condition,
        coulomb(nodal(0.3, 0.2)),
    );
    one["name"] = json!("contact");
    let two = |[a, b]: [&Value; 2]| {
        json!([
            of("a", ["belt_a", "rise_a"], a, coulomb(json!(0.3))),
            of("b", ["belt_b", "rise_b"], b, coulomb(json!(0.2)))
        ])
    };
    let alike: [&[(&str, f64)]; 2] = [
        &[("belt", 0.02), ("rise", 0.003)],
        &[
            ("belt_a", 0.02),
            ("belt_b", 0.02),
            ("rise_a", 0.003),
            ("rise_b", 0.003),
        ],
    ];
    for scheme in ["tr_bdf2", "midpoint", "backward_euler"] {
        let changes = [("time", json!({"step": 0.05, "scheme": scheme}))];
        compare(
            &scene(one.clone(), &changes),
            &scene(two([&condition; 2]), &changes),
            alike,
        );
    }
    let gives = json!({"kind": "compliance", "stiffness": 30.0, "exponent": 1.5, "gap": 0.001});
    let mut yielding = one.clone();
    yielding["condition"] = gives.clone();
    compare(&scene(yielding, &[]), &scene(two([&gives; 2]), &[]), alike);
    // one foot opens, the other gives way, each under a foundation of its own
    let model = compile(&scene(two([&condition, &gives]), &[])).unwrap();
    let mut mixed = started(model);
    for step in 0..30 {
        let rise = if step < 15 { 0.004 } else { -0.2 };
        drive(
            &mut mixed,
            step,
            &[
                ("belt_a", 0.02),
                ("belt_b", -0.03),
                ("rise_a", rise),
                ("rise_b", 0.01),
            ],
        );
        let of = |name: &str| values(&mixed, name);
        for (gap, pressure) in of("foot_a.gap").iter().zip(of("foot_a.pressure")) {
            assert!(
                *gap >= -1e-12 && pressure >= 0.0 && (*gap).min(pressure) < 1e-9,
                "{gap} {pressure}"
            );
        }
        for (gap, pressure) in of("foot_b.gap").iter().zip(of("foot_b.pressure")) {
            let given = 30.0 * (-gap).max(0.0).powf(1.5);
            assert!(
                (pressure - given).abs() < 1e-9 * given.max(1e-3),
                "{gap} {pressure}"
            );
        }
        let forces =
            ["foot_a", "foot_b", "contact"].map(|name| of(&format!("{name}.normal_force"))[0]);
        close(&[forces[0] + forces[1]], &forces[2..], "normal force");
        close(&of("rise_a.force"), &forces[..1], "force of the approach");
        let balance = of("energy.balance_error")[0].abs();
        assert!(
            balance < 0.2 * of("energy.external_work")[0].abs().max(1e-3),
            "{balance}"
        );
    }
    assert!(values(&mixed, "foot_a.open_fraction")[0] > 0.0);
}

/// A foot that is pressed beside one whose bound knows no pressure: both obey their laws.
#[test]
fn pressed_beside_pressure_free() {
    let contacts = json!([
        {"name": "foot_a", "part": "a", "friction": {"law": "coulomb", "coefficient": 0.3}},
        {"name": "foot_b", "part": "b", "friction": {"law": "exponential", "a": 0.02, "b": 0.01, "alpha": 3.0}}]);
    let mut simulator = started(compile(&scene(contacts, &[])).unwrap());
    let mut slipped = [0; 2];
    for step in 0..30 {
        drive(&mut simulator, step, &[]);
        let of = |name: &str| values(&simulator, name);
        let nodes = of("foot_a.slip_rate")
            .into_iter()
            .zip(of("foot_a.tangential_stress"));
        for ((rate, stress), pressure) in nodes.zip(of("foot_a.pressure")) {
            let bound = 0.3 * pressure.max(0.0);
            assert!(stress.abs() <= bound + 1e-12);
            if rate != 0.0 {
                slipped[0] += 1;
                assert!((stress + bound.copysign(rate)).abs() < 1e-12);
            }
        }
        for (rate, stress) in of("foot_b.slip_rate")
            .into_iter()
            .zip(of("foot_b.tangential_stress"))
        {
            let bound: f64 = 0.01 * (-3.0 * f64::abs(rate)).exp() + 0.01;
            if rate != 0.0 {
                slipped[1] += 1;
                assert!((stress + bound.copysign(rate)).abs() < 1e-12);
            }
        }
    }
    assert!(slipped[0] > 10 && slipped[1] > 10, "{slipped:?}");
}

fn mixed() -> Value {
    let contacts = json!([
        {"name": "foot_a", "part": "a", "condition": {"kind": "unilateral"}, "friction": {"law": "coulomb", "coefficient": 0.2},
         "foundation": [{"kind": "approach", "name": "rise", "start": 0.01}]},
        {"name": "foot_b", "part": "b", "friction": {"law": "bound", "bound": {"kind": "rate_and_state", "coefficient": 0.01,
            "a": 0.004, "b": 0.002, "rate": 0.001, "distance": 0.05, "evolution": "aging"}}}]);
    scene(contacts, &[])
}

#[test]
fn derivatives_are_those_of_differences() {
    let mut simulator = started(compile(&mixed()).unwrap());
    for step in 0..6 {
        drive(&mut simulator, step, &[("rise", 0.02)]);
    }
    let model = Arc::clone(simulator.model());
    let mut before = simulator.new_state();
    simulator.save(&mut before).unwrap();
    let outputs = |simulator: &mut Simulator, by: [f64; 3]| {
        simulator.restore(&before).unwrap();
        for (name, value) in ["push", "press", "rise"].iter().zip(by) {
            set(simulator, name, value);
        }
        simulator.do_step(simulator.time(), 0.05).unwrap();
        let mut out = vec![0.0; simulator.output_len()];
        simulator.get_outputs(&mut out).unwrap();
        out
    };
    let (at, seed) = ([0.29, 0.09, 0.0075], [0.3, -0.2, 0.01]);
    let moved = |by: f64| [0, 1, 2].map(|i| at[i] + by * seed[i]);
    let h = 1e-4;
    let (plus, minus) = (
        outputs(&mut simulator, moved(h)),
        outputs(&mut simulator, moved(-h)),
    );
    outputs(&mut simulator, at);
    let mut exact = vec![0.0; plus.len()];
    simulator.directional_derivative(&seed, &mut exact).unwrap();
    let mut first = 0;
    for port in model.ports().outputs() {
        let range = first..first + port.len();
        first = range.end;
        if port.name.starts_with("solver.") || port.name.ends_with("fraction") {
            continue;
        }
        let size = exact[range.clone()]
            .iter()
            .fold(1e-6, |m: f64, v| m.max(v.abs()));
        for i in range {
            let difference = (plus[i] - minus[i]) / (2.0 * h);
            assert!(
                (difference - exact[i]).abs() < 1e-4 * size,
                "{} {difference:e} {:e}",
                port.name,
                exact[i]
            );
        }
    }
}

#[test]
fn states_and_models_travel() {
    let model = compile(&mixed()).unwrap();
    let again = Arc::new(Model::from_bytes(&model.to_bytes()).unwrap());
    assert_eq!(again.fingerprint(), model.fingerprint());
    assert_eq!(again.contact(), model.contact());
    let names: Vec<_> = again
        .contact()
        .parts
        .iter()
        .map(|p| (p.name.clone(), p.nodes.clone()))
        .collect();
    assert_eq!(
        names,
        [
            ("foot_a".to_owned(), 0..NODES),
            ("foot_b".to_owned(), NODES..2 * NODES)
        ]
    );
    let (mut first, mut second) = (started(model), started(again));
    for step in 0..4 {
        drive(&mut first, step, &[("rise", 0.01)]);
    }
    second.restore_bytes(&first.to_bytes()).unwrap();
    for step in 4..8 {
        drive(&mut first, step, &[("rise", 0.01)]);
        drive(&mut second, step, &[("rise", 0.01)]);
    }
    assert_eq!(first.to_bytes(), second.to_bytes());
}

#[test]
fn coefficients_are_named_by_their_contact() {
    let contacts = json!([
        {"name": "foot_a", "part": "a", "friction": {"law": "exponential", "a": 0.02, "b": 0.01, "alpha": 3.0}},
        {"name": "foot_b", "part": "b", "friction": {"law": "exponential", "a": {"expression": "0.02 + 0.01 * x"}, "b": 0.01, "alpha": 3.0}}]);
    let mut simulator = started(compile(&scene(contacts, &[])).unwrap());
    assert_eq!(values(&simulator, "contacts[0].friction.a"), [0.02]);
    close(
        &values(&simulator, "contacts[1].friction.a"),
        &[0.02625, 0.0275, 0.02875, 0.03],
        "field",
    );
    let ports = ["contacts[1].friction.b", "contacts[0].friction.b"];
    let references = ports.map(|name| simulator.model().ports().find(name).unwrap().reference);
    // a set: above the smallest a of the second contact
    let error = simulator
        .set_many(&references, &[0.027, 0.001])
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("contacts[1].friction.a at contact node 0"),
        "{error}"
    );
    assert_eq!(values(&simulator, ports[1]), [0.01]);
    simulator.set_many(&references, &[0.02, 0.001]).unwrap();
    let kept = ports.map(|name| values(&simulator, name)[0]);
    assert_eq!(kept, [0.02, 0.001]);
    drive(&mut simulator, 0, &[]);
    let alpha = simulator
        .model()
        .ports()
        .find("contacts[0].friction.alpha")
        .unwrap()
        .reference;
    let error = simulator.set(alpha, -1.0).unwrap_err();
    assert!(
        error.to_string().contains("contacts[0].friction.alpha"),
        "{error}"
    );
}
