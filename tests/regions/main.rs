//! Bodies of several materials: regions of equal material are one body to the bit, layers against closed forms, model against
//! model, and what is computed from the materials of all regions.

#[path = "../common/mod.rs"]
mod common;
mod laws;
mod models;

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
