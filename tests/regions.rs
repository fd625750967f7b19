//! Bodies of several materials: regions of equal material are one body to the bit, layers against closed forms, model against
//! model, and what is computed from the materials of all regions.

mod common;

use common::{largest, relative, start, steps, strain_norm, value, values};
use serde_json::{Value, json};
use std::sync::Arc;
use stickslip::model::Compilation;
use stickslip::scene::{Scene, example};
use stickslip::{Model, Simulator};

const MODELS: [&str; 3] = ["full", "condensed", "reduced"];

/// An embedded scene; loads that start from zero start from these pressures instead.
fn embedded(name: &str) -> Value {
    let mut scene: Value =
        serde_json::from_str(example(name).expect("an embedded scene")).expect("JSON");
    for (load, start) in scene["loads"]
        .as_array_mut()
        .into_iter()
        .flatten()
        .zip([4e5, 1e5])
    {
        if load.get("start").is_none() {
            load["start"] = start.into();
        }
    }
    scene
}

fn parse(scene: &Value) -> Scene {
    Scene::from_json(&scene.to_string(), "regions").unwrap_or_else(|error| panic!("{error}"))
}

/// The scene with these boxes as regions and these materials, one per region and the last one for the body.
fn with_regions(mut scene: Value, boxes: &[(&str, &[f64], &[f64])], materials: &[Value]) -> Value {
    let region =
        |(name, from, to): &(&str, &[f64], &[f64])| json!({"name": name, "from": from, "to": to});
    scene["mesh"]["regions"] = boxes.iter().map(region).collect();
    let names = boxes.iter().map(|b| b.0).chain(["body"]);
    let named = |(name, material): (&str, &Value)| {
        let mut material = material.clone();
        material["region"] = name.into();
        material
    };
    scene["materials"] = names.zip(materials).map(named).collect();
    scene.as_object_mut().expect("a scene").remove("material");
    scene
}

/// Bits of all outputs over a run under a load that changes at every step.
fn bits(scene: &Scene) -> Vec<u64> {
    let mut simulator = start(scene);
    let mut values = vec![0.0; simulator.output_len()];
    let mut all = Vec::new();
    let first: Vec<f64> = scene.loads.iter().map(|load| load.start).collect();
    for n in 0..6 {
        let share = 1.0 + 0.4 * (0.9 * f64::from(n)).sin();
        let loads: Vec<f64> = first.iter().map(|p| p * share).collect();
        simulator.set_inputs(&loads).expect("loads");
        steps(&mut simulator, scene.time.step, 1);
        simulator.get_outputs(&mut values).expect("outputs");
        all.extend(values.iter().map(|v| v.to_bits()));
    }
    let rates = simulator
        .get_by_name("contact.slip_rate")
        .expect("slip rates");
    assert!(largest(&rates) > 0.0, "the contact slips");
    all
}

#[test]
fn regions_of_equal_material_are_one_body_to_the_bit() {
    let plane: &[(&str, &[f64], &[f64])] = &[
        ("low", &[0.0, 0.0], &[1.0, 0.2]),
        ("left", &[0.0, 0.2], &[0.3, 0.5]),
    ];
    let solid: &[(&str, &[f64], &[f64])] = &[("half", &[0.0; 3], &[0.05, 1.0, 1.0])];
    for (name, cells, boxes) in [
        ("kazmi2014", json!([8, 4]), plane),
        ("brake_pad_3d", json!([4, 2, 3]), solid),
    ] {
        for model in MODELS {
            for solver in [json!({"kind": "newton"}), json!({"kind": "fixed_point"})] {
                if name == "brake_pad_3d" && solver["kind"] == "fixed_point" {
                    continue;
                }
                let mut one = embedded(name);
                one["mesh"]["cells"] = cells.clone();
                one["fidelity"]["model"] = model.into();
                one["fidelity"]["solver"] = solver;
                let material = one["material"].clone();
                let several = vec![material; boxes.len() + 1];
                let several = parse(&with_regions(one.clone(), boxes, &several));
                let one = parse(&one);
                let body = Compilation::new(&several).expect("a body").body;
                assert_eq!(body.mesh.regions.len(), boxes.len() + 1);
                assert!(bits(&one) == bits(&several), "{name} {model}");
            }
        }
    }
}

