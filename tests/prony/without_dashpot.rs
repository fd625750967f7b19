//! Regions without dashpot.

use super::*;

/// Half of the body without dashpot, with memory there or without.
fn half_elastic(memory: &Value, overrides: &[(&str, &str)]) -> Scene {
    let mut value: Value = serde_json::from_str(&paper(8, overrides).to_json()).unwrap();
    let mut material = value["material"].take();
    value.as_object_mut().unwrap().remove("material");
    value["mesh"]["regions"] = json!([{"name": "right", "from": [0.5, 0.0], "to": [1.0, 0.5]}]);
    material["region"] = json!("body");
    let elasticity = material["elasticity"].clone();
    let right = json!({"region": "right", "elasticity": elasticity, "memory": memory});
    value["materials"] = json!([material, right]);
    if !overrides.iter().any(|(path, _)| *path == "time.scheme") {
        value["time"]["scheme"] = json!("auto");
    }
    scene(&value)
}

#[test]
fn a_region_may_have_no_dashpot() {
    let friction = ("contact.friction", r#"{"law": "tresca", "bound": 0.004}"#);
    let start = ("time.start", "zero");
    let run = |scene: &Scene| {
        let mut simulator = common::start(scene);
        let k = scene.time.step;
        let count = (1.0 / k).round() as usize;
        let mut all = Vec::new();
        for n in 1..=count {
            let load = -0.3 * (std::f64::consts::PI * n as f64 * k).sin();
            simulator.set_inputs(&[load]).unwrap();
            steps(&mut simulator, k, 1);
            if (4 * n) % count == 0 {
                all.extend(values(&simulator, "contact.slip"));
                all.extend(values(&simulator, "contact.slip_rate"));
            }
        }
        let work = value(&simulator, "energy.external_work").abs();
        let stored = value(&simulator, "energy.elastic");
        assert!(stored >= 0.0 && value(&simulator, "energy.viscous_dissipation") > 0.01 * work);
        all
    };
    for memory in [json!([]), rubber()] {
        for scheme in ["auto", "backward_euler"] {
            let of = |model: &str, step: &str| {
                half_elastic(
                    &memory,
                    &[
                        friction,
                        start,
                        ("time.scheme", scheme),
                        ("time.step", step),
                        ("fidelity.model", model),
                    ],
                )
            };
            assert_ne!(
                of("full", "0.03125").scheme(),
                stickslip::scene::Scheme::Trapezoid
            );
            let full = run(&of("full", "0.03125"));
            assert!(relative(&run(&of("condensed", "0.03125")), &full) < 1e-9);
            let reduced = run(&of("reduced", "0.03125"));
            assert!(
                relative(&reduced, &full) < 1e-6,
                "{scheme} {memory}: {:e}",
                relative(&reduced, &full)
            );
            // a tiny dashpot is nearly none
            let mut value: Value = serde_json::from_str(&of("full", "0.03125").to_json()).unwrap();
            value["materials"][1]["viscosity"] =
                json!({"law": "isotropic", "mu1": 1e-9, "mu2": 1e-9});
            value["time"]["scheme"] = json!(if scheme == "auto" { "tr_bdf2" } else { scheme });
            assert!(relative(&run(&scene(&value)), &full) < 1e-4);
        }
        let bytes = compile(&half_elastic(&memory, &[friction, start]))
            .unwrap()
            .to_bytes();
        assert!(Model::from_bytes(&bytes).unwrap().to_bytes() == bytes);
    }
}

#[test]
fn what_needs_a_dashpot_is_refused_without_one() {
    let refused = |overrides: &[(&str, &str)], path: &str, words: &str| {
        let scene: Value =
            serde_json::from_str(&half_elastic(&json!([]), &[("time.start", "zero")]).to_json())
                .unwrap();
        let edits: Vec<(String, String)> = overrides
            .iter()
            .map(|(p, v)| (p.to_string(), v.to_string()))
            .collect();
        let error = Scene::with_overrides(&scene.to_string(), "test", &edits)
            .expect_err("a refusal")
            .to_string();
        assert!(
            error.contains(path) && error.contains(words) && error.contains("materials[1]"),
            "{error}"
        );
    };
    refused(&[("time.start", "consistent")], "time.start", "zero");
    refused(&[("time.scheme", "trapezoid")], "time.scheme", "ring");
    refused(
        &[("time.scheme", "midpoint"), ("time.force", "true")],
        "time.scheme",
        "tr_bdf2",
    );
    refused(
        &[("time.scheme", "rectangle"), ("time.force", "true")],
        "time.scheme",
        "backward_euler",
    );
    refused(
        &[("time.tolerance", "1e-3")],
        "time.tolerance",
        "equal steps",
    );
    let one = [("material.viscosity.mu2".to_owned(), "0".to_owned())];
    let text = stickslip::scene::example("kazmi2014").unwrap();
    let error = Scene::with_overrides(text, "test", &one)
        .expect_err("a refusal")
        .to_string();
    assert!(
        error.contains("material.viscosity.mu2") && error.contains("> 0"),
        "{error}"
    );
}
