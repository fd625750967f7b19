//! A load that is held: the body relaxes, slip rates decay by thirty orders of magnitude and more, and the run goes on for ever
//! at the default tolerance and without iterations to speak of.
//!
//! In space the direction of slip is defined as long as there is any slip. A node that slips at 1e-9 of its former rate turns
//! its direction 1e9 times more easily, which no matrix can hold beside its other entries; see `friction::space`.

mod common;

use common::{largest, paper, start, value, values};
use stickslip::{Scene, Simulator};

/// The embedded pad with internal steps of 0.01 s, with which the figures below were computed.
fn pad(overrides: &[(&str, &str)]) -> Scene {
    let text = stickslip::scene::example("brake_pad_3d").unwrap();
    let step = [("time.step", "0.01")];
    let all: Vec<_> = step
        .iter()
        .chain(overrides)
        .map(|(path, value)| (path.to_string(), value.to_string()))
        .collect();
    Scene::with_overrides(text, "brake_pad_3d", &all).unwrap()
}

/// What `count` steps of size `k` took: iterations in all, the most in one.
fn hold(simulator: &mut Simulator, k: f64, count: usize) -> (f64, f64) {
    let (mut all, mut most) = (0.0, 0.0_f64);
    for _ in 0..count {
        simulator
            .do_step(simulator.time(), k)
            .unwrap_or_else(|e| panic!("{e}"));
        let iterations = value(simulator, "solver.iterations");
        (all, most) = (all + iterations, most.max(iterations));
        assert!(value(simulator, "solver.residual") <= 1e-10);
    }
    (all, most)
}

/// The brake pad at its own resolution, its own signals run out.
#[test]
fn brake_pad_after_its_signals() {
    let scene = pad(&[]);
    let mut simulator = start(&scene);
    for n in 1..=100 {
        let t = f64::from(n) * 0.01;
        let loads = scene.loads.iter().map(|l| scene.run.signals[&l.name].at(t));
        simulator.set_inputs(&loads.collect::<Vec<_>>()).unwrap();
        simulator.do_step(simulator.time(), 0.01).unwrap();
    }
    let fastest = value(&simulator, "contact.max_slip_rate");
    assert!(fastest > 1e-5, "{fastest:e}");
    let (_, most) = hold(&mut simulator, 0.01, 150);
    assert!(most <= 12.0, "{most}");
    let (all, _) = hold(&mut simulator, 0.01, 250);
    assert!(all <= 50.0, "{all} iterations in 250 steps at rest");
    assert!(value(&simulator, "contact.max_slip_rate") < 1e-12 * fastest.max(1e-3));
}