/// One of two layers: height (m), `sigma = viscosity eps' + modulus eps` (Pa s, Pa).
#[derive(Clone, Copy)]
struct Layer {
    height: f64,
    viscosity: f64,
    modulus: f64,
}

const LAYERS: [Layer; 2] = [
    Layer {
        height: 0.5,
        viscosity: 0.4,
        modulus: 1.0,
    },
    Layer {
        height: 0.25,
        viscosity: 0.9,
        modulus: 5.0,
    },
];

impl Layer {
    /// Change of the height (or shear) after a time under a constant stress that acts from the start.
    fn creep(&self, stress: f64, time: f64) -> f64 {
        let relaxed = 1.0 - (-self.modulus / self.viscosity * time).exp();
        self.height * stress / self.modulus * relaxed
    }

    /// No coupling of directions: the stress of a stretch eps is `modulus eps`, that of a shear gamma is half of it.
    fn material(&self, region: &str, is_solid: bool) -> Value {
        let convention = if is_solid {
            "three_dimensional"
        } else {
            "plane_strain"
        };
        json!({
            "region": region,
            "viscosity": {"law": "isotropic", "mu1": 0.0, "mu2": self.viscosity},
            "elasticity": {"law": "isotropic", "young": self.modulus, "poisson": 0.0, "convention": convention}
        })
    }
}

/// Two layers, the first one below.
fn layers(is_solid: bool, model: &str, step: f64, more: Value) -> Scene {
    let of = |x: f64, y: f64| if is_solid { vec![x, y, x] } else { vec![x, y] };
    let (kind, cells) = match is_solid {
        true => ("box", json!([1, 3, 1])),
        false => ("rectangle", json!([1, 3])),
    };
    let [low, high] = LAYERS;
    let mut scene = json!({
        "schema_version": 1, "name": "layers",
        "mesh": {"kind": kind, "size": of(0.5, 0.75), "cells": cells,
            "regions": [{"name": "low", "from": of(0.0, 0.0), "to": of(0.5, low.height)},
                        {"name": "high", "from": of(0.0, low.height), "to": of(0.5, 0.75)}]},
        // in another order than the regions
        "materials": [high.material("high", is_solid), low.material("low", is_solid)],
        "time": {"step": step, "scheme": "tr_bdf2"},
        "fidelity": {"model": model, "friction_tolerance": 1e-12}
    });
    for (key, value) in more.as_object().expect("an object") {
        scene[key] = value.clone();
    }
    parse(&scene)
}

/// Largest error of the last contact node's slip along its first tangent over a run, against `exact(time)`.
fn error_of_slip(scene: &Scene, exact: impl Fn(f64) -> f64) -> f64 {
    let mut simulator = start(scene);
    let mut worst: f64 = 0.0;
    for n in 1..=8 {
        simulator
            .set_inputs(&[scene.loads[0].start])
            .expect("a load");
        steps(&mut simulator, 0.125, 1);
        let contact = simulator.model().contact();
        let at = contact.len() - contact.components;
        let exact = exact(0.125 * f64::from(n));
        assert!(exact.abs() > 0.01, "the body moves");
        worst = worst.max((values(&simulator, "contact.slip")[at] - exact).abs());
    }
    worst
}

/// Pressed layers on a clamped bottom, one side on a frictionless foundation: the same stress in both, so that the top goes down
/// by the sum of what each layer does alone. The field is linear in each layer: exact in space for every element.
#[test]
fn pressed_layers_add_up() {
    for is_solid in [false, true] {
        for model in MODELS {
            let down = if is_solid {
                json!([0.0, -1.0, 0.0])
            } else {
                json!([0.0, -1.0])
            };
            let more = json!({
                "clamped": ["bottom"],
                "contact": {"part": "left", "friction": {"law": "frictionless"}},
                "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": down, "start": 0.2}],
            });
            let exact = |time| -LAYERS.iter().map(|l| l.creep(0.2, time)).sum::<f64>();
            let [coarse, fine] = [64.0, 256.0]
                .map(|n| error_of_slip(&layers(is_solid, model, 1.0 / n, more.clone()), exact));
            // second order in time
            assert!(fine < 2e-6, "{model} {is_solid}: {fine:e}");
            assert!(
                (12.0..20.0).contains(&(coarse / fine)),
                "{model} {is_solid}: {coarse:e} {fine:e}"
            );
        }
    }
}

