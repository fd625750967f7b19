//! Materials with memory: closed forms, limits, energies, rollback and derivatives. Trajectories of another solver are in
//! `bodies_reference`.

#[path = "../common/mod.rs"]
mod common;
mod given;
mod without_dashpot;

use common::{largest, paper, relative, scene, start, steps, value, values};
use serde_json::{Value, json};
use std::sync::Arc;
use stickslip::{Error, Model, Scene, Simulator, compile};

const MODELS: [&str; 3] = ["full", "condensed", "reduced"];
const LAMBDA: f64 = 0.3 / 0.28;
const TWO_MU: f64 = 1.0 / 1.3;

/// Two branches like those of a rubber.
fn rubber() -> Value {
    json!([{"tau": 0.05, "law": "isotropic", "shear": 0.3, "bulk": 0.5},
           {"tau": 0.8, "law": "isotropic", "shear": 0.2, "bulk": 0.1}])
}

/// The paper's body with this memory.
fn body(cells: u32, memory: &Value, overrides: &[(&str, &str)]) -> Scene {
    let memory = memory.to_string();
    let mut all = vec![("material.memory", memory.as_str())];
    all.extend_from_slice(overrides);
    paper(cells, &all)
}

/// A branch that is `factor` times the elasticity of the paper's example.
fn multiple(factor: f64, tau: f64) -> Value {
    json!({"tau": tau, "law": "isotropic", "shear": factor * TWO_MU / 2.0, "bulk": factor * (LAMBDA + TWO_MU / 3.0)})
}

/// Solves a small system by elimination; diagonals rule.
fn solved<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> [f64; N] {
    for i in 0..N {
        for j in i + 1..N {
            let share = a[j][i] / a[i][i];
            let row = a[i];
            for (entry, above) in a[j].iter_mut().zip(row).skip(i) {
                *entry -= share * above;
            }
            b[j] -= share * b[i];
        }
    }
    for i in (0..N).rev() {
        let known: f64 = (i + 1..N).map(|k| a[i][k] * b[k]).sum();
        b[i] = (b[i] - known) / a[i][i];
    }
    b
}

/// `eta u' + u + sum c (u - q) = 1`, `q' = (u - q) / tau` by the stages of a scheme, from rest: u after n steps.
struct Scalar {
    eta: f64,
    branches: [(f64, f64); 2],
}

impl Scalar {
    /// Rate of z = (u, q1, q2) with `z = p + theta_k z'`.
    fn stage(&self, p: [f64; 3], theta_k: f64) -> [f64; 3] {
        let [(c1, t1), (c2, t2)] = self.branches;
        let b = [[1.0 + c1 + c2, -c1, -c2], [-c1, c1, 0.0], [-c2, 0.0, c2]];
        let a = [self.eta, t1 * c1, t2 * c2];
        let (mut matrix, mut load) = ([[0.0; 3]; 3], [1.0, 0.0, 0.0]);
        for i in 0..3 {
            for j in 0..3 {
                matrix[i][j] = theta_k * b[i][j] + if i == j { a[i] } else { 0.0 };
                load[i] -= b[i][j] * p[j];
            }
        }
        solved(matrix, load)
    }

    fn after(&self, scheme: &str, k: f64, count: usize) -> f64 {
        let plus = |z: [f64; 3], by: f64, w: [f64; 3]| std::array::from_fn(|i| z[i] + by * w[i]);
        let mut z = [0.0; 3];
        let mut w = self.stage(z, 0.0);
        for _ in 0..count {
            match scheme {
                "trapezoid" => {
                    let p = plus(z, 0.5 * k, w);
                    w = self.stage(p, 0.5 * k);
                    z = plus(p, 0.5 * k, w);
                }
                "backward_euler" => {
                    w = self.stage(z, k);
                    z = plus(z, k, w);
                }
                "rectangle" => {
                    z = plus(z, k, w);
                    w = self.stage(z, 0.0);
                }
                "midpoint" => {
                    w = self.stage(z, 0.5 * k);
                    z = plus(z, k, w);
                }
                "tr_bdf2" => {
                    let theta = 1.0 - 0.5_f64.sqrt();
                    let first = self.stage(plus(z, theta * k, w), theta * k);
                    let outer = 0.5 * 0.5_f64.sqrt() * k;
                    let p = plus(plus(z, outer, w), outer, first);
                    w = self.stage(p, theta * k);
                    z = plus(p, theta * k, w);
                }
                other => panic!("{other}"),
            }
        }
        z[0]
    }
}

