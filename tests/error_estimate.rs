//! The estimate of the error in time against the error itself: that of the same model with a far smaller step.

mod common;

use common::{
    Course, Trajectory, pad_course, paper, paper_course, seal_course, start, steps,
    swinging_course, value,
};
use stickslip::compile;

const ESTIMATE: (&str, &str) = ("time.error_estimate", "true");

/// Every estimate within 0.3 and 3 of the error, and the errors of some size: otherwise nothing is shown.
fn assert_effective(label: &str, run: &Trajectory, fine: &Trajectory) {
    let found = run.effectivities(fine);
    assert!(found.len() >= 2, "{label}: {found:?}");
    assert!(
        found.iter().all(|e| (0.3..3.0).contains(e)),
        "{label}: {found:.2?}"
    );
}

/// The accumulated error of equal steps, at all communication points, step sizes 1/4 to 1/32 of them.
#[test]
fn estimate_is_the_error_of_equal_steps() {
    let courses: [(&str, Course, u32); 4] = [
        ("paper", paper_course(), 1024),
        ("swinging", swinging_course(), 1024),
        ("pad", pad_course(), 512),
        ("seal", seal_course(), 1024),
    ];
    for (label, course, parts) in courses {
        let fine = course.run_equal(parts, &[]);
        for parts in [4, 8, 16, 32] {
            let run = course.run_equal(parts, &[ESTIMATE]);
            assert_effective(&format!("{label}, {parts} steps"), &run, &fine);
        }
    }
}

/// Schemes and starts of first order, and TR-BDF2, on the paper's example.
#[test]
fn estimate_knows_the_order() {
    let fine = paper_course().run_equal(4096, &[]);
    for (scheme, start, range) in [
        ("trapezoid", "consistent", 0.9..1.1),
        ("tr_bdf2", "consistent", 0.9..1.1),
        ("backward_euler", "consistent", 0.9..1.3),
        // the largest slip rate, right after the start, is at no communication point
        ("backward_euler", "zero", 0.5..1.3),
        ("trapezoid", "zero", 0.5..1.1),
        ("tr_bdf2", "zero", 0.5..1.1),
    ] {
        for parts in [8, 32] {
            let given = [("time.scheme", scheme), ("time.start", start), ESTIMATE];
            let run = paper_course().run_equal(parts, &given);
            let found = run.effectivities(&fine);
            assert!(
                found.iter().all(|e| range.contains(e)),
                "{scheme} {start} {parts}: {found:.2?}"
            );
        }
    }
}

/// With chosen step sizes the second solution has twice the step.
#[test]
fn estimate_is_the_error_of_chosen_steps() {
    let courses: [(&str, Course, u32, [&str; 3]); 3] = [
        ("paper", paper_course(), 2048, ["1e-3", "1e-4", "1e-5"]),
        ("pad", pad_course(), 1024, ["1e-2", "1e-3", "1e-4"]),
        (
            "column",
            common::column_course(),
            2048,
            ["1e-3", "1e-4", "1e-5"],
        ),
    ];
    for (label, course, parts, tolerances) in courses {
        let fine = course.run_equal(parts, &[]);
        for tolerance in tolerances {
            let run = course.run(&[("time.tolerance", tolerance)]);
            assert_effective(&format!("{label}, tolerance {tolerance}"), &run, &fine);
        }
    }
}

/// A held load that jumps from step to step: both solutions follow at once.
#[test]
fn estimate_follows_jumps() {
    let table =
        "[[0, -0.3], [0.125, -0.3], [0.25, -0.6], [0.375, -0.6], [0.5, -0.1], [0.625, -0.4]]";
    let course = Course {
        overrides: vec![
            ("loads[0].interpolation", "\"hold\"".into()),
            ("run.signals.press", table.into()),
        ],
        count: 5,
        ..paper_course()
    };
    let fine = course.run_equal(1024, &[]);
    for parts in [4, 16] {
        let run = course.run_equal(parts, &[ESTIMATE]);
        assert_effective(&format!("jumps, {parts} steps"), &run, &fine);
    }
    let run = course.run(&[("time.tolerance", "1e-3")]);
    assert_effective("jumps, tolerance", &run, &fine);
}

/// The second solution looks on: asked for or not, the results are the same bits. It costs two steps per step.
#[test]
fn estimate_changes_no_result() {
    for scheme in ["trapezoid", "backward_euler", "tr_bdf2"] {
        let given = [("time.scheme", scheme)];
        let without = swinging_course().run_equal(3, &given);
        let with = swinging_course().run_equal(3, &[given[0], ESTIMATE]);
        assert_eq!(without.rates, with.rates);
        let (few, many) = (
            without.simulator.stage_solves() - 1,
            with.simulator.stage_solves() - 1,
        );
        assert_eq!(many, 3 * few);

        let tolerance = ("time.tolerance", "1e-3");
        let without = [given[0], tolerance, ("time.error_estimate", "false")];
        let without = swinging_course().run(&without);
        let with = swinging_course().run(&[given[0], tolerance]);
        assert_eq!(without.rates, with.rates);
    }
}

/// The port is there when the scene asks for it, directly or by a tolerance, and not otherwise.
#[test]
fn port_exists_when_asked_for() {
    for (given, exists) in [
        (vec![], false),
        (vec![ESTIMATE], true),
        (vec![("time.tolerance", "1e-3")], true),
        (
            vec![("time.tolerance", "1e-3"), ("time.error_estimate", "false")],
            false,
        ),
    ] {
        let model = compile(&paper(8, &given)).unwrap();
        assert_eq!(
            model.ports().find("solver.error_estimate").is_ok(),
            exists,
            "{given:?}"
        );
    }
}

/// A contact that never moves has no error in its slip rate.
#[test]
fn estimate_is_zero_at_rest() {
    let bound = ("contact.friction", r#"{"law": "tresca", "bound": 1e6}"#);
    for asked in [ESTIMATE, ("time.tolerance", "1e-4")] {
        let mut simulator = start(&paper(8, &[bound, asked]));
        assert_eq!(value(&simulator, "solver.error_estimate"), 0.0);
        steps(&mut simulator, 0.1, 3);
        assert_eq!(value(&simulator, "solver.error_estimate"), 0.0);
    }
}
