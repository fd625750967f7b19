//! Set-up, step and floor of the three models on the paper's example (k = 1/32), one thread.
//!
//! The floor of a reduced step is two passes over its own port matrix. `cargo bench --bench step` prints all in one run.

use divan::Bencher;
use faer::Mat;
use std::sync::Arc;
use stickslip::{Model, Scene, Simulator, compile, linalg};

const CELLS: [u32; 3] = [32, 64, 128];

fn main() {
    divan::main();
}

fn scene(cells: u32, model: &str) -> Scene {
    let overrides = [
        ("mesh.cells", format!("[{cells}, {}]", cells / 2)),
        ("fidelity.model", model.into()),
    ];
    let overrides = overrides.map(|(path, value)| (path.to_string(), value));
    let text = stickslip::scene::example("kazmi2014").expect("an embedded scene");
    Scene::with_overrides(text, "kazmi2014", &overrides).expect("a valid scene")
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
    use super::{Bencher, CELLS, Simulator, model};

    fn bench(bencher: Bencher, cells: u32, kind: &str) {
        let mut simulator = Simulator::new(model(cells, kind));
        simulator.init(0.0).expect("a start that converges");
        let start = simulator.state().clone();
        bencher
            .counter(divan::counter::ItemsCount::new(32_u32))
            .bench_local(|| {
                simulator.restore(&start).expect("its own state");
                for n in 0..32 {
                    let time = f64::from(n) / 32.0;
                    simulator
                        .do_step(time, 1.0 / 32.0)
                        .expect("a step that converges");
                }
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

/// Two passes over a port matrix of the size of the reduced model's.
#[divan::bench(args = CELLS)]
fn floor_of_a_reduced_step(bencher: Bencher, cells: u32) {
    let model = model(cells, "reduced");
    let (m, r) = (model.contact().len(), model.states());
    let ports = Mat::from_fn(m, r, |i, j| ((i * 7 + j * 3) % 11) as f64);
    let (mut short, mut long) = (vec![0.0; m], vec![1.0; r]);
    bencher.bench_local(|| {
        linalg::multiply(ports.as_ref(), &long, &mut short);
        linalg::multiply_transposed(ports.as_ref(), &short, &mut long);
        long.fill(1.0);
    });
}

/// Save and restore of the state, and all outputs, at h = 1/32.
mod state {
    use super::{Bencher, Simulator, model};

    #[divan::bench]
    fn save_and_restore(bencher: Bencher) {
        let mut simulator = Simulator::new(model(32, "reduced"));
        simulator.init(0.0).expect("a start that converges");
        let mut saved = simulator.state().clone();
        bencher.bench_local(|| {
            simulator.save(&mut saved).expect("its own state");
            simulator.restore(&saved).expect("its own state");
        });
    }

    #[divan::bench]
    fn get_outputs(bencher: Bencher) {
        let mut simulator = Simulator::new(model(32, "reduced"));
        simulator.init(0.0).expect("a start that converges");
        let mut out = vec![0.0; simulator.output_len()];
        bencher.bench_local(|| simulator.get_outputs(&mut out));
    }
}
