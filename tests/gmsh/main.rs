//! Meshes of Gmsh: every version and encoding gives the same mesh and model, traps are read right or refused by name, broken
//! files never panic nor take memory, bent cells have the accuracy of their degree.

#![allow(unsafe_code)] // a counting allocator

mod bent;
mod bodies;
mod fuzz;
mod sections;
mod traps;
mod versions;
mod writer;

use stickslip::element::ElementKind;
use stickslip::mesh::{GmshMesh, Mesh, MeshSpec};
use stickslip::{Error, MemoryFiles, Result};

/// Reads a file in memory.
pub fn read(bytes: &[u8]) -> Result<Mesh> {
    read_scaled(bytes, 1.0)
}

pub fn read_scaled(bytes: &[u8], scale: f64) -> Result<Mesh> {
    let file = "part.msh".to_owned();
    let files = MemoryFiles::new([("part.msh", bytes)]);
    Mesh::read(&MeshSpec::Gmsh(GmshMesh { file, scale }), &files)
}

/// What is said of a file that is refused.
pub fn refusal(bytes: &[u8]) -> String {
    match read(bytes) {
        Err(error @ Error::Scene { .. }) => {
            let text = error.to_string();
            assert!(text.contains("at mesh.file: found part.msh: "), "{text}");
            assert_eq!(text.lines().count(), 1);
            text
        }
        other => panic!("{other:?}"),
    }
}

/// A generated mesh, with places that need all digits.
pub fn generated(spec: &str, kind: ElementKind) -> Mesh {
    let spec: MeshSpec = serde_json::from_str(spec).unwrap();
    let mesh = Mesh::generate(&spec).unwrap();
    mesh.for_element(kind).unwrap()
}

/// A rectangle with two regions.
pub fn rectangle(kind: ElementKind) -> Mesh {
    let spec = r#"{"kind": "rectangle", "size": [1.1, 0.7], "cells": [3, 2], "grading": [1.3, 1.1],
        "regions": [{"name": "brake lining", "from": [0, 0], "to": [1.1, 0.35]}]}"#;
    generated(spec, kind)
}

/// A box with two regions.
pub fn solid(kind: ElementKind) -> Mesh {
    let spec = r#"{"kind": "box", "size": [1.1, 0.7, 0.3], "cells": [2, 1, 2], "grading": [1.3, 1.1, 1.2],
        "regions": [{"name": "lining", "from": [0, 0, 0], "to": [1.1, 0.7, 0.15]}]}"#;
    generated(spec, kind)
}

/// All of these, linear and quadratic.
pub fn all() -> Vec<Mesh> {
    let kinds = [ElementKind::P1, ElementKind::P2];
    kinds
        .into_iter()
        .flat_map(|kind| [rectangle(kind), solid(kind)])
        .collect()
}
