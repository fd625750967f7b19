//! Steps of a run, each timed by itself; the shortest of many runs counts, for what else the machine does only lengthens it.
//! The floor of a reduced step is two passes over the model's own port matrix (states x contact), measured the same way: with
//! faer's product, and with the one that a step takes.

use super::{Outcome, clock, common};
use common::{value, values};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use stickslip::simulator::drive::Drive;
use stickslip::{Folder, Model, Scene, Simulator, linalg};

/// Time for the runs of one kind.
const PATIENCE: Duration = Duration::from_millis(1500);

/// A simulator that steps through the run of its scene, on the scene's signals.
struct Run<'a> {
    scene: &'a Scene,
    simulator: Simulator,
    start: stickslip::State,
}

/// One step of the run.
struct Timed {
    /// Shortest time, us.
    time: f64,
    iterations: f64,
    /// Newton matrices factored and inverted.
    factorizations: u64,
    /// No contact node changes between stick and slip.
    is_steady: bool,
    stick_fraction: f64,
    max_slip_rate: f64,
}

impl<'a> Run<'a> {
    /// With the bound of friction times `factor`.
    fn new(scene: &'a Scene, model: &Arc<Model>, factor: f64) -> Result<Run<'a>, stickslip::Error> {
        let mut simulator = Simulator::new(Arc::clone(model));
        for name in ["bound", "a", "b"].iter().filter(|_| factor != 1.0) {
            let name = format!("contact.friction.{name}");
            if let Ok(port) = model.ports().find(&name) {
                let found = value(&simulator, &name);
                simulator.set(port.reference, factor * found)?;
            }
        }
        Drive::start(scene, &mut simulator)?;
        let start = simulator.state().clone();
        Ok(Run {
            scene,
            simulator,
            start,
        })
    }

    /// Mean time of a step of the first run, us: the system of the step size is factorized in it.
    fn first(&mut self) -> Result<f64, stickslip::Error> {
        let mut drive = Drive::resume(self.scene, &mut self.simulator)?;
        let mut sum = 0.0;
        while let Some(time) = timed_step(&mut drive)? {
            sum += time;
        }
        Ok(sum / drive.points().count as f64)
    }

    /// The steps, one by one.
    fn steps(&mut self) -> Result<Vec<Timed>, stickslip::Error> {
        self.simulator.restore(&self.start)?;
        let mut before = values(&self.simulator, "contact.stick");
        let mut steps = Vec::new();
        let mut drive = Drive::resume(self.scene, &mut self.simulator)?;
        loop {
            let factored = drive.simulator().friction_work().factorizations;
            if timed_step(&mut drive)?.is_none() {
                break;
            }
            let simulator = drive.simulator();
            let now = values(simulator, "contact.stick");
            steps.push(Timed {
                time: f64::INFINITY,
                iterations: value(simulator, "solver.iterations"),
                factorizations: simulator.friction_work().factorizations - factored,
                stick_fraction: value(simulator, "contact.stick_fraction"),
                max_slip_rate: value(simulator, "contact.max_slip_rate"),
                is_steady: before == now,
            });
            before = now;
        }
        let begin = Instant::now();
        while begin.elapsed() < PATIENCE {
            self.simulator.restore(&self.start)?;
            let mut drive = Drive::resume(self.scene, &mut self.simulator)?;
            for step in &mut steps {
                if let Some(time) = timed_step(&mut drive)? {
                    step.time = step.time.min(time);
                }
            }
        }
        Ok(steps)
    }
}

/// Takes a step; its time, us, or `None` at the end of the run.
fn timed_step(drive: &mut Drive) -> Result<Option<f64>, stickslip::Error> {
    let begin = Instant::now();
    let is_taken = drive.step()?.is_some();
    Ok(is_taken.then(|| 1e6 * begin.elapsed().as_secs_f64()))
}

/// Two passes over a port matrix of the size of the model's, us: with faer's product, and with ours.
fn floors(model: &Model) -> [f64; 2] {
    let (m, r) = (model.contact().len(), model.states());
    let ports = Mat::from_fn(r, m, |i, j| ((i * 7 + j * 3) % 11) as f64);
    let (mut short, mut long) = (vec![1.0; m], vec![0.0; r]);
    let product = |a: MatRef<f64>, x: &[f64], y: &mut [f64]| {
        let (rows, columns) = (a.nrows(), a.ncols());
        let x = MatRef::from_column_major_slice(x, columns, 1);
        let y = MatMut::from_column_major_slice_mut(y, rows, 1);
        matmul(y, Accum::Replace, a, x, 1.0, Par::Seq);
    };
    let library = clock::shortest(PATIENCE / 5, 20, || {
        product(ports.as_ref(), &short, &mut long);
        product(ports.transpose(), &long, &mut short);
        short.fill(1.0);
    });
    let own = clock::shortest(PATIENCE / 5, 20, || {
        linalg::multiply(ports.as_ref(), &short, &mut long);
        linalg::multiply_transposed(ports.as_ref(), &long, &mut short);
        short.fill(1.0);
    });
    [library, own]
}

/// Mean time over the steps that `is_part`, us; none without such a step.
fn mean(steps: &[Timed], is_part: impl Fn(&Timed) -> bool) -> Value {
    let times: Vec<f64> = steps
        .iter()
        .filter(|s| is_part(s))
        .map(|s| s.time)
        .collect();
    match times.len() {
        0 => Value::Null,
        count => json!(times.iter().sum::<f64>() / count as f64),
    }
}

/// Steps of the run of a scene file.
pub fn course(file: &str) -> Outcome {
    let text = std::fs::read_to_string(file)?;
    let scene = Scene::from_json(&text, file)?;
    let model = stickslip::compile_from(&scene, &Folder::of(Path::new(file)))?;
    let mut run = Run::new(&scene, &model, 1.0)?;
    let steps = run.steps()?;
    let iterations: f64 = steps.iter().map(|s| s.iterations).sum();
    Ok(json!({
        "contact": model.contact().len(),
        "states": model.states(),
        "mean_us": mean(&steps, |_| true),
        "worst_us": steps.iter().fold(0.0_f64, |w, s| w.max(s.time)),
        "iterations": iterations / steps.len() as f64,
        "factorizations": steps.iter().map(|s| s.factorizations).sum::<u64>(),
    }))
}

pub fn measure(scene: &Scene) -> Outcome {
    // one internal step each, whatever the communication step of the scene is
    let scene = &{
        let mut scene = scene.clone();
        scene.run.step = None;
        scene
    };
    let model = stickslip::compile(scene)?;
    let mut run = Run::new(scene, &model, 1.0)?;
    let first = run.first()?;
    let fields = ["slip_rate", "slip", "tangential_stress"]
        .map(|f| (f, json!(values(&run.simulator, &format!("contact.{f}")))));
    let places: Vec<f64> = model.contact().points.iter().map(|p| p[0]).collect();
    let tip = run.simulator.get_by_name("tip.displacement").ok();
    let steps = run.steps()?;
    // a thousandth of the bound, and a thousand times it: all nodes slip, all stick
    let all_slip = Run::new(scene, &model, 1e-3)?.steps()?;
    let all_stick = Run::new(scene, &model, 1e3)?.steps()?;
    let [library_floor, own_floor] = floors(&model);
    let iterations: f64 = steps.iter().map(|s| s.iterations).sum();
    let mut out = json!({
        "contact": model.contact().len(),
        "states": model.states(),
        "free_dofs": model.summary().free_dofs,
        "floor_us": library_floor,
        "own_floor_us": own_floor,
        "first_us": first,
        "mean_us": mean(&steps, |_| true),
        "worst_us": steps.iter().fold(0.0_f64, |w, s| w.max(s.time)),
        "iterations": iterations / steps.len() as f64,
        "factorizations": steps.iter().map(|s| s.factorizations).sum::<u64>(),
        "factoring_us": mean(&steps, |s| s.factorizations > 0),
        "plain_us": mean(&steps, |s| s.factorizations == 0),
        "slip_factorizations": all_slip.iter().map(|s| s.factorizations).sum::<u64>(),
        "steady_us": mean(&steps, |s| s.is_steady),
        "changing_us": mean(&steps, |s| !s.is_steady),
        "slip_us": mean(&all_slip, |s| s.is_steady && s.stick_fraction == 0.0),
        "stick_us": mean(&all_stick, |s| s.is_steady && s.stick_fraction == 1.0),
        "largest_slip_rate": steps.iter().fold(0.0_f64, |w, s| w.max(s.max_slip_rate)),
        "x": places,
        "tip": tip,
    });
    for (name, field) in fields {
        out[name] = field;
    }
    Ok(out)
}
