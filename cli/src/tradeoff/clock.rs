//! Clocks: what a setting costs, and the budget that remains.

use super::estimate::{Estimate, Speed};
use super::point::{Group, Point};
use std::cell::Cell;
use std::collections::HashMap;
use std::sync::Arc;
use std::time::{Duration, Instant};
use stickslip::simulator::drive::Drive;
use stickslip::tradeoff::{Candidate, Reference, Setting, Study};
use stickslip::{Compilation, Result, Simulator};

/// Compilations and runs are repeated while they take no more than this together, and the fastest counts.
const LONGEST_REPETITION: Duration = Duration::from_millis(150);
/// Most repetitions.
const REPETITIONS: usize = 5;

/// What may be spent: time, or work by estimate, which is the same on every machine.
pub struct Budget {
    start: Instant,
    limit: Limit,
}

enum Limit {
    Seconds(f64),
    /// Multiplications, and how many are spent.
    Work(f64, Cell<f64>),
}

impl Budget {
    pub fn of_seconds(seconds: f64) -> Budget {
        Budget {
            start: Instant::now(),
            limit: Limit::Seconds(seconds),
        }
    }

    pub fn of_work(multiplications: f64) -> Budget {
        Budget {
            start: Instant::now(),
            limit: Limit::Work(multiplications, Cell::new(0.0)),
        }
    }

    /// What there was to spend, in words.
    pub fn words(&self) -> String {
        match &self.limit {
            Limit::Seconds(seconds) => format!("{seconds} s"),
            Limit::Work(work, _) => format!("{work:e} multiplications"),
        }
    }

    pub fn seconds_spent(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Whether something estimated fits into a share of the budget.
    pub fn fits(&self, estimate: &Estimate, speed: &Speed, share: f64) -> bool {
        match &self.limit {
            Limit::Seconds(seconds) => {
                self.seconds_spent() + speed.seconds(estimate) <= share * seconds
            }
            Limit::Work(work, spent) => spent.get() + estimate.multiplications() <= share * work,
        }
    }

    /// Whether something else of a batch that has been begun, and takes `seconds`, has its time.
    pub fn has_time(&self, seconds: f64) -> bool {
        match &self.limit {
            Limit::Seconds(limit) => self.seconds_spent() + seconds <= *limit,
            Limit::Work(..) => true,
        }
    }

    /// Something estimated has been done.
    pub fn spend(&self, estimate: &Estimate) {
        if let Limit::Work(_, spent) = &self.limit {
            spent.set(spent.get() + estimate.multiplications());
        }
    }
}

/// Measures settings; the set-up of a body is measured once.
#[derive(Default)]
pub struct Clock {
    setups: HashMap<String, Duration>,
}

impl Clock {
    /// Compiles a setting, and times that where its body is new.
    pub fn compile(&mut self, study: &mut Study, setting: &Setting) -> Result<Candidate> {
        let body = study.body_of(setting)?;
        if self.setups.contains_key(&body) {
            return study.compile(setting);
        }
        let start = Instant::now();
        let candidate = study.compile(setting)?;
        let first = start.elapsed();
        let setup = fastest(first, || {
            let start = Instant::now();
            Compilation::new(&candidate.scene)?;
            Ok(start.elapsed())
        })?;
        self.setups.insert(body, setup);
        Ok(candidate)
    }

    /// Compiles, runs and times a setting.
    pub fn measure(
        &mut self,
        study: &mut Study,
        reference: &Reference,
        group: Group,
        setting: &Setting,
    ) -> Result<Point> {
        let candidate = self.compile(study, setting)?;
        let setup = self.setups.get(&study.body_of(setting)?).copied();
        let sample = candidate.run()?;
        let stepping = fastest(step_through(&candidate)?, || step_through(&candidate))?;
        let model = &candidate.model;
        Ok(Point {
            group,
            setting: setting.clone().needed(study.scene()),
            verdict: reference.judge(&sample)?,
            sample,
            setup: setup.unwrap_or_default(),
            stepping,
            states: model.states(),
            contact_nodes: model.contact().node_count(),
            model_bytes: model.summary().bytes,
            state_bytes: Simulator::new(Arc::clone(model)).state().byte_len(),
        })
    }
}

/// Time of the steps of a run.
fn step_through(candidate: &Candidate) -> Result<Duration> {
    let scene = &candidate.scene;
    let mut simulator = Simulator::new(Arc::clone(&candidate.model));
    let mut drive = Drive::start(scene, &mut simulator)?;
    let start = Instant::now();
    while drive.step()?.is_some() {}
    Ok(start.elapsed())
}

/// The least of a first measurement and a few more.
fn fastest(first: Duration, mut measure: impl FnMut() -> Result<Duration>) -> Result<Duration> {
    let (mut least, mut total) = (first, first);
    for _ in 1..REPETITIONS {
        if total + least > LONGEST_REPETITION {
            break;
        }
        let next = measure()?;
        total += next;
        least = least.min(next);
    }
    Ok(least)
}
