//! `fidelity.target_error`: the cheapest measured setting that meets a target.
//!
//! Measured are, family by family, meshes from coarse to fine, each with steps from long to short, until the errors that a
//! target bounds ([`Quantity::JUDGED`]) and what is left in the reference stay below it together. Of the first mesh of
//! every family that meets it, the one whose run takes the fewest multiplications is picked; these are counted, no clock is
//! read. The reference is refined until what is left in it is a tenth of the target. The cost of it all is bounded by the
//! largest mesh of the reference and by the multiplications of one run.

use super::errors::Quantity;
use super::family::{Family, cells, dimension};
use super::reference::{MARGIN, Reference, Refinement, Verdict};
use super::setting::Setting;
use super::study::{Study, loosest_reduction};
use crate::error::{Error, Result};
use crate::model::Selection;
use crate::progress::{Phase, Watch};
use crate::scene::Scene;

/// Where a target stands in a scene.
const PATH: &str = "fidelity.target_error";
/// Largest meshes of the reference, nodes: in the plane and in space.
const MOST_NODES: [u128; 2] = [70_000, 8_000];
/// Multiplications of a run beyond which neither the reference nor a setting goes: about a minute.
const MOST_MULTIPLICATIONS: f64 = 5e10;
/// Halvings of the communication step beyond which no setting and no reference goes.
const MOST_HALVINGS: usize = 10;
/// Cells of the coarsest mesh that is tried, as a share of those of the scene along every axis.
const COARSEST: f64 = 0.125;
/// Share of the target that the reduction may use.
const SHARE_OF_REDUCTION: f64 = 0.01;

/// A setting that meets the target.
struct Match {
    setting: Setting,
    verdict: Verdict,
    multiplications: f64,
}

/// The scene with the setting that is picked for its `fidelity.target_error`, and the record of how it was found; without a
/// target the scene as it is.
///
/// # Errors
/// [`Error::Scene`] at `fidelity.target_error` when it is out of reach; those of compilation and run.
pub(crate) fn resolve(scene: &Scene, watch: &mut Watch) -> Result<(Scene, Option<Selection>)> {
    match scene.fidelity.target_error {
        Some(target) => select(scene, target, watch).map(|(scene, found)| (scene, Some(found))),
        None => Ok((scene.clone(), None)),
    }
}

/// The scene with the setting that meets `target`, and the record of how it was found.
///
/// # Errors
/// [`Error::Scene`] at `fidelity.target_error` when it is out of reach; those of compilation and run.
fn select(scene: &Scene, target: f64, watch: &mut Watch) -> Result<(Scene, Selection)> {
    let mut study = Study::new(scene)?;
    let scene = study.scene().clone();
    let families = Family::all(&scene);
    let reference = reference(&mut study, target, watch)?;
    let mut search = Search {
        reference: &reference,
        target,
        best: None,
        tried: 0,
    };
    for family in &families {
        search.family(&mut study, family, watch)?;
    }
    let tried = search.tried;
    let Some(best) = search.best else {
        let allowed = format!("a larger one: none of the {tried} settings measured meets it");
        return Err(refusal(&scene, target, allowed));
    };
    let selection = Selection {
        target,
        errors: best.verdict.to_numbers(),
        changes: best.setting.clone().needed(&scene).changes().to_vec(),
        tried,
    };
    Ok((best.setting.apply(&scene)?, selection))
}

/// The reference that is ten times as accurate as the target.
fn reference(study: &mut Study, target: f64, watch: &mut Watch) -> Result<Reference> {
    let mut found = Reference::new(study)?;
    loop {
        watch.report(Phase::Selection, 0.0)?;
        let left = Quantity::JUDGED.map(|q| (found.uncertainty(q).unwrap_or(0.0), q.name()));
        let worst = left.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let (left, name) = worst.unwrap_or_default();
        if MARGIN * left <= target {
            return Ok(found);
        }
        if !is_affordable(study.scene(), &found) {
            let allowed = format!(
                "at least {:.1e}: ten times what is left of the {name} in a reference of {} mesh nodes and steps of {} s, the \
                 finest that a compilation affords",
                MARGIN * left,
                found.space().last().map_or(0, |l| l.mesh_nodes),
                found.time().last().map_or(0.0, |l| l.step),
            );
            return Err(refusal(study.scene(), target, allowed));
        }
        found.refine(study)?;
    }
}

