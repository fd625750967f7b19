//! Order in time of every scheme on one mesh (h = 1/16), the error the largest over the steps in the strain norm, against
//! a run with 2048 steps. The figures are those of an independent numpy/scipy solver.

mod common;

use common::{larger, paper, started, steps, strain_norm};
use std::sync::Arc;
use stickslip::Compilation;

const FINE: usize = 2048;
const COUNTS: [usize; 6] = [4, 8, 16, 32, 64, 128];

/// Displacement fields at all instants of a run with `count` steps.
fn run(scheme: &str, start: &str, count: usize) -> (Compilation, Vec<Vec<f64>>) {
    let step = (1.0 / count as f64).to_string();
    let scene = paper(
        16,
        &[
            ("time.scheme", scheme),
            ("time.start", start),
            ("time.step", &step),
            ("fidelity.model", "condensed"),
            ("history.capacity", "0"),
        ],
    );
    let compilation = Compilation::new(&scene).unwrap();
    let mut simulator = started(Arc::clone(&compilation.model));
    let mut fields = vec![simulator.state().displacement().to_vec()];
    for _ in 0..count {
        steps(&mut simulator, 1.0 / count as f64, 1);
        fields.push(simulator.state().displacement().to_vec());
    }
    (compilation, fields)
}

/// Largest error over the steps for every number of steps.
fn errors(scheme: &str, start: &str, counts: &[usize]) -> Vec<f64> {
    let (compilation, fine) = run("trapezoid", "consistent", FINE);
    counts
        .iter()
        .map(|&count| {
            let (_, coarse) = run(scheme, start, count);
            coarse
                .iter()
                .enumerate()
                .map(|(i, field)| {
                    let exact = &fine[i * FINE / count];
                    let error: Vec<f64> = field.iter().zip(exact).map(|(a, b)| a - b).collect();
                    strain_norm(&compilation, &error)
                })
                .fold(0.0, larger)
        })
        .collect()
}

fn order(errors: &[f64]) -> f64 {
    let [.., before, last] = errors else {
        panic!("two errors are needed")
    };
    (before / last).log2()
}

fn assert_close(found: &[f64], expected: &[f64]) {
    for (found, expected) in found.iter().zip(expected) {
        assert!(
            (found / expected - 1.0).abs() < 0.05,
            "found {found:e}, expected {expected:e}"
        );
    }
}

#[test]
fn trapezoid_with_consistent_start_is_second_order() {
    let found = errors("trapezoid", "consistent", &COUNTS);
    assert_close(
        &found,
        &[2.75e-2, 7.90e-3, 1.69e-3, 4.23e-4, 1.04e-4, 2.57e-5],
    );
    assert!(order(&found) > 1.9, "{found:?}");
}

#[test]
fn trapezoid_with_zero_start_is_first_order() {
    let found = errors("trapezoid", "zero", &COUNTS);
    assert_close(
        &found,
        &[6.81e-2, 5.61e-2, 3.68e-2, 2.12e-2, 1.14e-2, 5.89e-3],
    );
    assert!((0.85..1.1).contains(&order(&found)), "{found:?}");
}

#[test]
fn backward_euler_is_first_order() {
    let found = errors("backward_euler", "consistent", &COUNTS);
    assert_close(
        &found,
        &[3.68e-2, 2.50e-2, 1.45e-2, 7.87e-3, 4.12e-3, 2.12e-3],
    );
    assert!((0.85..1.1).contains(&order(&found)), "{found:?}");
}

#[test]
fn tr_bdf2_is_second_order() {
    let found = errors("tr_bdf2", "consistent", &COUNTS);
    assert!(order(&found) > 1.9, "{found:?}");
}

#[test]
fn rectangle_is_first_order_where_it_is_stable() {
    let found = errors("rectangle", "consistent", &COUNTS[2..]);
    assert!((0.85..1.15).contains(&order(&found)), "{found:?}");
}

/// The quadrature grows a mode of rate r once k r > 2: k = 1/4 is beyond 2 / 14.56 = 0.137, k = 1/8 is not.
#[test]
fn rectangle_blows_up_beyond_its_stability_limit() {
    let scene = |step: &str, until: usize| {
        let rectangle = [
            ("time.scheme", "rectangle"),
            ("time.force", "true"),
            ("time.step", step),
        ];
        let scene = paper(16, &rectangle);
        let model = stickslip::compile(&scene).unwrap();
        let limit = model.stability_limit().unwrap();
        assert!((limit - 2.0 / 14.560_439_56).abs() < 1e-6, "{limit}");
        let mut simulator = started(model);
        steps(&mut simulator, scene.time.step, until);
        common::largest(&common::values(&simulator, "contact.slip"))
    };
    assert!(scene("0.125", 160) < 0.2);
    assert!(scene("0.25", 80) > 1e3);
}
