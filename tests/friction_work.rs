//! Work of the default friction solver: how often a matrix of contact order is factored, and how often it is solved with.

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
