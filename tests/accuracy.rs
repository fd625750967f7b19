//! Accuracy per unknown on the paper's example at t = 1 (k = 1/32): what quadratic elements on a graded or locally refined
//! mesh reach, against the finest mesh of the paper (linear elements, h = 1/256), both measured against a far finer run.

mod common;

use common::accuracy::{End, FINE, REFINED};
use common::{paper, started, steps};
use std::sync::Arc;
use stickslip::Compilation;

fn run(overrides: &[(&str, &str)]) -> End {
    let mut all = vec![("fidelity.model", "condensed")];
    all.extend(overrides);
    let compilation = Compilation::new(&paper(32, &all)).unwrap();
    let mut simulator = started(Arc::clone(&compilation.model));
    simulator.set_inputs(&[-0.3]).unwrap();
    steps(&mut simulator, 1.0 / 32.0, 32);
    End::new(compilation, &simulator)
}

/// The finest mesh of the paper and what a fiftieth of its unknowns can do.
#[test]
fn a_fiftieth_of_the_unknowns_is_as_accurate_as_the_finest_mesh_of_the_paper() {
    let reference = run(&FINE);
    assert!((reference.tip - 0.118_963_34).abs() < 1e-7);

    let uniform = run(&[("mesh.cells", "[256, 128]")]);
    assert_eq!(uniform.dofs(), 132_354);
    let paper = uniform.errors(&reference);
    // 0.11894 against the limit 0.11896
    assert!((1.5e-5..3e-5).contains(&paper.tip), "{paper:?}");

    let graded = run(&[
        ("element", "p2"),
        ("mesh.cells", "[18, 8]"),
        ("mesh.grading", "[2.25, 2.5]"),
    ]);
    let refined = run(&REFINED);
    for run in [&graded, &refined] {
        assert!(50 * run.dofs() <= uniform.dofs());
        assert!(50 * run.compilation.body.len() <= uniform.dofs());
        let found = run.errors(&reference);
        assert!(found.tip < paper.tip, "{found:?} {paper:?}");
        assert!(found.slip_rate < paper.slip_rate, "{found:?} {paper:?}");
        assert!(found.strain < paper.strain, "{found:?} {paper:?}");
    }
    // Within 0.01 m the stress falls from +g to -0.7 g where the stick front stopped. Finer references than this one differ
    // by 2e-3 to 6e-3 from each other there, so errors of that size are alike; a mesh graded to the sides has ten times that.
    let stress = [&uniform, &refined, &graded].map(|run| run.errors(&reference).stress);
    assert!(
        stress[0] < 1e-2 && stress[1] < 1e-2 && stress[2] > 4e-2,
        "{stress:?}"
    );
}
