//! The run of a scene on its own signals: jumps, and runs that would not end.

mod common;

use common::{paper, relative, values};
use stickslip::scene::Signal;
use stickslip::simulator::course::Points;
use stickslip::simulator::drive::Drive;
use stickslip::{Scene, Simulator, compile};

fn with_signal(mut scene: Scene, table: &[[f64; 2]]) -> Scene {
    let signal = Signal::Table(table.to_vec());
    scene.run.signals.insert("press".to_owned(), signal);
    scene.validate("test").unwrap();
    scene
}

/// Runs a scene and shows its simulator at every communication point, jumps included.
fn run(scene: &Scene, mut watch: impl FnMut(&Simulator)) -> Simulator {
    let mut simulator = Simulator::new(compile(scene).unwrap());
    let mut drive = Drive::start(scene, &mut simulator).unwrap();
    while let Some(simulator) = drive.step().unwrap() {
        watch(simulator);
    }
    simulator
}

/// A run that is taken up again from a saved state ends with the same bits, also where it was left at a jump.
#[test]
fn a_run_is_taken_up_again_from_a_saved_state() {
    let table = [[0.0, -0.3], [0.17, -0.3], [0.17, -0.1], [1.0, -0.4]];
    let scene = with_signal(paper(8, &[("time.step", "0.1")]), &table);
    let whole = run(&scene, |_| {});
    assert!(whole.get_by_name("contact.max_slip_rate").unwrap()[0] > 0.0);
    for stop in 1..12 {
        let mut first = Simulator::new(compile(&scene).unwrap());
        let mut drive = Drive::start(&scene, &mut first).unwrap();
        for _ in 0..stop {
            drive.step().unwrap();
        }
        let mut second = Simulator::new(compile(&scene).unwrap());
        assert!(Drive::resume(&scene, &mut second).is_err());
        second.restore(first.state()).unwrap();
        let mut drive = Drive::resume(&scene, &mut second).unwrap();
        while drive.step().unwrap().is_some() {}
        assert_eq!(
            second.to_bytes(),
            whole.to_bytes(),
            "left after {stop} steps"
        );
    }
}

/// Levels with jumps between them are what held inputs are: the same bits at every communication point.
#[test]
fn levels_are_held_inputs() {
    // between communication points, on one (3 * 0.1 is not 0.3), and two within a step
    let table = [
        [0.0, -0.3],
        [0.17, -0.3],
        [0.17, -0.1],
        [0.3, -0.1],
        [0.3, -0.4],
        [0.52, -0.4],
        [0.52, -0.2],
        [0.56, -0.2],
        [0.56, -0.25],
        [1.0, -0.25],
    ];
    for changes in [
        vec![],
        vec![("time.scheme", "tr_bdf2")],
        vec![("time.scheme", "backward_euler")],
        vec![("time.tolerance", "1e-3")],
        vec![("time.error_estimate", "true")],
    ] {
        let mut changes = changes;
        changes.extend([
            ("run.step", "0.1"),
            ("run.until", "0.7"),
            ("time.step", "0.03125"),
        ]);
        let scene = with_signal(paper(8, &changes), &table);
        changes.push(("loads[0].interpolation", "hold"));
        let mut held = Simulator::new(compile(&paper(8, &changes)).unwrap());
        held.set_inputs(&[-0.3]).unwrap();
        held.init(0.0).unwrap();
        let mut times = Vec::new();
        run(&scene, |simulator| {
            let from = held.time();
            let level = table.iter().rev().find(|p| p[0] <= from).unwrap()[1];
            held.set_inputs(&[level]).unwrap();
            held.do_step(from, simulator.time() - from).unwrap();
            let of = |s: &Simulator| values(s, "contact.slip_rate");
            assert_eq!(of(simulator), of(&held), "{changes:?} at {}", held.time());
            assert_eq!(
                values(simulator, "contact.slip"),
                values(&held, "contact.slip")
            );
            times.push(simulator.time());
        });
        let expected = [0.1, 0.17, 0.2, 0.3, 0.4, 0.5, 0.52, 0.56, 0.6, 0.7];
        assert!(relative(&times, &expected) < 1e-15, "{times:?}");
        assert!(values(&held, "contact.slip").iter().any(|s| *s != 0.0));
    }
}

