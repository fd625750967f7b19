//! Pressed and moving contact against closed forms: a column that closes and lifts off, total Coulomb friction, the stick-slip cycle
//! of a spring slider.

mod common;

use common::{scene, start, value, values};
use serde_json::{Value, json};
use stickslip::simulator::drive::Drive;
use stickslip::{Simulator, compile};

const YOUNG: f64 = 2.0;
const VISCOSITY: f64 = 0.3;
const HEIGHT: f64 = 0.5;

/// A column without lateral effects (poisson 0, mu1 0) above a foundation that rises and falls.
fn column(scheme: &str, model: &str, k: f64, gap: f64, rise: Value) -> Value {
    json!({"schema_version": 1, "name": "column",
        "mesh": {"kind": "rectangle", "size": [0.3, HEIGHT], "cells": [3, 5]},
        "material": {"viscosity": {"law": "isotropic", "mu1": 0.0, "mu2": VISCOSITY},
                     "elasticity": {"law": "isotropic", "young": YOUNG, "poisson": 0.0, "convention": "plane_strain"}},
        "clamped": ["top"],
        "contact": {"part": "bottom", "condition": {"kind": "unilateral", "gap": gap},
                    "friction": {"law": "frictionless"},
                    "foundation": [{"kind": "approach", "name": "rise"}]},
        "time": {"scheme": scheme, "step": k}, "fidelity": {"model": model},
        "run": {"until": 2.0, "signals": {"rise": rise}}})
}

/// `p = (mu2 D' + E (D - g0)) / L` while closed, none before `D = g0`, lift-off on retreat V at `D - g0 = mu2 V / E`, and then a gap
/// that relaxes.
#[test]
fn column_closes_and_lifts_off() {
    let (gap, up, down) = (0.01, 0.1, 0.09);
    // rises to 0.1 in one second, then falls
    let rise = json!([[0.0, 0.0], [1.0, up], [2.0, up - down]]);
    let off = 1.0 + (up - gap - VISCOSITY * down / YOUNG) / down;
    assert!(off < 1.9);
    for model in ["full", "condensed", "reduced"] {
        for (scheme, tolerance) in [
            ("backward_euler", 2e-2),
            ("tr_bdf2", 1e-3),
            ("midpoint", 1e-3),
        ] {
            let k = 1.0 / 128.0;
            let scene = scene(&column(scheme, model, k, gap, rise.clone()));
            let mut simulator = Simulator::new(compile(&scene).unwrap());
            let mut drive = Drive::start(&scene, &mut simulator).unwrap();
            let (mut closed, mut open) = (0, 0);
            while let Some(simulator) = drive.step().unwrap() {
                let t = simulator.time();
                let (d, slope) = match t {
                    _ if t <= 1.0 => (up * t, up),
                    _ => (up - down * (t - 1.0), -down),
                };
                let pressures = values(simulator, "contact.pressure");
                let gaps = values(simulator, "contact.gap");
                let (closes, margin) = (gap / up, 2.0 * k);
                let exact = (VISCOSITY * slope + YOUNG * (d - gap)) / HEIGHT;
                let is_switching = [closes, 1.0, off].iter().any(|at| (t - at).abs() < margin);
                if is_switching {
                    continue;
                }
                let is_closed = t > closes && t < off;
                closed += usize::from(is_closed);
                open += usize::from(!is_closed);
                for (pressure, found) in pressures.iter().zip(&gaps) {
                    if is_closed {
                        // exact but for the step in which it closed
                        assert!(
                            (pressure - exact).abs() < 1e-9,
                            "{scheme} {model} {t}: {pressure} {exact}"
                        );
                        assert!(found.abs() < 1e-12);
                    } else {
                        assert_eq!(*pressure, 0.0, "{scheme} {model} {t}");
                    }
                }
                if t > off {
                    let strain = VISCOSITY * down / YOUNG * (-YOUNG * (t - off) / VISCOSITY).exp();
                    let expected = strain - (d - gap);
                    let error = (gaps[0] - expected).abs() / (VISCOSITY * down / YOUNG);
                    assert!(error < tolerance, "{scheme} {model} {t}: {error}");
                }
            }
            assert!(closed > 100 && open > 20, "{closed} {open}");
        }
    }
}

