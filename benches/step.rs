//! Set-up and steps of the three models on the paper's example (k = 1/32), one thread, in one run: `cargo bench --bench step`.
//!
//! The first tables hold the steps of the reduced model against their floor, two passes over the model's own port matrix
//! (contact dofs x states). Every step of the run is timed by itself, the shortest of many runs of it counts, and so does
//! the shortest of many floors: what else the machine does lengthens both. A step is steady when no contact node changes
//! between stick and slip in it.

use divan::Bencher;
use faer::Mat;
use std::sync::Arc;
use std::time::{Duration, Instant};
use stickslip::{Model, Scene, Simulator, compile, linalg};

const CELLS: [u32; 3] = [32, 64, 128];
/// Meshes of the reduced model: h = 1/32 ... 1/512.
const REDUCED_CELLS: [u32; 5] = [32, 64, 128, 256, 512];
/// Steps of the paper's run.
const STEPS: u32 = 32;
/// Time for the runs of one mesh.
const PATIENCE: Duration = Duration::from_millis(1500);
/// CPU time of a step of the fastest other program (scikit-fem, CHOLMOD, condensed Newton; zero start) at h = 1/32 and
/// 1/256 on a Xeon at 2.3 GHz, us.
const PEER: [(u32, f64); 2] = [(32, 530.0), (256, 32_800.0)];

fn main() {
    reduced_steps();
    divan::main();
}

fn scene(cells: u32, model: &str, start: &str) -> Scene {
    let overrides = [
        ("mesh.cells", format!("[{cells}, {}]", cells / 2)),
        ("fidelity.model", model.into()),
        ("time.start", start.into()),
    ];
    let overrides = overrides.map(|(path, value)| (path.to_string(), value));
    let text = stickslip::scene::example("kazmi2014").expect("an embedded scene");
    Scene::with_overrides(text, "kazmi2014", &overrides).expect("a valid scene")
}

fn model(cells: u32, kind: &str) -> Arc<Model> {
    compile(&scene(cells, kind, "consistent")).expect("a scene that compiles")
}

fn started(model: Arc<Model>) -> Simulator {
    let mut simulator = Simulator::new(model);
    simulator.init(0.0).expect("a start that converges");
    simulator
}

fn step(simulator: &mut Simulator, n: u32) {
    let time = f64::from(n) / f64::from(STEPS);
    simulator
        .do_step(time, 1.0 / f64::from(STEPS))
        .expect("a step that converges");
}

/// Shortest time of `f`, us, over many calls.
fn shortest(mut f: impl FnMut()) -> f64 {
    let begin = Instant::now();
    let mut shortest = f64::INFINITY;
    while begin.elapsed() < PATIENCE / 5 {
        let start = Instant::now();
        let count = 20;
        for _ in 0..count {
            f();
        }
        shortest = shortest.min(1e6 * start.elapsed().as_secs_f64() / f64::from(count));
    }
    shortest
}

/// Two passes over a port matrix of the size of the model's.
fn floor(model: &Model) -> f64 {
    let (m, r) = (model.contact().len(), model.states());
    let ports = Mat::from_fn(r, m, |i, j| ((i * 7 + j * 3) % 11) as f64);
    let (mut short, mut long) = (vec![1.0; m], vec![0.0; r]);
    shortest(|| {
        linalg::multiply(ports.as_ref(), &short, &mut long);
        linalg::multiply_transposed(ports.as_ref(), &long, &mut short);
        short.fill(1.0);
    })
}

/// One step of the run.
#[derive(Clone, Copy)]
struct Timed {
    /// Shortest time, us.
    time: f64,
    iterations: f64,
    is_steady: bool,
}

