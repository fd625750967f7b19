//! Bodies that nothing but their contact holds along its normal, and parts on rollers.

mod common;

use common::{relative, scene, value, values};
use serde_json::{Value, json};
use stickslip::simulator::drive::Drive;
use stickslip::{Error, Simulator, compile};

const YOUNG: f64 = 2.0;
const VISCOSITY: f64 = 0.3;
const SIZE: [f64; 2] = [0.8, 0.5];
const PRESSURE: f64 = 0.4;
const MODELS: [&str; 3] = ["full", "condensed", "reduced"];
const WHOLE: [&str; 3] = ["full", "condensed", "auto"];

/// A block under a pressure on its top, without lateral effects.
fn block(held: &Value, contact: &Value, time: &Value, signals: &Value) -> Value {
    let mut scene = json!({"schema_version": 1, "name": "block",
        "mesh": {"kind": "rectangle", "size": SIZE, "cells": [8, 5]},
        "material": {"viscosity": {"law": "isotropic", "mu1": 0.0, "mu2": VISCOSITY},
                     "elasticity": {"law": "isotropic", "young": YOUNG, "poisson": 0.0, "convention": "plane_strain"}},
        "contact": contact,
        "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": [0, -1], "start": PRESSURE}],
        "probes": [{"name": "top", "at": [0.4, 0.5]}],
        "time": time,
        "run": {"until": 1.0, "signals": signals}});
    for (key, value) in held.as_object().unwrap() {
        scene[key] = value.clone();
    }
    scene
}

fn guide() -> Value {
    json!({"driven": [{"part": "top", "directions": {"guide": [1, 0]}}]})
}

fn with_model(scene: &Value, model: &str) -> stickslip::Scene {
    let mut scene = scene.clone();
    scene["fidelity"] = json!({"model": model, "friction_tolerance": 1e-12});
    common::scene(&scene)
}

/// Pressure is load by area from the first moment on, and the block gives in as its column does.
#[test]
fn a_block_stands_under_its_load() {
    let contact = json!({"part": "bottom", "condition": {"kind": "unilateral"},
                         "friction": {"law": "coulomb", "coefficient": 0.3}});
    let time = json!({"scheme": "tr_bdf2", "step": 0.01});
    let signals = json!({"press": [[0.0, PRESSURE], [1.0, PRESSURE]]});
    for held in [
        guide(),
        json!({"rollers": ["left", "right"]}),
        json!({"rollers": ["left"]}),
    ] {
        for model in WHOLE {
            let scene = with_model(&block(&held, &contact, &time, &signals), model);
            let mut simulator = Simulator::new(compile(&scene).unwrap());
            let mut drive = Drive::start(&scene, &mut simulator).unwrap();
            while let Some(simulator) = drive.step().unwrap() {
                for pressure in values(simulator, "contact.pressure") {
                    assert!(
                        (pressure / PRESSURE - 1.0).abs() < 1e-9,
                        "{model} {held}: {pressure}"
                    );
                }
                let t = simulator.time();
                let strain = -PRESSURE / YOUNG * (1.0 - (-YOUNG * t / VISCOSITY).exp());
                let moved = values(simulator, "top.displacement")[1];
                let error = (moved - SIZE[1] * strain).abs() / (SIZE[1] * PRESSURE / YOUNG);
                assert!(error < 1e-4, "{model} {held} {t}: {error}");
                let stress = values(simulator, "contact.tangential_stress");
                assert!(stress.iter().all(|s| s.abs() < 1e-9));
            }
        }
    }
}

