//! The port matrix of a reduced model in single precision: what it saves, and what it costs in accuracy.

mod common;

use common::{larger, paper, start, value, values};
use stickslip::{Error, Model, Scene, Simulator, compile};

const SINGLE: (&str, &str) = ("fidelity.precision", "single");

fn scene(precision: &str, tolerance: &str) -> Scene {
    paper(
        32,
        &[
            ("fidelity.model", "reduced"),
            ("fidelity.precision", precision),
            ("fidelity.tolerance", tolerance),
        ],
    )
}

/// Largest difference of the run of the paper from that of the whole mesh, relative to the largest value: slip rate, stress.
fn errors(scene: &Scene) -> [f64; 2] {
    const PORTS: [&str; 2] = ["contact.slip_rate", "contact.tangential_stress"];
    let mut whole = start(&paper(32, &[("fidelity.model", "full")]));
    let mut reduced = start(scene);
    let (mut off, mut scale) = ([0.0_f64; 2], [0.0_f64; 2]);
    for _ in 0..32 {
        common::steps(&mut whole, 1.0 / 32.0, 1);
        common::steps(&mut reduced, 1.0 / 32.0, 1);
        for (i, port) in PORTS.into_iter().enumerate() {
            for (a, b) in values(&reduced, port).iter().zip(values(&whole, port)) {
                off[i] = larger(off[i], (a - b).abs());
                scale[i] = scale[i].max(b.abs());
            }
        }
    }
    [off[0] / scale[0], off[1] / scale[1]]
}

/// Down to 1e-6 the reduction is as accurate as in double precision, with half the memory and no more states.
#[test]
fn single_precision_keeps_what_it_promises() {
    for (tolerance, slip_rate, stress) in [("1e-5", 3e-7, 8e-5), ("1e-6", 3e-7, 8e-6)] {
        let found = errors(&scene("single", tolerance));
        assert!(
            found[0] <= slip_rate && found[1] <= stress,
            "{tolerance}: {found:?}"
        );
    }
    let [single, double] = ["single", "double"].map(|p| compile(&scene(p, "1e-6")).unwrap());
    let [a, b] = [&single, &double].map(|model| model.states());
    assert!(a <= b, "{a} states instead of {b}");
    let [a, b] = [&single, &double].map(|model| model.summary().bytes as f64);
    assert!(a < 0.6 * b, "{a} of {b} bytes");
}

/// What single precision cannot hold is refused, and says what could be had.
#[test]
fn tolerance_below_the_rounding_is_refused() {
    match compile(&scene("single", "1e-8")) {
        Err(Error::ReductionInaccurate { achieved, .. }) => {
            assert!((1e-8..1e-5).contains(&achieved), "{achieved:e}");
        }
        other => panic!("{:?}", other.map(|model| model.states())),
    }
}

/// A model without a port matrix does not silently ignore the wish.
#[test]
fn only_for_reduced_models() {
    for kind in ["full", "condensed", "auto"] {
        let text = stickslip::scene::example("kazmi2014").unwrap();
        let overrides = [("fidelity.model", kind), SINGLE].map(|(p, v)| (p.into(), v.into()));
        let refusal = Scene::with_overrides(text, "kazmi2014", &overrides).unwrap_err();
        assert!(
            refusal.to_string().contains("fidelity.precision"),
            "{refusal}"
        );
    }
}

#[test]
fn model_round_trips_as_bytes() {
    let model = compile(&scene("single", "1e-5")).unwrap();
    let bytes = model.to_bytes();
    let again = std::sync::Arc::new(Model::from_bytes(&bytes).unwrap());
    assert_eq!(again.to_bytes(), bytes);
    let [a, b] = [model, again].map(|model| {
        let mut simulator: Simulator = common::started(model);
        common::steps(&mut simulator, 0.01, 20);
        assert!(value(&simulator, "solver.residual") <= 1e-10);
        simulator.state().to_bytes()
    });
    assert_eq!(a, b);
}
