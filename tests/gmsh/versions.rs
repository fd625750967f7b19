//! One geometry is one mesh and one model, whoever wrote the file.

use crate::writer::{FORMATS, File, Format};
use crate::{all, read, read_scaled};
use std::collections::BTreeMap;
use stickslip::mesh::Mesh;
use stickslip::{MemoryFiles, Model, Scene, Simulator, compile, compile_from};

/// Corners of the cells by their places, sorted: what a mesh is, whatever its numbers.
fn cells_by_place(mesh: &Mesh) -> Vec<(String, Vec<[i64; 3]>)> {
    let key = |node: &u32| mesh.nodes[*node as usize].map(|x| (1e9 * x).round() as i64);
    let mut all: Vec<_> = mesh
        .cells()
        .zip(&mesh.cell_regions)
        .map(|(cell, region)| {
            let mut places: Vec<_> = cell.iter().map(key).collect();
            places.sort_unstable();
            (mesh.regions[*region as usize].clone(), places)
        })
        .collect();
    all.sort();
    all
}

#[test]
fn every_version_gives_the_same_mesh() {
    for mesh in all() {
        let file = File::of(&mesh);
        let first = read(&file.write(Format::Text4)).unwrap();
        assert_eq!(first.element, mesh.element);
        assert_eq!(first.nodes.len(), mesh.nodes.len());
        assert_eq!(cells_by_place(&first), cells_by_place(&mesh));
        assert!(first.unusable.is_empty());
        // sizes of regions and parts, and the normals of the faces with them
        let (found, expected) = (first.quality(), mesh.quality());
        let sizes = |q: &stickslip::mesh::Quality| -> BTreeMap<String, (usize, i64)> {
            let scaled = |x: f64| (1e12 * x).round() as i64;
            let regions = q
                .regions
                .iter()
                .map(|r| (format!("region {}", r.name), (r.cells, scaled(r.measure))));
            let parts = q
                .parts
                .iter()
                .map(|p| (format!("part {}", p.name), (p.faces, scaled(p.measure))));
            regions.chain(parts).collect()
        };
        assert_eq!(sizes(&found), sizes(&expected));
        for format in FORMATS {
            for file in [&file, &file.otherwise()] {
                let other = read(&file.write(format)).unwrap();
                assert_eq!(other, first, "{format:?} {}", mesh.element.name);
            }
        }
    }
}

/// Closed surfaces: the outward normals of all faces add up to nothing, and every face has the cell on its inner side.
#[test]
fn faces_point_outward() {
    for mesh in all() {
        let mesh = read(&File::of(&mesh).write(Format::Binary4(false, 8))).unwrap();
        let place = |node: u32| mesh.nodes[node as usize];
        let bounds = mesh.bounds();
        let mut sum = [0.0; 3];
        for face in mesh
            .parts
            .values()
            .flat_map(|faces| faces.chunks_exact(mesh.element.face_nodes()))
        {
            let edge = |i: usize| -> [f64; 3] {
                std::array::from_fn(|c| place(face[i])[c] - place(face[0])[c])
            };
            let (a, b) = (
                edge(1),
                if mesh.dimension == 3 {
                    edge(2)
                } else {
                    [0.0, 0.0, 1.0]
                },
            );
            let normal = [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ];
            // away from the middle of the box
            let out: f64 = (0..3)
                .map(|c| normal[c] * (place(face[0])[c] - 0.5 * (bounds[0][c] + bounds[1][c])))
                .sum();
            assert!(out > 0.0);
            for c in 0..3 {
                sum[c] += normal[c];
            }
        }
        assert!(sum.iter().all(|x| x.abs() < 1e-14), "{sum:?}");
    }
}

#[test]
fn scale_multiplies_the_coordinates() {
    let mesh = &all()[0];
    let bytes = File::of(mesh).write(Format::Text2);
    let (metres, other) = (read(&bytes).unwrap(), read_scaled(&bytes, 0.001).unwrap());
    for (p, q) in metres.nodes.iter().zip(&other.nodes) {
        assert_eq!(p.map(|x| 0.001 * x), *q);
    }
    assert_eq!(metres.cell_nodes, other.cell_nodes);
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = read_scaled(&bytes, scale).unwrap_err().to_string();
        assert!(error.contains("at mesh.scale"), "{error}");
    }
    // coordinates that overflow
    let error = read_scaled(&bytes, 1.7e308).unwrap_err().to_string();
    assert!(
        error.contains("$Nodes: node") && error.contains("after mesh.scale"),
        "{error}"
    );
}