/// Viscosity and branches proportional to the elasticity, no friction, a constant load: the displacement is the static one times
/// what one number does, exactly, in every scheme.
#[test]
fn proportional_operators_follow_one_number() {
    let scalar = Scalar {
        eta: 0.1,
        branches: [(0.5, 0.05), (0.3, 0.4)],
    };
    let memory = json!([multiple(0.3, 0.4), multiple(0.5, 0.05)]);
    let run = |model: &str, scheme: &str, k: f64, count: usize, memory: &Value| -> Vec<f64> {
        let (mu1, mu2) = ((0.1 * LAMBDA).to_string(), (0.1 * TWO_MU).to_string());
        let overrides = [
            ("material.viscosity.mu1", mu1.as_str()),
            ("material.viscosity.mu2", &mu2),
            ("contact.friction", r#"{"law": "frictionless"}"#),
            ("time.scheme", scheme),
            ("time.step", &k.to_string()),
            ("fidelity.model", model),
            ("fidelity.tolerance", "1e-11"),
        ];
        let mut simulator = start(&body(8, memory, &overrides));
        steps(&mut simulator, k, count);
        let mut seen = values(&simulator, "contact.slip");
        seen.extend(values(&simulator, "tip.displacement"));
        seen
    };
    // nothing is left of viscosity and memory after a step this long
    let at_rest = run("full", "backward_euler", 1e12, 1, &json!([]));
    for model in MODELS {
        for scheme in [
            "trapezoid",
            "backward_euler",
            "rectangle",
            "midpoint",
            "tr_bdf2",
        ] {
            let phi = scalar.after(scheme, 0.05, 20);
            let expected: Vec<f64> = at_rest.iter().map(|u| phi * u).collect();
            let error = relative(&run(model, scheme, 0.05, 20, &memory), &expected);
            assert!(error < 1e-10, "{model}, {scheme}: {error:e}");
        }
    }
    let phi = |k: f64, count| scalar.after("trapezoid", k, count);
    assert!((phi(0.05, 20) - 0.944_619_359_031_827).abs() < 1e-13);
    // second order towards the exact number
    let off = |k, count| (phi(k, count) - 0.944_545_717_802_259_8).abs();
    let order = (off(0.05, 20) / off(0.025, 40)).log2();
    assert!((order - 2.0).abs() < 0.02, "{order}");
}

fn press(k: f64, count: usize, scene: &Scene) -> Simulator {
    let mut simulator = start(scene);
    for n in 0..count {
        let load = if n < count / 2 { -0.3 } else { -0.1 };
        simulator.set_inputs(&[load]).unwrap();
        steps(&mut simulator, k, 1);
    }
    simulator
}

fn seen(simulator: &Simulator) -> Vec<f64> {
    let mut all = values(simulator, "contact.slip_rate");
    all.extend(values(simulator, "contact.slip"));
    all.extend(values(simulator, "tip.displacement"));
    all
}

/// A run with another material, seen at its end.
fn compared(memory: &Value, overrides: &[(&str, &str)]) -> Vec<f64> {
    seen(&press(1.0 / 16.0, 16, &body(8, memory, overrides)))
}

#[test]
fn branches_of_one_time_are_one_and_limits_are_elastic_or_viscous() {
    let condensed = ("fidelity.model", "condensed");
    let tr_bdf2 = ("time.scheme", "tr_bdf2");
    let branch = |tau: f64, shear: f64, bulk: f64| json!({"tau": tau, "law": "isotropic", "shear": shear, "bulk": bulk});
    let one = json!([branch(0.2, 0.5, 0.6)]);
    let two = json!([branch(0.2, 0.2, 0.5), branch(0.2, 0.3, 0.1)]);
    let reference = compared(&one, &[condensed]);
    assert!(relative(&compared(&two, &[condensed]), &reference) < 1e-12);
    let states = |memory| compile(&body(8, memory, &[condensed])).unwrap().states();
    assert_eq!(states(&two), states(&one));
    assert_eq!(states(&rubber()) * 2, states(&one) * 3);

    // a branch that never relaxes is an elasticity, one that always has is a viscosity
    let elastic = [
        ("material.elasticity.convention", "plane_strain"),
        ("material.elasticity.young", "1.8"),
        ("material.elasticity.poisson", "0.25"),
        tr_bdf2,
        condensed,
    ];
    // E = 1.8, nu = 0.25: G = 0.72, K = 1.2; a third of it as a branch
    let stiff = compared(&json!([]), &elastic);
    let mut softer = elastic;
    softer[1].1 = "1.2";
    let slow = compared(&json!([branch(1e9, 0.24, 0.4)]), &softer);
    assert!(relative(&slow, &stiff) < 1e-7);
    let without = compared(&json!([]), &softer);
    assert!(relative(&without, &stiff) > 0.1);
    // tau C = (mu1, mu2) = (0.04, 0.06) beside A: K = (0.04 + 0.06 / 3) / tau
    let tau = 1e-7;
    let thicker = [
        ("material.viscosity.mu1", "0.09"),
        ("material.viscosity.mu2", "0.16"),
        tr_bdf2,
        condensed,
    ];
    let fast = json!([branch(tau, 0.03 / tau, 0.06 / tau)]);
    let fast = compared(&fast, &[tr_bdf2, condensed]);
    assert!(relative(&fast, &compared(&json!([]), &thicker)) < 1e-3);
}

#[test]
fn several_regions_of_one_material_are_one_region() {
    let split = r#"[{"name": "half", "from": [0, 0], "to": [0.5, 0.5]}]"#;
    for model in MODELS {
        let whole = body(8, &rubber(), &[("fidelity.model", model)]);
        let mut value: Value = serde_json::from_str(&whole.to_json()).unwrap();
        let mut material = value["material"].take();
        value.as_object_mut().unwrap().remove("material");
        value["mesh"]["regions"] = serde_json::from_str(split).unwrap();
        material["region"] = json!("half");
        let mut other = material.clone();
        other["region"] = json!("body");
        value["materials"] = json!([material, other]);
        let [a, b] = [&whole, &scene(&value)].map(|scene| press(1.0 / 16.0, 16, scene));
        assert!(relative(&seen(&b), &seen(&a)) < 1e-9, "{model}");
        assert_eq!(a.model().states(), b.model().states());
    }
}

#[test]
fn energies_have_the_memorys_own_and_balance() {
    for model in MODELS {
        for scheme in ["trapezoid", "midpoint"] {
            let overrides = [("fidelity.model", model), ("time.scheme", scheme)];
            let simulator = press(1.0 / 32.0, 48, &body(16, &rubber(), &overrides));
            let work = value(&simulator, "energy.external_work");
            let error = value(&simulator, "energy.balance_error").abs() / work;
            assert!(error < 1e-13, "{model}, {scheme}: {error:e}");
            assert!(value(&simulator, "energy.viscous_dissipation") > 0.1 * work);
        }
    }
}

/// Every model, with normal contact and a moving foundation, or step control and error estimate.
fn cases() -> Vec<Scene> {
    let mut cases = Vec::new();
    for model in MODELS {
        let model = ("fidelity.model", model);
        let controlled = [
            model,
            ("time.scheme", "tr_bdf2"),
            ("time.tolerance", "1e-4"),
            ("time.error_estimate", "true"),
        ];
        let pressed = [
            model,
            ("time.scheme", "tr_bdf2"),
            (
                "contact",
                r#"{"part": "bottom", "condition": {"kind": "unilateral", "gap": 0.002}, "friction": {"law": "coulomb", "coefficient": 0.3},
                    "foundation": [{"name": "belt", "kind": "sliding", "direction": [1, 0]}]}"#,
            ),
        ];
        cases.push(body(8, &rubber(), &[model]));
        cases.push(body(8, &rubber(), &[model, ("time.scheme", "tr_bdf2")]));
        cases.push(body(8, &rubber(), &controlled));
        cases.push(body(8, &rubber(), &pressed));
    }
    cases
}

