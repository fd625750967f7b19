//! Internal steps chosen by `time.tolerance`: the accumulated error is of its size, and the work stays in bounds.

mod common;

use common::{
    Course, column, column_course, largest, pad_course, paper, paper_course, scene, seal_course,
    start, started, swinging_course, value,
};
use serde_json::json;
use stickslip::{Error, ErrorCode, Simulator, compile};

/// The error is at most this many tolerances.
const FACTOR: f64 = 4.0;

#[test]
fn error_is_of_the_size_of_the_tolerance() {
    let courses: [(&str, Course, u32); 5] = [
        ("paper", paper_course(), 4096),
        ("swinging", swinging_course(), 1024),
        ("pad", pad_course(), 1024),
        ("seal", seal_course(), 1024),
        ("column", column_course(), 1024),
    ];
    for (label, course, parts) in courses {
        let fine = course.run_equal(parts, &[]);
        let fine_error = largest(&course.run_equal(parts / 2, &[]).errors(&fine));
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
            let run = course.run(&[("time.tolerance", &format!("{tolerance:e}"))]);
            let error = largest(&run.errors(&fine));
            assert!(fine_error < 0.5 * tolerance, "{label}: {fine_error:e}");
            assert!(
                error < FACTOR * tolerance,
                "{label} {tolerance:e}: {error:e}"
            );
        }
    }
}

/// All implicit schemes, down to where backward Euler takes thousands of steps.
#[test]
fn every_implicit_scheme_meets_the_tolerance() {
    let fine = paper_course().run_equal(4096, &[]);
    for (scheme, start) in [
        ("trapezoid", "consistent"),
        ("trapezoid", "zero"),
        ("tr_bdf2", "consistent"),
        ("tr_bdf2", "zero"),
        ("midpoint", "consistent"),
        ("backward_euler", "consistent"),
        ("backward_euler", "zero"),
    ] {
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let run = paper_course().run(&[
                ("time.scheme", scheme),
                ("time.start", start),
                ("time.tolerance", &format!("{tolerance:e}")),
            ]);
            let error = largest(&run.errors(&fine));
            assert!(
                error < 1.5 * tolerance,
                "{scheme} {start} {tolerance:e}: {error:e}"
            );
        }
    }
}

/// Stage solves, refusals and factorizations. Equal steps with the same error at the communication points need more solves on
/// the paper's load, the cost of the estimate included.
#[test]
fn work_stays_in_bounds() {
    let fine = paper_course().run_equal(4096, &[]);
    for (parts, tolerance) in [(16, "1e-3"), (32, "1e-4"), (128, "1e-5")] {
        let equal = paper_course().run_equal(parts, &[]);
        let chosen = paper_course().run(&[("time.tolerance", tolerance)]);
        let (a, b) = (equal.errors(&fine), chosen.errors(&fine));
        assert!(largest(&b) < 2.5 * largest(&a));
        assert!(chosen.simulator.stage_solves() < equal.simulator.stage_solves());
    }
    for (label, course) in [
        ("paper", paper_course()),
        ("swinging", swinging_course()),
        ("pad", pad_course()),
        ("column", column_course()),
    ] {
        for tolerance in ["1e-2", "1e-3", "1e-4", "1e-5"] {
            let simulator = course.run(&[("time.tolerance", tolerance)]).simulator;
            let pairs = simulator.internal_steps() / 2;
            let refused = simulator.refused_pairs();
            assert!(
                refused <= pairs / 3,
                "{label} {tolerance}: {refused} of {pairs}"
            );
            // sizes are powers of two apart, and the last ten are kept
            let factorizations = simulator.factorizations();
            assert!(
                factorizations <= 24,
                "{label} {tolerance}: {factorizations}"
            );
            // two steps, once more for a refused pair, half as many for the estimate, and the start
            let solves = 3 * pairs + 2 * refused + 1;
            assert_eq!(simulator.stage_solves(), solves);
        }
    }
}

