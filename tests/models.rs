//! The three models of one scene against each other, and what the reduction, the certificate and `auto` report.

mod common;

use common::{paper, relative, start, steps, value, values};
use serde_json::json;
use stickslip::scene::ModelKind;
use stickslip::{Error, compile};

/// Slip rate over a run, one vector after the other.
fn slip_rates(overrides: &[(&str, &str)], count: usize, step: f64) -> (usize, Vec<f64>) {
    let mut simulator = start(&paper(32, overrides));
    let mut all = values(&simulator, "contact.slip_rate");
    for n in 0..count {
        let load = -0.3 + 0.1 * (0.3 * n as f64).sin();
        simulator.set_inputs(&[load]).unwrap();
        steps(&mut simulator, step, 1);
        all.extend(values(&simulator, "contact.slip_rate"));
    }
    (simulator.model().states(), all)
}

#[test]
fn reduced_slip_rate_is_within_ten_tolerances_of_full() {
    for step in [0.004, 0.03125, 0.3] {
        let time = ("time.step", "1");
        let (_, full) = slip_rates(&[time, ("fidelity.model", "full")], 32, step);
        let mut last_states = 0;
        for tolerance in ["1e-4", "1e-6", "1e-8"] {
            let (states, reduced) =
                slip_rates(&[time, ("fidelity.tolerance", tolerance)], 32, step);
            let error = relative(&reduced, &full);
            let allowed = 10.0 * tolerance.parse::<f64>().unwrap();
            assert!(
                error < allowed,
                "step {step}, tolerance {tolerance}: {error:e} with {states} states"
            );
            assert!(states > last_states && states < 200);
            last_states = states;
        }
    }
}

#[test]
fn reduction_reports_what_it_achieved() {
    let model = compile(&paper(32, &[])).unwrap();
    let summary = model.summary();
    assert_eq!(summary.kind, ModelKind::Reduced);
    let record = summary.reduction.as_ref().unwrap();
    assert!(record.achieved <= 1e-8 && record.achieved > 0.0);
    // the two ends, infinity and zero, are left to test the projection
    assert!(record.shifts.iter().all(|s| s.is_finite() && *s > 0.0));
    assert!(record.shifts.windows(2).all(|w| w[0] > w[1]));
    assert_eq!(summary.dofs_with_multipliers, 2210);
    assert_eq!(summary.free_dofs, 2080);
    assert!(summary.bytes < 100_000);
}

/// Cells of very different size leave the samples less digits than the tolerance asks for.
#[test]
fn reduction_out_of_reach_is_an_error_not_a_silent_loss() {
    let mut refused = 0;
    for (cells, tolerance) in [(16, 1e-10), (32, 1e-10), (64, 1e-7), (64, 1e-12)] {
        let asked = tolerance.to_string();
        let scene = |model| {
            let graded = [
                ("element", "p2"),
                ("mesh.grading", "[4, 4]"),
                ("fidelity.tolerance", asked.as_str()),
                ("fidelity.model", model),
            ];
            paper(cells, &graded)
        };
        let auto = compile(&scene("auto"));
        match compile(&scene("reduced")) {
            Ok(model) => {
                let record = model.summary().reduction.clone().unwrap();
                assert!(record.achieved <= tolerance, "{cells} {tolerance}");
            }
            // left to itself, the scene then keeps the mesh, and says why
            Err(Error::ReductionInaccurate { achieved, .. }) => {
                assert!(achieved > tolerance, "{cells} {tolerance}: {achieved}");
                let auto = auto.unwrap();
                assert_eq!(auto.summary().kind, ModelKind::Condensed);
                let why = auto.summary().fallback.clone().unwrap();
                assert!(why.contains("relative error"), "{why}");
                refused += 1;
            }
            // rounding alone is beyond the tolerance: of any model
            Err(Error::LostDigits { lost, .. }) => {
                assert!(lost > tolerance);
                assert!(matches!(auto.err(), Some(Error::LostDigits { .. })));
                refused += 1;
            }
            Err(error) => panic!("{cells} {tolerance}: {error}"),
        }
    }
    assert!(refused > 0);
}

