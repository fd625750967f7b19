//! Anisotropic laws, matrices and factors, and the plate.

use super::*;

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
