//! Work of a step, large steps, step control, and what is refused.

use super::*;

/// Iterations and factorizations of 32 steps and a start on the paper's example at h = 1/16, the factor kept and renewed.
#[test]
fn work_is_that_of_a_kept_factor() {
    let mut worst = 0.0_f64;
    for (name, viscosity, elasticity, iterations, factorizations) in [
        (
            "Carreau 2",
            carreau(0.2, 0.1),
            ELASTICITY.to_owned(),
            12.0,
            12,
        ),
        (
            "Carreau 10",
            carreau(1.0, 0.1),
            ELASTICITY.to_owned(),
            14.0,
            22,
        ),
        (
            "Carreau 100",
            carreau(10.0, 0.1),
            ELASTICITY.to_owned(),
            13.0,
            30,
        ),
        (
            "Carreau 1e4",
            carreau(1e3, 0.1),
            ELASTICITY.to_owned(),
            8.0,
            5,
        ),
        (
            "von Mises 5",
            VISCOSITY.to_owned(),
            von_mises(5.0, 0.01),
            10.0,
            5,
        ),
        (
            "von Mises 100",
            VISCOSITY.to_owned(),
            von_mises(100.0, 0.01),
            11.0,
            110,
        ),
        ("both", carreau(1.0, 0.1), von_mises(5.0, 0.01), 12.0, 20),
    ] {
        let mut simulator = start(&with_laws(16, &viscosity, &elasticity, &[]));
        for _ in 0..32 {
            steps(&mut simulator, 1.0 / 32.0, 1);
        }
        let mean = simulator.body_iterations() as f64 / 33.0;
        let factored = simulator.factorizations();
        println!(
            "{name}: {mean:.1} iterations a stage, {factored} factorizations, {} halvings",
            simulator.body_halvings()
        );
        assert!(mean <= iterations && factored <= factorizations, "{name}");
        worst = worst.max(mean);
    }
    assert!(worst > 2.0, "the laws bend");
}

/// Large steps of a law that falls by a factor of 100: the line search keeps Newton's method from cycling.
#[test]
fn large_steps_converge() {
    for k in [0.25, 1.0] {
        for scheme in ["trapezoid", "backward_euler"] {
            let step = format!("{k:?}");
            let more = [("time.step", step.as_str()), ("time.scheme", scheme)];
            let scene = with_laws(16, &carreau(10.0, 0.1), &von_mises(100.0, 0.002), &more);
            let (_, simulator) = course(&scene, k, (4.0 / k) as u32);
            println!(
                "{k} {scheme}: {} iterations, {} factorizations, {} halvings",
                simulator.body_iterations(),
                simulator.factorizations(),
                simulator.body_halvings()
            );
            assert!(value(&simulator, "solver.residual") <= 1e-10);
        }
    }
}

/// The step control halves and doubles as it does for a linear body.
#[test]
fn the_step_control_works() {
    let more = [("time.tolerance", "1e-4"), ("time.step", "0.25")];
    let scene = with_laws(8, &carreau(1.0, 0.1), &hencky(), &more);
    let (found, simulator) = course(&scene, 0.25, 4);
    assert!(simulator.internal_steps() > 8);
    let scene = with_laws(
        8,
        &carreau(1.0, 0.1),
        &hencky(),
        &[("time.step", "0.001953125")],
    );
    let (expected, _) = course(&scene, 0.25, 4);
    assert!(
        relative(&found, &expected) < 2e-3,
        "{:e}",
        relative(&found, &expected)
    );
}

/// What a nonlinear body cannot have is refused by name, and the certificate has the constants of the laws.
#[test]
fn what_needs_a_linear_body_is_refused() {
    let refusal = |more: &[(&str, &str)]| {
        let mut all = vec![
            ("material.viscosity".to_owned(), carreau(1.0, 0.1)),
            ("fidelity.model".to_owned(), "full".to_owned()),
        ];
        all.extend(
            more.iter()
                .map(|(path, value)| ((*path).to_owned(), (*value).to_owned())),
        );
        let text = stickslip::scene::example("kazmi2014").unwrap();
        Scene::with_overrides(text, "kazmi2014", &all)
            .unwrap_err()
            .to_string()
    };
    for (path, value, place) in [
        ("fidelity.model", "reduced", "fidelity.model"),
        (
            "fidelity.solver",
            r#"{"kind": "fixed_point"}"#,
            "fidelity.solver",
        ),
        (
            "fidelity.multiplicity_test",
            "true",
            "fidelity.multiplicity_test",
        ),
        (
            "driven",
            r#"[{"part": "right", "directions": {"push": [1, 0], "lift": [0, 1]}}]"#,
            "driven",
        ),
    ] {
        let found = refusal(&[(path, value)]);
        assert!(
            found.contains(place) && found.contains("material.viscosity"),
            "{found}"
        );
    }
    assert!(refusal(&[("material.viscosity.mu_inf", "0")]).contains("material.viscosity.mu_inf"));
    assert!(refusal(&[("material.viscosity.mu_0", "0.01")]).contains("material.viscosity.mu_0"));
    let scene = with_laws(8, &carreau(1.0, 0.1), &von_mises(5.0, 0.01), &[]);
    let model = compile(&scene).unwrap();
    let certificate = model.certificate();
    assert!((certificate.m_a - 0.1).abs() < 1e-14);
    assert!((certificate.l_a - 1.0).abs() < 1e-14);
    assert!((certificate.l_b - (5.0 + 1.0 / 1.3)).abs() < 1e-13);
    // what is proved holds for the lower tangents: the linear body of these
    let lower = with_laws(
        8,
        r#"{"law": "isotropic", "mu1": 0.05, "mu2": 0.1}"#,
        ELASTICITY,
        &[],
    );
    let expected = compile(&lower).unwrap().certificate().sharp_step;
    assert!((certificate.sharp_step / expected - 1.0).abs() < 1e-12);
}
