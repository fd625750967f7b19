//! Runs a case and keeps what it answered.

use super::case::{Case, Held, Path};
use std::panic::{AssertUnwindSafe, catch_unwind};
use stickslip::ports::Causality;
use stickslip::{Error, ErrorCode, Scene, Simulator, compile};

/// One contact at a communication point.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    pub rates: Vec<f64>,
    pub stress: Vec<f64>,
    pub pressure: Vec<f64>,
    /// None where contact cannot open.
    pub gap: Option<Vec<f64>>,
    pub slip: Vec<f64>,
    pub accumulated: Vec<f64>,
    pub state: Option<Vec<f64>>,
    pub normal_force: f64,
    pub force: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    pub contacts: Vec<Seen>,
    /// External work, elastic, viscous, friction, balance error.
    pub energies: [f64; 5],
    /// Forces of the driven directions.
    pub reactions: Vec<f64>,
}

#[derive(Debug, Clone)]
pub struct Refusal {
    pub code: ErrorCode,
    pub text: String,
    pub phase: &'static str,
}

#[derive(Debug, Clone, Default)]
pub struct Run {
    pub points: Vec<Point>,
    pub refusal: Option<Refusal>,
    /// Faults that need no oracle.
    pub faults: Vec<String>,
    pub components: usize,
    pub kind: String,
    /// A step said that it lost digits.
    pub has_lost_digits: bool,
    /// Largest residual at which a step stopped because rounding allows no less.
    pub floor: f64,
}

pub fn run(case: &Case) -> Run {
    catch_unwind(AssertUnwindSafe(|| attempt(case))).unwrap_or_else(|_| Run {
        faults: vec!["panic".into()],
        ..Run::default()
    })
}

fn refused(phase: &'static str, error: &Error) -> Option<Refusal> {
    Some(Refusal {
        code: error.code(),
        text: error.to_string(),
        phase,
    })
}

fn attempt(case: &Case) -> Run {
    let mut run = Run::default();
    let model =
        match Scene::from_json(&case.json().to_string(), "extreme").and_then(|s| compile(&s)) {
            Ok(model) => model,
            Err(error) => {
                run.refusal = refused("compile", &error);
                return run;
            }
        };
    run.components = model.contact().components;
    run.kind = format!("{:?}", model.summary().kind).to_lowercase();
    let courses = case.inputs();
    let ports = model
        .ports()
        .all()
        .iter()
        .filter(|p| p.causality == Causality::Input);
    let order: Vec<&[f64]> = ports
        .map(|p| {
            courses
                .iter()
                .find(|(name, _)| *name == p.name)
                .expect("an input of the case")
                .1
        })
        .collect();
    let inputs = |n: usize| order.iter().map(|course| course[n]).collect::<Vec<f64>>();
    let mut simulator = Simulator::new(model.clone());
    if let Err(error) = simulator
        .set_inputs(&inputs(0))
        .and_then(|()| simulator.init(0.0))
    {
        run.refusal = refused("init", &error);
        return run;
    }
    run.see(case, &simulator);
    for n in 0..case.count() {
        let result = simulator.set_inputs(&inputs(n + 1)).and_then(|()| {
            let before = simulator.to_bytes();
            let (time, size) = (simulator.time(), case.step * f64::from(case.cuts));
            let result = simulator.do_step(time, size);
            if result.is_err() && simulator.to_bytes() != before {
                run.faults.push("a refused step changed the state".into());
            }
            result
        });
        if let Err(error) = result {
            run.refusal = refused("step", &error);
            break;
        }
        run.has_lost_digits |= simulator.lost_digits().is_some();
        run.floor = run
            .floor
            .max(simulator.residual_at_rounding().unwrap_or(0.0));
        run.see(case, &simulator);
    }
    run
}

impl Run {
    fn see(&mut self, case: &Case, simulator: &Simulator) {
        let get = |name: &str| simulator.get_by_name(name).expect("a known port");
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
        let contacts = (0..case.contacts.len()).map(|i| {
            let prefix = case.prefix(i);
            let of = |name: &str| get(&format!("{prefix}.{name}"));
            Seen {
                rates: of("slip_rate"),
                stress: of("tangential_stress"),
                pressure: of("pressure"),
                gap: simulator.get_by_name(&format!("{prefix}.gap")).ok(),
                slip: of("slip"),
                accumulated: of("accumulated_slip"),
                state: simulator
                    .get_by_name(&format!("{prefix}.friction_state"))
                    .ok(),
                normal_force: of("normal_force")[0],
                force: of("force"),
            }
        });
        let energy = |name: &str| get(&format!("energy.{name}"))[0];
        let names = [
            "external_work",
            "elastic",
            "viscous_dissipation",
            "friction_dissipation",
            "balance_error",
        ];
        let reactions = match &case.held {
            Held::Driven { motions, .. } => {
                let force = |(i, motion): (usize, &super::case::Motion)| {
                    let kind = if matches!(motion.path, Path::Rotation(_)) {
                        "torque"
                    } else {
                        "force"
                    };
                    get(&format!("drive{i}.{kind}"))[0]
                };
                motions.iter().enumerate().map(force).collect()
            }
            Held::Clamped(_) => Vec::new(),
        };
        self.points.push(Point {
            contacts: contacts.collect(),
            energies: names.map(energy),
            reactions,
        });
    }

    /// Largest values over the points.
    pub fn scales(&self) -> Scales {
        let mut scales = Scales::default();
        for seen in self.points.iter().flat_map(|p| &p.contacts) {
            let largest =
                |values: &[f64], so_far: f64| values.iter().fold(so_far, |m, v| m.max(v.abs()));
            scales.rate = largest(&seen.rates, scales.rate);
            scales.stress = largest(&seen.stress, largest(&seen.pressure, scales.stress));
            scales.displacement = largest(
                seen.gap.as_deref().unwrap_or(&[]),
                largest(&seen.slip, scales.displacement),
            );
        }
        scales
    }
}

/// Largest slip rate, stress (pressures among them), and displacement (gaps and slips).
#[derive(Debug, Clone, Copy, Default)]
pub struct Scales {
    pub rate: f64,
    pub stress: f64,
    pub displacement: f64,
}