fn moved(simulator: &mut Simulator, from: usize, count: usize) {
    for n in from..from + count {
        let mut inputs = vec![-0.3 + 0.2 * (n as f64).sin()];
        inputs.resize(simulator.model().input_count(), 0.1);
        simulator.set_inputs(&inputs).unwrap();
        let step = 0.03 + 0.01 * (n % 3) as f64;
        simulator.do_step(simulator.time(), step).unwrap();
    }
}

#[test]
fn states_come_back_bit_for_bit() {
    for scene in cases() {
        let compiled = compile(&scene).unwrap();
        let bytes = compiled.to_bytes();
        let loaded = Arc::new(Model::from_bytes(&bytes).unwrap());
        assert!(loaded.to_bytes() == bytes);
        let mut simulator = Simulator::new(compiled);
        simulator.init(0.0).unwrap();
        moved(&mut simulator, 0, 6);
        let (saved, written) = (simulator.state().clone(), simulator.to_bytes());
        moved(&mut simulator, 6, 6);
        let after = simulator.state().clone();
        assert!(saved != after);
        simulator.restore(&saved).unwrap();
        moved(&mut simulator, 6, 6);
        assert_eq!(*simulator.state(), after);
        let mut other = Simulator::new(loaded);
        other.restore_bytes(&written).unwrap();
        moved(&mut other, 6, 6);
        assert_eq!(*other.state(), after);
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    for scene in cases() {
        if scene.time.tolerance.is_some() {
            continue;
        }
        let label = format!("{:?} {:?}", scene.fidelity.model, scene.scheme());
        let mut simulator = start(&scene);
        moved(&mut simulator, 0, 5);
        let saved = simulator.state().clone();
        let (time, step) = (simulator.time(), 0.05);
        let count = simulator.model().input_count();
        let inputs: Vec<f64> = (0..count)
            .map(|i| if i == 0 { -0.28 } else { 0.12 })
            .collect();
        let outputs = |simulator: &mut Simulator, by: f64| {
            simulator.restore(&saved).unwrap();
            let moved: Vec<f64> = inputs.iter().map(|v| v + by * 1e-6).collect();
            simulator.set_inputs(&moved).unwrap();
            simulator.do_step(time, step).unwrap();
            let mut out = vec![0.0; simulator.output_len()];
            simulator.get_outputs(&mut out).unwrap();
            out
        };
        let (up, down) = (outputs(&mut simulator, 1.0), outputs(&mut simulator, -1.0));
        outputs(&mut simulator, 0.0);
        let (seed, mut found) = (vec![1.0; count], vec![0.0; up.len()]);
        simulator.directional_derivative(&seed, &mut found).unwrap();
        let ports = simulator.model().ports();
        let mut first = 0;
        for port in ports.outputs() {
            let range = first..first + port.len();
            first = range.end;
            let is_smooth = ["contact.", "tip.", "press.", "energy.", "belt."]
                .iter()
                .any(|name| port.name.starts_with(name));
            let is_count = ["stick", "status", "open_fraction", "balance_error"]
                .iter()
                .any(|name| port.name.contains(name));
            if !is_smooth || is_count {
                continue;
            }
            let slopes: Vec<f64> = up[range.clone()]
                .iter()
                .zip(&down[range.clone()])
                .map(|(a, b)| (a - b) / 2e-6)
                .collect();
            let off: Vec<f64> = slopes
                .iter()
                .zip(&found[range])
                .map(|(a, b)| a - b)
                .collect();
            let error = largest(&off);
            assert!(
                error < 1e-5 * largest(&slopes).max(0.1),
                "{label}, {}: {error:e}",
                port.name
            );
        }
        let mut weights = vec![0.0; up.len()];
        weights
            .iter_mut()
            .enumerate()
            .for_each(|(i, w)| *w = (i as f64).sin());
        let mut adjoint = vec![0.0; count];
        simulator
            .adjoint_derivative(&weights, &mut adjoint)
            .unwrap();
        let one: f64 = adjoint.iter().sum();
        let other: f64 = weights.iter().zip(&found).map(|(w, d)| w * d).sum();
        assert!((one - other).abs() < 1e-9 * one.abs().max(1.0), "{label}");
    }
}

#[test]
fn all_models_agree_with_pressed_contact() {
    let all = cases();
    let runs: Vec<Vec<f64>> = [3, 7, 11]
        .iter()
        .map(|&i| {
            let mut simulator = start(&all[i]);
            moved(&mut simulator, 0, 20);
            assert!(largest(&values(&simulator, "contact.pressure")) > 0.0);
            let work = value(&simulator, "energy.external_work").abs();
            assert!(value(&simulator, "energy.elastic") > 1e-3 * work);
            let mut all = seen(&simulator);
            all.extend(values(&simulator, "contact.pressure"));
            all
        })
        .collect();
    assert!(relative(&runs[1], &runs[0]) < 1e-9);
    assert!(relative(&runs[2], &runs[0]) < 1e-6);
}

#[test]
fn step_control_knows_fast_branches() {
    let fast = json!([{"tau": 2e-3, "law": "isotropic", "shear": 1.0, "bulk": 1.0}]);
    let run = |overrides: &[(&str, &str)]| {
        let mut all = vec![("time.scheme", "tr_bdf2"), ("fidelity.model", "condensed")];
        all.extend_from_slice(overrides);
        let simulator = press(0.125, 8, &body(8, &fast, &all));
        values(&simulator, "contact.slip_rate")
    };
    let exact = run(&[("time.step", "0.0001")]);
    let controlled = run(&[("time.step", "0.125"), ("time.tolerance", "1e-4")]);
    let plain = run(&[("time.step", "0.125")]);
    let (with, without) = (relative(&controlled, &exact), relative(&plain, &exact));
    assert!(with < 1e-3 && without > 3.0 * with, "{with:e} {without:e}");
}