/// A periodic column of layers under its own weight along the foundation, clamped on top, sliding under Tresca friction g: the
/// stress at the height y is `g - f y`, so that the foot moves by `sum (f y_i - g)` creep of a unit stress, y_i the middle of layer
/// i. Quadratic triangles meet the field exactly.
#[test]
fn sheared_layers_add_up() {
    for model in MODELS {
        let (bound, force) = (0.05, 1.0);
        let mut scene = serde_json::to_value(layers(false, model, 1.0, json!({
            "clamped": ["top"],
            "contact": {"part": "bottom", "friction": {"law": "tresca", "bound": bound}},
            "loads": [{"name": "drag", "kind": "body_force", "direction": [1.0, 0.0], "start": force}],
            "element": "p2",
        })))
        .expect("JSON");
        scene["mesh"]["periodic"] = json!(["x"]);
        let exact = |time: f64| {
            let [low, high] = LAYERS;
            let middles = [low.height / 2.0, low.height + high.height / 2.0];
            // a shear stress gives twice the strain of a normal one
            let of = |(l, y): (&Layer, f64)| 2.0 * l.creep(force * y - bound, time);
            LAYERS.iter().zip(middles).map(of).sum::<f64>()
        };
        let [coarse, fine] = [64.0, 256.0].map(|n| {
            scene["time"]["step"] = (1.0 / n).into();
            error_of_slip(&parse(&scene), exact)
        });
        assert!(fine < 4e-6, "{model}: {fine:e}");
        assert!(
            (12.0..20.0).contains(&(coarse / fine)),
            "{model}: {coarse:e} {fine:e}"
        );
    }
}

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

/// A scene whose two laws are given, with loads along both axes.
fn of_laws(kind: &str, viscosity: Value, elasticity: Value) -> Value {
    let is_plane = kind == "rectangle";
    let (size, cells) = match is_plane {
        true => (json!([1.0, 0.5]), json!([6, 3])),
        false => (json!([1.0, 0.5, 0.6]), json!([3, 2, 2])),
    };
    let along = |direction: [f64; 3]| match is_plane {
        true => json!(direction[..2]),
        false => json!(direction),
    };
    json!({
        "schema_version": 1, "name": "laws",
        "mesh": {"kind": kind, "size": size, "cells": cells},
        "material": {"viscosity": viscosity, "elasticity": elasticity},
        "clamped": ["left"],
        "contact": {"part": "bottom", "friction": {"law": "tresca", "bound": 0.002}},
        "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": along([0.6, -0.8, 0.0]), "start": 0.1},
                  {"name": "pull", "kind": "body_force", "direction": along([0.3, 0.2, 0.7]), "start": -0.2}],
        "time": {"step": 0.05, "scheme": "trapezoid"},
        "fidelity": {"model": "full", "friction_tolerance": 1e-13}
    })
}

/// Slip rates, slips and stresses after some steps.
fn seen(simulator: &mut Simulator) -> Vec<f64> {
    steps(simulator, 0.05, 6);
    let of = |port: &str| values(simulator, &format!("contact.{port}"));
    [of("slip_rate"), of("slip"), of("tangential_stress")].concat()
}

fn isotropic(young: f64, poisson: f64, convention: &str) -> Value {
    json!({"law": "isotropic", "young": young, "poisson": poisson, "convention": convention})
}

/// Nine constants of an isotropic material.
fn nine(young: f64, poisson: f64, more: Value) -> Value {
    let shear = young / (2.0 * (1.0 + poisson));
    let mut law = json!({
        "law": "orthotropic", "young": vec![young; 3], "poisson": vec![poisson; 3], "shear": vec![shear; 3],
    });
    for (key, value) in more.as_object().expect("an object") {
        law[key] = value.clone();
    }
    law
}