fn refusal(scene: &Scene, target: f64, allowed: String) -> Error {
    Error::Scene {
        source_name: scene.name.clone(),
        path: PATH.to_owned(),
        found: target.to_string(),
        allowed,
    }
}

/// Whether the next refinement stays within the bounds.
fn is_affordable(scene: &Scene, reference: &Reference) -> bool {
    let dimension = dimension(scene);
    let (nodes, growth) = match reference.next() {
        Refinement::Time if reference.time().len() > MOST_HALVINGS => return false,
        Refinement::Time => (0, 2.0),
        // twice the contact nodes along every tangent, and a product of two of them
        Refinement::Space => {
            let last = reference.space().last().map_or(0, |l| l.mesh_nodes);
            ((last as u128) << dimension, 4f64.powi(dimension as i32 - 1))
        }
    };
    nodes <= MOST_NODES[dimension - 2]
        && growth * reference.work().multiplications <= MOST_MULTIPLICATIONS
}

struct Search<'a> {
    reference: &'a Reference,
    target: f64,
    best: Option<Match>,
    tried: usize,
}

impl Search<'_> {
    /// Looks for the coarsest mesh of a family that meets the target.
    fn family(&mut self, study: &mut Study, family: &Family, watch: &mut Watch) -> Result<()> {
        let finest = 0.5 * 2f64.powi(self.reference.space().len() as i32 - 2);
        let (mut factor, mut last) = (COARSEST, String::new());
        while factor <= finest {
            let size = cells(study.scene(), factor);
            factor *= 2.0;
            if size == last {
                continue;
            }
            let setting = Setting::unchanged()
                .with("mesh.cells", size.as_str())
                .and(&family.setting());
            last = size;
            if !self.mesh(study, setting, watch)? {
                break;
            }
        }
        Ok(())
    }

    /// Looks for the longest step on a mesh that meets the target; whether a finer mesh is worth a look.
    fn mesh(&mut self, study: &mut Study, setting: Setting, watch: &mut Watch) -> Result<bool> {
        let mut step = study.interval();
        let shortest = study.communication_step() / 2f64.powi(MOST_HALVINGS as i32);
        let share = (SHARE_OF_REDUCTION * self.target).log10().floor() as i32;
        let compile = |reduced: &Setting| study.compile(reduced);
        let (setting, _body) = match loosest_reduction(&setting, share.min(-4), || true, compile) {
            Ok(found) => found,
            // this mesh gives no model; a finer one may
            Err(
                Error::ReductionInaccurate { .. } | Error::LostDigits { .. } | Error::Body { .. },
            ) => return Ok(true),
            Err(error) => return Err(error),
        };
        let mut before = None;
        while step >= shortest {
            watch.report(Phase::Selection, 0.0)?;
            let setting = setting.clone().with("time.step", format!("{step:?}"));
            step *= 0.5;
            let candidate = match study.compile(&setting) {
                Ok(candidate) => candidate,
                // too long a step for an explicit scheme: a shorter one may do
                Err(Error::Unstable { .. }) => continue,
                Err(error) => return Err(error),
            };
            let most = self
                .best
                .as_ref()
                .map_or(MOST_MULTIPLICATIONS, |b| b.multiplications);
            if candidate.least_multiplications() >= most {
                // shorter steps cost more; so do finer meshes if this is the longest step
                return Ok(before.is_some());
            }
            let sample = match candidate.run() {
                Ok(sample) => sample,
                // too long a step for friction: a shorter one may do
                Err(Error::Value { .. } | Error::NotConverged { .. }) => continue,
                Err(error) => return Err(error),
            };
            self.tried += 1;
            let multiplications = sample.trajectory.work.multiplications;
            let verdict = self.reference.judge(&sample)?;
            if verdict.meets(self.target, &Quantity::JUDGED) {
                if multiplications < most {
                    self.best = Some(Match {
                        setting,
                        verdict,
                        multiplications,
                    });
                }
                return Ok(false);
            }
            if before.is_some_and(|b: Verdict| !verdict.improves(&b, &Quantity::JUDGED)) {
                return Ok(true);
            }
            before = Some(verdict);
        }
        Ok(true)
    }
}
