//! Speed against accuracy: errors against the reference, its limit, and `fidelity.target_error`.

mod common;

use common::paper;
use std::sync::Arc;
use stickslip::simulator::drive::Drive;
use stickslip::tradeoff::{Measured, Quantity, Reference, Sample, Setting, Study, Verdict, cells};
use stickslip::{Compilation, Error, Model, Scene, Simulator, compile};

/// A small paper's example: 8 x 4 cells, 8 steps.
fn small() -> Scene {
    paper(8, &[("time.step", "0.125"), ("fidelity.model", "auto")])
}

fn sample(study: &mut Study, setting: &Setting) -> Sample {
    study.compile(setting).unwrap().run().unwrap()
}

#[test]
fn errors_fall_with_cells_and_with_steps_down_to_the_limit_of_the_reference() {
    let scene = small();
    let mut study = Study::new(&scene).unwrap();
    let mut reference = Reference::new(&mut study).unwrap();
    for _ in 0..3 {
        reference.refine(&mut study).unwrap();
    }
    let mut judge = |setting: Setting| {
        let sample = sample(&mut study, &setting);
        reference.judge(&sample).unwrap()
    };
    let fine = Setting::unchanged().with("time.step", "0.00390625");
    let by_cells: Vec<_> = [0.5, 1.0, 2.0]
        .map(|factor| judge(fine.clone().with("mesh.cells", cells(&scene, factor))))
        .to_vec();
    let fine = Setting::unchanged()
        .with("element", "p2")
        .with("mesh.cells", "[16,8]");
    let by_steps: Vec<_> = ["0.25", "0.125", "0.0625"]
        .map(|step| judge(fine.clone().with("time.step", step)))
        .to_vec();
    for verdicts in [by_cells, by_steps] {
        for quantity in [Quantity::SlipRate, Quantity::Displacement] {
            let errors: Vec<f64> = verdicts
                .iter()
                .map(|v| v.of(quantity).unwrap().error())
                .collect();
            assert!(
                errors.windows(2).all(|e| e[1] < 0.7 * e[0]),
                "{quantity:?}: {errors:?}"
            );
        }
        let coarsest = verdicts[0].of(Quantity::SlipRate).unwrap();
        assert_eq!(coarsest.figure(), Some(coarsest.error()));
    }
    // what is as fine as the reference itself is at its limit, and no figure
    let alike = Setting::unchanged()
        .with("element", "p2")
        .with("mesh.grading", "[2.5,2.5]")
        .with("mesh.cells", "[16,8]")
        .with("time.step", "0.0078125");
    let alike = judge(alike).of(Quantity::SlipRate).unwrap();
    assert_eq!(alike.figure(), None);
    assert!(alike.bound() < 11.0 * alike.uncertainty());
}

/// What a reference says is left in it is not less than its difference from a far finer one.
#[test]
fn what_is_left_in_the_reference_covers_its_error() {
    let seal = Scene::from_json(stickslip::scene::example("seal").unwrap(), "seal").unwrap();
    let coarser = Setting::unchanged().with("mesh.cells", cells(&seal, 0.5));
    let seal = coarser.apply(&seal).unwrap();
    let changes = [("time.step", "0.0625"), ("fidelity.model", "auto")];
    for scene in [paper(16, &changes), seal] {
        let name = &scene.name;
        let mut study = Study::new(&scene).unwrap();
        let mut reference = Reference::new(&mut study).unwrap();
        let mut levels = Vec::new();
        for _ in 0..2 {
            let setting = reference.next_setting(study.scene());
            let setting = setting.with("fidelity.tolerance", "1e-8");
            reference.refine(&mut study).unwrap();
            let left = Quantity::JUDGED.map(|q| reference.uncertainty(q).unwrap());
            levels.push((sample(&mut study, &setting), left));
        }
        for _ in 0..3 {
            reference.refine(&mut study).unwrap();
        }
        for (sample, left) in &levels {
            let verdict = reference.judge(sample).unwrap();
            for (quantity, left) in Quantity::JUDGED.iter().zip(left) {
                let error = verdict.of(*quantity).unwrap().error();
                assert!(error < *left, "{name}, {quantity:?}: {error} of {left}");
            }
        }
    }
}

/// Work is counted: a run takes half as many multiplications with half the steps, but for the iterations.
#[test]
fn work_is_counted_alike_in_every_run() {
    let mut study = Study::new(&small()).unwrap();
    let setting = Setting::unchanged();
    let (once, again) = (sample(&mut study, &setting), sample(&mut study, &setting));
    assert_eq!(once.trajectory, again.trajectory);
    assert_eq!(once.trajectory.work.steps, 8);
    let halved = sample(&mut study, &setting.with("time.step", "0.25"));
    let ratio = once.trajectory.work.multiplications / halved.trajectory.work.multiplications;
    assert!((1.6..2.2).contains(&ratio), "{ratio}");
}

