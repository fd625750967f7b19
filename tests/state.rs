//! State: saved and restored bit for bit, untouched by a failed step, refused when damaged, the same on every thread.

mod common;

use common::{paper, start, started, steps, value, values};
use std::sync::Arc;
use stickslip::{Error, Simulator, compile};

/// A load and a step size that change from step to step.
fn drive(simulator: &mut Simulator, n: u32) {
    simulator
        .set_inputs(&[-0.3 + 0.25 * f64::from(n).sin()])
        .unwrap();
    let step = 0.004 * f64::from(1 + n % 9);
    simulator.do_step(simulator.time(), step).unwrap();
}

fn outputs(simulator: &Simulator) -> Vec<u64> {
    let mut out = vec![0.0; simulator.output_len()];
    simulator.get_outputs(&mut out).unwrap();
    out.iter().map(|v| v.to_bits()).collect()
}

#[test]
fn restored_run_is_the_same_run() {
    const EQUAL: (&str, &str) = ("time.error_estimate", "false");
    const ESTIMATED: (&str, &str) = ("time.error_estimate", "true");
    const CHOSEN: (&str, &str) = ("time.tolerance", "1e-4");
    for (scheme, model, steps) in [
        ("trapezoid", "reduced", EQUAL),
        ("tr_bdf2", "reduced", EQUAL),
        ("trapezoid", "condensed", EQUAL),
        ("backward_euler", "full", EQUAL),
        ("trapezoid", "reduced", ESTIMATED),
        ("trapezoid", "reduced", CHOSEN),
        ("tr_bdf2", "condensed", CHOSEN),
        ("backward_euler", "reduced", ("time.tolerance", "1e-2")),
    ] {
        let given = [("time.scheme", scheme), ("fidelity.model", model), steps];
        let scene = paper(16, &given);
        let model = compile(&scene).unwrap();
        let mut original = started(Arc::clone(&model));
        (0..7).for_each(|n| drive(&mut original, n));
        let mut saved = original.state().clone();
        original.save(&mut saved).unwrap();
        let bytes = original.to_bytes();

        let mut by_memory = Simulator::new(Arc::clone(&model));
        by_memory.restore(&saved).unwrap();
        let mut by_bytes = Simulator::new(compile(&scene).unwrap());
        by_bytes.restore_bytes(&bytes).unwrap();
        for n in 7..40 {
            drive(&mut original, n);
            drive(&mut by_memory, n);
            drive(&mut by_bytes, n);
            assert_eq!(outputs(&original), outputs(&by_memory));
            assert_eq!(outputs(&original), outputs(&by_bytes));
            assert!(original.state() == by_bytes.state());
        }
        // back in time, and forward again
        let end = original.to_bytes();
        original.restore(&saved).unwrap();
        (7..40).for_each(|n| drive(&mut original, n));
        assert!(original.to_bytes() == end);
    }
}

#[test]
fn failed_step_leaves_the_state() {
    // Problem 7.4 takes 14 iterations on average over this run, and more than 25 near the transition from slip to stick
    let solver = r#"{"kind": "fixed_point", "max_iterations": 25}"#;
    let mut simulator = start(&paper(
        32,
        &[("fidelity.solver", solver), ("time.start", "zero")],
    ));
    let (before, error) = loop {
        assert!(simulator.time() < 1.0, "every step converged");
        let before = simulator.to_bytes();
        if let Err(error) = simulator.do_step(simulator.time(), 0.03125) {
            break (before, error);
        }
    };
    let Error::NotConverged {
        iterations, time, ..
    } = error
    else {
        panic!("{error}")
    };
    assert_eq!((iterations, time), (25, simulator.time()));
    assert!(simulator.to_bytes() == before);
    // a smaller step goes on from there
    simulator.do_step(simulator.time(), 0.001).unwrap();
}

#[test]
fn illegal_calls_change_nothing() {
    let scene = paper(8, &[]);
    let mut simulator = Simulator::new(compile(&scene).unwrap());
    let fresh = simulator.to_bytes();
    assert!(matches!(
        simulator.do_step(0.0, 0.1),
        Err(Error::CallOrder { .. })
    ));
    assert!(matches!(simulator.init(f64::NAN), Err(Error::Value { .. })));
    assert!(matches!(
        simulator.set_inputs(&[]),
        Err(Error::Length {
            expected: 1,
            found: 0,
            ..
        })
    ));
    assert!(simulator.to_bytes() == fresh);
    simulator.init(2.0).unwrap();
    let before = simulator.to_bytes();
    assert!(matches!(simulator.init(0.0), Err(Error::CallOrder { .. })));
    for step in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            simulator.do_step(2.0, step),
            Err(Error::Step { .. })
        ));
    }
    for time in [1.9, 2.2, f64::NAN, f64::INFINITY] {
        assert!(
            matches!(simulator.do_step(time, 0.1), Err(Error::Step { .. })),
            "{time}"
        );
    }
    // so small that the time would not advance
    assert!(matches!(
        simulator.do_step(2.0, 1e-17),
        Err(Error::Step { .. })
    ));
    assert!(matches!(
        simulator.set_inputs(&[f64::NAN]),
        Err(Error::Value { .. })
    ));
    let port = |name: &str| simulator.model().ports().find(name).unwrap().reference;
    let (output, alpha) = (port("contact.slip"), port("contact.friction.alpha"));
    assert!(matches!(
        simulator.set(output, 1.0),
        Err(Error::CallOrder { .. })
    ));
    assert!(matches!(
        simulator.set(alpha, -1.0),
        Err(Error::Value { .. })
    ));
    assert!(matches!(
        simulator.set(9999, 1.0),
        Err(Error::Unknown { .. })
    ));
    assert!(matches!(
        simulator.get(output, &mut [0.0; 3]),
        Err(Error::Length { .. })
    ));
    assert!(simulator.to_bytes() == before);
    // a time off by rounding is the same instant
    simulator.do_step(2.0 + 1e-15, 0.1).unwrap();
}