#[test]
fn nine_isotropic_constants_are_isotropic_whatever_the_axes() {
    let viscous = json!({"law": "isotropic", "mu1": 0.03, "mu2": 0.1});
    let turned = json!([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]]);
    let mut cases = Vec::new();
    for convention in ["plane_strain", "plane_stress"] {
        for angle in [0.0, 37.0, -120.0] {
            let more = json!({"angle_deg": angle, "convention": convention});
            cases.push(("rectangle", convention, more));
        }
    }
    cases.push(("box", "three_dimensional", json!({ "axes": turned })));
    cases.push(("box", "three_dimensional", json!({})));
    for (kind, convention, more) in cases {
        let one = of_laws(kind, viscous.clone(), isotropic(1.3, 0.3, convention));
        let other = of_laws(kind, viscous.clone(), nine(1.3, 0.3, more.clone()));
        let reference = seen(&mut start(&parse(&one)));
        assert!(largest(&reference) > 1e-3);
        for model in MODELS {
            let mut other = other.clone();
            other["fidelity"]["model"] = model.into();
            let found = seen(&mut start(&parse(&other)));
            let error = relative(&found, &reference);
            assert!(error < 1e-9, "{kind} {more} {model}: {error:e}");
        }
        // constants of the certificate and rates are those of the isotropic law
        let compile = |scene: &Value| Compilation::new(&parse(scene)).expect("a body").model;
        let (a, b) = (compile(&one), compile(&other));
        for (x, y) in [
            (a.certificate().m_a, b.certificate().m_a),
            (a.certificate().l_b, b.certificate().l_b),
            (a.certificate().c0_squared, b.certificate().c0_squared),
            (a.summary().rates[0], b.summary().rates[0]),
            (a.summary().rates[1], b.summary().rates[1]),
        ] {
            assert!((x / y - 1.0).abs() < 1e-9, "{kind} {more}: {x} {y}");
        }
    }
}

/// Mesh, axes of the material, tangent and loads turned together: the same along the contact.
#[test]
fn a_turned_body_behaves_alike() {
    let law = |angle: f64, scale: f64| {
        json!({
            "law": "orthotropic", "young": [4.0 * scale, scale, 2.0 * scale], "poisson": [0.3, 0.2, 0.4],
            "shear": [0.4 * scale, 0.5 * scale, 0.6 * scale], "angle_deg": angle, "convention": "plane_strain",
        })
    };
    let base = of_laws("rectangle", law(20.0, 0.1), law(-35.0, 1.0));
    let reference = {
        let mesh = stickslip::mesh::Mesh::generate(&parse(&base).mesh).expect("a mesh");
        let compiled = Compilation::on_mesh(&parse(&base), mesh).expect("a body");
        seen(&mut common::started(compiled.model))
    };
    assert!(largest(&reference) > 1e-3);
    for degrees in [25.0_f64, 140.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let turn = |v: [f64; 2]| [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]];
        let mut scene = of_laws(
            "rectangle",
            law(20.0 + degrees, 0.1),
            law(-35.0 + degrees, 1.0),
        );
        for load in scene["loads"].as_array_mut().expect("loads") {
            let at = |i: usize| load["direction"][i].as_f64().expect("a number");
            load["direction"] = json!(turn([at(0), at(1)]));
        }
        scene["contact"]["tangent"] = json!(turn([1.0, 0.0]));
        let scene = parse(&scene);
        let mut mesh = stickslip::mesh::Mesh::generate(&scene.mesh).expect("a mesh");
        for node in &mut mesh.nodes {
            let [x, y] = turn([node[0], node[1]]);
            *node = [x, y, 0.0];
        }
        let compiled = Compilation::on_mesh(&scene, mesh).expect("a body");
        let found = seen(&mut common::started(compiled.model));
        let error = relative(&found, &reference);
        assert!(error < 1e-10, "{degrees}: {error:e}");
    }
}

