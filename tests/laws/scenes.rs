//! Scenes with every law, all models and schemes: what the outputs show is the law.

use crate::common::random::Random;
use crate::common::{largest, paper, started, value, values};
use crate::{draw, laws_in_pascal};
use serde_json::json;
use stickslip::contact::SlipPath;
use stickslip::contact::bounds::Bounds;
use stickslip::contact::law::{ChosenLaw, Given};
use stickslip::scene::Friction;
use stickslip::{Error, Scene, Simulator, compile};

/// The friction of a scene with these coefficients, as its JSON text.
fn text(chosen: &ChosenLaw) -> String {
    let law = chosen.law();
    let given = law.coefficients().zip(chosen.places());
    let given = given.map(|(declared, place)| {
        let list = chosen.start()[place.range()].to_vec();
        match (place.is_array, declared.extent) {
            _ if list.is_empty() => Given::Absent,
            (false, _) => Given::Number(list[0]),
            (true, stickslip::contact::law::Extent::Nodes) => Given::Nodes(list),
            (true, _) => match place.columns {
                Some(columns) => {
                    let rows = list.len() / columns;
                    Given::Rows(list, vec![columns; rows])
                }
                None => Given::Points(list),
            },
        }
    });
    let friction = Friction {
        law: chosen.law(),
        coefficients: given.collect(),
        memory: Vec::new(),
    };
    serde_json::to_string(&friction).unwrap()
}

/// Stresses of the nodes against the law: at the bound against the slip, or within it at rest.
fn assert_law_holds(simulator: &Simulator, chosen: &ChosenLaw, label: &str) {
    let stress = values(simulator, "contact.tangential_stress");
    let rates = values(simulator, "contact.slip_rate");
    let slips = values(simulator, "contact.accumulated_slip");
    let bounds = chosen.bounds();
    let of = |node: usize, rate: f64| {
        let path = SlipPath {
            base: slips[node],
            per_rate: 0.0,
        };
        bounds.evaluate(node, rate, path).bound
    };
    let scale = (0..rates.len())
        .map(|node| of(node, 0.0))
        .fold(largest(&stress), f64::max);
    for (node, (stress, rate)) in stress.iter().zip(&rates).enumerate() {
        let bound = of(node, rate.abs());
        let violated = if *rate == 0.0 {
            stress.abs() - bound
        } else {
            (stress + bound * rate.signum()).abs()
        };
        assert!(
            violated <= 1e-9 * bound.max(1e-3 * scale),
            "{label}: node {node}, {violated:e} of {bound:e}"
        );
    }
}

#[test]
fn stresses_are_those_of_the_law() {
    let mut random = Random::new(5);
    let (mut slipped, mut stuck) = (0.0_f64, 0.0_f64);
    for law in laws_in_pascal() {
        for model in ["full", "condensed", "reduced"] {
            for scheme in ["trapezoid", "backward_euler", "tr_bdf2"] {
                for fields in [None, Some(8)] {
                    let chosen = draw(law, &mut random, fields);
                    let friction = text(&chosen);
                    let label = format!("{model} {scheme} {friction}");
                    let scene = paper(
                        8,
                        &[
                            ("fidelity.model", model),
                            ("time.scheme", scheme),
                            ("contact.friction", &friction),
                        ],
                    );
                    let mut simulator = started(compile(&scene).unwrap());
                    for step in 0..12 {
                        let press = -0.3 * (1.0 + 0.8 * f64::from(step).sin());
                        simulator.set_inputs(&[press]).unwrap();
                        simulator
                            .do_step(simulator.time(), 0.05)
                            .unwrap_or_else(|e| panic!("{label}: {e}"));
                        assert_law_holds(&simulator, &chosen, &label);
                        slipped = slipped.max(value(&simulator, "contact.max_slip_rate"));
                        stuck = stuck.max(value(&simulator, "contact.stick_fraction"));
                    }
                }
            }
        }
    }
    assert!(slipped > 0.01 && stuck > 0.5, "{slipped} {stuck}");
}

/// A friction reads back equal, and is written as the scene has it.
#[test]
fn friction_reads_back_as_it_was_written() {
    let mut random = Random::new(9);
    for law in laws_in_pascal() {
        for fields in [None, Some(8)] {
            let friction = text(&draw(law, &mut random, fields));
            let scene = paper(8, &[("contact.friction", &friction)]);
            assert_eq!(
                serde_json::to_string(&scene.contacts()[0].friction).unwrap(),
                friction
            );
            let again = Scene::from_json(&scene.to_json(), "again").unwrap();
            assert_eq!(again, scene);
        }
    }
    // a number is the kind that Tresca's law is
    let number = paper(
        8,
        &[("contact.friction", r#"{"law": "bound", "bound": 0.002}"#)],
    );
    let tresca = paper(
        8,
        &[("contact.friction", r#"{"law": "tresca", "bound": 0.002}"#)],
    );
    assert_eq!(number, tresca);
}

/// The same law under its two names: the same bits.
#[test]
fn the_exponential_kind_is_the_exponential_law() {
    let law = json!({"law": "exponential", "a": 0.003, "b": 0.001, "alpha": 100.0});
    let kind = json!({"law": "bound", "bound": {"kind": "exponential", "static": 0.003, "kinetic": 0.001, "decay": 100.0}});
    let fields = json!({"law": "exponential", "a": {"nodes": vec![0.003; 8]}, "b": 0.001, "alpha": {"nodes": vec![100.0; 8]}});
    let run = |friction: &serde_json::Value| {
        let scene = paper(8, &[("contact.friction", &friction.to_string())]);
        let mut simulator = started(compile(&scene).unwrap());
        let mut all = Vec::new();
        for _ in 0..16 {
            simulator.do_step(simulator.time(), 1.0 / 16.0).unwrap();
            let rates = values(&simulator, "contact.slip_rate");
            let stress = values(&simulator, "contact.tangential_stress");
            all.extend(rates.iter().chain(&stress).map(|v| v.to_bits()));
        }
        assert!(value(&simulator, "contact.max_slip_rate") > 0.0);
        all
    };
    assert_eq!(run(&law), run(&kind));
    assert_eq!(run(&law), run(&fields));
}

/// Coefficients per node belong to the mesh that they were given for.
#[test]
fn a_field_of_another_mesh_is_refused() {
    let field =
        |count: usize| json!({"law": "tresca", "bound": {"nodes": vec![0.002; count]}}).to_string();
    for count in [7, 9] {
        let scene = paper(8, &[("contact.friction", &field(count))]);
        let error = compile(&scene).err().unwrap();
        let text = error.to_string();
        assert!(matches!(error, Error::Scene { .. }), "{text}");
        let parts = [
            "contact.friction.bound.nodes",
            &count.to_string(),
            "one number per contact node: 8",
        ];
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    }
    let scene = stickslip::scene::example("kazmi2014").unwrap();
    let overrides = [
        ("contact.friction", field(32).as_str()),
        ("fidelity.target_error", "0.1"),
    ]
    .map(|(path, value)| (path.to_owned(), value.to_owned()));
    let error = Scene::with_overrides(scene, "test", &overrides)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("fidelity.target_error") && error.contains("contact.friction.bound"),
        "{error}"
    );
    let scene = paper(8, &[("contact.friction", &field(8))]);
    let error = stickslip::tradeoff::Study::new(&scene)
        .err()
        .unwrap()
        .to_string();
    assert!(
        error.contains("contact.friction.bound") && error.contains("one mesh"),
        "{error}"
    );
}
