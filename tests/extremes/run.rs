//! Runs a case and keeps what it answered.

use crate::case::Case;
use std::panic::{AssertUnwindSafe, catch_unwind};
use stickslip::{Error, ErrorCode, Scene, Simulator, compile};

/// What is seen at a communication point.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    pub time: f64,
    pub rates: Vec<f64>,
    pub stress: Vec<f64>,
    pub slip: Vec<f64>,
    /// External work, elastic, viscous, friction, balance error.
    pub energies: [f64; 5],
    pub residual: f64,
    pub iterations: f64,
}

/// Where and why a case was refused.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    pub code: ErrorCode,
    pub text: String,
    /// `compile`, `init` or `step`.
    pub phase: &'static str,
}

#[derive(Debug, Clone, Default)]
pub struct Run {
    pub points: Vec<Point>,
    pub refusal: Option<Refusal>,
    /// Faults that need no oracle: a panic, a number that is not finite, a state changed by a refused call.
    pub faults: Vec<String>,
    /// Coordinates of the contact nodes.
    pub positions: Vec<[f64; 3]>,
    pub components: usize,
    pub kind: String,
    /// Whether a step said that it lost digits.
    pub has_lost_digits: bool,
}

/// Runs a case to its end or to its first refusal.
pub fn run(case: &Case) -> Run {
    match catch_unwind(AssertUnwindSafe(|| attempt(case))) {
        Ok(run) => run,
        Err(_) => Run {
            faults: vec!["panic".into()],
            ..Run::default()
        },
    }
}

fn attempt(case: &Case) -> Run {
    let mut run = Run::default();
    let refused = |phase, error: Error| {
        Some(Refusal {
            code: error.code(),
            text: error.to_string(),
            phase,
        })
    };
    let compiled = Scene::from_json(&case.json().to_string(), "extreme").and_then(|s| compile(&s));
    let model = match compiled {
        Ok(model) => model,
        Err(error) => {
            run.refusal = refused("compile", error);
            return run;
        }
    };
    run.positions.clone_from(&model.contact().points);
    run.components = model.contact().components;
    run.kind = format!("{:?}", model.summary().kind).to_lowercase();
    let mut simulator = Simulator::new(model);
    if let Err(error) = simulator.init(0.0) {
        run.refusal = refused("init", error);
        return run;
    }
    run.see(&simulator);
    for n in 0..case.count() {
        let inputs: Vec<f64> = case.loads.iter().map(|load| load.course[n + 1]).collect();
        let result = simulator.set_inputs(&inputs).and_then(|()| {
            let before = simulator.to_bytes();
            let (time, size) = (simulator.time(), case.step * f64::from(case.cuts));
            let result = simulator.do_step(time, size);
            if result.is_err() && simulator.to_bytes() != before {
                run.faults.push("a refused step changed the state".into());
            }
            result
        });
        if let Err(error) = result {
            run.refusal = refused("step", error);
            break;
        }
        run.has_lost_digits |= simulator.lost_digits().is_some();
        run.see(&simulator);
    }
    run
}

impl Run {
    fn see(&mut self, simulator: &Simulator) {
        let get = |name: &str| simulator.get_by_name(name).expect("a known port");
        let energy = |name: &str| get(&format!("energy.{name}"))[0];
        let mut all = vec![0.0; simulator.output_len()];
        simulator
            .get_outputs(&mut all)
            .expect("the length asked for");
        if all.iter().any(|v| !v.is_finite()) {
            self.faults.push(format!(
                "an output is not finite at point {}",
                self.points.len()
            ));
        }
        self.points.push(Point {
            time: simulator.time(),
            rates: get("contact.slip_rate"),
            stress: get("contact.tangential_stress"),
            slip: get("contact.slip"),
            energies: [
                energy("external_work"),
                energy("elastic"),
                energy("viscous_dissipation"),
                energy("friction_dissipation"),
                energy("balance_error"),
            ],
            residual: get("solver.residual")[0],
            iterations: get("solver.iterations")[0],
        });
    }

    /// Largest slip rate over all points, and largest stress.
    pub fn scales(&self) -> (f64, f64) {
        let over = |values: fn(&Point) -> &Vec<f64>| {
            let all = self.points.iter().flat_map(values);
            all.fold(0f64, |m, v| m.max(v.abs()))
        };
        (over(|p| &p.rates), over(|p| &p.stress))
    }
}