/// Many loads are not held as fields; together they do what one does.
#[test]
fn a_load_in_eight_parts_is_one_load() {
    let loads = |count: u32| {
        let press = |i: u32| {
            let (name, start) = (format!("p{i}"), -0.3 / f64::from(count));
            json!({"name": name, "kind": "traction", "part": "top", "direction": [0, 1], "start": start})
        };
        let parts = (0..count).map(press);
        serde_json::Value::from_iter(parts).to_string()
    };
    for tolerance in ["1e-6", "1e-8"] {
        let mut of = [1, 8].map(|count| {
            let loads = loads(count);
            start(&paper(
                16,
                &[
                    ("loads", &loads),
                    ("run.signals", "{}"),
                    ("fidelity.tolerance", tolerance),
                ],
            ))
        });
        for _ in 0..32 {
            of.iter_mut().for_each(|s| steps(s, 0.03125, 1));
            let [one, eight] = of.each_ref().map(|s| values(s, "contact.slip_rate"));
            let allowed = 100.0 * tolerance.parse::<f64>().unwrap();
            let difference = relative(&eight, &one);
            assert!(difference < allowed, "{tolerance}: {difference:e}");
        }
    }
}

#[test]
fn auto_takes_the_cheaper_model() {
    let kind = |mesh: &str| {
        let scene = paper(
            8,
            &[
                ("fidelity.model", "auto"),
                ("mesh", mesh),
                ("fidelity.tolerance", "1e-9"),
            ],
        );
        compile(&scene).unwrap().summary().kind
    };
    let block = r#"{"kind": "rectangle", "size": [1.0, 0.5], "cells": [64, 32]}"#;
    assert_eq!(kind(block), ModelKind::Reduced);
    // a thin strip is nearly all contact: there is nothing to leave out
    let strip = r#"{"kind": "rectangle", "size": [1.0, 0.0078125], "cells": [128, 1]}"#;
    assert_eq!(kind(strip), ModelKind::Condensed);
}

/// A proportional material has one relaxation rate for everything; the reduction finds few states and stays exact.
#[test]
fn proportional_material_reduces_to_one_rate() {
    let material = json!({
        "viscosity": {"law": "isotropic", "mu1": 0.3, "mu2": 0.8},
        "elasticity": {"law": "isotropic", "young": 1.6 * 17.0 / 14.0, "poisson": 3.0 / 14.0, "convention": "plane_strain"}
    });
    let material = material.to_string();
    let run = |kind: &str| {
        slip_rates(
            &[("material", &material), ("fidelity.model", kind)],
            20,
            0.03125,
        )
    };
    let ((states, reduced), (_, full)) = (run("reduced"), run("full"));
    assert!(
        relative(&reduced, &full) < 1e-8,
        "{:e}",
        relative(&reduced, &full)
    );
    // contact dofs, one load, two components of one probe: no more directions exist
    assert!(states <= 35, "{states}");
}

/// c0^2 = 1.219, L_g = 0.2 and m_A = 0.1 at h = 1/32; the sharp constant is 0.1018 for A alone and crosses L_g near k = 0.22
/// (independent numpy/scipy solver).
#[test]
fn certificate_of_the_example_of_the_paper() {
    let certificate = |step: &str| {
        *compile(&paper(32, &[("time.step", step)]))
            .unwrap()
            .certificate()
    };
    let paper_step = certificate("0.03125");
    assert!((paper_step.c0_squared - 1.219).abs() < 5e-4);
    assert!((paper_step.l_g - 0.2).abs() < 1e-15 && (paper_step.m_a - 0.1).abs() < 1e-15);
    assert!((paper_step.sharp_instant - 0.1018).abs() < 5e-5);
    assert!(!paper_step.is_theorem_satisfied() && !paper_step.is_step_unique());
    assert_eq!(paper_step.step_limit(), 0.0);
    assert!(paper_step.margin() < -0.4);
    assert!(!certificate("0.21").is_step_unique());
    assert!(certificate("0.23").is_step_unique());
    let gentle = compile(&paper(32, &[("contact.friction.alpha", "10")])).unwrap();
    assert!(gentle.certificate().is_theorem_satisfied() && gentle.certificate().step_limit() > 0.0);
}

/// At alpha = 400 several steps of the example have two solutions, their slip rates up to 8.7e-3 apart; at alpha = 10 one
/// solution is certified.
#[test]
fn two_sided_start_finds_second_solutions() {
    let run = |alpha: &str| {
        let scene = paper(
            32,
            &[
                ("time.start", "zero"),
                ("contact.friction.alpha", alpha),
                ("fidelity.multiplicity_test", "true"),
            ],
        );
        let mut simulator = start(&scene);
        let (mut count, mut gap) = (0, 0.0_f64);
        for _ in 0..32 {
            steps(&mut simulator, 0.03125, 1);
            count += usize::from(value(&simulator, "solver.solutions") > 1.0);
            gap = gap.max(value(&simulator, "solver.solution_gap"));
        }
        (count, gap)
    };
    let (count, gap) = run("400");
    assert!((5..=20).contains(&count), "{count}");
    assert!((5e-3..1.2e-2).contains(&gap), "{gap:e}");
    let (count, _) = run("10");
    assert_eq!(count, 0);
    let mut untested = start(&paper(8, &[]));
    steps(&mut untested, 0.03125, 1);
    assert_eq!(value(&untested, "solver.solutions"), 0.0);
}

