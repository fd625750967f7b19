//! Bodies whose laws are not linear: limits that are linear bodies, orders in the step, energies, derivatives, rollback, work.

#[path = "../common/mod.rs"]
mod common;
mod work;

use common::{largest, paper, relative, start, started, steps, value, values};
use serde_json::{Value, json};
use stickslip::scene::Scene;
use stickslip::{Model, Simulator, compile};

const WHOLE: [&str; 2] = ["full", "condensed"];

fn carreau(mu_0: f64, mu_inf: f64) -> String {
    let law = json!({"law": "carreau", "mu1": 0.1, "mu_0": mu_0, "mu_inf": mu_inf, "c": 0.05, "deviator": "in_plane"});
    law.to_string()
}

fn von_mises(beta: f64, kappa: f64) -> String {
    let base =
        json!({"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"});
    json!({"law": "von_mises", "base": base, "beta": beta, "kappa": kappa}).to_string()
}

fn hencky() -> String {
    json!({"law": "hencky", "bulk": 1.0, "mu_0": 0.8, "mu_inf": 0.2, "c": 0.05}).to_string()
}

/// The isotropic law `lambda tr I + two_mu eps` of plane strain.
fn isotropic(lambda: f64, two_mu: f64) -> String {
    let mu = 0.5 * two_mu;
    let young = mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
    let poisson = 0.5 * lambda / (lambda + mu);
    json!({"law": "isotropic", "young": young, "poisson": poisson, "convention": "plane_strain"})
        .to_string()
}

/// The paper's example with other laws.
fn with_laws(cells: u32, viscosity: &str, elasticity: &str, more: &[(&str, &str)]) -> Scene {
    let mut overrides = vec![
        ("fidelity.model", "condensed"),
        ("material.viscosity", viscosity),
        ("material.elasticity", elasticity),
    ];
    overrides.extend_from_slice(more);
    paper(cells, &overrides)
}

/// The paper's own laws.
const VISCOSITY: &str = r#"{"law": "isotropic", "mu1": 0.05, "mu2": 0.1}"#;
const ELASTICITY: &str =
    r#"{"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"}"#;

/// A branch of long memory.
const MEMORY: &str = r#"[{"tau": 0.08, "law": "isotropic", "shear": 0.2, "bulk": 0.3}]"#;

/// Slip rates and stresses after `count` steps under a load that swings.
fn course(scene: &Scene, k: f64, count: u32) -> (Vec<f64>, Simulator) {
    let mut simulator = start(scene);
    for n in 0..count {
        let swing = 1.0 + 0.9 * (7.0 * k * f64::from(n + 1)).sin();
        let loads: Vec<f64> = scene.loads.iter().map(|l| l.start * swing).collect();
        simulator.set_inputs(&loads).unwrap();
        steps(&mut simulator, k, 1);
    }
    let mut seen = values(&simulator, "contact.slip_rate");
    seen.extend(values(&simulator, "contact.tangential_stress"));
    assert!(largest(&seen) > 1e-4);
    (seen, simulator)
}

/// The machinery of Newton's method with laws that are linear ones in other words gives the linear body.
#[test]
fn limits_of_laws_are_linear_bodies() {
    let lambda = 0.3 / 0.52;
    let two_mu = 1.0 / 1.3;
    let unilateral: [(&str, &str); 3] = [
        (
            "contact.condition",
            r#"{"kind": "unilateral", "gap": 1e-3}"#,
        ),
        (
            "contact.friction",
            r#"{"law": "coulomb", "coefficient": 0.2}"#,
        ),
        ("time.scheme", "tr_bdf2"),
    ];
    let displaced = [(
        "initial",
        r#"{"displacement": [{"expression": "0.02 * x^2"}, 0]}"#,
    )];
    let remembering = [("material.memory", MEMORY)];
    for more in [&[][..], &unilateral, &displaced, &remembering] {
        for model in WHOLE {
            let more = [more, &[("fidelity.model", model)]].concat();
            // not a law that bends: no cell has an excess
            let newtonian = with_laws(8, &carreau(0.2, 0.2), ELASTICITY, &more);
            let plain = r#"{"law": "isotropic", "mu1": 0.0, "mu2": 0.2}"#;
            let (found, simulator) = course(&newtonian, 0.05, 12);
            assert_eq!(simulator.body_iterations(), 0);
            let (expected, _) = course(&with_laws(8, plain, ELASTICITY, &more), 0.05, 12);
            assert!(relative(&found, &expected) < 1e-13, "{model}");
            // beyond kappa everywhere
            let beta = 0.4;
            let scene = with_laws(8, VISCOSITY, &von_mises(beta, 0.0), &more);
            let (found, simulator) = course(&scene, 0.05, 12);
            assert!(simulator.body_iterations() > 0);
            let all = isotropic(lambda - beta / 3.0, two_mu + beta);
            let (expected, linear) = course(&with_laws(8, VISCOSITY, &all, &more), 0.05, 12);
            assert!(
                relative(&found, &expected) < 1e-8,
                "{model} {:e}",
                relative(&found, &expected)
            );
            for port in [
                "energy.elastic",
                "energy.viscous_dissipation",
                "energy.friction_dissipation",
            ] {
                let (a, b) = (value(&simulator, port), value(&linear, port));
                assert!((a / b - 1.0).abs() < 1e-8, "{port}: {a} {b}");
            }
            // below kappa everywhere: one iteration a stage, and not a digit
            let scene = with_laws(8, VISCOSITY, &von_mises(beta, 1e3), &more);
            let (found, simulator) = course(&scene, 0.05, 12);
            assert_eq!(simulator.body_iterations(), simulator.stage_solves());
            let (expected, _) = course(&with_laws(8, VISCOSITY, ELASTICITY, &more), 0.05, 12);
            assert!(relative(&found, &expected) < 1e-13, "{model}");
        }
    }
}