/// A belt that runs under it takes the whole friction, mu times the load; the guide bears it. Power is in balance to rounding, the
/// foundation lifting the block on the way.
#[test]
fn a_guided_block_bears_mu_times_its_load() {
    let mu = 0.3;
    let contact = json!({"part": "bottom", "pressure": true,
        "friction": {"law": "coulomb", "coefficient": mu},
        "foundation": [{"kind": "sliding", "name": "belt", "direction": [1, 0]}, {"kind": "approach", "name": "lift"}]});
    let time = json!({"scheme": "trapezoid", "step": 0.01, "force": true});
    let signals = json!({"press": [[0.0, PRESSURE], [1.0, PRESSURE]],
        "belt": [[0.0, 0.0], [0.1, 0.5], [1.0, 0.5]],
        "lift": [[0.0, 0.0], [0.2, 0.002], [0.6, 0.02], [1.0, 0.0]]});
    for model in WHOLE {
        let scene = with_model(&block(&guide(), &contact, &time, &signals), model);
        let mut simulator = Simulator::new(compile(&scene).unwrap());
        let mut drive = Drive::start(&scene, &mut simulator).unwrap();
        let mut rows = Vec::new();
        while let Some(simulator) = drive.step().unwrap() {
            let balance = value(simulator, "energy.balance_error");
            assert!(balance < 1e-9, "{model}: {balance}");
            let pressed: f64 = values(simulator, "contact.normal_force").iter().sum();
            assert!(
                (pressed / (PRESSURE * SIZE[0]) - 1.0).abs() < 1e-9,
                "{model}: {pressed}"
            );
            rows.push((
                value(simulator, "guide.force"),
                value(simulator, "contact.stick_fraction"),
            ));
        }
        let (force, stuck) = rows[rows.len() - 1];
        assert_eq!(stuck, 0.0);
        // where friction tilts the block its contact pulls, and friction is with what presses alone
        let pressures = values(&simulator, "contact.pressure");
        let last = pressures.len() - 1;
        let share = SIZE[0] / last as f64;
        let weights = (0..=last).map(|i| if i % last == 0 { 0.5 * share } else { share });
        let pressing = pressures.iter().zip(weights);
        let limit = mu * pressing.map(|(p, w)| p.max(0.0) * w).sum::<f64>();
        assert!(pressures[last] < 0.0, "{pressures:?}");
        assert!(
            (force.abs() / limit - 1.0).abs() < 1e-9,
            "{model}: {force} {limit}"
        );
    }
}

/// Half of a body that is its own mirror image, on rollers in the plane of symmetry, moves as the half of the whole: contact nodes
/// in that plane too.
#[test]
fn rollers_are_a_plane_of_symmetry() {
    let of = |width: f64, cells: u32, rollers: Value, model: &str| {
        json!({"schema_version": 1, "name": "half",
            "mesh": {"kind": "rectangle", "size": [width, 0.5], "cells": [cells, 4]},
            "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                         "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"}},
            "clamped": ["top"], "rollers": rollers,
            "contact": {"part": "bottom", "condition": {"kind": "unilateral"},
                        "friction": {"law": "coulomb", "coefficient": 0.2},
                        "foundation": [{"kind": "approach", "name": "rise"}]},
            "time": {"step": 0.02}, "fidelity": {"model": model, "tolerance": 1e-9, "friction_tolerance": 1e-12},
            "run": {"until": 0.6, "signals": {"rise": [[0.0, 0.0], [0.3, 0.1], [0.6, 0.02]]}}})
    };
    let run = |value: &Value| -> Vec<[Vec<f64>; 3]> {
        let scene = scene(value);
        let mut simulator = Simulator::new(compile(&scene).unwrap());
        let mut drive = Drive::start(&scene, &mut simulator).unwrap();
        let mut rows = Vec::new();
        while let Some(simulator) = drive.step().unwrap() {
            let fields = [
                "contact.pressure",
                "contact.slip",
                "contact.tangential_stress",
            ];
            rows.push(fields.map(|name| values(simulator, name)));
        }
        rows
    };
    // friction magnifies the error of a reduction
    for (model, most) in MODELS.into_iter().zip([1e-7, 1e-7, 1e-6]) {
        let whole = run(&of(2.0, 16, json!([]), model));
        let half = run(&of(1.0, 8, json!(["left"]), model));
        let (mut slid, mut opened) = (0, 0);
        for (whole, half) in whole.iter().zip(&half) {
            for (whole, half) in whole.iter().zip(half) {
                let size = common::largest(whole).max(1e-3);
                let error = relative(half, &whole[8..]) * common::largest(half) / size;
                assert!(error < most, "{model}: {error}");
            }
            // nothing slides in the plane of symmetry
            assert!(half[1][0].abs() < 1e-12 && half[2][0].abs() < 1e-9);
            slid += half[1].iter().filter(|slip| **slip != 0.0).count();
            opened += half[0].iter().filter(|pressure| **pressure == 0.0).count();
        }
        assert!(slid > 20 && opened > 20, "{slid} {opened}");
    }
}

