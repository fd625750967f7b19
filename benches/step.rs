//! Set-up and steps of the three models on the paper's example (k = 1/32), one thread, in one run: `cargo bench --bench step`.
//! The goals bench holds the steps of the reduced model against their floor.

#[path = "../tests/common/mod.rs"]
mod common;

use common::{paper, started, steps};
use divan::Bencher;
use std::sync::Arc;
use stickslip::{Model, Scene, compile};

const CELLS: [u32; 3] = [32, 64, 128];
/// Steps of the paper's run.
const STEPS: u32 = 32;

fn main() {
    divan::main();
}

fn scene(cells: u32, kind: &str) -> Scene {
    paper(cells, &[("fidelity.model", kind)])
}

fn model(cells: u32, kind: &str) -> Arc<Model> {
    compile(&scene(cells, kind)).expect("a scene that compiles")
}

mod setup {
    use super::{Bencher, CELLS, compile, scene};

    fn bench(bencher: Bencher, cells: u32, kind: &str) {
        let scene = scene(cells, kind);
        bencher.bench_local(|| compile(&scene));
    }

    #[divan::bench(args = CELLS, sample_count = 5)]
    fn full(bencher: Bencher, cells: u32) {
        bench(bencher, cells, "full");
    }

    #[divan::bench(args = CELLS, sample_count = 5)]
    fn condensed(bencher: Bencher, cells: u32) {
        bench(bencher, cells, "condensed");
    }

    #[divan::bench(args = CELLS, sample_count = 5)]
    fn reduced(bencher: Bencher, cells: u32) {
        bench(bencher, cells, "reduced");
    }
}

/// Mean over the 32 steps of the paper's run: one sample is the whole run.
mod run_of_32_steps {
    use super::{Bencher, CELLS, STEPS, model, started, steps};

    fn bench(bencher: Bencher, cells: u32, kind: &str) {
        let mut simulator = started(model(cells, kind));
        let start = simulator.state().clone();
        bencher
            .counter(divan::counter::ItemsCount::new(STEPS))
            .bench_local(|| {
                simulator.restore(&start).expect("its own state");
                steps(&mut simulator, 1.0 / f64::from(STEPS), STEPS as usize);
            });
    }

    #[divan::bench(args = CELLS, sample_count = 10)]
    fn full(bencher: Bencher, cells: u32) {
        bench(bencher, cells, "full");
    }

    #[divan::bench(args = CELLS, sample_count = 10)]
    fn condensed(bencher: Bencher, cells: u32) {
        bench(bencher, cells, "condensed");
    }

    #[divan::bench(args = CELLS, sample_count = 20)]
    fn reduced(bencher: Bencher, cells: u32) {
        bench(bencher, cells, "reduced");
    }
}

/// The same for a pad on a belt (k = 1/32, 32 contact nodes): a bound in Pa, Coulomb's law in bilateral contact, and contact that
/// can open. The ratios to the first are the price of pressure.
mod belt {
    use super::{Bencher, common, compile, started};
    use serde_json::json;
    use stickslip::Simulator;

    fn simulator(condition: &str, friction: serde_json::Value) -> Simulator {
        let scene = json!({"schema_version": 1, "name": "belt",
            "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [32, 16]},
            "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                         "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "kazmi2014"}},
            "clamped": ["left"],
            "contact": {"part": "bottom", "condition": {"kind": condition}, "friction": friction,
                        "foundation": [{"kind": "sliding", "name": "belt", "direction": [1, 0]}]},
            "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": [0, 1], "start": -0.3}],
            "time": {"scheme": "backward_euler", "step": 0.03125}});
        started(compile(&common::scene(&scene)).expect("a scene that compiles"))
    }

    fn bench(bencher: Bencher, condition: &str, friction: serde_json::Value) {
        let mut simulator = simulator(condition, friction);
        let start = simulator.state().clone();
        bencher
            .counter(divan::counter::ItemsCount::new(128_u32))
            .bench_local(|| {
                simulator.restore(&start).expect("its own state");
                for i in 0..128 {
                    let t = f64::from(i) / 32.0;
                    let belt = 0.1 * (2.0 * (t + 1.0 / 32.0)).sin();
                    simulator.set_inputs(&[-0.3, belt]).expect("inputs");
                    simulator.do_step(t, 1.0 / 32.0).expect("a step");
                }
            });
    }

    #[divan::bench(sample_count = 50)]
    fn bound(bencher: Bencher) {
        bench(
            bencher,
            "bilateral",
            json!({"law": "exponential", "a": 0.1, "b": 0.08, "alpha": 1.0}),
        );
    }

    #[divan::bench(sample_count = 50)]
    fn coulomb(bencher: Bencher) {
        bench(
            bencher,
            "bilateral",
            json!({"law": "coulomb", "coefficient": 0.3}),
        );
    }

    #[divan::bench(sample_count = 50)]
    fn unilateral(bencher: Bencher) {
        bench(
            bencher,
            "unilateral",
            json!({"law": "coulomb", "coefficient": 0.3}),
        );
    }
}

/// A new step size: the first step of each size pays for its factorization.
#[divan::bench(args = CELLS)]
fn new_step_size(bencher: Bencher, cells: u32) {
    let mut simulator = started(model(cells, "reduced"));
    let start = simulator.state().clone();
    let mut size = 1e-3;
    bencher.bench_local(|| {
        simulator.restore(&start).expect("its own state");
        size *= 1.000_001;
        simulator.do_step(0.0, size).expect("a step that converges");
    });
}

/// Save and restore of the state, and all outputs, at h = 1/32.
mod state {
    use super::{Bencher, model, started};

    #[divan::bench]
    fn save_and_restore(bencher: Bencher) {
        let mut simulator = started(model(32, "reduced"));
        let mut saved = simulator.state().clone();
        bencher.bench_local(|| {
            simulator.save(&mut saved).expect("its own state");
            simulator.restore(&saved).expect("its own state");
        });
    }

    #[divan::bench]
    fn get_outputs(bencher: Bencher) {
        let simulator = started(model(32, "reduced"));
        let mut out = vec![0.0; simulator.output_len()];
        bencher.bench_local(|| simulator.get_outputs(&mut out));
    }
}
