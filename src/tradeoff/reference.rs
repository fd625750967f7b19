//! The reference: the scene on finer and finer meshes and steps, until two levels agree.
//!
//! Level 0 in space has half the cells of the scene along every axis, each next one twice as many; level 0 in time steps
//! as far as the scene communicates, each next one half as far. The scheme is L-stable and of second order; friction and
//! the reduction are solved far below the errors looked for. Differences between levels in space are those of the finest
//! meshes so far, differences between levels in time are taken on the coarsest mesh. With `d` the last difference and `r` the
//! mean ratio of the last differences, the error left is taken as
//!
//! ```text
//! d max(m, 1 / (r - 1))
//! ```
//!
//! in space and in time, and both are added, with the tolerance of the reduction: a geometric series. The floor m counts on
//! first order (1) where r is the ratio of two differences, and on second order (1/3) where it is the mean of two ratios; of
//! one difference alone 2 d is left, which counts on order 0.6. Levels that do not approach each other (`r <= 1`) leave it
//! unknown. What is refined next is what contributes most.
//! An error is a figure only where it is at least ten times the error left in the reference.

use super::errors::{Errors, Quantity};
use super::family::{Family, cells, dimension};
use super::setting::Setting;
use super::study::{Candidate, Sample, Study};
use super::trajectory::Work;
use crate::error::{Error, Result};
use crate::model::Selection;
use crate::scene::{ModelKind, Scene};
use crate::simulator::course::Points;

/// How many times more accurate than a measured setting the reference is.
pub const MARGIN: f64 = 10.0;
/// Tolerances of the reduction that the reference tries, tightest first; a body that none of them reduces stays whole.
const REDUCTION_TOLERANCES: [f64; 2] = [1e-8, 1e-6];
/// Least share of the last difference that is taken to be left, by the number of ratios that were measured.
const FLOORS: [f64; 3] = [2.0, 1.0, 1.0 / 3.0];
/// Differences below this are rounding, and need not fall any more.
const ROUNDING: f64 = 1e-9;
/// Share of the time discretisation in the remaining error above which time is refined.
const SHARE_OF_TIME: f64 = 0.2;

/// A level of the reference, in space or in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Nodes of the mesh.
    pub mesh_nodes: usize,
    /// Contact nodes.
    pub contact_nodes: usize,
    /// Internal step, s.
    pub step: f64,
    /// Tolerance of the reduction; 0 for a body that stayed whole.
    pub reduction: f64,
    /// Difference from the level before.
    pub difference: Option<Errors>,
}

/// What is refined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refinement {
    Space,
    Time,
}

/// The finest level so far, and how far it can be trusted.
pub struct Reference {
    family: Family,
    space: Vec<Level>,
    time: Vec<Level>,
    /// The finest mesh and step.
    finest: Run,
    /// The coarsest mesh at the same step.
    coarsest: Run,
}

/// A run of a level, and its body for the next level in time.
#[derive(Clone)]
struct Run {
    sample: Sample,
    /// Place of its tolerance among [`REDUCTION_TOLERANCES`].
    tolerance: usize,
    _body: Candidate,
}

/// An error against the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    error: f64,
    uncertainty: f64,
}

impl Measured {
    /// Difference from the reference.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// What is left in the reference.
    pub fn uncertainty(&self) -> f64 {
        self.uncertainty
    }

    /// The relative error; `None` at the limit of the reference, which is then not ten times as accurate.
    pub fn figure(&self) -> Option<f64> {
        (self.error >= MARGIN * self.uncertainty).then_some(self.error)
    }

    /// What the true error does not exceed: the difference, and what is left in the reference.
    pub fn bound(&self) -> f64 {
        self.error + self.uncertainty
    }
}

/// The errors of a run, quantity by quantity; `None` where there is nothing to compare.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Verdict([Option<Measured>; 4]);

impl From<&Selection> for Verdict {
    /// How well the setting does that was picked for a model.
    fn from(selection: &Selection) -> Verdict {
        let mut pairs = selection.errors.chunks_exact(2);
        Verdict(std::array::from_fn(|_| {
            let (error, uncertainty) = match pairs.next() {
                Some(&[error, uncertainty]) => (error, uncertainty),
                _ => return None,
            };
            (!error.is_nan()).then_some(Measured { error, uncertainty })
        }))
    }
}

impl Verdict {
    pub fn of(&self, quantity: Quantity) -> Option<Measured> {
        self.0[quantity as usize]
    }