/// Step by step: several solutions where the law falls fast, one where it falls slowly; under Coulomb's law one is proved up to
/// `mu_max c = 1`, and nothing beyond.
#[test]
fn steps_say_whether_they_have_one_solution() {
    let run = |overrides: &[(&str, &str)]| -> Vec<[f64; 3]> {
        let mut all = vec![("fidelity.uniqueness", "true")];
        all.extend_from_slice(overrides);
        let mut simulator = start(&paper(32, &all));
        let step = |_| {
            steps(&mut simulator, 0.03125, 1);
            ["uniqueness", "uniqueness_margin", "solutions"]
                .map(|name| value(&simulator, &format!("solver.{name}")))
        };
        (0..32).map(step).collect()
    };
    let several = run(&[("time.start", "zero"), ("contact.friction.alpha", "400")]);
    let count = several.iter().filter(|row| row[0] == -1.0).count();
    assert!((5..=20).contains(&count), "{count}");
    for [answer, margin, solutions] in several {
        assert!(margin < 0.0 && (answer == -1.0) == (solutions > 1.0) && answer < 1.0);
    }
    for [answer, margin, solutions] in run(&[("contact.friction.alpha", "10")]) {
        assert!(
            answer == 1.0 && margin > 0.0 && margin < 1.0 && solutions == 1.0,
            "{margin}"
        );
    }
    let coulomb = |coefficient: &str| {
        let law = format!(r#"{{"law": "coulomb", "coefficient": {coefficient}}}"#);
        run(&[("contact.friction", &law)])
    };
    // the proof ends at 1 / c, about 0.41 at 32 contact nodes
    let margins = ["0.2", "0.3"].map(|mu| {
        let rows = coulomb(mu);
        assert!(
            rows.iter().all(|row| row[0] == 1.0 && row[2] == 1.0),
            "{mu}: {rows:?}"
        );
        rows[0][1]
    });
    let c = (margins[0] - margins[1]) / 0.1;
    assert!(
        (1.0 - margins[0] - 0.2 * c).abs() < 1e-9 && (0.35..0.5).contains(&(1.0 / c)),
        "{c}"
    );
    assert!(
        coulomb("0.8")
            .iter()
            .all(|row| row[0] == 0.0 && row[1] < 0.0)
    );
    // a law that falls takes from the margin what its pressure says
    let falling = r#"{"kind": "exponential", "static": 0.25, "kinetic": 0.2, "decay": 1.0}"#;
    for [_, margin, _] in coulomb(falling) {
        assert!(margin < 1.0 - 0.25 * c - 1e-6, "{margin}");
    }
}

/// A communication step of any size is cut into equal internal steps; its size costs no factorization when it is known.
#[test]
fn communication_steps_of_any_size() {
    for model in ["condensed", "reduced"] {
        let scene = paper(16, &[("fidelity.model", model), ("time.step", "0.03")]);
        let (mut large, mut small) = (start(&scene), start(&scene));
        steps(&mut large, 0.1, 5);
        steps(&mut small, 0.025, 20);
        let (a, b) = (
            values(&large, "contact.slip_rate"),
            values(&small, "contact.slip_rate"),
        );
        assert!(relative(&a, &b) < 1e-9);
        assert_eq!(small.factorizations(), 2);

        // a master that computes its steps as differences of times
        let mut jitter = start(&scene);
        let before = jitter.factorizations();
        for n in 0..1000 {
            let (from, to) = (f64::from(n) * 0.01, f64::from(n + 1) * 0.01);
            jitter.do_step(from, to - from).unwrap();
        }
        assert!(jitter.factorizations() - before <= 2);
        assert!((jitter.time() - 10.0).abs() < 1e-12);
    }
}

/// `hold` applies the new load from the beginning of the step: a jump, followed with second order by settling first.
#[test]
fn held_inputs_jump_and_linear_inputs_ramp() {
    let run = |interpolation: &str, count: u32| {
        let mut simulator = start(&paper(
            16,
            &[
                ("loads[0].interpolation", interpolation),
                ("time.step", "1"),
            ],
        ));
        simulator.set_inputs(&[-0.6]).unwrap();
        steps(&mut simulator, 0.5 / f64::from(count), count as usize);
        value(&simulator, "tip.displacement")
    };
    let reference = run("hold", 512);
    let error = |count| (run("hold", count) - reference).abs();
    assert!((error(16) / error(32)).log2() > 1.8);
    // a ramp over the first step alone lags behind the jump by first order
    assert!((run("linear", 32) - reference).abs() > 5.0 * error(32));
}
