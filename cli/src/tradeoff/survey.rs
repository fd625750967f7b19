//! The measurements that fit the budget: the reference first, then the settings, cheapest first.

use super::clock::{Budget, Clock};
use super::estimate::{Estimate, MEMORY, Speed};
use super::plan::{Batch, JOINT_REDUCTION, batches};
use super::point::{Group, Point};
use crate::console;
use std::time::Instant;
use stickslip::Result;
use stickslip::tradeoff::{Quantity, Reference, Setting, Study, Verdict};

/// Compilations of a setting: one to run it, one at least to time it.
const COMPILATIONS: f64 = 2.0;

/// What was measured and what was not.
pub struct Survey {
    pub points: Vec<Point>,
    /// Settings that cannot be had, and why.
    pub refused: Vec<(Setting, String)>,
    /// Batches that did not fit.
    pub skipped: Vec<Batch>,
}

/// A reference that is refined while it fits a share of the budget.
pub struct Refined {
    pub reference: Reference,
    speed: Speed,
}

impl Refined {
    /// Two levels in space and in time.
    pub fn new(study: &mut Study) -> Result<Refined> {
        Ok(Refined {
            reference: Reference::new(study)?,
            speed: Speed::unknown(),
        })
    }

    /// Refines as far as a share of the budget goes; whether it went any further.
    pub fn refine(&mut self, study: &mut Study, budget: &Budget, share: f64) -> Result<bool> {
        let spinner = console::spinner(&format!("{}: reference", study.scene().name));
        let mut has_gone_further = false;
        loop {
            let next = self.reference.next_setting(study).apply(study.scene())?;
            let estimate = Estimate::of(&next, 1.0);
            let is_affordable = budget.fits(self.speed.seconds(&estimate), share);
            if !is_affordable || estimate.bytes > MEMORY {
                spinner.finish_and_clear();
                return Ok(has_gone_further);
            }
            let start = Instant::now();
            self.reference.refine(study)?;
            self.speed.learn(&estimate, start.elapsed().as_secs_f64());
            has_gone_further = true;
        }
    }
}

/// Measures batch after batch until the next one does not fit; the scene as given in any case.
pub fn settings(study: &mut Study, reference: &Reference, budget: &Budget) -> Result<Survey> {
    let mut planned = batches(study);
    let bar = console::bar(planned.len() as u64, &study.scene().name);
    let mut clock = Clock::new(study)?;
    let mut survey = Survey {
        points: Vec::new(),
        refused: Vec::new(),
        skipped: Vec::new(),
    };
    let mut speed = Speed::unknown();
    while !planned.is_empty() {
        let estimate = planned[0].estimate;
        let is_affordable = budget.fits(COMPILATIONS * speed.seconds(&estimate), 1.0);
        if !survey.points.is_empty() && (!is_affordable || estimate.bytes > MEMORY) {
            survey.skipped = planned;
            break;
        }
        let batch = planned.remove(0);
        let start = Instant::now();
        survey.measure(study, reference, &mut clock, &batch, budget)?;
        speed.learn(&estimate, start.elapsed().as_secs_f64() / COMPILATIONS);
        bar.inc(1);
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

    fn measure(
        &mut self,
        study: &mut Study,
        reference: &Reference,
        clock: &mut Clock,
        batch: &Batch,
        budget: &Budget,
    ) -> Result<()> {
        let outcome = match batch.steps.as_slice() {
            [] => clock
                .measure(study, reference, batch.group, &batch.setting)
                .map(|point| self.points.push(point)),
            steps => self.scan(study, reference, clock, (batch, steps), budget),
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

    /// Shorter and shorter steps on one mesh, until they improve nothing.
    fn scan(
        &mut self,
        study: &mut Study,
        reference: &Reference,
        clock: &mut Clock,
        (batch, steps): (&Batch, &[String]),
        budget: &Budget,
    ) -> Result<()> {
        let (mesh, _body) = study.loosest(&batch.setting, JOINT_REDUCTION)?;
        let mut before: Option<Verdict> = None;
        for step in steps {
            if before.is_some() && !budget.fits(0.0, 1.0) {
                break;
            }
            let setting = mesh.clone().with("time.step", step.as_str());
            let point = clock.measure(study, reference, batch.group, &setting)?;
            let verdict = point.verdict;
            self.points.push(point);
            if before.is_some_and(|b| !verdict.improves(&b, &Quantity::ALL)) {
                break;
            }
            before = Some(verdict);
        }
        Ok(())
    }
}