/// Full and condensed model, in the plane with quadratic cells, in space, and with regions that are linear.
#[test]
fn models_agree() {
    let plane =
        |more: &[(&str, &str)]| with_laws(8, &carreau(0.5, 0.05), &von_mises(5.0, 0.01), more);
    let mut solid: Value =
        serde_json::from_str(stickslip::scene::example("brake_pad_3d").unwrap()).unwrap();
    let material = |law: Value| {
        json!({"viscosity": solid["material"]["viscosity"], "elasticity": {
            "law": "von_mises", "base": law, "beta": 4.0 * law["young"].as_f64().unwrap(), "kappa": 1e-5}})
    };
    let bent = material(solid["material"]["elasticity"].clone());
    solid["mesh"]["cells"] = json!([2, 4, 4]);
    solid["mesh"]["regions"] = json!([{"name": "half", "from": [0, 0, 0], "to": [0.05, 1, 1]}]);
    let linear = solid["material"].clone();
    let with_region = |mut material: Value, region: &str| {
        material["region"] = json!(region);
        material
    };
    solid["materials"] = json!([with_region(bent, "half"), with_region(linear, "body")]);
    solid.as_object_mut().unwrap().remove("material");
    let of_solid = |model: &str| {
        let mut scene = solid.clone();
        scene["fidelity"]["model"] = json!(model);
        for (load, start) in scene["loads"]
            .as_array_mut()
            .unwrap()
            .iter_mut()
            .zip([4e5, 1e5])
        {
            load["start"] = json!(start);
        }
        common::scene(&scene)
    };
    let scenes = |model: &'static str| {
        [
            plane(&[("fidelity.model", model)]),
            plane(&[("fidelity.model", model), ("element", "p2")]),
            of_solid(model),
        ]
    };
    for (full, condensed) in scenes("full").iter().zip(&scenes("condensed")) {
        let k = full.time.step;
        let ((a, first), (b, _)) = (course(full, k, 8), course(condensed, k, 8));
        assert!(relative(&a, &b) < 1e-7, "{:e}", relative(&a, &b));
        assert!(first.body_iterations() > first.stage_solves() / 3);
    }
    // nothing of an automatic model is reduced
    let automatic = compile(&plane(&[("fidelity.model", "auto")])).unwrap();
    assert!(
        automatic
            .summary()
            .fallback
            .as_ref()
            .unwrap()
            .contains("not linear")
    );
}

