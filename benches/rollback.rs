//! What a rollback costs at h = 1/32: save and restore must stay below a microsecond together.

use divan::Bencher;
use stickslip::{Scene, Simulator, compile};

fn main() {
    divan::main();
}

/// The paper's example after 40 steps, so that its history is full.
fn simulator() -> Simulator {
    let text = stickslip::scene::example("kazmi2014").unwrap_or_default();
    let mut simulator = Scene::from_json(text, "kazmi2014")
        .and_then(|scene| compile(&scene))
        .map(Simulator::new)
        .expect("an embedded scene compiles");
    simulator.init(0.0).expect("a start that converges");
    for _ in 0..40 {
        let time = simulator.time();
        simulator
            .do_step(time, 0.03125)
            .expect("a step that converges");
    }
    simulator
}

#[divan::bench(sample_count = 1000, sample_size = 100)]
fn save_and_restore(bencher: Bencher) {
    let mut simulator = simulator();
    let mut state = simulator.new_state();
    bencher.bench_local(|| {
        simulator.save(divan::black_box(&mut state)).is_ok()
            && simulator.restore(divan::black_box(&state)).is_ok()
    });
}

#[divan::bench]
fn serialize(bencher: Bencher) {
    let simulator = simulator();
    bencher.bench_local(|| simulator.to_bytes());
}

#[divan::bench]
fn directional_derivative(bencher: Bencher) {
    let mut simulator = simulator();
    let mut out = vec![0.0; simulator.output_len()];
    bencher.bench_local(|| simulator.directional_derivative(&[1.0], &mut out).is_ok());
}

#[divan::bench]
fn step_and_roll_back(bencher: Bencher) {
    let mut simulator = simulator();
    let mut state = simulator.new_state();
    let time = simulator.time();
    bencher.bench_local(|| {
        simulator.save(&mut state).is_ok()
            && simulator.do_step(time, 0.03125).is_ok()
            && simulator.restore(&state).is_ok()
    });
}