/// The same without normal unknowns: the only component of the contact node in the plane of symmetry is then held, of materials that
/// stay free, of such whose strain norm is assembled, and of a body all of whose nodes are in contact or held too.
#[test]
fn rollers_hold_the_only_component_of_a_contact_node() {
    let memory = json!([{"tau": 0.1, "law": "isotropic", "shear": 0.3, "bulk": 0.5}]);
    let of = |half: bool, rows: u32, memory: &Value, fidelity: &Value| {
        let (width, cells) = if half { (1.0, 8) } else { (2.0, 16) };
        let pull = |part: &str, direction: i32| json!({"name": part, "kind": "traction", "part": part, "direction": [direction, 0]});
        let mut loads = vec![pull("right", 1)];
        let mut signals = json!({"right": [[0.0, 0.0], [0.3, 0.2], [0.6, -0.1]]});
        if !half {
            loads.push(pull("left", -1));
            signals["left"] = signals["right"].clone();
        }
        let rollers = if half { json!(["left"]) } else { json!([]) };
        json!({"schema_version": 1, "name": "half",
            "mesh": {"kind": "rectangle", "size": [width, 0.5], "cells": [cells, rows]},
            "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                         "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"},
                         "memory": memory},
            "clamped": ["top"], "rollers": rollers, "loads": loads,
            "contact": {"part": "bottom", "friction": {"law": "tresca", "bound": 0.02}},
            "time": {"step": 0.02}, "fidelity": fidelity,
            "run": {"until": 0.6, "signals": signals}})
    };
    let run = |value: &Value| -> Vec<[Vec<f64>; 2]> {
        let scene = scene(value);
        let mut simulator = Simulator::new(compile(&scene).unwrap());
        let mut drive = Drive::start(&scene, &mut simulator).unwrap();
        let mut rows = Vec::new();
        while let Some(simulator) = drive.step().unwrap() {
            let fields = ["contact.slip", "contact.tangential_stress"];
            rows.push(fields.map(|name| values(simulator, name)));
        }
        rows
    };
    for (model, is_free, rows, memory) in [
        ("full", false, 4, &json!([])),
        ("full", false, 4, &memory),
        ("condensed", false, 1, &memory),
        ("reduced", false, 4, &memory),
        ("reduced", true, 4, &memory),
    ] {
        let mut fidelity = json!({"model": model, "friction_tolerance": 1e-12});
        if model == "reduced" {
            fidelity["tolerance"] = json!(1e-9);
            fidelity["free_material"] = json!(is_free);
        }
        let whole = run(&of(false, rows, memory, &fidelity));
        let half = run(&of(true, rows, memory, &fidelity));
        let (mut slid, mut stuck) = (0, 0);
        for (whole, half) in whole.iter().zip(&half) {
            for (whole, half) in whole.iter().zip(half) {
                let errors = whole[8..].iter().zip(half).map(|(a, b)| (a - b).abs());
                let error = errors.fold(0.0, f64::max) / common::largest(whole).max(1e-3);
                assert!(error < 1e-6, "{model} {is_free} {rows}: {error}");
            }
            assert!(half[0][0].abs() < 1e-12, "{}", half[0][0]);
            slid += half[0].iter().filter(|slip| slip.abs() > 1e-6).count();
            stuck += half[0].iter().filter(|slip| slip.abs() < 1e-12).count();
        }
        assert!(slid > 20 && stuck > 20, "{model}: {slid} {stuck}");
    }
}