fn run(model: &Arc<Model>) -> Vec<Timed> {
    let mut simulator = started(Arc::clone(model));
    let start = simulator.state().clone();
    let stick = |s: &Simulator| s.get_by_name("contact.stick").expect("a port");
    let mut before = stick(&simulator);
    let mut steps: Vec<Timed> = (0..STEPS)
        .map(|n| {
            step(&mut simulator, n);
            let now = stick(&simulator);
            Timed {
                time: f64::INFINITY,
                iterations: simulator.get_by_name("solver.iterations").expect("a port")[0],
                is_steady: std::mem::replace(&mut before, now.clone()) == now,
            }
        })
        .collect();
    let begin = Instant::now();
    while begin.elapsed() < PATIENCE {
        simulator.restore(&start).expect("its own state");
        for (n, timed) in (0..).zip(&mut steps) {
            let start = Instant::now();
            step(&mut simulator, n);
            timed.time = timed.time.min(1e6 * start.elapsed().as_secs_f64());
        }
    }
    steps
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(s, c), v| (s + v, c + 1.0));
    sum / count
}

fn reduced_steps() {
    for start in ["consistent", "zero"] {
        println!("\nsteps of the reduced model, {start} start; times in us, ratios to the floor");
        println!(
            "{:>5} {:>4} {:>5} {:>7} | {:>7} {:>7} {:>7} {:>7} | {:>6} {:>6} {:>6} {:>6} | {:>5} {:>9}",
            "1/h",
            "m",
            "r",
            "floor",
            "mean",
            "worst",
            "steady",
            "unrest",
            "mean",
            "worst",
            "steady",
            "unrest",
            "its",
            "growth"
        );
        let mut last: Option<(f64, f64)> = None;
        for cells in REDUCED_CELLS {
            let model = compile(&scene(cells, "reduced", start)).expect("a scene that compiles");
            let (m, r) = (model.contact().len(), model.states());
            let floor = floor(&model);
            let steps = run(&model);
            let average = mean(steps.iter().map(|s| s.time));
            let worst = steps.iter().fold(0.0_f64, |w, s| w.max(s.time));
            let part = |steady| {
                mean(
                    steps
                        .iter()
                        .filter(|s| s.is_steady == steady)
                        .map(|s| s.time),
                )
            };
            let (steady, unrest) = (part(true), part(false));
            let iterations = mean(steps.iter().map(|s| s.iterations));
            let exponent = last.map_or(String::new(), |(size, time)| {
                format!("m^{:.2}", (average / time).ln() / (m as f64 / size).ln())
            });
            println!(
                "{cells:>5} {m:>4} {r:>5} {floor:>7.2} | {average:>7.2} {worst:>7.2} {steady:>7.2} {unrest:>7.2} | {:>6.2} {:>6.2} {:>6.2} {:>6.2} | {iterations:>5.2} {exponent:>9}",
                average / floor,
                worst / floor,
                steady / floor,
                unrest / floor
            );
            if let Some((_, peer)) = PEER.iter().find(|(n, _)| *n == cells)
                && start == "zero"
            {
                println!(
                    "      {:.0} times faster than the peer's {peer} us",
                    peer / average
                );
            }
            if std::env::var_os("STEPS").is_some() {
                for (n, s) in steps.iter().enumerate() {
                    println!(
                        "{n:>4} {:>8.2} us {:>6.2} floors {:>3} iterations{}",
                        s.time,
                        s.time / floor,
                        s.iterations,
                        if s.is_steady { "" } else { ", changes" }
                    );
                }
            }
            last = Some((m as f64, average));
        }
    }
    println!();
}

mod setup {
    use super::{Bencher, CELLS, compile, scene};

    fn bench(bencher: Bencher, cells: u32, kind: &str) {
        let scene = scene(cells, kind, "consistent");
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
    use super::{Bencher, CELLS, STEPS, model, started, step};

    fn bench(bencher: Bencher, cells: u32, kind: &str) {
        let mut simulator = started(model(cells, kind));
        let start = simulator.state().clone();
        bencher
            .counter(divan::counter::ItemsCount::new(STEPS))
            .bench_local(|| {
                simulator.restore(&start).expect("its own state");
                (0..STEPS).for_each(|n| step(&mut simulator, n));
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