#[test]
fn damaged_or_foreign_bytes_are_refused() {
    let mut simulator = start(&paper(8, &[]));
    steps(&mut simulator, 0.03125, 3);
    let good = simulator.to_bytes();
    for length in 0..good.len() {
        assert!(
            simulator.restore_bytes(&good[..length]).is_err(),
            "{length}"
        );
    }
    for at in 0..good.len() {
        let mut bad = good.clone();
        bad[at] ^= 1 << (at % 8);
        assert!(simulator.restore_bytes(&bad).is_err(), "{at}");
    }
    let longer = [good.as_slice(), &[0; 8]].concat();
    assert!(matches!(
        simulator.restore_bytes(&longer),
        Err(Error::Bytes { .. })
    ));
    assert!(simulator.to_bytes() == good);

    let mut other = start(&paper(8, &[("contact.friction.alpha", "99")]));
    assert!(matches!(
        other.restore_bytes(&good),
        Err(Error::Fingerprint { .. })
    ));
    let mut larger = start(&paper(16, &[]));
    assert!(matches!(
        larger.restore(simulator.state()),
        Err(Error::Fingerprint { .. })
    ));
    // what only the command line reads does not make another model
    let mut same = start(&paper(8, &[("run.until", "7")]));
    same.restore_bytes(&good).unwrap();
}

/// 16 simulators of one model on threads, and one after other work: the same bits.
#[test]
fn bits_do_not_depend_on_threads_or_history() {
    let model = compile(&paper(16, &[])).unwrap();
    let run = |model: Arc<stickslip::Model>| {
        let mut simulator = started(model);
        (0..50).for_each(|n| drive(&mut simulator, n));
        simulator.to_bytes()
    };
    let expected = run(Arc::clone(&model));
    let threads: Vec<_> = (0..16)
        .map(|_| {
            let model = Arc::clone(&model);
            std::thread::spawn(move || run(model))
        })
        .collect();
    for thread in threads {
        assert!(thread.join().unwrap() == expected);
    }
    // a workspace full of other step sizes
    let mut used = started(Arc::clone(&model));
    let fresh = used.state().clone();
    (0..20).for_each(|n| {
        used.do_step(used.time(), 0.001 * f64::from(n + 1)).unwrap();
    });
    used.restore(&fresh).unwrap();
    (0..50).for_each(|n| drive(&mut used, n));
    assert!(used.to_bytes() == expected);
    used.reset();
    used.init(0.0).unwrap();
    (0..50).for_each(|n| drive(&mut used, n));
    assert!(used.to_bytes() == expected);
}

#[test]
fn history_keeps_the_last_steps_of_every_node() {
    let mut simulator = start(&paper(8, &[("history.capacity", "5")]));
    let past = |simulator: &Simulator, node: usize| -> Vec<(f64, f64, f64)> {
        let past = simulator.slip_history(node).unwrap();
        past.map(|p| (p.time, p.slip[0], p.tangential_stress[0]))
            .collect()
    };
    assert_eq!(past(&simulator, 0).len(), 1);
    let mut expected = Vec::new();
    for n in 0..12 {
        expected.push((
            simulator.time(),
            values(&simulator, "contact.slip")[7],
            values(&simulator, "contact.tangential_stress")[7],
        ));
        if n < 11 {
            steps(&mut simulator, 0.03125, 1);
        }
    }
    assert_eq!(past(&simulator, 7), expected[expected.len() - 5..]);
    assert!(simulator.slip_history(8).is_err());
}

/// Friction coefficients change between steps; the contact follows at once.
#[test]
fn coefficients_are_tunable() {
    let mut simulator = start(&paper(
        8,
        &[("contact.friction", r#"{"law": "tresca", "bound": 0.001}"#)],
    ));
    steps(&mut simulator, 0.03125, 4);
    let bound = simulator
        .model()
        .ports()
        .find("contact.friction.bound")
        .unwrap()
        .reference;
    simulator.set(bound, 1e6).unwrap();
    assert_eq!(value(&simulator, "contact.friction.bound"), 1e6);
    let slip = values(&simulator, "contact.slip");
    steps(&mut simulator, 0.03125, 4);
    assert_eq!(values(&simulator, "contact.slip"), slip);
    assert_eq!(value(&simulator, "contact.stick_fraction"), 1.0);
}