/// Errors of a scheme fall with its order, both operators being nonlinear and the material having memory.
#[test]
fn orders_in_the_step() {
    let laws = (carreau(0.4, 0.1), von_mises(1.0, 0.01));
    let at = |scheme: &str, steps: u32| {
        let step = format!("{:?}", 0.5 / f64::from(steps));
        let more = [
            ("time.scheme", scheme),
            ("time.step", step.as_str()),
            // slips everywhere: a change between stick and slip has an error of its own
            ("contact.friction", r#"{"law": "tresca", "bound": 1e-4}"#),
            ("fidelity.friction_tolerance", "1e-13"),
            ("material.memory", MEMORY),
        ];
        let mut simulator = start(&with_laws(4, &laws.0, &laws.1, &more));
        simulator.set_inputs(&[-0.2]).unwrap();
        common::steps(&mut simulator, 0.5, 1);
        values(&simulator, "tip.displacement")
    };
    let exact = at("trapezoid", 2048);
    for (scheme, least, most) in [
        ("trapezoid", 1.7, 2.4),
        ("midpoint", 1.7, 2.4),
        ("tr_bdf2", 1.7, 2.8),
        ("backward_euler", 0.85, 1.2),
        ("rectangle", 0.8, 1.3),
    ] {
        let errors = [64, 128].map(|steps| relative(&at(scheme, steps), &exact));
        let order = (errors[0] / errors[1]).log2();
        assert!(
            order > least && order < most,
            "{scheme}: {order} of {errors:?}"
        );
    }
}

/// Balance of energies over a run: exact for a nonlinear viscosity, an error of the scheme for a nonlinear elasticity.
#[test]
fn energies_balance() {
    let balance = |viscosity: &str, elasticity: &str, k: f64| {
        let scene = with_laws(
            4,
            viscosity,
            elasticity,
            &[("fidelity.friction_tolerance", "1e-13")],
        );
        let count = (0.5 / k).round() as u32;
        let (_, simulator) = course(&scene, k, count);
        value(&simulator, "energy.balance_error").abs()
            / value(&simulator, "energy.external_work").abs()
    };
    let exact = balance(&carreau(1.0, 0.05), ELASTICITY, 0.05);
    assert!(exact < 1e-11, "{exact:e}");
    let [coarse, fine] = [0.025, 0.0125].map(|k| balance(VISCOSITY, &hencky(), k));
    assert!(coarse < 1e-2 && fine < 0.35 * coarse, "{coarse:e} {fine:e}");
    assert!(fine > 1e-9, "the scheme has an error");
}

/// Outputs by inputs, against differences of whole steps.
#[test]
fn derivatives_are_those_of_the_step() {
    let pressed = [
        (
            "contact.condition",
            r#"{"kind": "unilateral", "gap": 1e-3}"#,
        ),
        (
            "contact.friction",
            r#"{"law": "coulomb", "coefficient": 0.2}"#,
        ),
    ];
    for (scheme, more) in [
        ("trapezoid", &[][..]),
        ("midpoint", &[]),
        ("tr_bdf2", &pressed),
    ] {
        let more = [
            more,
            &[
                ("time.scheme", scheme),
                ("fidelity.friction_tolerance", "1e-13"),
            ],
        ]
        .concat();
        let scene = with_laws(8, &carreau(0.4, 0.1), &hencky(), &more);
        let (_, simulator) = course(&scene, 0.05, 7);
        let at = |load: f64| {
            let mut moved = simulator.clone();
            moved.set_inputs(&[load]).unwrap();
            steps(&mut moved, 0.05, 1);
            let mut out = vec![0.0; moved.output_len()];
            moved.get_outputs(&mut out).unwrap();
            (out, moved)
        };
        let (load, change) = (-0.21, 1e-5);
        let (_, mut here) = at(load);
        let mut slope = vec![0.0; here.output_len()];
        here.directional_derivative(&[1.0], &mut slope).unwrap();
        let (plus, minus) = (at(load + change).0, at(load - change).0);
        let mut checked = 0;
        let mut first = 0;
        for port in here.model().ports().outputs() {
            let all = first..first + port.len();
            first = all.end;
            // counts and indicators have no derivative, and the balance is a difference of almost equal numbers
            let is_none = port.name.starts_with("solver.") || port.name == "energy.balance_error";
            if is_none || largest(&slope[all.clone()]) == 0.0 {
                continue;
            }
            let difference = |i: usize| (plus[i] - minus[i]) / (2.0 * change);
            let found: Vec<f64> = all.clone().map(difference).collect();
            let error = relative(&slope[all.clone()], &found);
            assert!(error < 1e-5, "{scheme} {}: {error:e}", port.name);
            checked += 1;
        }
        assert!(checked > 8, "{checked}");
        // the transposed derivative
        let seed: Vec<f64> = (0..slope.len()).map(|i| (i as f64).cos()).collect();
        let mut transposed = [0.0];
        here.adjoint_derivative(&seed, &mut transposed).unwrap();
        let product: f64 = seed.iter().zip(&slope).map(|(a, b)| a * b).sum();
        assert!((transposed[0] / product - 1.0).abs() < 1e-12);
    }
}

/// The same state and inputs give the same bits, whatever a simulator did before, and whatever it has factored.
#[test]
fn states_are_all_that_a_step_depends_on() {
    let pressed = [
        (
            "contact.condition",
            r#"{"kind": "unilateral", "gap": 1e-3}"#,
        ),
        (
            "contact.friction",
            r#"{"law": "coulomb", "coefficient": 0.2}"#,
        ),
        ("time.scheme", "tr_bdf2"),
    ];
    let estimated = [("time.error_estimate", "true")];
    for more in [&[][..], &pressed, &estimated] {
        let scene = with_laws(16, &carreau(1.0, 0.01), &von_mises(20.0, 0.005), more);
        let (_, mut simulator) = course(&scene, 0.04, 10);
        let bytes = simulator.to_bytes();
        let go_on = |simulator: &mut Simulator| {
            for n in 0..6 {
                simulator.set_inputs(&[-0.3 + 0.05 * f64::from(n)]).unwrap();
                steps(simulator, 0.04, 1);
            }
            simulator.to_bytes()
        };
        let expected = go_on(&mut simulator);
        // a fresh simulator, of a model that went through bytes
        let model = Model::from_bytes(&simulator.model().to_bytes()).unwrap();
        assert_eq!(model.fingerprint(), simulator.model().fingerprint());
        let mut fresh = Simulator::new(model.into());
        fresh.restore_bytes(&bytes).unwrap();
        assert!(go_on(&mut fresh) == expected, "a fresh simulator");
        // one that has been elsewhere: other sizes, derivatives
        let mut other = started(simulator.model().clone());
        other.set_inputs(&[-0.05]).unwrap();
        steps(&mut other, 0.013, 3);
        let mut slopes = vec![0.0; other.output_len()];
        other.directional_derivative(&[1.0], &mut slopes).unwrap();
        other.restore_bytes(&bytes).unwrap();
        assert!(go_on(&mut other) == expected, "one that has been elsewhere");
    }
}
