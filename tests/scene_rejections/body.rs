//! Mistakes in mesh, regions, materials, parts and points.

use super::refusal::*;
use stickslip::{Error, Scene};

#[test]
#[rustfmt::skip] // one row, one mistake
fn materials_across_values() {
    assert_edits_refused(
        "kazmi2014",
        &[
            (r#""mu1": 0.05"#, r#""mu1": -0.05"#, "material.viscosity.mu1", "2 mu1 + mu2 = 0", "> 0"),
            // Each number is in its range, but lambda overflows.
            (r#"1.0, "poisson": 0.3"#, r#"1e308, "poisson": 0.4999"#, "material.elasticity", "lambda = inf", "finite"),
        ],
    );
    let plane = r#""plane_strain", "plane_stress""#;
    assert_edits_refused(
        "kazmi2014",
        &[(r#""kazmi2014"}"#, r#""three_dimensional"}"#, "material.elasticity.convention", "in 2 dimensions", plane)],
    );
    assert_edits_refused(
        "brake_pad_3d",
        &[
            ("three_dimensional", "plane_strain", "material.elasticity.convention", "in 3", r#""kazmi2014", "three_dimensional""#),
            ("three_dimensional", "plane_stress", "material.elasticity.convention", "plane_stress", "three_dimensional"),
            (r#""mu1": 2e4"#, r#""mu1": -4e4"#, "material.viscosity.mu1", "3 mu1 + mu2", "> 0"),
        ],
    );
}

/// Laws with directions: the condition that is violated is named.
#[test]
#[rustfmt::skip] // one row, one mistake
fn anisotropic_materials() {
    let isotropic = r#"{"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "kazmi2014"}"#;
    let law = |young: &str, poisson: &str, more: &str| format!(
        r#"{{"law": "orthotropic", "young": {young}, "poisson": {poisson}, "shear": [1, 1, 1]{more}}}"#
    );
    let good = r#", "convention": "plane_strain""#;
    let matrix = |rows: &str| format!(r#"{{"law": "matrix", "matrix": {rows}}}"#);
    assert_edits_refused(
        "kazmi2014",
        &[
            (isotropic, &law("[1, 1]", "[0, 0, 0]", good), "material.elasticity.young", "[1,1]", "an array of 3"),
            (isotropic, &law("[1, 0, 1]", "[0, 0, 0]", good), "material.elasticity.young[1]", "0", "> 0"),
            (isotropic, &law("[4, 1, 1]", "[2.5, 0, 0]", good), "material.elasticity.poisson[0]", "2.5", "sqrt(E1/E2) = 2"),
            (isotropic, &law("[1, 1, 1]", "[0.6, 0.6, 0.6]", good), "material.elasticity.poisson", "= -0.5", "2 nu21 nu32 nu13 > 0"),
            (isotropic, &law("[1, 1, 1]", "[0, 0, 0]", ""), "material.elasticity.convention", "nothing", r#""plane_strain", "plane_stress""#),
            (isotropic, &law("[1, 1, 1]", "[0, 0, 0]", r#", "axes": [[1,0,0],[0,1,0],[0,0,1]]"#), "material.elasticity.axes", "2 dimensions", "angle_deg"),
            (isotropic, &matrix("[[1, 0], [0, 1]]"), "material.elasticity.matrix", "[2, 2]", "3 rows of 3 numbers"),
            (isotropic, &matrix("[[1, 2, 0], [2, 1, 0], [0, 0, 1]]"), "material.elasticity.matrix", "smallest eigenvalue of -", "positive"),
            (isotropic, &matrix("[[1, 0, 0], [0.1, 1, 0], [0, 0, 1]]"), "material.elasticity.matrix[1][0]", "0.1 and 0", "symmetric"),
            (r#""mu2": 0.1"#, r#""mu2": 0.1, "gradient": [1]"#, "material.viscosity.gradient", "1 numbers", "2 numbers"),
            (r#""mu2": 0.1"#, r#""mu2": 0.1, "factor": {"expression": "1 + q"}"#, "material.viscosity.factor.expression", "character 5", "x"),
            (r#""mu2": 0.1"#, r#""mu2": 0.1, "factor": 2"#, "material.viscosity.factor", "2", "expression"),
        ],
    );
    let elastic = r#""poisson": 0.3, "convention": "kazmi2014"}"#;
    let plate = |more: &str| format!(r#""poisson": 0.3, "convention": "plane_stress_relaxing"{more}"#);
    assert_edits_refused(
        "kazmi2014",
        &[
            (elastic, &plate(r#", "gradient": [0.1, 0]}"#), "material.elasticity.convention", "a law that varies", "isotropic laws"),
            (elastic, &plate(r#"}, "memory": [{"law": "isotropic", "tau": 1, "shear": 1, "bulk": 1}]"#), "material.elasticity.convention", "memory", "without memory"),
        ],
    );
    let solid = |more: &str| format!(
        r#"{{"law": "orthotropic", "young": [1, 1, 1], "poisson": [0, 0, 0], "shear": [1, 1, 1]{more}}}"#
    );
    let isotropic = r#"{"law": "isotropic", "young": 5e6, "poisson": 0.3, "convention": "three_dimensional"}"#;
    assert_edits_refused(
        "brake_pad_3d",
        &[
            (isotropic, &solid(r#", "angle_deg": 3"#), "material.elasticity.angle_deg", "3 dimensions", "axes"),
            (isotropic, &solid(r#", "convention": "plane_strain""#), "material.elasticity.convention", "plane_strain", "three_dimensional"),
            (isotropic, &solid(r#", "axes": [[1,0,0],[0,1,0.1],[0,0,1]]"#), "material.elasticity.axes", "off by 1", "orthonormal"),
        ],
    );
}

#[test]
#[rustfmt::skip] // one row, one mistake
fn meshes_and_parts() {
    let cells = "[32, 16]";
    let refine = |place: &str| format!(r#"[32, 16], "refine": [{place}]"#);
    let left = r#"["left"]"#;
    assert_edits_refused(
        "kazmi2014",
        &[
            (cells, "[40000, 40000]", "mesh.cells", "3200080001 nodes", "at most 1073741824 nodes"),
            (cells, "[4294967295, 4294967295]", "mesh.cells", "nodes", "at most"),
            (cells, r#"[32, 16], "periodic": ["z"]"#, "mesh.periodic[0]", "\"z\"", "x, y"),
            (cells, r#"[32, 16], "periodic": ["w"]"#, "mesh.periodic[0]", "\"w\"", r#""x", "y", "z""#),
            (cells, r#"[32, 16], "periodic": ["x", "x"]"#, "mesh.periodic[1]", "\"x\" a second time", "once"),
            (cells, r#"[32, 16], "periodic": ["x"]"#, "clamped[0]", "\"left\"", "bottom, top (mesh.periodic is [\"x\"])"),
            (cells, r#"[32, 16], "periodic": ["y"]"#, "contact.part", "\"bottom\"", "left, right (mesh.periodic"),
            (cells, r#"[32, 16], "periodic": ["x", "y"]"#, "clamped[0]", "\"left\"", "no part"),
            (cells, r#"[32, 16], "grading": 2"#, "mesh.grading", "2", "an array of 2, each a number >= 1"),
            (cells, r#"[32, 16], "grading": [2.0]"#, "mesh.grading", "[2.0]", "an array of 2, each a number >= 1"),
            (cells, r#"[32, 16], "grading": [2, 0.5]"#, "mesh.grading[1]", "0.5", "a number >= 1"),
            (cells, r#"[32, 16], "grading": [6, 1]"#, "mesh.grading[0]", "6, whose first cell is 2.98", "at most 5.56"),
            (cells, r#"[32, 16], "grading": [1, 2], "periodic": ["y"]"#, "mesh.grading[1]", "2", "1 along an axis of mesh.periodic"),
            (cells, &refine(r#"{"from": [0, 0.5], "size": 0}"#), "mesh.refine[0].size", "0", "> 0"),
            (cells, &refine(r#"{"from": [0, 0.5], "size": 1e-8}"#), "mesh.refine[0].size", "1e-8", "at least 1e-7"),
            (cells, &refine(r#"{"from": [0, 0], "to": [1, 0.5], "size": 1e-5}"#), "mesh.refine[0].size", "1e-5", "at least 3.05"),
            (cells, &refine(r#"{"from": [0, 0.6], "size": 0.1}"#), "mesh.refine[0].from[1]", "0.6", "0 to 0.5, inside the body"),
            (cells, &refine(r#"{"from": [0.2, 0], "to": [0.1, 0], "size": 0.1}"#), "mesh.refine[0].to[0]", "0.1", "0.2 (mesh.refine[0].from) to 1"),
            (cells, &refine(r#"{"from": [0.2, 0], "to": [0.3, 0.6], "size": 0.1}"#), "mesh.refine[0].to[1]", "0.6", "to 0.5"),
            (cells, &refine(r#"{"at": [0.2, 0], "size": 0.1}"#), "mesh.refine[0].at", "unknown key", "from, size, to"),
            (cells, &refine(r#"{"from": [0.2], "size": 0.1}"#), "mesh.refine[0].from", "[0.2]", "an array of 2"),
            (cells, &format!(r#"{}, "periodic": ["x"]"#, refine(r#"{"from": [0, 0], "size": 0.1}"#)), "mesh.refine", "with mesh.periodic", "no refinement of a periodic mesh"),
            (left, r#"["wall"]"#, "clamped[0]", "\"wall\"", "left, right, bottom, top"),
            (left, r#"["front"]"#, "clamped[0]", "\"front\"", "left, right, bottom, top"),
            (left, r#"["left", "left"]"#, "clamped[1]", "a second time", "once"),
            (left, r#"["left", "bottom"]"#, "clamped[1]", "contact.part", "not in contact"),
            (left, "[]", "clamped", "[]", "at least 1"),
            (r#""part": "bottom""#, r#""part": "base""#, "contact.part", "\"base\"", "left, right, bottom, top"),
            (r#""part": "top""#, r#""part": "roof""#, "loads[0].part", "\"roof\"", "left, right, bottom, top"),
            (r#""part": "top""#, r#""part": "bottom""#, "loads[0].part", "contact.part", "not in contact"),
            (r#""part": "top""#, r#""part": "left""#, "loads[0].part", "which is clamped", "not clamped"),
            (r#""part": "top", "#, "", "loads[0].part", "nothing", "for a traction"),
            (r#""traction""#, r#""body_force""#, "loads[0].part", "\"top\"", "no part"),
        ],
    );
    assert_edits_refused(
        "brake_pad_3d",
        &[
            (r#""part": "back""#, r#""part": "rear""#, "loads[1].part", "\"rear\"", "top, back, front"),
            ("[16, 3, 8]", r#"[16, 3, 8], "refine": []"#, "mesh.refine", "unknown key", "cells, grading, kind, periodic, regions, size"),
            ("[16, 3, 8]", r#"[16, 3, 8], "grading": [1, 1]"#, "mesh.grading", "[1,1]", "an array of 3"),
            ("[16, 3, 8]", r#"[16, 3, 8], "grading": [1, 2, 20]"#, "mesh.grading[2]", "20, whose first cell is", "at most 11.1"),
        ],
    );
}

#[test]
#[rustfmt::skip] // one row, one mistake
fn vectors_and_points() {
    let tangent = |t: &str| format!(r#""part": "bottom", "tangent": {t}"#);
    let bottom = r#""part": "bottom""#;
    assert_edits_refused(
        "kazmi2014",
        &[
            ("[0, 1]", "[0, 1, 0]", "loads[0].direction", "[0.0,1.0,0.0]", "2 numbers"),
            ("[0, 1]", "[0, 0]", "loads[0].direction", "[0.0,0.0]", "nonzero"),
            ("[0, 1]", "[0, 1e-200]", "loads[0].direction", "1e-200", "nonzero"),
            ("[0, 1]", "[0, 1e200]", "loads[0].direction", "1e+200", "finite"),
            (bottom, &tangent("[1]"), "contact.tangent", "[1.0]", "2 numbers"),
            (bottom, &tangent("[0, 0]"), "contact.tangent", "[0.0,0.0]", "nonzero"),
            ("[1.0, 0.0]", "[1.0]", "probes[0].at", "[1.0]", "2 numbers"),
        ],
    );
}

/// What only the mesh shows is refused when the body is made, in the same way.
#[test]
#[rustfmt::skip] // one row, one mistake
fn what_the_mesh_shows() {
    let tangent = |t: &str| format!(r#""part": "bottom", "tangent": {t}"#);
    let bottom = r#""part": "bottom""#;
    let regions = |boxes: &str| format!(r#""cells": [8, 4], "regions": [{boxes}]"#);
    let cells = r#""cells": [32, 16]"#;
    let low = r#"{"name": "low", "from": [0, 0], "to": [1, 0.25]}"#;
    let both = r#"["left", "right"]"#;
    let contact = r#""contact": "#;
    let initial = |u: &str| format!(r#""initial": {{"displacement": {u}}}, "contact": "#);
    for (name, edits, path, found, allowed) in [
        ("kazmi2014", vec![(r#"["left"]"#, both.to_owned()), (cells, r#""cells": [1, 16]"#.to_owned())], "clamped", "left", "leave nodes of contact.part free"),
        ("kazmi2014", vec![(bottom, tangent("[0, -2]"))], "contact.tangent", "-2.0", "not normal to the contact"),
        ("kazmi2014", vec![("[1.0, 0.0]", "[1.5, 0.0]".to_owned())], "probes[0].at", "[1.5, 0.0]", "a point of the body"),
        ("kazmi2014", vec![("[1.0, 0.0]", "[1.0, -0.1]".to_owned())], "probes[0].at", "-0.1", "a point of the body"),
        ("kazmi2014", vec![(cells, regions(&format!(r#"{low}, {{"name": "thin", "from": [0, 0.3], "to": [1, 0.301]}}"#)))], "mesh.regions[1]", "a box without cells", "centroid"),
        ("kazmi2014", vec![(cells, regions(&format!(r#"{low}, {{"name": "left", "from": [0, 0], "to": [0.5, 0.5]}}"#)))], "mesh.regions[1]", "mesh.regions[0]", "without common cells"),
        ("kazmi2014", vec![(r#""mu2": 0.1"#, r#""mu2": 0.1, "gradient": [-1.5, 0]"#.to_owned())], "material.viscosity.gradient", "-0.0", "every cell"),
        ("kazmi2014", vec![(r#""mu2": 0.1"#, r#""mu2": 0.1, "factor": {"expression": "y - 0.1"}"#.to_owned())], "material.viscosity.factor.expression", " at [", "every cell"),
        ("kazmi2014", vec![(contact, initial(r#"[{"expression": "0.1 + x"}, 0]"#))], "initial.displacement", "[0.1, 0.0] at the clamped, driven or held node [0.0, ", "0 where"),
        ("kazmi2014", vec![(contact, initial(r#"[0, {"expression": "x"}]"#))], "initial.displacement", "at the contact node [0.03125, 0.0]", "along the foundation"),
        ("kazmi2014", vec![(contact, initial(r#"[{"expression": "1/x"}, 0]"#))], "initial.displacement[0]", "inf at [0.0, 0.0]", "finite"),
        ("brake_pad_3d", vec![(r#""tangent": [1, 0, 0]"#, r#""tangent": [1e-12, 1, 0]"#.to_owned())], "contact.tangent", "1.0", "not normal to the contact"),
        ("brake_pad_3d", vec![("[0.0, 0.0, 0.02]", "[0.0, 0.0, 0.2]".to_owned())], "probes[0].at", "0.2", "a point of the body"),
    ] {
        let mut text = text_of(name).to_owned();
        for (old, new) in &edits {
            assert_eq!(text.matches(old).count(), 1, "{old:?} must occur once");
            text = text.replace(old, new);
        }
        let scene = Scene::from_json(&text, "test.json").expect("a scene whose mesh is at fault");
        match stickslip::compile(&scene).map(drop) {
            Err(Error::Scene { path: at, found: was, allowed: may, .. }) => {
                assert_eq!(at, path, "found {was}, allowed {may}");
                assert!(was.contains(found), "{path}: {was:?} lacks {found:?}");
                assert!(may.contains(allowed), "{path}: {may:?} lacks {allowed:?}");
            }
            other => panic!("{path}: {other:?}"),
        }
    }
    let text = text_of("kazmi2014").replace(r#"["left"]"#, both);
    let quadratic = text.replace(cells, r#""cells": [1, 16]"#).replace(r#""p1""#, r#""p2""#);
    for text in [text, quadratic] {
        let scene = Scene::from_json(&text, "test.json").expect("a valid scene");
        assert!(stickslip::compile(&scene).is_ok());
    }
}

/// Regions of the mesh and their materials, by what a scene alone shows.
#[test]
fn regions_and_materials() {
    let mut scene: serde_json::Value = serde_json::from_str(text_of("kazmi2014")).expect("JSON");
    let material = scene["material"].clone();
    let of = |region: &str| {
        let mut material = material.clone();
        material["region"] = region.into();
        material
    };
    let region = |name: &str, from: &[f64], to: &[f64]| serde_json::json!({"name": name, "from": from, "to": to});
    scene["mesh"]["regions"] = [region("low", &[0.0, 0.0], &[1.0, 0.25])]
        .into_iter()
        .collect();
    let both = scene.clone();
    scene.as_object_mut().expect("a scene").remove("material");
    let with = |materials: Vec<serde_json::Value>| {
        let mut scene = scene.clone();
        scene["materials"] = materials.into();
        scene
    };
    let with_region = |region: serde_json::Value| {
        let mut scene = both.clone();
        scene["mesh"]["regions"][0] = region;
        scene
    };
    let mut flawed = of("body");
    flawed["viscosity"]["mu1"] = (-0.05).into();
    let mut beside = both.clone();
    beside["materials"] = vec![of("low"), of("body")].into();
    let mut both_of_one = both.clone();
    both_of_one["material"] = serde_json::Value::Null;
    for (scene, path, found, allowed) in [
        (
            scene.clone(),
            "material",
            "nothing",
            "or materials, by region",
        ),
        (both_of_one, "material", "null", "an object with the keys"),
        (
            beside,
            "materials",
            "beside material",
            "materials by region",
        ),
        (
            with(vec![of("low"), of("rim")]),
            "materials[1].region",
            "\"rim\"",
            "the regions low, body",
        ),
        (
            with(vec![of("low"), of("low")]),
            "materials[1].region",
            "a second time",
            "once",
        ),
        (
            with(vec![of("body")]),
            "materials",
            "none for the region \"low\"",
            "every region",
        ),
        (
            with(vec![of("low"), flawed]),
            "materials[1].viscosity.mu1",
            "2 mu1 + mu2 = 0",
            "> 0",
        ),
        (
            with(vec![material.clone()]),
            "materials[0].region",
            "nothing",
            "Name of the region",
        ),
        (
            with_region(region("body", &[0.0, 0.0], &[1.0, 0.25])),
            "mesh.regions[0].name",
            "body",
            "in no box",
        ),
        (
            with_region(region("low", &[0.0], &[1.0, 0.25])),
            "mesh.regions[0].from",
            "[0.0]",
            "2 numbers",
        ),
        (
            with_region(region("low", &[0.0, 0.3], &[1.0, 0.25])),
            "mesh.regions[0].to[1]",
            "0.25",
            "> 0.3",
        ),
    ] {
        assert_refused(&scene.to_string(), (path, found, allowed));
    }
    // whether cells are left to the body, the mesh knows
    let everywhere = |materials: Vec<serde_json::Value>| {
        let mut scene = with(materials);
        scene["mesh"]["regions"][0] = region("low", &[0.0, 0.0], &[1.0, 0.5]);
        scene["mesh"]["cells"] = vec![4, 2].into();
        scene
    };
    for (scene, expected) in [
        (
            with(vec![of("low")]),
            Some(("materials", "none for the region \"body\"")),
        ),
        (
            everywhere(vec![of("low"), of("body")]),
            Some(("materials[1].region", "a region without cells")),
        ),
        (everywhere(vec![of("low")]), None),
        (both, None),
    ] {
        let scene = Scene::from_json(&scene.to_string(), "test.json").expect("a valid scene");
        assert_eq!(
            Scene::from_json(&scene.to_json(), "test.json").as_ref(),
            Ok(&scene)
        );
        match (stickslip::compile(&scene).map(drop), expected) {
            (Ok(()), None) => {}
            (Err(Error::Scene { path, found, .. }), Some((at, was))) => {
                assert_eq!(path, at);
                assert!(found.contains(was), "{found}");
            }
            other => panic!("{other:?}"),
        }
    }
}