    /// Error and uncertainty of every quantity; not a number where there is nothing to compare.
    pub(crate) fn to_numbers(self) -> Vec<f64> {
        let pair = |m: Option<Measured>| m.map_or([f64::NAN; 2], |m| [m.error, m.uncertainty]);
        self.0.into_iter().flat_map(pair).collect()
    }

    /// Whether any of these is smaller than in the setting before by more than a fifth: what a shorter step does as long as
    /// the error is not that of the mesh.
    pub fn improves(&self, before: &Verdict, quantities: &[Quantity]) -> bool {
        quantities.iter().any(|q| {
            let pair = self.of(*q).zip(before.of(*q));
            pair.is_some_and(|(now, before)| now.error < 0.8 * before.error)
        })
    }

    /// Whether none of these quantities is off by more than `target`.
    pub fn meets(&self, target: f64, quantities: &[Quantity]) -> bool {
        let mut found = quantities.iter().filter_map(|q| self.of(*q));
        found.all(|measured| measured.bound() <= target)
    }
}

impl Reference {
    /// Two levels in space and two in time.
    ///
    /// # Errors
    /// Those of the compilation and the run of a level; [`Error::Scene`] for a scene in which nothing moves.
    pub fn new(study: &mut Study) -> Result<Reference> {
        let family = Family::most_accurate(study.scene());
        let (first, coarsest) = level(study, &setting_of(study.scene(), &family, 0, 0), 0)?;
        let mut reference = Reference {
            family,
            space: vec![first.clone()],
            time: vec![first],
            finest: coarsest.clone(),
            coarsest,
        };
        reference.refine_time(study)?;
        reference.refine_space(study)?;
        match Quantity::ALL
            .iter()
            .any(|q| reference.uncertainty(*q).is_some())
        {
            true => Ok(reference),
            false => Err(Error::Scene {
                source_name: study.scene().name.clone(),
                path: "run.signals".to_owned(),
                found: "loads under which nothing moves".to_owned(),
                allowed: "a run with something to compare".to_owned(),
            }),
        }
    }

    /// What [`Reference::refine`] does next: of the quantity that is known worst, what contributes most.
    pub fn next(&self) -> Refinement {
        let left = |levels: &[Level], quantity| left(levels, quantity).unwrap_or(0.0);
        let parts = Quantity::JUDGED.map(|q| (left(&self.space, q), left(&self.time, q)));
        let worst = parts
            .into_iter()
            .max_by(|a, b| (a.0 + a.1).total_cmp(&(b.0 + b.1)));
        match worst {
            // written so that what is unknown is refined
            Some((space, time)) if space < (1.0 / SHARE_OF_TIME - 1.0) * time => Refinement::Time,
            _ => Refinement::Space,
        }
    }

    /// The settings that [`Reference::new`] compiles and runs, the most costly one last.
    pub fn first_settings(scene: &Scene) -> [Setting; 3] {
        let family = Family::most_accurate(scene);
        [(0, 0), (0, 1), (1, 1)].map(|(space, time)| setting_of(scene, &family, space, time))
    }

    /// The finest setting that [`Reference::refine`] would run next. Refined in time it is on a mesh that is compiled.
    pub fn next_setting(&self, scene: &Scene) -> Setting {
        let (space, time) = (self.space.len() as u32, self.time.len() as u32);
        match self.next() {
            Refinement::Space => setting_of(scene, &self.family, space, time - 1),
            Refinement::Time => setting_of(scene, &self.family, space - 1, time),
        }
    }

    /// Goes one level further.
    ///
    /// # Errors
    /// Those of the compilation and the run; the reference is then unchanged.
    pub fn refine(&mut self, study: &mut Study) -> Result<Refinement> {
        let next = self.next();
        match next {
            Refinement::Space => self.refine_space(study)?,
            Refinement::Time => self.refine_time(study)?,
        }
        Ok(next)
    }

    fn refine_space(&mut self, study: &mut Study) -> Result<()> {
        let (space, time) = (self.space.len() as u32, self.time.len() as u32 - 1);
        let setting = setting_of(study.scene(), &self.family, space, time);
        let (mut next, finest) = level(study, &setting, self.finest.tolerance)?;
        next.difference = Some(self.finest.sample.errors(&finest.sample)?);
        self.space.push(next);
        self.finest = finest;
        Ok(())
    }

    fn refine_time(&mut self, study: &mut Study) -> Result<()> {
        let (space, time) = (self.space.len() as u32 - 1, self.time.len() as u32);
        let setting = setting_of(study.scene(), &self.family, 0, time);
        let (mut next, coarsest) = level(study, &setting, self.coarsest.tolerance)?;
        let finest = match space {
            0 => coarsest.clone(),
            _ => {
                let setting = setting_of(study.scene(), &self.family, space, time);
                level(study, &setting, self.finest.tolerance)?.1
            }
        };
        next.difference = Some(self.coarsest.sample.errors(&coarsest.sample)?);
        self.time.push(next);
        (self.finest, self.coarsest) = (finest, coarsest);
        Ok(())
    }

