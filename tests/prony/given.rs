//! Memory as scenes give it: what is refused, shares of moduli, the fractional kernel.

use super::*;

#[test]
fn mistakes_are_named() {
    let text = stickslip::scene::example("kazmi2014").unwrap();
    let refused = |memory: &str, path: &str, words: &str| {
        let edit = [("material.memory".to_owned(), memory.to_owned())];
        match Scene::with_overrides(text, "test", &edit) {
            Err(error @ Error::Scene { .. }) => {
                let message = error.to_string();
                assert!(
                    message.contains(path) && message.contains(words),
                    "{message}"
                );
            }
            other => panic!("{memory}: {other:?}"),
        }
    };
    let branch = |tau: &str, shear: &str, bulk: &str| {
        format!(r#"[{{"tau": {tau}, "law": "isotropic", "shear": {shear}, "bulk": {bulk}}}]"#)
    };
    refused(&branch("0", "1", "1"), "material.memory[0].tau", "> 0");
    refused(&branch("-1", "1", "1"), "material.memory[0].tau", "> 0");
    refused(&branch("1", "-1", "1"), "material.memory[0].shear", ">= 0");
    refused(&branch("1", "1", "-1"), "material.memory[0].bulk", ">= 0");
    refused(&branch("1", "0", "0"), "material.memory[0]", "does nothing");
    refused(&branch("1e-309", "1", "1"), "material.memory[0]", "finite");
    refused(
        r#"[{"tau": 1, "law": "maxwell"}]"#,
        "material.memory[0].law",
        "isotropic",
    );
    refused(
        r#"[{"tau": 1, "law": "isotropic", "shear": 1}]"#,
        "material.memory[0]",
        "bulk",
    );
    let shares = r#"{"relative": [{"tau": 1, "shear": 0.6}, {"tau": 2, "shear": 0.4}], "moduli": "long_term"}"#;
    refused(shares, "material.memory.relative", "below 1");
    refused(
        r#"{"relative": [{"tau": 1, "shear": 0.6}]}"#,
        "material.memory",
        "moduli",
    );
    let table = r#"{"dynamic": [[1, 5, 0.1], [10, 9, 0.1]], "frequency": "hertz"}"#;
    refused(table, "material.memory.dynamic", "%");
    refused(
        &table.replace("[10", "[1"),
        "material.memory.dynamic",
        "increase",
    );
    refused(
        r#"{"relaxation": [[0, 2], [1, 1]]}"#,
        "material.memory.relaxation",
        "increase",
    );
    let kernel =
        r#"{"fractional": {"order": 0.5, "shear": 1, "bulk": 0, "shortest": 1, "longest": 1}}"#;
    refused(kernel, "material.memory.fractional", "beyond the shortest");
    refused(r#"{"creep": 1}"#, "material.memory", "relative");
    let many = vec![multiple(0.1, 1.0); 65];
    refused(&json!(many).to_string(), "material.memory", "64");
    // a driven part that strains the body
    let driven = r#"[{"part": "right", "directions": {"piston": [1, 0], "rise": [0, 1]}}]"#;
    let strained = body(
        8,
        &rubber(),
        &[("driven", driven), ("loads", "[]"), ("run.signals", "{}")],
    );
    let error = compile(&strained).err().expect("a refusal").to_string();
    assert!(
        error.contains("driven[0].directions.piston") && error.contains("memory"),
        "{error}"
    );
    // one that moves it as a whole
    let whole = r#"[{"part": "top", "directions": {"guide": [1, 0]}}]"#;
    let free = [
        ("driven", whole),
        ("clamped", "[]"),
        ("loads", "[]"),
        ("run.signals", "{}"),
    ];
    if let Err(error) = compile(&body(8, &rubber(), &free)) {
        panic!("{error}");
    }
}

/// The table of another program in shares of the moduli is the same material as its branches.
#[test]
fn shares_of_moduli_are_branches() {
    let elasticity =
        r#"{"law": "isotropic", "young": 1.8, "poisson": 0.25, "convention": "plane_strain"}"#;
    let of =
        |memory: &Value, elasticity: &str| compared(memory, &[("material.elasticity", elasticity)]);
    // G = 0.72, K = 1.2
    let shares = json!({"relative": [{"tau": 0.1, "shear": 0.25, "bulk": 0.1}, {"tau": 0.5, "shear": 0.25}], "moduli": "instantaneous"});
    let branches = json!([{"tau": 0.1, "law": "isotropic", "shear": 0.18, "bulk": 0.12},
                          {"tau": 0.5, "law": "isotropic", "shear": 0.18, "bulk": 0.0}]);
    // what is left: G = 0.36, K = 1.08
    let left =
        r#"{"law": "isotropic", "young": 0.972, "poisson": 0.35, "convention": "plane_strain"}"#;
    assert!(relative(&of(&shares, elasticity), &of(&branches, left)) < 1e-10);
    let mut late = shares.clone();
    late["moduli"] = json!("long_term");
    let stiffer = json!([{"tau": 0.1, "law": "isotropic", "shear": 0.36, "bulk": 0.4 / 3.0},
                         {"tau": 0.5, "law": "isotropic", "shear": 0.36, "bulk": 0.0}]);
    assert!(relative(&of(&late, elasticity), &of(&stiffer, elasticity)) < 1e-10);
}

/// `c D^(1/2) u + B u = F` has `u = F / B (1 - erfcx((B / c) sqrt t))`.
#[test]
fn a_fractional_kernel_creeps_as_it_should() {
    let fractional = |bulk: f64, shear: f64| json!({"fractional": {"order": 0.5, "shear": shear, "bulk": bulk, "shortest": 2e-5, "longest": 2.0}});
    let (mu1, mu2) = ((1e-5 * LAMBDA).to_string(), (1e-5 * TWO_MU).to_string());
    let run = |memory: &Value, k: f64, count: usize| {
        let overrides = [
            ("material.viscosity.mu1", mu1.as_str()),
            ("material.viscosity.mu2", &mu2),
            ("contact.friction", r#"{"law": "frictionless"}"#),
            ("time.scheme", "backward_euler"),
            ("time.step", &k.to_string()),
            ("fidelity.model", "condensed"),
        ];
        let mut simulator = start(&body(4, memory, &overrides));
        steps(&mut simulator, k, count);
        value(&simulator, "tip.displacement")
    };
    let at_rest = run(&json!([]), 1e9, 1);
    let creep = run(
        &fractional(LAMBDA + TWO_MU / 3.0, TWO_MU / 2.0),
        1.0 / 800.0,
        800,
    ) / at_rest;
    let exact = 1.0 - 0.427_583_576_155_807;
    assert!((creep / exact - 1.0).abs() < 2e-3, "{creep} for {exact}");
}
