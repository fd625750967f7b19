//! Fronts between stick and slip that move over many nodes in one step: the iterations do not grow with the nodes.

mod common;

use common::{paper, start, value};
use stickslip::Simulator;

/// A pressure that swings once in six steps, on flat cells: in most steps the front crosses a large part of the contact.
fn swing(simulator: &mut Simulator, count: u32) -> Vec<f64> {
    (1..=count)
        .map(|n| {
            let t = f64::from(n - 1) / 32.0;
            let load = if n == 1 {
                -0.3
            } else {
                -0.3 - 0.1 * (32.0 * t).sin()
            };
            simulator.set_inputs(&[load]).unwrap();
            simulator.do_step(simulator.time(), 1.0 / 32.0).unwrap();
            assert!(
                value(simulator, "solver.residual") <= 1e-10
                    || simulator.residual_at_rounding().is_some()
            );
            value(simulator, "solver.iterations")
        })
        .collect()
}

#[test]
fn iterations_do_not_grow_with_the_nodes() {
    for (cells, count) in [(96, 24), (192, 24), (384, 24), (1024, 8)] {
        let scene = paper(
            cells,
            &[
                ("mesh.cells", &format!("[{cells}, 4]")),
                ("fidelity.model", "condensed"),
            ],
        );
        let mut simulator = start(&scene);
        let iterations = swing(&mut simulator, count);
        let (most, sum) = iterations
            .iter()
            .fold((0.0_f64, 0.0), |(most, sum), i| (most.max(*i), sum + i));
        let mean = sum / f64::from(count);
        assert!(
            most <= 30.0 && most <= 3.0 * mean,
            "{cells} cells: {iterations:?}"
        );
    }
}

/// The solution is that of the plain iteration, which is left alone on fewer nodes than the cascade begins at: the tip of a flat
/// body on 32 and 256 cells along its length agrees to the error of the mesh.
#[test]
fn solution_is_the_same_branch() {
    let tip = |cells: u32| {
        let scene = paper(cells, &[("mesh.cells", &format!("[{cells}, 4]"))]);
        let mut simulator = start(&scene);
        swing(&mut simulator, 24);
        value(&simulator, "tip.displacement")
    };
    let (coarse, fine) = (tip(32), tip(256));
    assert!((coarse / fine - 1.0).abs() < 5e-3, "{coarse} {fine}");
}