/// A small body under a constant load, in every model, scheme and law: the end is that of a run at a loose tolerance.
#[test]
fn constant_load_in_space() {
    let laws = [
        r#"{"law": "tresca", "bound": 20000}"#,
        r#"{"law": "exponential", "a": 30000, "b": 15000, "alpha": 100}"#,
        r#"{"law": "exponential", "a": 20000, "b": 20000, "alpha": 0}"#,
        r#"{"law": "frictionless"}"#,
    ];
    for law in laws {
        for scheme in ["trapezoid", "backward_euler", "tr_bdf2", "rectangle"] {
            for model in ["full", "condensed", "reduced"] {
                let run = |solver: &str| {
                    let mut simulator = start(&pad(&[
                        ("mesh.cells", "[2, 1, 1]"),
                        ("contact.friction", law),
                        ("time.scheme", scheme),
                        ("fidelity.model", model),
                        ("fidelity.solver", solver),
                    ]));
                    simulator.set_inputs(&[1e5, 2e4]).unwrap();
                    simulator
                };
                let mut simulator = run(r#"{"kind": "newton"}"#);
                let mut fastest: f64 = 0.0;
                for _ in 0..300 {
                    simulator.do_step(simulator.time(), 0.01).unwrap();
                    fastest = fastest.max(value(&simulator, "contact.max_slip_rate"));
                }
                let (all, most) = hold(&mut simulator, 0.01, 2000);
                let stages = if scheme == "tr_bdf2" { 2.0 } else { 1.0 };
                // without friction nothing is left at rest but rounding, which takes a step of its own
                let allowed = if law.contains("frictionless") {
                    2000.0
                } else {
                    500.0
                };
                assert!(
                    most <= 2.0 * stages && all <= allowed * stages,
                    "{law}, {scheme}, {model}: {all}, at most {most}"
                );
                let rate = value(&simulator, "contact.max_slip_rate");
                assert!(
                    fastest > 1e-5 && rate < 1e-11 * fastest,
                    "{law}, {scheme}, {model}: {rate:e}"
                );
                let slip = values(&simulator, "contact.slip");
                let mut peer = run(r#"{"kind": "fixed_point"}"#);
                for _ in 0..2300 {
                    peer.do_step(peer.time(), 0.01).unwrap();
                }
                let error = common::relative(&values(&peer, "contact.slip"), &slip);
                assert!(error < 2e-6, "{law}, {scheme}, {model}: {error:e}");
            }
        }
    }
}

/// Case (c): figures from runs of an older build at a friction tolerance of 1e-7 and 1e-6, and with the fixed point.
#[test]
fn small_pad_comes_to_rest() {
    let mut simulator = start(&pad(&[
        ("mesh.cells", "[2, 1, 1]"),
        ("contact.friction", r#"{"law": "tresca", "bound": 20000}"#),
        ("loads[0].start", "1e5"),
    ]));
    hold(&mut simulator, 0.01, 300);
    let force = values(&simulator, "contact.force");
    assert!((force[0] + 16.68275).abs() < 2e-4, "{force:?}");
    assert!((force[1] - 0.00588).abs() < 2e-4, "{force:?}");
    let slip = values(&simulator, "contact.slip");
    let most = largest(&slip);
    assert!((most / 1.303363e-4 - 1.0).abs() < 1e-5, "{most:e}");
    assert_eq!(value(&simulator, "contact.max_slip_rate"), 0.0);
    assert_eq!(value(&simulator, "contact.stick_fraction"), 1.0);
}

/// A million steps after the load was held.
#[test]
fn a_million_steps() {
    let tresca = r#"{"law": "tresca", "bound": 20000}"#;
    let small = [("mesh.cells", "[2, 1, 1]"), ("contact.friction", tresca)];
    let plane = paper(4, &[]);
    for (scene, loads) in [(pad(&small), vec![1e5, 3e4]), (plane, vec![-0.3])] {
        let mut simulator = start(&scene);
        let k = scene.time.step;
        simulator.set_inputs(&loads).unwrap();
        let mut fastest: f64 = 0.0;
        for _ in 0..400 {
            simulator.do_step(simulator.time(), k).unwrap();
            fastest = fastest.max(value(&simulator, "contact.max_slip_rate"));
        }
        let before = values(&simulator, "contact.slip");
        let mut iterations = 0.0;
        for _ in 0..1_000_000 {
            simulator.do_step(simulator.time(), k).unwrap();
            iterations += value(&simulator, "solver.iterations");
        }
        assert!(iterations <= 1000.0, "{iterations}");
        let after = values(&simulator, "contact.slip");
        assert!(common::relative(&after, &before) < 1e-8);
        assert!(largest(&after) > 1e-6);
        let rate = value(&simulator, "contact.max_slip_rate");
        assert!(rate < 1e-12 * fastest, "{rate:e} of {fastest:e}");
    }
}

/// Random constant loads on random bodies, in space and in the plane; the generator is a fixed sequence.
#[test]
fn random_constant_loads() {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    for trial in 0..120 {
        let law = match trial % 3 {
            0 => format!(r#"{{"law": "tresca", "bound": {}}}"#, 3e4 * random()),
            1 => {
                let b = 2e4 * random();
                let (a, alpha) = (
                    b * (1.0 + 2.0 * random()),
                    10.0_f64.powf(4.0 * random() - 1.0),
                );
                format!(r#"{{"law": "exponential", "a": {a}, "b": {b}, "alpha": {alpha}}}"#)
            }
            _ => format!(
                r#"{{"law": "exponential", "a": {}, "b": 0, "alpha": 10}}"#,
                3e4 * random()
            ),
        };
        let cells = |most: f64, random: &mut dyn FnMut() -> f64| 1 + (most * random()) as u32;
        let counts = [4.0, 2.0, 4.0].map(|most| cells(most, &mut random));
        let scene = pad(&[
            ("mesh.cells", &format!("{counts:?}")),
            ("contact.friction", &law),
        ]);
        let loads = [1.0, 1.0].map(|sign| sign * 4e5 * (random() - 0.5));
        let mut simulator = start(&scene);
        simulator.set_inputs(&loads).unwrap();
        let mut fastest: f64 = 0.0;
        for step in 0..2000 {
            simulator
                .do_step(simulator.time(), 0.01)
                .unwrap_or_else(|e| {
                    panic!("trial {trial}, step {step}, {counts:?}, {law}, {loads:?}: {e}")
                });
            fastest = fastest.max(value(&simulator, "contact.max_slip_rate"));
        }
        let (all, most) = hold(&mut simulator, 0.01, 200);
        assert!(
            all <= 100.0 && most <= 4.0,
            "trial {trial}, {counts:?}, {law}, {loads:?}: {all}, at most {most}"
        );
        let rate = value(&simulator, "contact.max_slip_rate");
        assert!(
            rate <= 1e-9 * fastest,
            "trial {trial}: {rate:e} of {fastest:e}"
        );
    }
}