/// Where all nodes slide one way, friction is mu times the normal force, and so are the forces that drive the block.
#[test]
fn sliding_block_takes_mu_times_its_normal_force() {
    let text = json!({"schema_version": 1, "name": "block",
        "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [16, 8]},
        "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                     "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"}},
        "driven": [{"part": "top", "directions": {"down": [0, -1], "along": [1, 0]}}],
        "contact": {"part": "bottom", "condition": {"kind": "unilateral"},
                    "friction": {"law": "coulomb", "coefficient": 0.3},
                    "foundation": [{"kind": "sliding", "name": "table", "direction": [1, 0]}]},
        "time": {"scheme": "backward_euler", "step": 0.03125},
        "run": {"until": 1.5, "signals": {
            "down": [[0, 0], [0.05, 0.04], [0.45, 0.04], [0.5, 0], [1.5, 0]],
            "along": [[0, 0], [0.5, 0], [0.7, 0.15], [1.5, 0.15]]}}});
    let scene = scene(&text);
    let mut simulator = Simulator::new(compile(&scene).unwrap());
    let mut drive = Drive::start(&scene, &mut simulator).unwrap();
    while drive.step().unwrap().is_some() {}
    let sim = drive.simulator();
    let normal = value(sim, "contact.normal_force");
    assert!(normal > 0.01 && value(sim, "contact.stick_fraction") == 0.0);
    for (port, sign) in [
        ("contact.force", -1.0),
        ("along.force", 1.0),
        ("table.force", -1.0),
    ] {
        let ratio = sign * value(sim, port) / normal;
        assert!((ratio - 0.3).abs() < 1e-12, "{port}: {ratio}");
    }
    assert!((value(sim, "down.force") / normal - 1.0).abs() < 1e-12);
}

/// Dragging the only held part is dragging the foundation the other way.
#[test]
fn driven_part_and_foundation_are_the_same_motion() {
    for scheme in ["backward_euler", "tr_bdf2", "midpoint"] {
        let scene = |is_driven: bool| {
            let (driven, clamped, foundation, signals) = if is_driven {
                (
                    json!([{"part": "top", "directions": {"drag": [1, 0], "lift": [0, 1]}}]),
                    json!([]),
                    json!([]),
                    json!({"drag": [[0, 0.1], [0.4, 0.3], [1, -0.2]]}),
                )
            } else {
                (
                    json!([]),
                    json!(["top"]),
                    json!([{"kind": "sliding", "name": "belt", "direction": [-1, 0]}]),
                    json!({"belt": [[0, 0.1], [0.4, 0.3], [1, -0.2]]}),
                )
            };
            let mut signals = signals;
            signals["press"] = json!(-0.3);
            scene(&json!({"schema_version": 1, "name": "block",
                "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [8, 4]},
                "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                             "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"}},
                "clamped": clamped, "driven": driven,
                "contact": {"part": "bottom", "condition": {"kind": "unilateral"}, "foundation": foundation,
                            "friction": {"law": "coulomb", "coefficient": 0.4}},
                "loads": [{"name": "press", "kind": "body_force", "direction": [0, 1]}],
                "probes": [{"name": "corner", "at": [1.0, 0.0]}],
                "time": {"scheme": scheme, "step": 0.025}, "run": {"until": 1.0, "signals": signals}}))
        };
        let end = |is_driven: bool| {
            let scene = scene(is_driven);
            let mut simulator = Simulator::new(compile(&scene).unwrap());
            let mut drive = Drive::start(&scene, &mut simulator).unwrap();
            while drive.step().unwrap().is_some() {}
            simulator
        };
        let (driven, belt) = (end(true), end(false));
        for port in [
            "contact.slip",
            "contact.slip_rate",
            "contact.tangential_stress",
            "contact.pressure",
        ] {
            let error = common::relative(&values(&driven, port), &values(&belt, port));
            assert!(error < 1e-12, "{scheme} {port}: {error:e}");
        }
        let force = |sim: &Simulator, port: &str| value(sim, port);
        assert!((force(&driven, "drag.force") - force(&belt, "belt.force")).abs() < 1e-13);
        // the body has moved with the part that is driven
        let moved = value(&driven, "drag.displacement");
        let probes = [&driven, &belt].map(|sim| values(sim, "corner.displacement")[0]);
        assert!(
            (probes[0] - moved - probes[1]).abs() < 1e-13,
            "{probes:?} {moved}"
        );
        assert!(moved.abs() > 0.05);
    }
}

