//! Pressed and moving contact against closed forms: a column that closes and lifts off, total Coulomb friction, the stick-slip cycle
//! of a spring slider, Hertz and Cattaneo-Mindlin on a mesh of Gmsh, a drum brake.

mod common;

use common::{scene, start, value, values};
use serde_json::{Value, json};
use std::f64::consts::PI;
use stickslip::scene::{ExampleFiles, Scene, example};
use stickslip::simulator::drive::Drive;
use stickslip::{MemoryFiles, Simulator, compile, compile_from};

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

/// A file of the test meshes under the name that the scene has for it.
fn file(name: &str) -> MemoryFiles {
    let root = env!("CARGO_MANIFEST_DIR");
    let bytes = std::fs::read(format!("{root}/tests/meshes/{name}.msh")).unwrap();
    MemoryFiles::new([("part.msh", bytes.as_slice())])
}

fn set(simulator: &mut Simulator, name: &str, value: f64) {
    let reference = simulator.model().ports().find(name).unwrap().reference;
    simulator.set(reference, value).unwrap();
}

/// Largest errors of a pressed and dragged half disc against the theories of Hertz and of Cattaneo and Mindlin.
#[derive(Debug, Default)]
struct PartialSlip {
    /// Half width of the contact, by the second moment of the pressure and by the nodes that touch.
    widths: [f64; 2],
    /// Pressure and shear over the width, root mean square.
    pressure: f64,
    shear: f64,
    /// Half width of the zone that sticks, by the nodes and by the shear in the middle.
    stick: [f64; 2],
}

/// Half a disc of Gmsh, pressed without friction on the flat foundation and then dragged with it, slowly: `a^2 = 4 P R / (pi E*)`,
/// `p = 2 P / (pi a) sqrt(1 - x^2/a^2)`, `c = a sqrt(1 - Q / (mu P))`, shear `mu (p_a - c/a p_c)`. The width of the contact is 1/50
/// of the radius, and the body nearly incompressible: what the theories leave out (the shear bends the surface along its normal) is
/// below 1 %.
fn partial_slip(mesh: &str) -> PartialSlip {
    const RADIUS: f64 = 0.05;
    const MU: f64 = 0.02;
    let (young, poisson, time) = (1e7, 0.45, 1e-3);
    let (mu1, mu2) = (
        young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
        young / (1.0 + poisson),
    );
    let scene = scene(&json!({"schema_version": 1, "name": "half_disc",
        "mesh": {"kind": "gmsh", "file": "part.msh"},
        "material": {"viscosity": {"law": "isotropic", "mu1": time * mu1, "mu2": time * mu2},
                     "elasticity": {"law": "isotropic", "young": young, "poisson": poisson, "convention": "plane_strain"}},
        "driven": [{"part": "top", "input": "displacement", "directions": {"press": [0, -1], "drag": [1, 0]}}],
        "contact": {"part": "round", "condition": {"kind": "unilateral", "gap": "geometry"},
                    "friction": {"law": "coulomb", "coefficient": 0.0}},
        "time": {"scheme": "backward_euler", "step": 0.1},
        "fidelity": {"model": "condensed", "friction_tolerance": 1e-10}}));
    let mut simulator = common::started(compile_from(&scene, &file(mesh)).unwrap());
    let step = |simulator: &mut Simulator, press: f64, drag: f64| {
        set(simulator, "press", press);
        set(simulator, "drag", drag);
        simulator.do_step(simulator.time(), 0.1).unwrap();
    };
    let depth = 4.4e-5;
    for i in 1..=12 {
        step(&mut simulator, depth * f64::from(i.min(10)) / 10.0, 0.0);
    }
    set(&mut simulator, "contact.friction.coefficient", MU);
    let mut worst = PartialSlip::default();
    let mut sampled = 0;
    for i in 0..=16 {
        step(&mut simulator, depth, 1.6e-6 * f64::from(i) / 16.0);
        let contact = simulator.model().contact();
        let (x, w): (Vec<f64>, &[f64]) = (
            contact.points.iter().map(|p| p[0]).collect(),
            &contact.weights,
        );
        let sum = |f: &dyn Fn(usize) -> f64| (0..w.len()).map(|n| w[n] * f(n)).sum::<f64>();
        let [p, q, status] = ["pressure", "tangential_stress", "status"]
            .map(|name| values(&simulator, &format!("contact.{name}")));
        let (force, pull) = (sum(&|n| p[n]), -sum(&|n| q[n]));
        let modulus = young / (1.0 - poisson * poisson);
        let a = (4.0 * force * RADIUS / (PI * modulus)).sqrt();
        let hertz = |width: f64, n: usize| {
            let most = 2.0 * force / (PI * a);
            most * (width / a) * (1.0 - (x[n] / width).powi(2)).max(0.0).sqrt()
        };
        let most = |to: &mut f64, error: f64| *to = to.max(error.abs());
        let moment = 2.0 * (sum(&|n| p[n] * x[n] * x[n]) / force).sqrt();
        most(&mut worst.widths[0], moment / a - 1.0);
        let touching = sum(&|n| f64::from(u8::from(status[n] > 0.0))) / 2.0;
        most(&mut worst.widths[1], touching / a - 1.0);
        let rms = |f: &dyn Fn(usize) -> f64, g: &dyn Fn(usize) -> f64| {
            (sum(&|n| (f(n) - g(n)).powi(2)) / sum(&|n| g(n).powi(2))).sqrt()
        };
        if i == 0 {
            most(&mut worst.pressure, rms(&|n| p[n], &|n| hertz(a, n)));
        }
        let share = pull / (MU * force);
        if !(0.25..0.8).contains(&share) {
            continue;
        }
        sampled += 1;
        let c = a * (1.0 - share).sqrt();
        let shear = |n: usize| MU * (hertz(a, n) - hertz(c, n));
        most(&mut worst.shear, rms(&|n| -q[n], &shear));
        let sticking = sum(&|n| f64::from(u8::from(status[n] == 1.0))) / 2.0;
        most(&mut worst.stick[0], sticking / c - 1.0);
        let middle = (0..w.len())
            .min_by(|i, j| x[*i].abs().total_cmp(&x[*j].abs()))
            .unwrap();
        let by_shear = a * (1.0 + q[middle] / (MU * p[middle]));
        most(&mut worst.stick[1], by_shear / c - 1.0);
        println!(
            "{mesh} Q/(mu P) {share:.3} stick {:.4} {:.4}",
            sticking / c - 1.0,
            by_shear / c - 1.0
        );
    }
    assert!(sampled >= 4, "{sampled}");
    println!("{mesh} {worst:?}");
    worst
}

