//! Steps of a run, each timed by itself; the shortest of many runs counts, for what else the machine does only lengthens it.
//! The floor of a reduced step is two passes over the model's own port matrix (states x contact), measured the same way.

use super::{Outcome, clock, common};
use common::{value, values};
use faer::Mat;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::{Duration, Instant};
use stickslip::{Model, Scene, Simulator, linalg};

/// Time for the runs of one kind.
const PATIENCE: Duration = Duration::from_millis(1500);

/// A simulator that steps through the run of its scene.
struct Run {
    simulator: Simulator,
    start: stickslip::State,
    size: f64,
    count: usize,
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

impl Run {
    /// With the bound of friction times `factor`.
    fn new(model: &Arc<Model>, factor: f64) -> Result<Run, stickslip::Error> {
        let size = model.scene().time.step;
        let count = (model.scene().run.until / size).round() as usize;
        let mut simulator = Simulator::new(Arc::clone(model));
        // the second coefficient is not to exceed the first
        let mut coefficients = ["contact.friction.a", "contact.friction.b"];
        if factor < 1.0 {
            coefficients.reverse();
        }
        for name in coefficients.iter().filter(|_| factor != 1.0) {
            let found = value(&simulator, name);
            let reference = model.ports().find(name)?.reference;
            simulator.set(reference, factor * found)?;
        }
        simulator.init(0.0)?;
        let start = simulator.state().clone();
        Ok(Run {
            simulator,
            start,
            size,
            count,
        })
    }

    /// Mean time of a step of the first run, us: the system of the step size is factorized in it.
    fn first(&mut self) -> f64 {
        let begin = Instant::now();
        common::steps(&mut self.simulator, self.size, self.count);
        1e6 * begin.elapsed().as_secs_f64() / self.count as f64
    }

    /// The steps, one by one.
    fn steps(&mut self) -> Result<Vec<Timed>, stickslip::Error> {
        self.simulator.restore(&self.start)?;
        let mut before = values(&self.simulator, "contact.stick");
        let mut steps = Vec::new();
        for _ in 0..self.count {
            let factored = self.simulator.friction_work().factorizations;
            common::steps(&mut self.simulator, self.size, 1);
            let now = values(&self.simulator, "contact.stick");
            steps.push(Timed {
                time: f64::INFINITY,
                iterations: value(&self.simulator, "solver.iterations"),
                factorizations: self.simulator.friction_work().factorizations - factored,
                stick_fraction: value(&self.simulator, "contact.stick_fraction"),
                max_slip_rate: value(&self.simulator, "contact.max_slip_rate"),
                is_steady: before == now,
            });
            before = now;
        }
        let begin = Instant::now();
        while begin.elapsed() < PATIENCE {
            self.simulator.restore(&self.start)?;
            for step in &mut steps {
                let start = Instant::now();
                common::steps(&mut self.simulator, self.size, 1);
                step.time = step.time.min(1e6 * start.elapsed().as_secs_f64());
            }
        }
        Ok(steps)
    }
}

/// Two passes over a port matrix of the size of the model's, us.
fn floor(model: &Model) -> f64 {
    let (m, r) = (model.contact().len(), model.states());
    let ports = Mat::from_fn(r, m, |i, j| ((i * 7 + j * 3) % 11) as f64);
    let (mut short, mut long) = (vec![1.0; m], vec![0.0; r]);
    clock::shortest(PATIENCE / 5, 20, || {
        linalg::multiply(ports.as_ref(), &short, &mut long);
        linalg::multiply_transposed(ports.as_ref(), &long, &mut short);
        short.fill(1.0);
    })
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

pub fn measure(scene: &Scene) -> Outcome {
    let model = stickslip::compile(scene)?;
    let mut run = Run::new(&model, 1.0)?;
    let first = run.first();
    let fields = ["slip_rate", "slip", "tangential_stress"]
        .map(|f| (f, json!(values(&run.simulator, &format!("contact.{f}")))));
    let places: Vec<f64> = model.contact().points.iter().map(|p| p[0]).collect();
    let tip = run.simulator.get_by_name("tip.displacement").ok();
    let steps = run.steps()?;
    // a thousandth of the bound, and a thousand times it: all nodes slip, all stick
    let all_slip = Run::new(&model, 1e-3)?.steps()?;
    let all_stick = Run::new(&model, 1e3)?.steps()?;
    let iterations: f64 = steps.iter().map(|s| s.iterations).sum();
    let mut out = json!({
        "contact": model.contact().len(),
        "states": model.states(),
        "free_dofs": model.summary().free_dofs,
        "floor_us": floor(&model),
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