    /// Work of the finest run so far.
    pub fn work(&self) -> Work {
        self.finest.sample.trajectory.work
    }

    /// The levels in space, coarsest first.
    pub fn space(&self) -> &[Level] {
        &self.space
    }

    /// The levels in time, coarsest first.
    pub fn time(&self) -> &[Level] {
        &self.time
    }

    /// Relative error left in the finest level; infinite where it is unknown, `None` where there is nothing to compare.
    pub fn uncertainty(&self, quantity: Quantity) -> Option<f64> {
        let reduction = self.space.last().map_or(0.0, |level| level.reduction);
        Some(left(&self.space, quantity)? + left(&self.time, quantity)? + reduction)
    }

    /// Errors of a run of the same study.
    ///
    /// # Errors
    /// [`Error::Value`] for a run of another study.
    pub fn judge(&self, sample: &Sample) -> Result<Verdict> {
        let errors = sample.errors(&self.finest.sample)?;
        Ok(Verdict(Quantity::ALL.map(|quantity| {
            Some(Measured {
                error: errors.of(quantity)?,
                uncertainty: self.uncertainty(quantity)?,
            })
        })))
    }
}

/// Error left in the last of these levels: see the module.
fn left(levels: &[Level], quantity: Quantity) -> Option<f64> {
    let differences: Vec<f64> = levels
        .iter()
        .filter_map(|l| l.difference.and_then(|d| d.of(quantity)))
        .collect();
    let last = *differences.last()?;
    let count = differences.len().min(3) - 1;
    let first = differences[differences.len() - 1 - count];
    if count == 0 || first.max(last) <= ROUNDING {
        return Some(FLOORS[0] * last);
    }
    let ratio = (first / last).powf(1.0 / count as f64);
    Some(match ratio > 1.0 {
        true => last * (1.0 / (ratio - 1.0)).max(FLOORS[count]),
        false => f64::INFINITY,
    })
}

/// The setting of a level, but for the tolerance of the reduction.
fn setting_of(scene: &Scene, family: &Family, space: u32, time: u32) -> Setting {
    // the contact of a solid is most of its surface: reducing it costs more than all steps of the run
    let model = match dimension(scene) {
        3 => "condensed",
        _ => "auto",
    };
    let step = Points::of(scene).step / 2f64.powi(time as i32);
    family
        .setting()
        .with("mesh.cells", cells(scene, 0.5 * 2f64.powi(space as i32)))
        .with("time.scheme", "tr_bdf2")
        .with("time.step", format!("{step:?}"))
        .with("time.tolerance", "null")
        .with("time.error_estimate", "null")
        .with("fidelity.model", model)
        .with("fidelity.precision", "double")
        .with("fidelity.friction_tolerance", "1e-10")
}

/// Compiles and runs a level, with the first tolerance of the reduction that will do, from that of the level before on.
fn level(study: &mut Study, setting: &Setting, first: usize) -> Result<(Level, Run)> {
    for (i, tolerance) in REDUCTION_TOLERANCES.iter().enumerate().skip(first) {
        let reduced = setting
            .clone()
            .with("fidelity.tolerance", format!("{tolerance:e}"));
        match run(study, reduced, i) {
            Err(
                Error::ReductionInaccurate { .. } | Error::LostDigits { .. } | Error::Body { .. },
            ) => {}
            outcome => return outcome,
        }
    }
    let whole = setting.clone().with("fidelity.model", "condensed");
    run(study, whole, REDUCTION_TOLERANCES.len())
}

fn run(study: &mut Study, setting: Setting, tolerance: usize) -> Result<(Level, Run)> {
    let candidate = study.compile(&setting)?;
    let sample = candidate.run()?;
    let summary = candidate.model.summary();
    let level = Level {
        mesh_nodes: summary.mesh_nodes,
        contact_nodes: candidate.model.contact().node_count(),
        step: candidate.scene.time.step,
        reduction: match summary.kind {
            ModelKind::Reduced => candidate.scene.fidelity.tolerance,
            ModelKind::Full | ModelKind::Condensed | ModelKind::Auto => 0.0,
        },
        difference: None,
    };
    let run = Run {
        sample,
        tolerance,
        _body: candidate,
    };
    Ok((level, run))
}