#[test]
fn half_disc_is_that_of_hertz_and_slips_as_cattaneo_and_mindlin_say() {
    let (fine, coarse) = (partial_slip("half_disc"), partial_slip("half_disc_coarse"));
    for (what, fine, coarse, limit) in [
        ("width", fine.widths[0], coarse.widths[0], 0.02),
        ("width by nodes", fine.widths[1], f64::INFINITY, 0.02),
        ("pressure", fine.pressure, coarse.pressure, 0.02),
        ("shear", fine.shear, coarse.shear, 0.05),
        ("stick zone by nodes", fine.stick[0], f64::INFINITY, 0.02),
        ("stick zone", fine.stick[1], coarse.stick[1], 0.02),
    ] {
        assert!(fine < limit, "{what}: {fine}");
        // what nodes count goes in steps of a node
        assert!(fine < coarse, "{what}: {fine} {coarse}");
    }
}

/// A stiff shoe that turns about a hinge into a drum: the lining, which gives way in proportion to the pressure, has the pressure
/// `p = k phi a sin(theta)`, a the distance of the hinge from the axis and theta the angle from it. Moments of the pressure and of
/// the friction about the hinge, and the torque, are those of the long internal shoe of textbooks: friction presses the shoe on
/// (leading) or off (trailing).
#[test]
fn drum_brake_amplifies_its_torque() {
    let (radius, distance, hinge) = (0.14, 0.11, 2.1_f64);
    let (stiffness, mu, turn) = (1e6, 0.4, 1e-3);
    // the lining of the mesh reaches from 0.6 to 1.8
    let (from, to) = (hinge - 1.8, hinge - 0.6);
    let scale = stiffness * turn * distance * radius;
    let squares = |t: f64| t / 2.0 - (2.0 * t).sin() / 4.0;
    let of_pressure = scale * distance * (squares(to) - squares(from));
    let cosines = f64::cos(from) - f64::cos(to);
    let both = (f64::sin(to).powi(2) - f64::sin(from).powi(2)) / 2.0;
    let of_friction = mu * scale * (radius * cosines - distance * both);
    let torque = mu * scale * radius * cosines;
    let mut actuation = Vec::new();
    for sense in [1.0, -1.0] {
        let scene = scene(&json!({"schema_version": 1, "name": "drum_brake",
            "mesh": {"kind": "gmsh", "file": "part.msh"},
            "material": {"viscosity": {"law": "isotropic", "mu1": 1e8, "mu2": 1e8},
                         "elasticity": {"law": "isotropic", "young": 1e13, "poisson": 0.3, "convention": "plane_strain"}},
            "driven": [{"part": "cam", "input": "displacement", "directions":
                {"turn": {"centre": [distance * hinge.cos(), distance * hinge.sin()]}}}],
            "contact": {"part": "drum face", "condition": {"kind": "compliance", "stiffness": stiffness},
                        "friction": {"law": "coulomb", "coefficient": mu},
                        "foundation": [{"kind": "rotation", "name": "drum", "centre": [0, 0], "start": sense * 20.0}]},
            "time": {"scheme": "backward_euler", "step": 0.1},
            "fidelity": {"model": "condensed", "friction_tolerance": 1e-10}}));
        let mut simulator = common::started(compile_from(&scene, &file("shoe")).unwrap());
        for i in 1..=12 {
            set(&mut simulator, "turn", turn * f64::from(i.min(10)) / 10.0);
            simulator.do_step(simulator.time(), 0.1).unwrap();
        }
        assert_eq!(value(&simulator, "contact.stick_fraction"), 0.0);
        let close = |found: f64, exact: f64, what: &str| {
            assert!(
                (found / exact - 1.0).abs() < 1e-3,
                "{what} {sense}: {found} {exact}"
            );
        };
        close(value(&simulator, "drum.torque"), sense * torque, "torque");
        let needed = value(&simulator, "turn.torque");
        close(needed, of_pressure - sense * of_friction, "actuation");
        actuation.push(needed);
    }
    // the leading shoe gets by with a fraction of what the trailing one needs
    let amplification = (of_pressure + of_friction) / (of_pressure - of_friction);
    assert!(amplification > 2.0, "{amplification}");
    assert!((actuation[1] / actuation[0] / amplification - 1.0).abs() < 2e-3);
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

/// A lip that hardly changes its volume resists some motions 1e5 times as much as others. What a step of friction takes there stays
/// within tens, where the stroke turns and where the shaft comes to a stop too, and rounding is told from what is not solved.
#[test]
fn a_lip_that_keeps_its_volume_takes_tens_of_iterations() {
    let memory = r#"[{"tau":0.5,"law":"isotropic","shear":8e5,"bulk":0}]"#;
    for overrides in [
        &[("material.memory", memory)][..],
        &[("contact.friction.coefficient", "0.3")],
        &[
            ("material.memory", memory),
            ("contact.friction.coefficient", "0.2"),
        ],
    ] {
        let text = example("lip_seal").unwrap();
        let overrides = overrides
            .iter()
            .map(|(p, v)| (p.to_string(), v.to_string()));
        let overrides: Vec<_> = overrides.collect();
        let scene = Scene::with_overrides(text, "lip_seal", &overrides).unwrap();
        let model = compile_from(&scene, &ExampleFiles).unwrap();
        let mut simulator = Simulator::new(model);
        let mut drive = Drive::start(&scene, &mut simulator).unwrap();
        let mut most = 0.0_f64;
        while let Some(simulator) = drive.step().unwrap() {
            most = most.max(value(simulator, "solver.iterations"));
        }
        assert!((10.0..80.0).contains(&most), "{overrides:?}: {most}");
    }
}
