//! The trajectories of `tests/reference`, computed by independent solvers (numpy/scipy and scikit-fem, their own meshes and
//! assembly, the friction law solved to rounding), against the three models.

mod common;

use common::{larger, largest, paper, start, steps, value, values};
use serde_json::Value;

/// Largest error relative to the largest value of the field.
const TOLERANCE: f64 = 1e-6;
const MODELS: [&str; 3] = ["full", "condensed", "reduced"];

fn load(name: &str) -> Value {
    let path = format!("{}/tests/reference/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|v| v.as_f64().unwrap()).collect()
}

fn check(name: &str) {
    let file = load(name);
    let parameters = &file["parameters"];
    let scheme = match file["scheme"].as_str().unwrap() {
        "trap" => "trapezoid",
        "be" => "backward_euler",
        "rect" => "rectangle",
        other => panic!("unknown scheme {other}"),
    };
    let k = file["step_size"].as_f64().unwrap();
    let cells = file["cells"][0].as_u64().unwrap() as u32;
    let samples = file["samples"].as_array().unwrap();
    assert_eq!(samples.len(), 8);
    for model in MODELS {
        let scene = paper(
            cells,
            &[
                ("time.scheme", scheme),
                ("time.start", file["start"].as_str().unwrap()),
                ("time.step", &k.to_string()),
                ("contact.friction.a", &parameters["a"].to_string()),
                ("contact.friction.b", &parameters["b"].to_string()),
                ("contact.friction.alpha", &parameters["alpha"].to_string()),
                ("fidelity.model", model),
            ],
        );
        let mut simulator = start(&scene);
        let fields = ["slip_rate", "slip", "tangential_stress"];
        let (mut error, mut scale) = ([0.0_f64; 3], [0.0_f64; 3]);
        for sample in samples {
            let instant = sample["t"].as_f64().unwrap();
            let count = ((instant - simulator.time()) / k).round() as usize;
            steps(&mut simulator, k, count);
            assert!((simulator.time() - instant).abs() < 1e-12);
            for (i, field) in fields.iter().enumerate() {
                let expected = numbers(&sample[field]);
                let found = values(&simulator, &format!("contact.{field}"));
                assert_eq!(found.len(), expected.len());
                let difference: Vec<f64> =
                    found.iter().zip(&expected).map(|(a, b)| a - b).collect();
                error[i] = larger(error[i], largest(&difference));
                scale[i] = scale[i].max(largest(&expected));
            }
        }
        for (i, field) in fields.iter().enumerate() {
            let relative = error[i] / scale[i];
            assert!(
                relative < TOLERANCE,
                "{name}, {model}, {field}: {relative:e}"
            );
        }
    }
}

#[test]
fn nonmonotone_consistent() {
    check("paper_h32_nonmonotone_consistent");
}

#[test]
fn nonmonotone_zero() {
    check("paper_h32_nonmonotone_zero");
}

#[test]
fn nonmonotone_backward_euler() {
    check("paper_h32_nonmonotone_backward_euler");
}

#[test]
fn nonmonotone_rectangle() {
    check("paper_h32_nonmonotone_rectangle");
}

#[test]
fn nonmonotone_coarse() {
    check("paper_h8_nonmonotone_consistent");
}

#[test]
fn constant_bound_low() {
    check("paper_h32_a001_consistent");
    check("paper_h32_a001_zero");
}

#[test]
fn constant_bound_high() {
    check("paper_h32_a003_consistent");
    check("paper_h32_a003_zero");
}

/// scikit-fem assembly, CHOLMOD and a condensed Newton solver: the end of the run, zero start.
fn check_peer(name: &str, cells: u32) {
    let tolerance = 1e-9;
    let file = load(name);
    for model in MODELS {
        let scene = paper(
            cells,
            &[
                ("time.start", "zero"),
                ("fidelity.model", model),
                ("fidelity.tolerance", "1e-9"),
                ("fidelity.friction_tolerance", "1e-13"),
            ],
        );
        let mut simulator = start(&scene);
        steps(&mut simulator, 0.03125, 32);
        for (field, key) in [("slip_rate", "w_tau"), ("tangential_stress", "sigma_tau")] {
            let expected = numbers(&file[key]);
            let found = values(&simulator, &format!("contact.{field}"));
            let relative = common::relative(&found, &expected);
            // relative to what is left at the end, a small share of the largest of the run
            assert!(
                relative < tolerance,
                "{name}, {model}, {field}: {relative:e}"
            );
        }
        let (found, expected) = (
            value(&simulator, "tip.displacement"),
            file["u_x10"].as_f64().unwrap(),
        );
        assert!(
            (found / expected - 1.0).abs() < tolerance,
            "{name}, {model}: {found} {expected}"
        );
    }
}

#[test]
fn peer_at_two_mesh_sizes() {
    check_peer("peer_h32", 32);
    check_peer("peer_h64", 64);
}

/// The default solver on the paper's example: few iterations.
#[test]
fn newton_takes_few_iterations() {
    for start_kind in ["zero", "consistent"] {
        let mut simulator = start(&paper(32, &[("time.start", start_kind)]));
        let counts: Vec<f64> = (0..32)
            .map(|_| {
                steps(&mut simulator, 0.03125, 1);
                assert!(value(&simulator, "solver.residual") <= 1e-10);
                value(&simulator, "solver.iterations")
            })
            .collect();
        let mean = counts.iter().sum::<f64>() / 32.0;
        assert!(
            mean <= 6.0 && largest(&counts) <= 15.0,
            "{start_kind}: {counts:?}"
        );
    }
}

/// Problem 7.4 at h = k = 1/32 from the zero start: an independent solver takes 14.4 iterations a step with both stop
/// tests and 5.3 with that on the displacement alone.
#[test]
fn fixed_point_reproduces_the_independent_iteration_counts() {
    for (stop, expected) in [("displacement_and_stress", 14.4), ("displacement", 5.3)] {
        let solver = format!(r#"{{"kind": "fixed_point", "tolerance": 1e-6, "stop": "{stop}"}}"#);
        for model in MODELS {
            let scene = paper(
                32,
                &[
                    ("time.start", "zero"),
                    ("fidelity.solver", &solver),
                    ("fidelity.model", model),
                ],
            );
            let mut simulator = start(&scene);
            let mut total = 0.0;
            for _ in 0..32 {
                steps(&mut simulator, 0.03125, 1);
                total += value(&simulator, "solver.iterations");
            }
            let mean = total / 32.0;
            assert!((mean - expected).abs() < 0.1, "{stop}, {model}: {mean}");
        }
    }
}