/// The paper's example on a given mesh.
pub fn paper(mesh: &str) -> Scene {
    let text = stickslip::scene::example("kazmi2014").unwrap();
    let overrides = [
        ("mesh", mesh),
        ("fidelity.model", "condensed"),
        ("fidelity.friction_tolerance", "1e-12"),
    ];
    Scene::with_overrides(
        text,
        "kazmi2014",
        &overrides.map(|(p, v)| (p.to_owned(), v.to_owned())),
    )
    .unwrap()
}

pub fn run(model: std::sync::Arc<Model>) -> Vec<f64> {
    let mut simulator = Simulator::new(model);
    simulator.init(0.0).unwrap();
    for n in 0..32 {
        simulator.set_inputs(&[-0.3]).unwrap();
        simulator.do_step(f64::from(n) / 32.0, 1.0 / 32.0).unwrap();
    }
    let mut values = vec![0.0; simulator.output_len()];
    simulator.get_outputs(&mut values).unwrap();
    values
}

#[test]
fn every_version_gives_the_same_model() {
    let generated = r#"{"kind": "rectangle", "size": [1.0, 0.5], "cells": [8, 4]}"#;
    let rectangle = crate::generated(generated, Default::default());
    let file = File::of(&rectangle);
    let scene = paper(r#"{"kind": "gmsh", "file": "part.msh"}"#);
    let compiled =
        |bytes: &[u8]| compile_from(&scene, &MemoryFiles::new([("part.msh", bytes)])).unwrap();
    let first = compiled(&file.write(Format::Text4));
    for format in FORMATS {
        let bytes = file.otherwise().write(format);
        let model = compiled(&bytes);
        assert_eq!(model.fingerprint(), first.fingerprint(), "{format:?}");
        // the file travels with the model, and compiles to the same model again
        let loaded = Model::from_bytes(&model.to_bytes()).unwrap();
        assert_eq!(loaded.to_bytes(), model.to_bytes());
        assert_eq!(loaded.files().0["part.msh"][..], bytes[..]);
        let again = compile_from(loaded.scene(), loaded.files()).unwrap();
        assert_eq!(again.to_bytes(), model.to_bytes());
    }
    // and steps as the generated mesh does, but for the order of sums
    let (ours, expected) = (run(first), run(compile(&paper(generated)).unwrap()));
    assert_eq!(ours.len(), expected.len());
    let largest = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let worst = ours
        .iter()
        .zip(&expected)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    let moves = expected.iter().filter(|x| x.abs() > 1e-3).count();
    assert!(
        moves > 10 && worst < 1e-10 * largest,
        "{worst:e} of {largest}"
    );
}

#[test]
fn a_scene_without_its_file_is_refused_by_name() {
    let scene = paper(r#"{"kind": "gmsh", "file": "part.msh"}"#);
    let error = compile(&scene).map(drop).unwrap_err().to_string();
    assert!(
        error.contains("at mesh.file: found \"part.msh\", which cannot be read: no files came"),
        "{error}"
    );
    let error = compile_from(&scene, &MemoryFiles::new([("other.msh", &b"x"[..])]))
        .map(drop)
        .unwrap_err();
    assert!(
        error.to_string().contains("came with the scene: other.msh"),
        "{error}"
    );
    let folder = std::env::temp_dir().join("stickslip_without_a_mesh");
    let error = compile_from(&scene, &stickslip::Folder(folder))
        .map(drop)
        .unwrap_err()
        .to_string();
    assert!(error.contains("stickslip_without_a_mesh"), "{error}");
}

/// What only the mesh can say is said of the scene, by its path.
#[test]
fn scenes_are_checked_against_the_mesh() {
    let file = File::of(&crate::rectangle(Default::default()));
    let files = MemoryFiles::new([("part.msh", &file.write(Format::Text4)[..])]);
    let gmsh = r#"{"kind": "gmsh", "file": "part.msh"}"#;
    let text = stickslip::scene::example("kazmi2014").unwrap();
    for (path, value, at, said) in [
        (
            "clamped",
            r#"["side"]"#,
            "clamped[0]",
            "the parts of the mesh: bottom, left, right, top",
        ),
        ("contact.part", "\"belt\"", "contact.part", "\"belt\""),
        (
            "loads[0].direction",
            "[0, 1, 0]",
            "loads[0].direction",
            "2 numbers, one per dimension",
        ),
        (
            "probes[0].at",
            "[0, 1, 0]",
            "probes[0].at",
            "2 numbers, one per dimension",
        ),
        (
            "contact.tangent",
            "[0, 1, 0]",
            "contact.tangent",
            "2 numbers, one per dimension",
        ),
        (
            "material.elasticity.convention",
            "\"three_dimensional\"",
            "material.elasticity.convention",
            "plane",
        ),
        (
            "fidelity.memory_limit",
            "1e3",
            "mesh.file",
            "what takes at most 0.000 GB (fidelity.memory_limit)",
        ),
        ("element", "\"p2\"", "", ""),
    ] {
        let overrides = [("mesh", gmsh), (path, value)].map(|(p, v)| (p.to_owned(), v.to_owned()));
        let scene = Scene::with_overrides(text, "scene", &overrides);
        let outcome = scene.and_then(|scene| compile_from(&scene, &files));
        match (at, outcome.map(|model| model.summary().mesh_nodes)) {
            // linear cells get midside nodes, and the probe at (1, 0) is inside
            ("", Ok(nodes)) => assert!(nodes > file.nodes.len()),
            (at, Err(error)) => {
                let error = error.to_string();
                assert!(
                    error.contains(&format!("at {at}: ")) && error.contains(said),
                    "{error}"
                );
            }
            (_, Ok(_)) => panic!("{path} = {value} was taken"),
        }
    }
    let overrides = [("mesh", gmsh), ("fidelity.target_error", "0.01")]
        .map(|(p, v)| (p.to_owned(), v.to_owned()));
    let error = Scene::with_overrides(text, "scene", &overrides)
        .unwrap_err()
        .to_string();
    assert!(error.contains("at fidelity.target_error"), "{error}");
}

/// Files that Gmsh itself has written: of second order, bent, with an interface between two regions.
#[test]
fn files_of_gmsh_itself_are_one_mesh() {
    let read = |bytes: &[u8]| {
        let mut mesh = read(bytes).unwrap();
        // the reason names an element, whose number is another one in each version
        let why = mesh.unusable.remove("interface").unwrap();
        assert!(
            why.ends_with("lies inside the body, between two cells"),
            "{why}"
        );
        assert!(mesh.unusable.is_empty());
        mesh
    };
    let first = read(include_bytes!("../meshes/shoe.msh"));
    for bytes in [
        &include_bytes!("../meshes/shoe.bin.msh")[..],
        include_bytes!("../meshes/shoe.v2.msh"),
        include_bytes!("../meshes/shoe.v2.bin.msh"),
    ] {
        assert_eq!(read(bytes), first);
    }
    assert_eq!(first.regions, ["lining", "rim"]);
    let names: Vec<&str> = first.parts.keys().map(String::as_str).collect();
    assert_eq!(names, ["7", "cam", "drum face", "pivot"]);
    // areas and arcs of the drawing: parabolas through three points of an arc of 0.3
    let quality = first.quality();
    for (region, area) in [
        ("rim", 0.6 * (0.12f64.powi(2) - 0.01)),
        ("lining", 0.6 * (0.14f64.powi(2) - 0.12f64.powi(2))),
    ] {
        let found = quality.regions.iter().find(|r| r.name == region).unwrap();
        assert!(
            (found.measure / area - 1.0).abs() < 1e-4,
            "{region} {}",
            found.measure
        );
    }
    let arc = quality
        .parts
        .iter()
        .find(|p| p.name == "drum face")
        .unwrap();
    assert!((arc.measure / (1.2 * 0.14) - 1.0).abs() < 1e-4);
}

#[test]
fn a_solid_of_gmsh_has_its_curved_face() {
    let mesh = read(include_bytes!("../meshes/wedge.msh")).unwrap();
    assert_eq!(
        (mesh.element.name, mesh.regions[0].as_str()),
        ("tet10", "wedge")
    );
    let quality = mesh.quality();
    let quarter = std::f64::consts::FRAC_PI_4;
    assert!((quality.regions[0].measure / (0.5 * quarter) - 1.0).abs() < 1e-4);
    for (name, area) in [("base", quarter), ("lid", quarter), ("curved", quarter)] {
        let found = quality.parts.iter().find(|p| p.name == name).unwrap();
        assert!(
            (found.measure / area - 1.0).abs() < 1e-3,
            "{name} {}",
            found.measure
        );
    }
    assert!(quality.bent > 0 && quality.least_jacobian > 0.5);
}
