//! Two materials in all models, with certificate, norm and the fixed point.

use super::*;

/// A stiff plate on a soft lining.
fn two_materials(name: &str, cells: Value, model: &str) -> Value {
    let mut scene = embedded(name);
    scene["mesh"]["cells"] = cells;
    scene["fidelity"]["model"] = model.into();
    scene["fidelity"]["friction_tolerance"] = 1e-12.into();
    let soft = scene["material"].clone();
    let mut stiff = soft.clone();
    let times = |value: &Value, factor: f64| json!(value.as_f64().expect("a number") * factor);
    stiff["elasticity"]["young"] = times(&stiff["elasticity"]["young"], 7.0);
    stiff["elasticity"]["poisson"] = 0.2.into();
    stiff["viscosity"]["mu2"] = times(&stiff["viscosity"]["mu2"], 1.7);
    let size: Vec<f64> = scene["mesh"]["size"]
        .as_array()
        .expect("sizes")
        .iter()
        .filter_map(Value::as_f64)
        .collect();
    let (mut from, to) = (vec![0.0; size.len()], size.clone());
    from[1] = 0.5 * size[1];
    with_regions(scene, &[("plate", &from, &to)], &[stiff, soft])
}

/// Contact outputs over a run, and the model.
fn run(scene: &Scene) -> ([Vec<f64>; 2], Arc<Model>) {
    let compilation = Compilation::new(scene).unwrap_or_else(|error| panic!("{error}"));
    let mut simulator = Simulator::new(Arc::clone(&compilation.model));
    simulator.init(0.0).expect("a start");
    let first: Vec<f64> = scene.loads.iter().map(|load| load.start).collect();
    let mut found = [Vec::new(), Vec::new()];
    for n in 0..12 {
        let share = 1.0 + 0.5 * (0.7 * f64::from(n)).sin();
        let loads: Vec<f64> = first.iter().map(|p| p * share).collect();
        simulator.set_inputs(&loads).expect("loads");
        steps(&mut simulator, scene.time.step, 1);
        found[0].extend(values(&simulator, "contact.slip_rate"));
        found[1].extend(values(&simulator, "contact.tangential_stress"));
    }
    assert!(value(&simulator, "energy.balance_error").abs() < 1e-12);
    assert!(largest(&found[0]) > 0.0 && largest(&found[1]) > 0.0);
    (found, compilation.model)
}

#[test]
fn the_three_models_agree_on_two_materials() {
    for (name, cells) in [
        ("kazmi2014", json!([12, 6])),
        ("brake_pad_3d", json!([6, 2, 3])),
    ] {
        let (full, model) = run(&parse(&two_materials(name, cells.clone(), "full")));
        let one = {
            let mut scene = embedded(name);
            scene["mesh"]["cells"] = cells.clone();
            scene["fidelity"]["model"] = "full".into();
            run(&parse(&scene)).0
        };
        assert!(relative(&one[0], &full[0]) > 0.05, "the plate matters");
        let full_certificate = *model.certificate();
        for (model, tolerance) in [("condensed", [1e-9, 1e-9]), ("reduced", [1e-6, 1e-4])] {
            let (found, model) = run(&parse(&two_materials(name, cells.clone(), model)));
            for ((found, full), tolerance) in found.iter().zip(&full).zip(tolerance) {
                let error = relative(found, full);
                assert!(error < tolerance, "{name}: {error:e}");
            }
            let (c, f) = (model.certificate(), &full_certificate);
            for (c, f) in [
                (c.c0_squared, f.c0_squared),
                (c.m_a, f.m_a),
                (c.l_b, f.l_b),
                (c.sharp_instant, f.sharp_instant),
                (c.sharp_step, f.sharp_step),
            ] {
                assert!((c / f - 1.0).abs() < 1e-6, "{name}: {c} {f}");
            }
        }
    }
}

/// Rates and constants are extremes over the regions; the strain norm is that of the field, whatever the materials are.
#[test]
fn certificate_and_norm_know_all_regions() {
    let scene = two_materials("kazmi2014", json!([8, 4]), "full");
    let compilation = Compilation::new(&parse(&scene)).expect("a body");
    let body = &compilation.body;
    let extremes = (0..body.mesh.cell_count()).map(|cell| {
        let [a, b] = &*body.forms.of(cell);
        (a.extremes(2)[0], b.extremes(2)[1])
    });
    let (m_a, l_b) = extremes.fold((f64::INFINITY, 0.0_f64), |all, e| {
        (all.0.min(e.0), all.1.max(e.1))
    });
    let certificate = compilation.model.certificate();
    assert_eq!((certificate.m_a, certificate.l_b), (m_a, l_b));
    let uniform = Compilation::new(&parse(&{
        let mut scene = embedded("kazmi2014");
        scene["mesh"]["cells"] = json!([8, 4]);
        scene["fidelity"]["model"] = "full".into();
        scene
    }));
    // the trace constant is one of the mesh alone
    let uniform = uniform.expect("a body");
    let (of_two, of_one) = (
        certificate.c0_squared,
        uniform.model.certificate().c0_squared,
    );
    assert!((of_two / of_one - 1.0).abs() < 1e-10, "{of_two} {of_one}");
    let field: Vec<f64> = (0..body.len()).map(|i| (1.3 * i as f64).sin()).collect();
    let norms = (
        strain_norm(&compilation, &field),
        strain_norm(&uniform, &field),
    );
    assert!((norms.0 / norms.1 - 1.0).abs() < 1e-12, "{norms:?}");
    // what relaxes lies between the rates of the materials
    let [low, high] = body.element_rates;
    for shift in 0..20 {
        let field: Vec<f64> = (0..body.len())
            .map(|i| (1.3 * (i * i + shift) as f64).sin())
            .collect();
        let (a, b) = body.operators.product(&field, &field);
        assert!(low * a <= b && b <= high * a, "{shift}");
    }
}

/// The fixed point measures displacements in the strain norm, which the three models know alike; models read back equal.
#[test]
fn the_fixed_point_stops_alike_in_all_models() {
    let iterations = MODELS.map(|model| {
        let mut scene = two_materials("kazmi2014", json!([8, 4]), model);
        scene["fidelity"]["solver"] =
            json!({"kind": "fixed_point", "tolerance": 1e-5, "stop": "displacement"});
        let compilation = Compilation::new(&parse(&scene)).expect("a model");
        let bytes = compilation.model.to_bytes();
        let read = Arc::new(Model::from_bytes(&bytes).expect("a model"));
        assert_eq!(read.to_bytes(), bytes);
        [Arc::clone(&compilation.model), read].map(|model| {
            let mut simulator = Simulator::new(model);
            simulator.init(0.0).expect("a start");
            let mut iterations = Vec::new();
            for n in 0..6 {
                simulator
                    .set_inputs(&[-0.3 - 0.02 * f64::from(n)])
                    .expect("a load");
                steps(&mut simulator, 1.0 / 32.0, 1);
                iterations.push(value(&simulator, "solver.iterations"));
            }
            iterations
        })
    });
    assert!(iterations[0][0].iter().any(|n| *n > 2.0));
    for of_model in &iterations {
        assert_eq!(of_model[0], of_model[1], "read back");
        assert_eq!(of_model[0], iterations[0][0]);
    }
}