/// A ramp that ends in a jump keeps the order of the scheme: the step before it ends with the load before it.
#[test]
fn a_jump_keeps_the_order_of_the_scheme() {
    let table = [[0.0, 0.0], [0.55, -0.3], [0.55, 0.1], [1.0, -0.1]];
    let end = |step: &str| {
        let changes = [
            ("contact.friction", r#"{"law": "frictionless"}"#),
            ("time.step", step),
            ("run.step", step),
        ];
        values(
            &run(&with_signal(paper(4, &changes), &table), |_| ()),
            "tip.displacement",
        )
    };
    let exact = end("0.0015625");
    let errors = ["0.1", "0.05", "0.025"].map(|step| relative(&end(step), &exact));
    for pair in errors.windows(2) {
        assert!(pair[0] / pair[1] > 3.5, "{errors:?}");
    }
    assert!(errors[2] < 5e-3, "{errors:?}");
}

/// A run of more than 1e9 steps is refused with their number, before it begins.
#[test]
fn runs_without_end_are_refused() {
    for (changes, steps, path) in [
        (
            vec![("time.step", "1e-300"), ("run.until", "0.1")],
            "1.0e299 steps of time.step = 1e-300",
            "found 0.1",
        ),
        (
            vec![("run.until", "1e300")],
            "steps of time.step = 0.03125",
            "found 1e300",
        ),
        (
            vec![("run.step", "1e-12")],
            "1.0e12 steps of run.step = 1e-12",
            "found 1",
        ),
        (
            vec![("run.step", "1e300"), ("run.until", "1e300")],
            "3.2e301 steps of time.step",
            "found 1e300",
        ),
        (
            vec![("run.step", "1e-300"), ("run.until", "1e300")],
            "1.8e308 steps of run.step",
            "found 1e300",
        ),
    ] {
        let error = Points::checked(&paper(4, &changes))
            .unwrap_err()
            .to_string();
        for part in [steps, path, "at run.until", "at most 1e9 steps"] {
            assert!(error.contains(part), "{part}: {error}");
        }
    }
    let long = paper(4, &[("run.until", "31250000")]);
    assert_eq!(Points::checked(&long).unwrap().count, 1_000_000_000);
}

/// Texts of users and numbers in errors: short, escaped, in their shortest form.
#[test]
fn a_step_that_does_not_move_the_time_says_so() {
    let mut simulator = Simulator::new(compile(&paper(4, &[])).unwrap());
    simulator.init(0.5).unwrap();
    let error = simulator.do_step(0.5, 5e-17).unwrap_err().to_string();
    assert!(
        error.contains("resolution of the time") && error.contains("5e-17"),
        "{error}"
    );
    assert!(error.contains("1.1102230246251565e-16"), "{error}");
    let error = simulator.do_step(0.25, 0.1).unwrap_err().to_string();
    assert!(error.contains("expected 0.5, found 0.25"), "{error}");
    let error = simulator.do_step(0.5, 1e300).unwrap_err().to_string();
    assert!(error.contains("found 1e300"), "{error}");
}

/// Differences of communication points far from 0 are one step each, of the same size: one factorization serves them all.
#[test]
fn fixed_rates_far_from_zero_take_one_internal_step_each() {
    for (step, start) in [
        (1e-3, 65_536.0),
        (1e-3, 1e6),
        (1.0 / 60.0, 131_072.0),
        (0.05, 1.7e9),
    ] {
        let text = format!("{step:?}");
        for changes in [
            vec![("time.step", text.as_str())],
            vec![
                ("time.step", text.as_str()),
                ("time.error_estimate", "true"),
            ],
        ] {
            let mut simulator = Simulator::new(compile(&paper(4, &changes)).unwrap());
            let first = (start / step) as i64;
            let at = |i: i64| (first + i) as f64 * step;
            simulator.init(at(0)).unwrap();
            for i in 0..1000 {
                simulator.do_step(at(i), at(i + 1) - at(i)).unwrap();
            }
            assert_eq!(simulator.internal_steps(), 1000, "{step} from {start}");
            assert!(
                simulator.factorizations() <= 4,
                "{}",
                simulator.factorizations()
            );
        }
    }
}