/// A spring slider, (K, eta, P) = (2, 0.5, 1), drawn at V = 0.1 under a law that weakens faster than viscosity resists: sticks until
/// `K x + eta V = mu_s`, jumps, slides to the fold and sticks again. The period by quadrature of the sliding part is 1.145795.
#[test]
fn spring_slider_sticks_and_slips_with_its_period() {
    let of = |steps: u32| {
        let k = 6.0 * 1.145795 / f64::from(steps);
        let text = json!({"schema_version": 1, "name": "slider",
            "mesh": {"kind": "rectangle", "size": [1.0, 1.0], "cells": [1, 1], "periodic": ["x"]},
            // shear: K = two_mu / 2, eta = mu2 / 2
            "material": {"viscosity": {"law": "isotropic", "mu1": 0.0, "mu2": 1.0},
                         "elasticity": {"law": "isotropic", "young": 4.0, "poisson": 0.0, "convention": "plane_strain"}},
            "driven": [{"part": "top", "directions": {"draw": [1, 0], "hold": [0, 1]}}],
            "contact": {"part": "bottom", "friction": {"law": "bound", "bound":
                {"kind": "exponential", "static": 0.5, "kinetic": 0.3, "decay": 20.0}}},
            "time": {"scheme": "backward_euler", "step": k}});
        let mut simulator = start(&scene(&text));
        simulator.set_inputs(&[0.1, 0.0]).unwrap();
        let mut starts = Vec::new();
        let mut stuck = true;
        for i in 0..2 * steps {
            simulator.do_step(f64::from(i) * k, k).unwrap();
            let sticks = value(&simulator, "contact.stick_fraction") == 1.0;
            if stuck && !sticks {
                starts.push(simulator.time());
            }
            stuck = sticks;
        }
        // the first cycle begins without strain
        (starts[starts.len() - 1] - starts[1]) / (starts.len() - 2) as f64
    };
    for (steps, measured) in [(400, 1.16871), (1600, 1.15152), (6400, 1.14723)] {
        let period = of(steps);
        println!("{steps} steps in 6 periods: {period} (an independent solver: {measured})");
        assert!(
            (period / measured - 1.0).abs() < 2e-3,
            "{steps}: {period} {measured}"
        );
    }
}

/// A gap that is written as a formula is the gap node by node; what is no formula, no number or no gap is refused with its place.
#[test]
fn gap_is_a_formula_of_the_place() {
    let compiled = |gap: serde_json::Value| {
        let text = json!({"schema_version": 1, "name": "block",
            "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [8, 4]},
            "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                         "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"}},
            "clamped": ["left"],
            "contact": {"part": "bottom", "condition": {"kind": "unilateral", "gap": gap},
                        "friction": {"law": "coulomb", "coefficient": 0.3}},
            "time": {"scheme": "backward_euler", "step": 0.03125}});
        compile(&scene(&text))
    };
    let start = |gap| {
        let mut simulator = Simulator::new(compiled(gap).unwrap());
        simulator.init(0.0).unwrap();
        values(&simulator, "contact.gap")
    };
    let gaps = start(json!({"expression": "0.01 * x^2 + y"}));
    let nodes: Vec<f64> = (1..=8)
        .map(|i| 0.01 * (f64::from(i) / 8.0).powi(2))
        .collect();
    assert_eq!(gaps.len(), nodes.len());
    for (found, expected) in gaps.iter().zip(&nodes) {
        assert!((found - expected).abs() < 1e-16, "{gaps:?}");
    }
    assert_eq!(gaps, start(json!({"nodes": gaps})));
    for (formula, found, allowed) in [
        ("0.01 *", "the end at character 7", "a number"),
        ("r", "at character 1", "x y z"),
        ("1 / (x - x)", "inf at contact node 0", "finite numbers"),
        ("-x", "-0.125 at contact node 0", "a gap >= 0"),
    ] {
        let error = compiled(json!({"expression": formula}))
            .err()
            .unwrap()
            .to_string();
        assert!(error.contains("contact.condition.gap"), "{error}");
        assert!(error.contains(found) && error.contains(allowed), "{error}");
    }
}
