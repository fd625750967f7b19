//! Scenes and runs shared by the tests.
#![allow(dead_code)] // every test binary uses its own part

pub mod accuracy;
pub mod random;

use serde_json::{Value, json};
use std::sync::Arc;
use stickslip::{Compilation, Model, Scene, Simulator, compile};

/// The paper's example with `cells` along x (half as many along y) and the given overrides, as JSON paths.
pub fn paper(cells: u32, overrides: &[(&str, &str)]) -> Scene {
    let text = stickslip::scene::example("kazmi2014").expect("an embedded scene");
    let mut all = vec![(
        "mesh.cells".to_string(),
        format!("[{cells}, {}]", (cells / 2).max(1)),
    )];
    all.extend(
        overrides
            .iter()
            .map(|(p, v)| (p.to_string(), v.to_string())),
    );
    Scene::with_overrides(text, "kazmi2014", &all).expect("a valid scene")
}

/// A scene from its JSON value.
pub fn scene(value: &Value) -> Scene {
    Scene::from_json(&value.to_string(), "test scene").expect("a valid scene")
}

/// A simulator of a freshly compiled scene, initialized at 0.
pub fn start(scene: &Scene) -> Simulator {
    started(compile(scene).expect("a scene that compiles"))
}

/// A simulator of a model, initialized at 0.
pub fn started(model: Arc<Model>) -> Simulator {
    let mut simulator = Simulator::new(model);
    simulator.init(0.0).expect("a start that converges");
    simulator
}

/// `count` steps of size `k` from the current time.
pub fn steps(simulator: &mut Simulator, k: f64, count: usize) {
    for _ in 0..count {
        simulator
            .do_step(simulator.time(), k)
            .expect("a step that converges");
    }
}

/// One value of a scalar port.
pub fn value(simulator: &Simulator, port: &str) -> f64 {
    simulator.get_by_name(port).expect("a known port")[0]
}

/// Values of a port.
pub fn values(simulator: &Simulator, port: &str) -> Vec<f64> {
    simulator.get_by_name(port).expect("a known port")
}

/// The larger of two numbers; not a number where one of them is none, so that no comparison holds.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Largest magnitude; not a number where one of the values is none.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| larger(m, v.abs()))
}

/// Largest difference relative to the largest reference value.
pub fn relative(found: &[f64], reference: &[f64]) -> f64 {
    assert_eq!(found.len(), reference.len());
    let difference: Vec<f64> = found.iter().zip(reference).map(|(a, b)| a - b).collect();
    largest(&difference) / largest(reference).max(f64::MIN_POSITIVE)
}

/// Strain norm of a nodal field on the body of a compilation.
pub fn strain_norm(compilation: &Compilation, field: &[f64]) -> f64 {
    compilation.body.strain_norm(field)
}

/// A block `length` x `height`, one cell wide and periodic along x, clamped on top, in contact at the bottom: simple
/// shear, one contact node.
pub fn column(friction: Value, time: Value) -> Value {
    json!({
        "schema_version": 1, "name": "column",
        "mesh": {"kind": "rectangle", "size": [1.0, 1.0], "cells": [1, 1], "periodic": ["x"]},
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 0.5, "mu2": 2.0},
            "elasticity": {"law": "isotropic", "young": 6.0, "poisson": 0.25, "convention": "plane_strain"}
        },
        "clamped": ["top"],
        "contact": {"part": "bottom", "friction": friction},
        "loads": [{"name": "drag", "kind": "body_force", "direction": [1, 0]}],
        "time": time,
        "fidelity": {"model": "full", "friction_tolerance": 1e-13}
    })
}

/// A run of an embedded scene on its signals, seen at equal communication points.
pub struct Course {
    pub scene: &'static str,
    pub overrides: Vec<(&'static str, String)>,
    /// Communication step, s.
    pub step: f64,
    pub count: usize,
}

/// What a course gave.
pub struct Trajectory {
    /// Slip rates at the communication points, the start first.
    pub rates: Vec<Vec<f64>>,
    /// `solver.error_estimate` at the same points; zeros without.
    pub estimates: Vec<f64>,
    pub iterations: f64,
    pub simulator: Simulator,
}

impl Course {
    /// Runs with more overrides.
    pub fn run(&self, more: &[(&str, &str)]) -> Trajectory {
        let text = stickslip::scene::example(self.scene).expect("an embedded scene");
        let own = self.overrides.iter().map(|(p, v)| (*p, v.as_str()));
        let all: Vec<_> = own
            .chain(more.iter().copied())
            .map(|(p, v)| (p.to_string(), v.to_string()))
            .collect();
        let scene = Scene::with_overrides(text, self.scene, &all).expect("a valid scene");
        let loads = |t: f64| -> Vec<f64> {
            let signal = |l: &stickslip::scene::Load| scene.run.signals[&l.name].at(t);
            scene.loads.iter().map(signal).collect()
        };
        let mut simulator = Simulator::new(compile(&scene).expect("a scene that compiles"));
        simulator.set_inputs(&loads(0.0)).expect("fitting loads");
        simulator.init(0.0).expect("a start that converges");
        let has_estimate = simulator
            .model()
            .ports()
            .find("solver.error_estimate")
            .is_ok();
        let mut out = Trajectory {
            rates: vec![values(&simulator, "contact.slip_rate")],
            estimates: vec![0.0],
            iterations: 0.0,
            simulator,
        };
        for n in 0..self.count {
            let simulator = &mut out.simulator;
            let (from, to) = (n as f64 * self.step, (n + 1) as f64 * self.step);
            simulator.set_inputs(&loads(to)).expect("fitting loads");
            simulator
                .do_step(from, self.step)
                .expect("a step that converges");
            out.rates.push(values(simulator, "contact.slip_rate"));
            out.iterations += value(simulator, "solver.iterations");
            out.estimates.push(if has_estimate {
                value(simulator, "solver.error_estimate")
            } else {
                0.0
            });
        }
        out
    }