/// A communication step of any size ends exactly, its internal steps are no larger than `time.step`, and add up.
#[test]
fn communication_steps_end_exactly() {
    let mut simulator = start(&paper(
        16,
        &[
            ("time.step", "0.03"),
            ("time.tolerance", "1e-4"),
            ("history.capacity", "4096"),
        ],
    ));
    let mut ends = vec![0.0];
    for h in [0.1, 0.03, 0.06, 0.0001, 0.25, 1e-9, 0.0600001, 1.0] {
        simulator.set_inputs(&[-0.3 - h]).unwrap();
        let end = simulator.time() + h;
        simulator.do_step(simulator.time(), h).unwrap();
        assert_eq!(simulator.time(), end);
        ends.push(end);
    }
    let past: Vec<f64> = simulator.slip_history(0).unwrap().map(|p| p.time).collect();
    assert_eq!(past.len() as u64, simulator.internal_steps() + 1);
    assert!(
        past.windows(2)
            .all(|t| t[1] > t[0] && t[1] - t[0] < 0.03 * (1.0 + 1e-9))
    );
    let is_recorded = |end: &f64| past.iter().any(|t| (t - end).abs() <= 1e-15 * end);
    assert!(ends.iter().all(is_recorded));
}

/// Schemes of second order take steps of like size: also the one whose stages have means only.
#[test]
fn the_midpoint_rule_takes_as_many_steps_as_the_trapezoid() {
    let steps = |scheme: &str| {
        let overrides = [("time.tolerance", "1e-4"), ("time.scheme", scheme)];
        let mut simulator = start(&paper(16, &overrides));
        for n in 0..8 {
            let h = 0.125;
            simulator.do_step(f64::from(n) * h, h).unwrap();
        }
        simulator.internal_steps() as f64
    };
    let (trapezoid, midpoint) = (steps("trapezoid"), steps("midpoint"));
    assert!(trapezoid > 16.0);
    assert!(midpoint < 1.5 * trapezoid, "{midpoint} {trapezoid}");
}

/// The proposed size is carried over: many small communication steps are not each begun by refusals.
#[test]
fn small_communication_steps_are_not_refused_again_and_again() {
    let mut simulator = start(&paper(16, &[("time.tolerance", "1e-5")]));
    for n in 0..256 {
        simulator
            .do_step(f64::from(n) / 256.0, 1.0 / 256.0)
            .unwrap();
    }
    assert!(
        simulator.refused_pairs() <= 16,
        "{}",
        simulator.refused_pairs()
    );
}

/// Backward Euler cannot do 1e-9: the smallest step is refused with its numbers, and the state stays.
/// The size of the next internal step does not begin at that of a communication step of next to nothing.
#[test]
fn a_communication_step_of_next_to_nothing_costs_nothing_later() {
    let mut simulator = start(&paper(16, &[("time.tolerance", "1e-3")]));
    let tiny = 7.5e-322;
    simulator.do_step(0.0, tiny).unwrap();
    simulator.do_step(tiny, 0.05).unwrap();
    // sizes double from 2^-29 of the largest at least
    assert!(
        simulator.internal_steps() < 150,
        "{}",
        simulator.internal_steps()
    );
}

#[test]
fn out_of_reach_is_an_error() {
    let friction = json!({"law": "tresca", "bound": 0.1});
    let time = json!({"scheme": "backward_euler", "step": 1e3, "tolerance": 1e-9});
    let mut simulator = started(compile(&scene(&column(friction, time))).unwrap());
    simulator.set_inputs(&[0.7]).unwrap();
    let before = simulator.to_bytes();
    let error = simulator.do_step(0.0, 1e3).unwrap_err();
    assert_eq!(error.code(), ErrorCode::ToleranceOutOfReach);
    let Error::ToleranceOutOfReach { step, excess, .. } = error else {
        panic!("{error}")
    };
    assert!(
        (1.0..2.0).contains(&(step / (1e3 * 2.0_f64.powi(-30)))),
        "{step:e}"
    );
    assert!(excess > 1.0 && excess.is_finite());
    assert!(error.to_string().contains("time.tolerance = 1e-9"));
    assert!(simulator.to_bytes() == before);
}

/// Friction that does not converge with a large step is tried with a smaller one.
#[test]
fn pairs_that_do_not_converge_are_refused() {
    let scene = |more: &[(&str, &str)]| {
        let solver = r#"{"kind": "fixed_point", "max_iterations": 25}"#;
        let given = [("fidelity.solver", solver), ("time.start", "zero")];
        paper(32, &[&given, more].concat())
    };
    let run = |simulator: &mut Simulator| {
        (0..32).try_for_each(|n| simulator.do_step(f64::from(n) / 32.0, 1.0 / 32.0))
    };
    let mut equal = start(&scene(&[]));
    assert!(matches!(run(&mut equal), Err(Error::NotConverged { .. })));
    let mut chosen = start(&scene(&[("time.tolerance", "1e-2")]));
    run(&mut chosen).unwrap();
    assert!(value(&chosen, "contact.slip_rate").is_finite());
}
