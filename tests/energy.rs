//! The energy balance of every scheme: external work less elastic energy, viscous and frictional dissipation.
//!
//! | scheme | balance error over the steps |
//! |---|---|
//! | trapezoid, consistent start | rounding |
//! | trapezoid, zero start | `k/2 (F - B u_0) . w` with the mean velocity of the first step: at n = 0 the forces do not balance |
//! | backward Euler | sum of `1/2 du . B du` (dissipated by the scheme) |
//! | rectangle | minus the same (created by the scheme) |
//! | TR-BDF2 | `k w . B (u_b - u_m)` with means over the stages: second order in k |

mod common;

use common::{paper, started, steps, value};
use std::sync::Arc;
use stickslip::{Compilation, Simulator};

fn simulator(overrides: &[(&str, &str)]) -> (Compilation, Simulator) {
    let mut all = vec![("fidelity.friction_tolerance", "1e-12")];
    all.extend_from_slice(overrides);
    let compilation = Compilation::new(&paper(16, &all)).unwrap();
    let simulator = started(Arc::clone(&compilation.model));
    (compilation, simulator)
}

#[test]
fn trapezoid_balances_to_rounding() {
    for model in ["full", "condensed", "reduced"] {
        let (_, mut simulator) = simulator(&[("fidelity.model", model)]);
        for n in 0..200 {
            // loads that change, communication steps that are no multiple of the internal one
            simulator
                .set_inputs(&[-0.3 + 0.2 * f64::from(n).sin()])
                .unwrap();
            steps(&mut simulator, 0.01 + 0.03 * f64::from(n % 7), 1);
            let parts = [
                "energy.elastic",
                "energy.viscous_dissipation",
                "energy.friction_dissipation",
            ]
            .map(|port| value(&simulator, port));
            assert!(parts.iter().all(|p| *p >= 0.0));
            let size: f64 = parts.iter().sum();
            let error = value(&simulator, "energy.balance_error").abs();
            assert!(
                error < 1e-11 * size,
                "{model}, step {n}: {error:e} of {size:e}"
            );
        }
    }
}

#[test]
fn zero_start_misses_half_of_the_work_of_the_first_step() {
    let (_, mut simulator) = simulator(&[("time.start", "zero"), ("fidelity.model", "condensed")]);
    steps(&mut simulator, 0.03125, 1);
    let first = 0.5 * value(&simulator, "energy.external_work");
    for _ in 0..20 {
        let error = value(&simulator, "energy.balance_error");
        assert!((error - first).abs() < 1e-11 * first, "{error:e} {first:e}");
        steps(&mut simulator, 0.03125, 1);
    }
}

#[test]
fn first_order_schemes_lose_or_create_the_quadratic_term() {
    for (scheme, sign) in [("backward_euler", 1.0), ("rectangle", -1.0)] {
        let (compilation, mut simulator) =
            simulator(&[("time.scheme", scheme), ("fidelity.model", "condensed")]);
        let mut expected = 0.0;
        for _ in 0..30 {
            let before = simulator.state().displacement().to_vec();
            steps(&mut simulator, 0.03125, 1);
            let change: Vec<f64> = simulator
                .state()
                .displacement()
                .iter()
                .zip(&before)
                .map(|(a, b)| a - b)
                .collect();
            let (_, quadratic) = compilation.body.operators.product(&change, &change);
            expected += sign * 0.5 * quadratic;
            let error = value(&simulator, "energy.balance_error");
            assert!(
                (error / expected - 1.0).abs() < 1e-9,
                "{scheme}: {error:e} {expected:e}"
            );
        }
    }
}

#[test]
fn tr_bdf2_is_off_by_second_order() {
    let error = |count: u32| {
        let step = 1.0 / f64::from(count);
        let (_, mut simulator) =
            simulator(&[("time.scheme", "tr_bdf2"), ("time.step", &step.to_string())]);
        steps(&mut simulator, step, count as usize);
        value(&simulator, "energy.balance_error").abs() / value(&simulator, "energy.external_work")
    };
    let (coarse, fine) = (error(32), error(64));
    assert!(
        fine < 1e-3 && (coarse / fine).log2() > 1.8,
        "{coarse:e} {fine:e}"
    );
}

/// Work as the master computes it from the ports: intensity times measure times mean velocity, integrated.
#[test]
fn conjugate_ports_close_the_power_balance() {
    let (_, mut simulator) = simulator(&[]);
    let measure = 1.0;
    let mut work = 0.0;
    for _ in 0..32 {
        let before = value(&simulator, "press.displacement");
        steps(&mut simulator, 0.03125, 1);
        work += -0.3 * measure * (value(&simulator, "press.displacement") - before);
    }
    let account = value(&simulator, "energy.external_work");
    assert!((work / account - 1.0).abs() < 1e-12, "{work} {account}");
}
