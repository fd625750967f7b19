//! The measurements that fit the budget: the reference first, then the settings, cheapest first.

use super::clock::{Budget, Clock};
use super::estimate::{Estimate, Speed};
use super::plan::{Batch, JOINT_REDUCTION, batches};
use super::point::{Group, Point};
use crate::console;
use std::time::Instant;
use stickslip::tradeoff::{
    Candidate, Quantity, Reference, Refinement, Setting, Study, Verdict, loosest_reduction,
};
use stickslip::{Error, Result};

/// What was measured and what was not.
pub struct Survey {
    pub points: Vec<Point>,
    /// Settings that cannot be had, and why.
    pub refused: Vec<(Setting, String)>,
    /// Batches that did not fit the budget.
    pub skipped: Vec<Batch>,
    /// Batches that may not fit the memory.
    pub too_large: Vec<Batch>,
}

/// A reference that is refined while it fits a share of the budget.
pub struct Refined {
    pub reference: Reference,
    speed: Speed,
}

impl Refined {
    /// Two levels in space and in time.
    pub fn new(study: &mut Study) -> Result<Refined> {
        let scene = study.scene();
        let mut estimate: Option<Estimate> = None;
        for setting in Reference::first_settings(scene) {
            let next = Estimate::of(&setting.apply(scene)?, 1.0);
            estimate = Some(estimate.map_or(next, |sum| sum.and(&next)));
        }
        let bytes = estimate.filter(|e| !e.has_room()).map(|e| e.bytes);
        if let Some(bytes) = bytes {
            return Err(Error::Scene {
                source_name: scene.name.clone(),
                path: "mesh.cells".to_owned(),
                found: format!("{:?}", scene.mesh.grid().map(|grid| grid.cells)),
                allowed: format!(
                    "fewer: a reference on this mesh would take about {}",
                    gigabytes(bytes)
                ),
            });
        }
        let mut speed = Speed::unknown();
        let start = Instant::now();
        let reference = Reference::new(study)?;
        if let Some(estimate) = estimate {
            speed.learn(&estimate, start.elapsed().as_secs_f64());
        }
        Ok(Refined { reference, speed })
    }

    /// Refines as far as a share of the budget goes; whether it went any further.
    pub fn refine(&mut self, study: &mut Study, budget: &Budget, share: f64) -> Result<bool> {
        let spinner = console::spinner(&format!("{}: reference", study.scene().name));
        let mut has_gone_further = false;
        loop {
            let scene = study.scene();
            let next = self.reference.next_setting(scene).apply(scene)?;
            let mut estimate = Estimate::of(&next, 1.0);
            if self.reference.next() == Refinement::Time {
                estimate.setup = 0.0;
            }
            let is_affordable = budget.fits(&estimate, &self.speed, share);
            if !is_affordable || !estimate.has_room() {
                spinner.finish_and_clear();
                return Ok(has_gone_further);
            }
            let start = Instant::now();
            self.reference.refine(study)?;
            self.speed.learn(&estimate, start.elapsed().as_secs_f64());
            budget.spend(&estimate);
            has_gone_further = true;
        }
    }
}

/// Measures batch after batch until the next one does not fit; the scene as given in any case.
pub fn settings(study: &mut Study, reference: &Reference, budget: &Budget) -> Result<Survey> {
    let mut planned = batches(study);
    let bar = console::bar(planned.len() as u64, &study.scene().name);
    let mut bench = Bench {
        study,
        reference,
        budget,
        clock: Clock::default(),
    };
    let mut survey = Survey {
        points: Vec::new(),
        refused: Vec::new(),
        skipped: Vec::new(),
        too_large: Vec::new(),
    };
    // the body of the scene as it is, which many settings share
    let _given = match planned.first() {
        Some(batch) if batch.estimate.has_room() => Some(bench.compile(&Setting::unchanged())?),
        _ => None,
    };
    let mut speed = Speed::unknown();
    while !planned.is_empty() {
        let estimate = planned[0].estimate;
        let is_affordable = budget.fits(&estimate, &speed, 1.0);
        if estimate.has_room() && !is_affordable && !survey.points.is_empty() {
            let (small, large) = planned.into_iter().partition(|b| b.estimate.has_room());
            survey.skipped = small;
            survey.too_large.extend::<Vec<Batch>>(large);
            break;
        }
        let batch = planned.remove(0);
        bar.inc(1);
        if !estimate.has_room() {
            survey.too_large.push(batch);
            continue;
        }
        let start = Instant::now();
        survey.measure(&mut bench, &batch)?;
        speed.learn(&estimate, start.elapsed().as_secs_f64());
        budget.spend(&estimate);
    }
    bar.finish_and_clear();
    survey.points.sort_by_key(|p| p.group as usize);
    Ok(survey)
}

impl Survey {
    /// Judges all points again, after the reference was refined.
    pub fn judge(&mut self, reference: &Reference) -> Result<()> {
        for point in &mut self.points {
            point.verdict = reference.judge(&point.sample)?;
        }
        Ok(())
    }

    fn measure(&mut self, bench: &mut Bench, batch: &Batch) -> Result<()> {
        let outcome = match batch.ladders.is_empty() {
            true => bench
                .measure(batch.group, &batch.setting)
                .map(|point| self.points.push(point)),
            false => self.climb(bench, batch),
        };
        match outcome {
            // without the scene as it is there is nothing to vary
            Err(error) if batch.group == Group::AsGiven => Err(error),
            Err(error) => {
                self.refused
                    .push((batch.setting.clone(), error.to_string()));
                Ok(())
            }
            Ok(()) => Ok(()),
        }
    }

    /// Steps in time on one mesh, as far as they improve anything.
    fn climb(&mut self, bench: &mut Bench, batch: &Batch) -> Result<()> {
        let (mesh, _body) = bench.reduce(&batch.setting)?;
        for ladder in &batch.ladders {
            let mut before: Option<Verdict> = None;
            let mut last = 0.0;
            for steps in ladder {
                // the next one takes about twice as long
                if before.is_some() && !bench.budget.has_time(2.0 * last) {
                    return Ok(());
                }
                let start = Instant::now();
                let setting = mesh.clone().and(steps);
                let point = bench.measure(batch.group, &setting)?;
                let verdict = point.verdict;
                self.points.push(point);
                if before.is_some_and(|b| !verdict.improves(&b, &Quantity::ALL)) {
                    break;
                }
                before = Some(verdict);
                last = start.elapsed().as_secs_f64();
            }
        }
        Ok(())
    }
}

/// What settings are measured with.
struct Bench<'a> {
    study: &'a mut Study,
    reference: &'a Reference,
    budget: &'a Budget,
    clock: Clock,
}

impl Bench<'_> {
    fn compile(&mut self, setting: &Setting) -> Result<Candidate> {
        self.clock.compile(self.study, setting)
    }

    fn measure(&mut self, group: Group, setting: &Setting) -> Result<Point> {
        let (study, reference) = (&mut *self.study, self.reference);
        self.clock.measure(study, reference, group, setting)
    }

    /// Compiles with the loosest tolerance of the reduction that will do, as long as there is time to try.
    fn reduce(&mut self, setting: &Setting) -> Result<(Setting, Candidate)> {
        let budget = self.budget;
        let start = Instant::now();
        let has_time = || budget.has_time(start.elapsed().as_secs_f64());
        loosest_reduction(setting, JOINT_REDUCTION, has_time, |reduced| {
            self.compile(reduced)
        })
    }
}

/// Bytes in words.
pub fn gigabytes(bytes: f64) -> String {
    format!("{:.1} GB of memory", 1e-9 * bytes)
}
