//! Work of the friction solvers: how often a matrix of contact order is factored, how often it is solved with, and what bounds
//! it.

mod common;

use common::{paper, start, value};
use stickslip::Simulator;
use stickslip::contact::solve::newton::Work;

/// Work, and Newton steps, of one step.
fn step(simulator: &mut Simulator, size: f64) -> (Work, f64) {
    let before = simulator.friction_work();
    simulator.do_step(simulator.time(), size).unwrap();
    let after = simulator.friction_work();
    let work = Work {
        factorizations: after.factorizations - before.factorizations,
        solves: after.solves - before.solves,
        products: after.products - before.products,
    };
    (work, value(simulator, "solver.iterations"))
}

/// The run of the paper, in which three quarters of the contact begin to stick: a factorization in two steps or fewer, and
/// hardly one where the front rests; the other Newton steps are solves with a factor that is at hand.
#[test]
fn run_of_the_paper() {
    for cells in [32, 64, 128] {
        let mut simulator = start(&paper(cells, &[]));
        let steps: Vec<_> = (0..32).map(|_| step(&mut simulator, 1.0 / 32.0)).collect();
        let factorizations: u64 = steps.iter().map(|(work, _)| work.factorizations).sum();
        assert!(factorizations <= 18, "{cells}: {factorizations}");
        for (n, (work, iterations)) in steps.iter().enumerate() {
            assert!(work.solves <= 16, "{cells}, step {n}: {work:?}");
            // a direction is solved for again only when a node would start backwards, or from a new matrix
            assert!(work.solves as f64 <= iterations + 4.0, "{cells}, step {n}");
        }
        let late: u64 = steps[24..]
            .iter()
            .map(|(work, _)| work.factorizations)
            .sum();
        assert!(late <= 1, "{cells}: {late}");
    }
}

/// Where everything slips, and the node at the corner reverses once in a while, the matrix of the first step serves the whole run.
#[test]
fn slip_everywhere() {
    for cells in [64, 128] {
        let bound = [
            ("contact.friction.a", "3e-6"),
            ("contact.friction.b", "1e-6"),
        ];
        let mut simulator = start(&paper(cells, &bound));
        // the first step of its size
        step(&mut simulator, 1.0 / 32.0);
        let steps = (1..32).map(|_| step(&mut simulator, 1.0 / 32.0));
        let factorizations: u64 = steps.map(|(work, _)| work.factorizations).sum();
        assert_eq!(factorizations, 0, "{cells} cells");
        assert_eq!(value(&simulator, "contact.stick_fraction"), 0.0);
    }
}

/// A jittering step size costs no factorization once the few sizes are known, and a simulator that takes over a saved state
/// makes its one matrix anew, to the same bits.
#[test]
fn sizes_and_restored_states() {
    let model = stickslip::compile(&paper(32, &[])).unwrap();
    let mut simulator = common::started(std::sync::Arc::clone(&model));
    let sizes = [1.0 / 64.0, 1.0 / 32.0];
    for n in 0..40 {
        step(&mut simulator, sizes[n % 2]);
    }
    let saved = simulator.state().clone();
    let more: Vec<_> = (0..8)
        .map(|n| step(&mut simulator, sizes[n % 2]).0)
        .collect();
    assert!(more.iter().all(|work| work.factorizations == 0), "{more:?}");

    let mut other = common::started(model);
    other.restore(&saved).unwrap();
    let again: Vec<_> = (0..8).map(|n| step(&mut other, sizes[n % 2]).0).collect();
    assert_eq!(again.iter().map(|work| work.factorizations).sum::<u64>(), 2);
    assert_eq!(simulator.state().to_bytes(), other.state().to_bytes());
}

/// Steps of a contact that slips, sticks and opens, and how each ended.
fn ends(limit: Option<&str>, overrides: &[(&str, &str)]) -> (Vec<f64>, Vec<(f64, Option<f64>)>) {
    let mut overrides = overrides.to_vec();
    overrides.extend(limit.map(|limit| ("fidelity.work_limit", limit)));
    let mut simulator = start(&paper(32, &overrides));
    let mut outputs = vec![0.0; simulator.output_len()];
    let ends = (0..48_u32).map(|n| {
        let load = 0.4 * (0.5 * f64::from(n)).sin() - 0.1;
        simulator.set_inputs(&[load]).unwrap();
        simulator.do_step(simulator.time(), 1.0 / 32.0).unwrap();
        let residual = value(&simulator, "solver.residual");
        match simulator.truncated_residual() {
            Some(reached) => assert_eq!(reached, residual),
            None => assert!(residual <= 1e-10, "{residual:e}"),
        }
        (
            value(&simulator, "solver.iterations"),
            simulator.truncated_residual(),
        )
    });
    let ends = ends.collect();
    simulator.get_outputs(&mut outputs).unwrap();
    (outputs, ends)
}

/// A limit that is enough changes nothing. One that is not is never exceeded, and steps that it ends say so.
#[test]
fn a_limit_of_work_ends_steps_at_their_best_iterate() {
    let unilateral = r#"{"kind": "unilateral"}"#;
    let coulomb = r#"{"law": "coulomb", "coefficient": 0.3}"#;
    let pressed = [
        ("contact.condition", unilateral),
        ("time.scheme", "auto"),
        ("contact.friction", coulomb),
    ];
    for overrides in [&[][..], &pressed] {
        let (free, all) = ends(None, overrides);
        let needed = all
            .iter()
            .fold(0.0, |most: f64, (count, _)| most.max(*count));
        assert!(needed >= 3.0, "{needed}");
        let (enough, unnoted) = ends(Some("100000"), overrides);
        assert_eq!(enough, free);
        assert!(unnoted.iter().all(|(_, residual)| residual.is_none()));
        for limit in [1.0, 2.0] {
            let (_, noted) = ends(Some(&format!("{limit}")), overrides);
            assert!(noted.iter().all(|(count, _)| *count <= limit));
            let residuals: Vec<f64> = noted.iter().filter_map(|(_, r)| *r).collect();
            assert!(!residuals.is_empty(), "{overrides:?} {limit}");
            assert!(residuals.iter().all(|r| *r > 1e-10 && r.is_finite()));
        }
    }
}

/// The search for other solutions runs with pressure, and changes no result.
#[test]
fn a_search_for_other_solutions_changes_nothing() {
    let pressed = [
        ("contact.condition", r#"{"kind": "unilateral"}"#),
        ("time.scheme", "auto"),
        (
            "contact.friction",
            r#"{"law": "coulomb", "coefficient": 0.3}"#,
        ),
    ];
    let run = |test: &str| {
        let mut overrides = pressed.to_vec();
        overrides.push(("fidelity.multiplicity_test", test));
        let mut simulator = start(&paper(16, &overrides));
        common::steps(&mut simulator, 1.0 / 32.0, 16);
        simulator
    };
    let (with, without) = (run("true"), run("false"));
    assert_eq!(value(&with, "solver.solutions"), 1.0);
    assert_eq!(value(&without, "solver.solutions"), 0.0);
    for port in ["contact.slip_rate", "contact.pressure", "contact.gap"] {
        assert_eq!(common::values(&with, port), common::values(&without, port));
    }
}
