//! Memory is estimated before it is taken: what does not fit is refused with the estimate and the place in the scene.

mod common;

use common::{column, paper, scene};
use serde_json::json;
use stickslip::scene::ModelKind;
use stickslip::{Error, Model, Scene, compile};

fn refusal(scene: &Scene) -> (String, String, String) {
    match compile(scene).err() {
        Some(Error::Scene {
            path,
            found,
            allowed,
            ..
        }) => (path, found, allowed),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_recorded_past_and_a_mesh_beyond_the_limit_are_refused_with_the_estimate() {
    // 3 states of a million rows of 1 + 3 x 256 numbers: 18.5 GB
    let past = [("mesh.cells", "[256, 4]"), ("history.capacity", "1000000")];
    let (path, found, allowed) = refusal(&paper(4, &past));
    assert_eq!(path, "history.capacity");
    assert!(
        found.contains("about 18.") && found.contains(" GB"),
        "{found}"
    );
    assert!(allowed.contains("fidelity.memory_limit"), "{allowed}");

    // 4.5 million nodes: the factor alone takes 20 GB
    for model in ["full", "condensed", "reduced", "auto"] {
        let mesh = [("mesh.cells", "[1500, 1500]"), ("fidelity.model", model)];
        let (path, found, _) = refusal(&paper(4, &mesh));
        assert_eq!(path, "mesh.cells");
        assert!(
            found.contains("4503001 nodes") && found.contains(" GB"),
            "{found}"
        );
    }
    // before there is a mesh: this one would take a terabyte
    let (path, ..) = refusal(&paper(4, &[("mesh.cells", "[20000, 20000]")]));
    assert_eq!(path, "mesh.cells");
    let refined = [(
        "mesh.refine",
        r#"[{"from": [0, 0], "to": [1, 0.5], "size": 1e-4}]"#,
    )];
    assert_eq!(refusal(&paper(4, &refined)).0, "mesh.cells");
}

#[test]
fn the_limit_is_that_of_the_scene() {
    let limited = |bytes: &str, model: &str| {
        paper(
            16,
            &[("fidelity.memory_limit", bytes), ("fidelity.model", model)],
        )
    };
    for model in ["full", "condensed", "reduced", "auto"] {
        assert!(compile(&limited("1e8", model)).is_ok(), "{model}");
        assert_eq!(refusal(&limited("1e5", model)).0, "mesh.cells", "{model}");
    }
    // a long contact has much in common with itself: the reduction needs more than the whole mesh, and auto says so
    let long = |model: &str| {
        let all = [
            ("mesh.cells", "[200, 1]"),
            ("fidelity.memory_limit", "2e7"),
            ("fidelity.model", model),
        ];
        paper(4, &all)
    };
    assert_eq!(refusal(&long("reduced")).0, "mesh.cells");
    let model = compile(&long("auto")).unwrap();
    assert_eq!(model.summary().kind, ModelKind::Condensed);
    let why = model.summary().fallback.clone().unwrap();
    assert!(why.contains("fidelity.memory_limit"), "{why}");
    // the default is not written, and costs no scene its bits
    assert!(!paper(4, &[]).to_json().contains("memory_limit"));
}

#[test]
fn a_model_tells_the_size_of_its_states_and_simulators() {
    for capacity in [0, 7] {
        let mut value = column(
            json!({"law": "tresca", "bound": 0.1}),
            json!({"step": 0.1, "tolerance": 1e-3}),
        );
        value["history"] = json!({"capacity": capacity});
        let model = compile(&scene(&value)).unwrap();
        let state = stickslip::Simulator::new(model.clone()).state().byte_len();
        assert_eq!(model.state_bytes(), state);
        assert!(model.simulator_bytes() > 3 * state);
    }
}

/// Bytes of a model whose scene asks for more than its format allows, or for more memory than there may be.
#[test]
fn a_compiled_model_is_no_way_around_the_limits() {
    let bytes = compile(&paper(4, &[("history.capacity", "1000000")]))
        .unwrap()
        .to_bytes();
    for (from, to) in [
        ("\"capacity\": 1000000", "\"capacity\": 9000000"),
        ("\"step\": 0.03125", "\"step\": -.03125"),
        ("\"alpha\": 100.0", "\"alpha\": -10.0"),
        ("\"cells\": [\n      4,", "\"cells\": [\n      0,"),
    ] {
        let forged = forge(&bytes, from, to);
        match Model::from_bytes(&forged).err() {
            Some(Error::Bytes { what }) => println!("{what}"),
            other => panic!("{from}: {other:?}"),
        }
    }
    // within the ranges, but beyond the limit
    let limited = paper(
        4,
        &[
            ("history.capacity", "1000"),
            ("fidelity.memory_limit", "9999999"),
        ],
    );
    let bytes = compile(&limited).unwrap().to_bytes();
    let forged = forge(
        &bytes,
        "\"memory_limit\": 9999999.0",
        "\"memory_limit\": 9999.0",
    );
    assert!(matches!(
        Model::from_bytes(&forged).err(),
        Some(Error::Bytes { .. })
    ));
}

/// Replaces a text of the same length, and makes fingerprint and checksum fit.
fn forge(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let mut forged = bytes.to_vec();
    let at = bytes
        .windows(from.len())
        .position(|w| w == from.as_bytes())
        .expect(from);
    let mut to = to.to_owned();
    while to.len() < from.len() {
        to.push(' ');
    }
    assert_eq!(to.len(), from.len());
    forged[at..at + from.len()].copy_from_slice(to.as_bytes());
    common::reseal(&mut forged);
    forged
}
