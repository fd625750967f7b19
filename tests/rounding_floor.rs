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

/// A column 485 times as high as wide, under steps of 1e4 s: it slips as a whole, and the forces between its three contact nodes are
/// 1e10 times what holds it back. The last digits of the slip rates are forces above the tolerance, but nothing else is.
#[test]
fn a_tall_body_slips_as_a_whole() {
    let text = include_str!("cases/tall_column.json");
    let mut tried = 0;
    for cuts in [1, 2, 3] {
        let scene = stickslip::Scene::from_json(text, "tall_column").unwrap();
        let step = scene.time.step;
        let mut simulator = start(&scene);
        for load in [0.19968834593675414, -0.24414628961843376] {
            simulator.set_inputs(&[load]).unwrap();
            simulator
                .do_step(simulator.time(), f64::from(cuts) * step)
                .unwrap();
            assert!(value(&simulator, "solver.iterations") < 40.0 * f64::from(cuts));
            let rates = common::values(&simulator, "contact.slip_rate");
            let stresses = common::values(&simulator, "contact.tangential_stress");
            for (w, stress) in rates.iter().zip(&stresses) {
                if *w != 0.0 {
                    let off = stress / (-0.1096708488366106 * w.signum()) - 1.0;
                    assert!(off.abs() < 1e-12, "{off:e}");
                    tried += 1;
                }
            }
        }
    }
    assert!(tried > 6, "{tried}");
}