    /// Runs with equal internal steps, `parts` of them in a communication step.
    pub fn run_equal(&self, parts: u32, more: &[(&str, &str)]) -> Trajectory {
        let step = format!("{:?}", self.step / f64::from(parts));
        self.run(&[&[("time.step", step.as_str())], more].concat())
    }
}

impl Trajectory {
    /// Errors against a run with far smaller steps at the communication points: discrete L2 norm over the contact, relative to
    /// the largest of the slip rate up to there. The start, whose velocity is given, counts as exact.
    pub fn errors(&self, fine: &Trajectory) -> Vec<f64> {
        let contact = self.simulator.model().contact();
        let norm = |x: &mut dyn Iterator<Item = f64>| {
            let square = |(i, x): (usize, f64)| contact.weights[i / contact.components] * x * x;
            x.enumerate().map(square).sum::<f64>().sqrt()
        };
        let mut largest = norm(&mut self.rates[0].iter().copied()).max(f64::MIN_POSITIVE);
        let mut errors = vec![0.0];
        for (rates, exact) in self.rates.iter().zip(&fine.rates).skip(1) {
            largest = norm(&mut rates.iter().copied()).max(largest);
            errors.push(norm(&mut rates.iter().zip(exact).map(|(a, b)| a - b)) / largest);
        }
        errors
    }

    /// Estimates over errors, at the points where the error is at least a tenth of its largest: elsewhere it passes through
    /// zero.
    pub fn effectivities(&self, fine: &Trajectory) -> Vec<f64> {
        let errors = self.errors(fine);
        let floor = 0.1 * largest(&errors);
        let pairs = self.estimates.iter().zip(&errors);
        pairs
            .filter(|(_, error)| **error > floor)
            .map(|(estimate, error)| estimate / error)
            .collect()
    }
}

/// The paper's example on the load of the paper.
pub fn paper_course() -> Course {
    Course {
        scene: "kazmi2014",
        overrides: Vec::new(),
        step: 0.125,
        count: 8,
    }
}

/// The paper's example under a pressure that swings twice a second: the contact sticks and slips in turn, to and fro.
pub fn swinging_course() -> Course {
    let swing = |i: u32| {
        let phase = 2.0 * std::f64::consts::TAU * f64::from(i) / 16.0;
        [f64::from(i) / 16.0, -0.3 * (1.0 + 0.9 * phase.sin())]
    };
    let table: Vec<_> = (0..=16).map(swing).collect();
    Course {
        scene: "kazmi2014",
        overrides: vec![("run.signals.press", json!(table).to_string())],
        step: 0.0625,
        count: 16,
    }
}

/// The brake pad of the examples: 3D, two loads, friction in two directions.
pub fn pad_course() -> Course {
    Course {
        scene: "brake_pad_3d",
        overrides: Vec::new(),
        step: 0.125,
        count: 8,
    }
}

/// The seal of the examples: TR-BDF2, sticks, slips and sticks.
pub fn seal_course() -> Course {
    Course {
        scene: "seal",
        overrides: Vec::new(),
        step: 0.125,
        count: 16,
    }
}

/// One contact node under a drag that swings: a single kink at a time.
pub fn column_course() -> Course {
    let swing = |i: u32| {
        let t = f64::from(i) / 8.0;
        [t, 0.1 * (std::f64::consts::PI * t).sin()]
    };
    let table: Vec<_> = (0..=32).map(swing).collect();
    Course {
        scene: "sheared_column",
        overrides: vec![("run.signals.pull", json!(table).to_string())],
        step: 0.125,
        count: 32,
    }
}

/// Makes the checksum of framed bytes fit their content again.
pub fn reseal(bytes: &mut [u8]) {
    let end = bytes.len() - 8;
    let checksum = xxhash_rust::xxh3::xxh3_64(&bytes[..end]);
    bytes[end..].copy_from_slice(&checksum.to_le_bytes());
}