/// Settings that differ in time, friction and history alone share a body, and give what a fresh compilation gives.
#[test]
fn a_shared_body_changes_no_bit() {
    let scene = small();
    let mut study = Study::new(&scene).unwrap();
    let _given = study.compile(&Setting::unchanged()).unwrap();
    for (path, value) in [
        ("time.step", "0.0625"),
        ("time.scheme", "tr_bdf2"),
        ("time.tolerance", "1e-3"),
        ("time.error_estimate", "true"),
        ("fidelity.friction_tolerance", "1e-4"),
        ("fidelity.tolerance", "1e-4"),
        ("mesh.cells", "[4,2]"),
    ] {
        let setting = Setting::unchanged().with(path, value);
        let shared = study.compile(&setting).unwrap();
        let fresh = compile(&setting.apply(&scene).unwrap()).unwrap();
        assert_eq!(shared.model.to_bytes(), fresh.to_bytes(), "{path}");
        let is_same_body = ["time", "frict"].iter().any(|word| path.contains(word));
        let body = study.body_of(&setting).unwrap();
        let given = study.body_of(&Setting::unchanged()).unwrap();
        assert_eq!(body == given, is_same_body, "{path}");
    }
}

/// Slip rates at all communication points of a scene: time, then values along the contact.
struct Course {
    points: Vec<f64>,
    weights: Vec<f64>,
    rows: Vec<(f64, Vec<f64>)>,
    displacements: Vec<Vec<f64>>,
}

/// Steps a compiled scene on its own signals; plane scenes, `axis` along the contact.
fn course(scene: &Scene, model: &Arc<Model>, axis: usize) -> Course {
    let mut simulator = Simulator::new(Arc::clone(model));
    let names: Vec<String> = scene
        .loads
        .iter()
        .map(|l| &l.name)
        .chain(scene.probes.iter().map(|p| &p.name))
        .map(|name| format!("{name}.displacement"))
        .collect();
    let mut course = Course {
        points: model.contact().points.iter().map(|p| p[axis]).collect(),
        weights: model.contact().weights.clone(),
        rows: Vec::new(),
        displacements: Vec::new(),
    };
    let mut drive = Drive::start(scene, &mut simulator).unwrap();
    loop {
        let simulator = drive.simulator();
        let rates = simulator.get_by_name("contact.slip_rate").unwrap();
        course.rows.push((simulator.time(), rates));
        let values = names.iter().map(|n| simulator.get_by_name(n).unwrap());
        course.displacements.push(values.flatten().collect());
        if drive.step().unwrap().is_none() {
            break;
        }
    }
    course
}

/// Relative errors of slip rate and displacement against a far finer run, read linearly at the nodes of the coarse one.
fn true_errors(coarse: &Course, fine: &Course) -> [f64; 2] {
    let stride = (fine.rows.len() - 1) / (coarse.rows.len() - 1);
    assert_eq!(stride * (coarse.rows.len() - 1), fine.rows.len() - 1);
    let read = |rates: &[f64], x: f64| {
        let after = fine.points.partition_point(|p| *p < x);
        let after = after.clamp(1, fine.points.len() - 1);
        let (a, b) = (fine.points[after - 1], fine.points[after]);
        let share = (x - a) / (b - a);
        (1.0 - share) * rates[after - 1] + share * rates[after]
    };
    let mut sums = [0.0; 4];
    for (n, (time, rates)) in coarse.rows.iter().enumerate() {
        let (exact_time, exact) = &fine.rows[stride * n];
        assert!((time - exact_time).abs() < 1e-9);
        for ((x, rate), weight) in coarse.points.iter().zip(rates).zip(&coarse.weights) {
            let exact = read(exact, *x);
            sums[0] += weight * (rate - exact).powi(2);
            sums[1] += weight * exact.powi(2);
        }
        for (own, exact) in coarse.displacements[n]
            .iter()
            .zip(&fine.displacements[stride * n])
        {
            sums[2] += (own - exact).powi(2);
            sums[3] += exact.powi(2);
        }
    }
    [(sums[0] / sums[1]).sqrt(), (sums[2] / sums[3]).sqrt()]
}

