//! Where rounding keeps the friction law from holding to the tolerance, the step is taken, with a note and the residual reached.

mod common;

use common::{paper, start, value};

/// Cells drawn to the corners by the third power and one row of four: their aspect reaches 3e4, the forces of the body
/// cancel to 1e-7 of what each node contributes, and the law holds to some 1e-9 of the forces that meet.
#[test]
fn strongly_graded_cells() {
    let scene = paper(
        64,
        &[
            ("mesh.cells", "[64, 4]"),
            ("mesh.grading", "[3, 1]"),
            ("fidelity.model", "auto"),
        ],
    );
    let mut simulator = start(&scene);
    let mut noted = 0;
    for n in 0..32 {
        simulator.do_step(simulator.time(), 1.0 / 32.0).unwrap();
        let residual = value(&simulator, "solver.residual");
        match simulator.residual_at_rounding() {
            Some(reached) => {
                assert_eq!(reached, residual);
                assert!(
                    residual > 1e-10 && residual <= 1e-8,
                    "step {n}: {residual:e}"
                );
                noted += 1;
            }
            None => assert!(residual <= 1e-10, "step {n}: {residual:e}"),
        }
    }
    assert!(noted > 0);
}

/// No note where the tolerance is met, however fast the nodes slip under forces far above their bounds.
#[test]
fn no_note_without_need() {
    for load in ["-0.3", "-3e5"] {
        let mut simulator = start(&paper(16, &[("loads[0].start", load)]));
        for _ in 0..32 {
            simulator.do_step(simulator.time(), 1.0 / 32.0).unwrap();
            assert_eq!(simulator.residual_at_rounding(), None);
            assert!(value(&simulator, "solver.residual") <= 1e-10);
        }
    }
}
