//! The settings to measure: the scene as given, one thing varied at a time, and meshes with steps to match.

use super::estimate::Estimate;
use super::point::Group;
use stickslip::scene::{Scene, Scheme};
use stickslip::tradeoff::{Family, GRADINGS, Setting, Study, cells, elements, grading};

/// Cells along every axis, as shares of those of the scene.
const SIZES: [f64; 6] = [0.125, 0.25, 0.5, 1.0, 2.0, 4.0];
/// Tolerances of the error in time that choose the internal steps.
const TIME_TOLERANCES: [&str; 7] = ["1e-1", "3e-2", "1e-2", "3e-3", "1e-3", "3e-4", "1e-4"];
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
    /// Ladders of steps in time, each more accurate and more costly than the one before, of which only those up to the error
    /// of the mesh are worth measuring; none for the setting alone.
    pub ladders: Vec<Vec<Setting>>,
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
    for element in elements(scene) {
        vary(Group::Mesh, "element", element.to_owned());
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
    vary(Group::Step, "time.error_estimate", "true".to_owned());
    for model in MODELS {
        singles.push((Group::Model, of_kind(Setting::unchanged(), model)));
    }
    // single precision does not hold tighter reductions
    let single = of_kind(Setting::unchanged(), "reduced")
        .with("fidelity.precision", "single")
        .with("fidelity.tolerance", "1e-6");
    singles.push((Group::Tolerance, single));
    let steps = equal_steps(study).chain(chosen_steps(study));
    singles.extend(steps.map(|setting| (Group::Step, setting)));
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
            setting: setting.needed(scene),
            ladders: Vec::new(),
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
        let cost = |batch: &Batch| batch.estimate.multiplications();
        cost(a).total_cmp(&cost(b))
    });
    batches
}

/// A setting with another kind of model, in double precision.
fn of_kind(setting: Setting, model: &str) -> Setting {
    setting
        .with("fidelity.model", model)
        .with("fidelity.precision", "double")
}

/// A mesh with shorter and shorter steps, equal ones and chosen ones.
fn joint(study: &Study, family: &Family, factor: f64) -> Option<Batch> {
    let scene = study.scene();
    let mut mesh = Setting::unchanged()
        .with("mesh.cells", cells(scene, factor))
        .and(&family.setting());
    if let Scheme::Rectangle | Scheme::BackwardEuler = scene.time.scheme {
        mesh = mesh.with("time.scheme", "trapezoid");
    }
    let mut setting = mesh.with("fidelity.friction_tolerance", JOINT_FRICTION);
    let mut estimate = Estimate::of(&setting.apply(scene).ok()?, SCANNED);
    if !estimate.has_room() {
        // the reduction takes most of the memory
        setting = of_kind(setting, "condensed");
        estimate = Estimate::of(&setting.apply(scene).ok()?, SCANNED);
    }
    Some(Batch {
        group: Group::Joint,
        setting,
        ladders: vec![equal_steps(study).collect(), chosen_steps(study).collect()],
        estimate,
    })
}

/// Equal steps worth trying, longest first.
fn equal_steps(study: &Study) -> impl Iterator<Item = Setting> {
    let (unit, longest) = (study.communication_step(), study.interval());
    let steps = STEPS.into_iter().map(move |share| share * unit);
    steps.filter(move |step| *step <= longest).map(|step| {
        Setting::unchanged()
            .with("time.step", format!("{step:?}"))
            .with("time.tolerance", "null")
            .with("time.error_estimate", "null")
    })
}

/// Steps chosen by a tolerance up to the longest one, loosest first.
fn chosen_steps(study: &Study) -> impl Iterator<Item = Setting> {
    let longest = study.interval();
    TIME_TOLERANCES.into_iter().map(move |tolerance| {
        Setting::unchanged()
            .with("time.step", format!("{longest:?}"))
            .with("time.tolerance", tolerance)
            .with("time.error_estimate", "false")
    })
}