/// The setting that is picked meets its target against a run that took no part in picking it: other element and grading than
/// the reference, another scheme, the norm computed here.
#[test]
fn the_setting_that_is_picked_meets_its_target() {
    for (name, axis, target, cells, step) in [
        ("kazmi2014", 0, "0.05", "[64,32]", "0.00390625"),
        ("seal", 1, "0.1", "[16,40]", "0.0025"),
    ] {
        let text = stickslip::scene::example(name).unwrap();
        let with = |changes: &[(&str, &str)]| {
            let changes: Vec<_> = changes
                .iter()
                .map(|(path, value)| (path.to_string(), value.to_string()))
                .collect();
            Scene::with_overrides(text, name, &changes).unwrap()
        };
        let picked = Compilation::new(&with(&[("fidelity.target_error", target)])).unwrap();
        let fine = with(&[
            ("mesh.cells", cells),
            ("mesh.grading", "[1.5,1.5]"),
            ("element", "p2"),
            ("time.scheme", "trapezoid"),
            ("time.step", step),
        ]);
        let fine = course(&fine, &compile(&fine).unwrap(), axis);
        let own = course(&picked.scene, &picked.model, axis);
        let errors = true_errors(&own, &fine);
        let target: f64 = target.parse().unwrap();
        assert!(errors.iter().all(|e| *e < target), "{name}: {errors:?}");
        // neither is it wastefully better: the next coarser ladder rung would miss it
        let selection = picked.model.summary().selection.as_ref().unwrap();
        let worst =
            Quantity::JUDGED.map(|q| Verdict::from(selection).of(q).map_or(0.0, |m| m.error()));
        assert!(
            worst.iter().any(|e| *e > 0.02 * target),
            "{name}: {worst:?}"
        );
    }
}

#[test]
fn the_pick_is_recorded_and_the_model_carries_the_resolved_scene() {
    let asked = paper(
        8,
        &[("time.step", "0.125"), ("fidelity.target_error", "0.1")],
    );
    let compilation = Compilation::new(&asked).unwrap();
    let model = &compilation.model;
    let selection = model.summary().selection.clone().unwrap();
    assert_eq!(selection.target, 0.1);
    assert!(selection.tried > 0 && !selection.changes.is_empty());
    let meets = |q: &Quantity| {
        Verdict::from(&selection)
            .of(*q)
            .is_some_and(|m: Measured| m.error() <= 0.1)
    };
    assert!(Quantity::JUDGED.iter().all(meets));

    // the record, applied to the scene that was given, is the scene that was compiled
    let mut given = asked.clone();
    given.fidelity.target_error = None;
    let by_hand = Scene::with_overrides(&given.to_json(), "scene", &selection.changes).unwrap();
    assert_eq!(compilation.scene, by_hand);
    assert_eq!(model.scene().mesh, by_hand.mesh);
    assert_eq!(model.scene().fidelity.target_error, None);
    // and compiles to the same model, whose states fit
    let plain = compile(&by_hand).unwrap();
    assert_eq!(plain.fingerprint(), model.fingerprint());
    assert_eq!(plain.summary().selection, None);

    let read = Model::from_bytes(&model.to_bytes()).unwrap();
    assert_eq!(read.summary(), model.summary());
    assert_eq!(read.to_bytes(), model.to_bytes());
    // geometry, material, loads, contact, scheme and start are not for it to change
    assert_eq!(
        by_hand.mesh.grid().unwrap().size,
        asked.mesh.grid().unwrap().size
    );
    assert_eq!(by_hand.material, asked.material);
    assert_eq!(by_hand.loads, asked.loads);
    assert_eq!(by_hand.contact, asked.contact);
    assert_eq!(by_hand.time.scheme, asked.time.scheme);
    assert_eq!(by_hand.time.start, asked.time.start);
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    let asked = paper(
        8,
        &[
            ("time.step", "0.125"),
            ("run.until", "0.5"),
            ("fidelity.target_error", "0.2"),
        ],
    );
    let (once, again) = (compile(&asked).unwrap(), compile(&asked).unwrap());
    assert_eq!(once.to_bytes(), again.to_bytes());
}

fn refusal(outcome: Result<Arc<Model>, Error>) -> (String, String) {
    match outcome.err() {
        Some(Error::Scene { path, allowed, .. }) => (path, allowed),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_target_out_of_reach_is_refused_at_its_path() {
    let text = stickslip::scene::example("brake_pad_3d").unwrap();
    let changes = [("fidelity.target_error", "0.001"), ("run.until", "0.1")];
    let changes = changes.map(|(path, value)| (path.to_owned(), value.to_owned()));
    let scene = Scene::with_overrides(text, "pad", &changes).unwrap();
    let (path, allowed) = refusal(compile(&scene));
    assert_eq!(path, "fidelity.target_error");
    assert!(allowed.starts_with("at least "), "{allowed}");
}

#[test]
fn a_target_needs_a_mesh_of_its_own_and_something_that_moves() {
    let asked = paper(8, &[("fidelity.target_error", "0.1")]);
    let mesh = stickslip::mesh::Mesh::generate(&asked.mesh).unwrap();
    let (path, _) = refusal(Compilation::on_mesh(&asked, mesh).map(|c| c.model));
    assert_eq!(path, "fidelity.target_error");
    let still = paper(
        4,
        &[
            ("fidelity.target_error", "0.1"),
            ("loads[0].start", "0"),
            ("run.signals", "{}"),
        ],
    );
    assert_eq!(refusal(compile(&still)).0, "run.signals");
}
