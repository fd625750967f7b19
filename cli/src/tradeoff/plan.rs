//! The settings to measure: the scene as given, one thing varied at a time, and meshes with steps to match.

use super::estimate::Estimate;
use super::point::Group;
use stickslip::scene::{Scene, Scheme};
use stickslip::tradeoff::{ELEMENTS, Family, GRADINGS, Setting, Study, cells, grading};

/// Cells along every axis, as shares of those of the scene.
const SIZES: [f64; 6] = [0.125, 0.25, 0.5, 1.0, 2.0, 4.0];
/// Internal steps, as shares of the communication step.
const STEPS: [f64; 7] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.0625];
const SCHEMES: [&str; 4] = ["trapezoid", "tr_bdf2", "backward_euler", "rectangle"];
const MODELS: [&str; 3] = ["full", "condensed", "reduced"];
const REDUCTION_TOLERANCES: [&str; 5] = ["1e-2", "1e-3", "1e-4", "1e-6", "1e-8"];
const FRICTION_TOLERANCES: [&str; 4] = ["1e-2", "1e-4", "1e-6", "1e-8"];
/// Tolerance of friction in the joint settings, and exponent of the loosest one of the reduction: far below the errors of
/// their meshes.
const JOINT_FRICTION: &str = "1e-4";
pub const JOINT_REDUCTION: i32 = -4;

/// Runs of the step of the scene that the scan over its steps costs.
const SCANNED: f64 = 4.0;

/// Settings that are measured one after the other.
pub struct Batch {
    pub group: Group,
    pub setting: Setting,
    /// Shorter and shorter steps, of which only those up to the error of the mesh are worth measuring; none for the step of
    /// the setting.
    pub steps: Vec<String>,
    /// Estimated cost, for the order and the budget.
    pub estimate: Estimate,
}

/// All batches, the scene as given first, then by their estimated cost.
pub fn batches(study: &Study) -> Vec<Batch> {
    let scene = study.scene();
    let mut singles: Vec<(Group, Setting)> = vec![(Group::AsGiven, Setting::unchanged())];
    let mut vary = |group, path: &str, value: String| {
        singles.push((group, Setting::unchanged().with(path, value)));
    };
    for factor in SIZES {
        vary(Group::Cells, "mesh.cells", cells(scene, factor));
    }
    for exponent in GRADINGS {
        vary(Group::Mesh, "mesh.grading", grading(scene, exponent));
    }
    for element in ELEMENTS {
        vary(Group::Mesh, "element", element.to_owned());
    }
    for step in steps(study) {
        vary(Group::Step, "time.step", step);
    }
    for scheme in SCHEMES {
        vary(Group::Scheme, "time.scheme", scheme.to_owned());
    }
    for tolerance in REDUCTION_TOLERANCES {
        vary(Group::Tolerance, "fidelity.tolerance", tolerance.to_owned());
    }
    for tolerance in FRICTION_TOLERANCES {
        let path = "fidelity.friction_tolerance";
        vary(Group::Tolerance, path, tolerance.to_owned());
    }
    vary(Group::Tolerance, "fidelity.precision", "single".to_owned());
    for model in MODELS {
        vary(Group::Model, "fidelity.model", model.to_owned());
    }
    let mut known: Vec<Scene> = Vec::new();
    let mut batches = Vec::new();
    for (group, setting) in singles {
        // what the scene refuses does not exist for it, and what it says already is measured once
        let Ok(applied) = setting.apply(scene) else {
            continue;
        };
        if known.contains(&applied) {
            continue;
        }
        batches.push(Batch {
            group,
            setting,
            steps: Vec::new(),
            estimate: Estimate::of(&applied, 1.0),
        });
        known.push(applied);
    }
    for family in &Family::all(scene) {
        batches.extend(
            SIZES
                .iter()
                .filter_map(|factor| joint(study, family, *factor)),
        );
    }
    batches[1..].sort_by(|a, b| {
        a.estimate
            .multiplications
            .total_cmp(&b.estimate.multiplications)
    });
    batches
}

/// A mesh with shorter and shorter steps.
fn joint(study: &Study, family: &Family, factor: f64) -> Option<Batch> {
    let scene = study.scene();
    let mut mesh = Setting::unchanged()
        .with("mesh.cells", cells(scene, factor))
        .and(&family.setting());
    if let Scheme::Rectangle | Scheme::BackwardEuler = scene.time.scheme {
        mesh = mesh.with("time.scheme", "trapezoid");
    }
    let setting = mesh.with("fidelity.friction_tolerance", JOINT_FRICTION);
    let applied = setting.apply(scene).ok()?;
    Some(Batch {
        group: Group::Joint,
        setting,
        steps: steps(study).collect(),
        estimate: Estimate::of(&applied, SCANNED),
    })
}

/// Steps worth trying, longest first.
fn steps(study: &Study) -> impl Iterator<Item = String> {
    let (unit, longest) = (study.communication_step(), study.interval());
    STEPS
        .into_iter()
        .map(move |share| share * unit)
        .filter(move |step| *step <= longest)
        .map(|step| format!("{step:?}"))
}