/// What nothing holds is named when the scene is read, and when contact opens.
#[test]
fn free_motions_are_named() {
    let contact = json!({"part": "bottom", "condition": {"kind": "unilateral"}, "friction": {"law": "frictionless"}});
    let time = json!({"step": 0.01});
    let signals =
        json!({"press": [[0.0, PRESSURE], [0.5, PRESSURE], [0.6, -PRESSURE], [1.0, -PRESSURE]]});
    for (held, motion) in [
        (json!({"rollers": ["side"]}), None),
        (
            json!({"driven": [{"part": "top", "directions": {"up": [0, 1]}}]}),
            Some("moves along [1.0, 0.0]"),
        ),
        (json!({"rollers": ["top"]}), Some("moves along [1.0, 0.0]")),
    ] {
        let text = block(&held, &contact, &time, &signals).to_string();
        let error = match stickslip::Scene::from_json(&text, "test") {
            Ok(scene) => compile(&scene).map(|_| ()).unwrap_err(),
            Err(error) => error,
        };
        let Error::Scene { path, found, .. } = &error else {
            panic!("{error}");
        };
        match motion {
            None => assert_eq!(path, "rollers[0]"),
            Some(motion) => {
                assert_eq!(path, "clamped");
                assert!(found.contains(motion), "{found}");
            }
        }
    }
    for model in WHOLE {
        let scene = with_model(&block(&guide(), &contact, &time, &signals), model);
        let mut simulator = Simulator::new(compile(&scene).unwrap());
        let mut drive = Drive::start(&scene, &mut simulator).unwrap();
        let error = loop {
            match drive.step() {
                Ok(Some(_)) => {}
                Ok(None) => panic!("{model}: it would fly away"),
                Err(error) => break error,
            }
        };
        assert!(
            matches!(
                error,
                Error::NotHeld {
                    node: _,
                    closed: 0,
                    ..
                }
            ),
            "{model}: {error}"
        );
        assert!(
            (0.5..0.6).contains(&simulator.time()),
            "{model}: {}",
            simulator.time()
        );
    }
    let reduced = with_model(&block(&guide(), &contact, &time, &signals), "reduced");
    let Err(Error::Scene { path, .. }) = compile(&reduced) else {
        panic!("there is nothing to reduce");
    };
    assert_eq!(path, "fidelity.model");
    let mut free = block(&guide(), &contact, &time, &signals);
    free["fidelity"] = json!({"free_material": true});
    let Err(Error::Scene { path, .. }) = compile(&scene(&free)) else {
        panic!("a material stays free by what is reduced");
    };
    assert_eq!(path, "fidelity.free_material");
    // nothing is proved of a law that weakens where the contact may open
    let mut falls = block(&guide(), &contact, &time, &signals);
    let falling = json!({"kind": "exponential", "static": 1e-9, "kinetic": 0.0, "decay": 1e-3});
    for coefficient in [json!(0.1), falling] {
        falls["contact"]["friction"] = json!({"law": "coulomb", "coefficient": coefficient});
        let certificate = *compile(&scene(&falls)).unwrap().certificate();
        assert!(!certificate.is_step_unique() && !certificate.is_theorem_satisfied());
    }
    // closed at the start by nothing: a gap
    let mut open = block(&guide(), &contact, &time, &signals);
    open["contact"]["condition"]["gap"] = json!(0.01);
    let mut simulator = Simulator::new(compile(&scene(&open)).unwrap());
    assert!(matches!(simulator.init(0.0), Err(Error::NotHeld { .. })));
}