/// A law given as a matrix is the one that it is the matrix of; a gradient is a factor, and a factor that jumps is two regions.
#[test]
fn matrices_and_factors_are_what_they_stand_for() {
    let viscous = json!({"law": "isotropic", "mu1": 0.03, "mu2": 0.1});
    let elastic = isotropic(1.3, 0.3, "plane_strain");
    let (lambda, two_mu) = (1.3 * 0.3 / (1.3 * 0.4), 1.0);
    let matrix = json!({"law": "matrix", "matrix": [
        [lambda + two_mu, lambda, 0.0], [lambda, lambda + two_mu, 0.0], [0.0, 0.0, two_mu / 2.0]
    ]});
    let run = |scene: &Value| seen(&mut start(&parse(scene)));
    let one = run(&of_laws("rectangle", viscous.clone(), elastic.clone()));
    let other = run(&of_laws("rectangle", viscous.clone(), matrix));
    assert!(relative(&other, &one) < 1e-11);

    let with = |law: &Value, key: &str, value: Value| {
        let mut law = law.clone();
        law[key] = value;
        law
    };
    let graded = of_laws(
        "rectangle",
        with(&viscous, "gradient", json!([0.5, 1.0])),
        with(&elastic, "gradient", json!([1.0, -0.5])),
    );
    let formula = of_laws(
        "rectangle",
        with(&viscous, "factor", json!({"expression": "1 + 0.5 * x + y"})),
        with(&elastic, "factor", json!({"expression": "1 + x - 0.5 * y"})),
    );
    let (a, b) = (run(&graded), run(&formula));
    assert!(relative(&a, &b) < 1e-11 && relative(&a, &one) > 1e-2);
    for model in MODELS {
        let mut graded = graded.clone();
        graded["fidelity"]["model"] = model.into();
        assert!(relative(&run(&graded), &a) < 1e-6, "{model}");
    }
    // the pencil of every cell is that of the law times a ratio of factors
    let compiled = Compilation::new(&parse(&graded)).expect("a body");
    let rates = compiled.model.summary().rates;
    let all = (0..compiled.body.mesh.cell_count()).map(|cell| {
        let [a, b] = &*compiled.body.forms.of(cell);
        (stickslip::material::Form::rates(a, b, 2), a.extremes(2)[0])
    });
    let (mut low, mut high, mut m_a) = (f64::INFINITY, 0.0_f64, f64::INFINITY);
    for (rates, own) in all {
        (low, high, m_a) = (low.min(rates[0]), high.max(rates[1]), m_a.min(own));
    }
    assert!((rates[0] / low - 1.0).abs() < 1e-13 && (rates[1] / high - 1.0).abs() < 1e-13);
    assert!((compiled.model.certificate().m_a / m_a - 1.0).abs() < 1e-13);

    // times a power of two, which changes no digits
    let jump = json!({"expression": "1 + 3 * min(1, max(0, 1e6 * (x - 0.5)))"});
    let mut factors = of_laws("rectangle", viscous.clone(), with(&elastic, "factor", jump));
    let mut regions = with_regions(
        of_laws("rectangle", viscous.clone(), elastic.clone()),
        &[("right", &[0.5, 0.0], &[1.0, 0.5])],
        &[
            json!({"viscosity": viscous, "elasticity": isotropic(5.2, 0.3, "plane_strain")}),
            json!({"viscosity": viscous, "elasticity": elastic}),
        ],
    );
    for model in MODELS {
        factors["fidelity"]["model"] = model.into();
        regions["fidelity"]["model"] = model.into();
        assert!(bits(&parse(&factors)) == bits(&parse(&regions)), "{model}");
    }
}

/// A plate with free faces is a plane with the laws and the branch that the strain across it leaves; the membrane law is another.
#[test]
fn a_plate_with_free_faces_has_a_branch_on_the_trace() {
    let ([a1, a2], young, poisson) = ([0.05_f64, 0.1_f64], 1.0, 0.4);
    let viscous = json!({"law": "isotropic", "mu1": a1, "mu2": a2});
    let plate = of_laws(
        "rectangle",
        viscous.clone(),
        isotropic(young, poisson, "plane_stress_relaxing"),
    );
    let b1 = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let b2 = young / (1.0 + poisson);
    let spring = ((a1 * b2 - a2 * b1) / (a1 + a2)).powi(2) / (b1 + b2);
    let plane = isotropic(young, poisson, "plane_stress");
    let mut written = of_laws(
        "rectangle",
        json!({"law": "isotropic", "mu1": a1 * a2 / (a1 + a2), "mu2": a2}),
        plane.clone(),
    );
    written["material"]["memory"] =
        json!([{"law": "isotropic", "tau": (a1 + a2) / (b1 + b2), "shear": 0.0, "bulk": spring}]);
    let run = |scene: &Value| seen(&mut start(&parse(scene)));
    let reference = run(&written);
    assert!(largest(&reference) > 1e-3);
    for model in ["full", "condensed", "reduced", "auto"] {
        let mut plate = plate.clone();
        plate["fidelity"]["model"] = model.into();
        let error = relative(&run(&plate), &reference);
        assert!(error < 1e-9, "{model}: {error:e}");
    }
    let membrane = run(&of_laws("rectangle", viscous, plane));
    assert!(relative(&membrane, &reference) > 1e-2);
}
