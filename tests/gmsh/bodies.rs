//! Bodies on meshes of Gmsh: the patch test, and pieces that do not hang together.

use crate::versions::paper;
use crate::writer::{File, Format};
use crate::{generated, read};
use stickslip::element::ElementKind;
use stickslip::fem::Body;
use stickslip::mesh::Mesh;
use stickslip::{Error, MemoryFiles, Scene, compile_from};

/// The file of a mesh whose inner nodes are moved; second-order cells keep straight sides.
fn irregular(spec: &str, kind: ElementKind) -> Mesh {
    let mut linear = generated(spec, ElementKind::P1);
    let mut is_outer = vec![false; linear.nodes.len()];
    linear
        .parts
        .values()
        .flatten()
        .for_each(|n| is_outer[*n as usize] = true);
    let d = linear.dimension;
    for (i, node) in linear
        .nodes
        .iter_mut()
        .enumerate()
        .filter(|(i, _)| !is_outer[*i])
    {
        for (c, x) in node.iter_mut().enumerate().take(d) {
            *x += 0.02 * ((7 * i + 3 * c) as f64).sin();
        }
    }
    read(&File::of(&linear.for_element(kind).unwrap()).write(Format::Binary4(false, 8))).unwrap()
}

/// The field `u = (x, 0)` is clamped at x = 0 and tangential at the bottom; its stress is uniform, so that no force is left inside.
#[test]
fn a_linear_field_leaves_no_force_inside() {
    let plane = r#"{"kind": "rectangle", "size": [1.0, 0.5], "cells": [6, 3]}"#;
    let space = r#"{"kind": "box", "size": [1.0, 0.5, 0.4], "cells": [4, 2, 2]}"#;
    for (spec, kind) in [
        (plane, ElementKind::P1),
        (plane, ElementKind::P2),
        (space, ElementKind::P1),
    ] {
        let mesh = irregular(spec, kind);
        let mut scene = paper(r#"{"kind": "gmsh", "file": "part.msh"}"#);
        scene.element = Some(kind);
        if mesh.dimension == 3 {
            scene.loads[0].direction = vec![0.0, 1.0, 0.0];
            scene.probes.clear();
        }
        let body = Body::assemble_on(&scene, mesh).unwrap();
        let mut u = vec![0.0; body.len()];
        let mut is_outer = vec![false; body.mesh.nodes.len()];
        body.mesh
            .parts
            .values()
            .flatten()
            .for_each(|n| is_outer[*n as usize] = true);
        for node in 0..body.mesh.nodes.len() as u32 {
            let x = body.mesh.nodes[node as usize][0];
            for (dof, axis) in body.dofs.range(node).zip(body.dofs.frame(node)) {
                u[dof] = x * axis[0];
            }
        }
        let mut force = vec![0.0; body.len()];
        body.operators.apply(&body.operators.b, &u, &mut force);
        let (mut inside, mut outside) = (0.0f64, 0.0f64);
        let mut count = 0;
        for (node, is_outer) in (0..).zip(&is_outer) {
            for dof in body.dofs.range(node) {
                match is_outer {
                    true => outside = outside.max(force[dof].abs()),
                    false => {
                        count += 1;
                        inside = inside.max(force[dof].abs());
                    }
                }
            }
        }
        assert!(count > 10 && outside > 1e-2, "{count} {outside}");
        assert!(inside < 1e-14, "{} {inside:e}", body.mesh.element.name);
    }
}

/// Two rectangles that touch and share no node.
fn two_pieces() -> File {
    let left = File::of(&generated(
        r#"{"kind": "rectangle", "size": [1.0, 0.5], "cells": [4, 2]}"#,
        ElementKind::P1,
    ));
    let mut file = left.clone();
    let count = left.nodes.len();
    file.nodes
        .extend(left.nodes.iter().map(|p| [p[0] + 1.0, p[1], p[2]]));
    file.tags.extend((1..=count as u64).map(|tag| 1000 + tag));
    file.names.push((2, 300, "loose part".into()));
    let mut loose = left.blocks.iter().find(|b| b.of == 2).unwrap().clone();
    (loose.entity, loose.groups) = (30, vec![300]);
    loose.cells.iter_mut().flatten().for_each(|n| *n += count);
    file.blocks.push(loose);
    file
}

#[test]
fn a_piece_that_nothing_holds_is_named() {
    let bytes = two_pieces().write(Format::Text4);
    assert_eq!(read(&bytes).unwrap().quality().pieces, 2);
    let scene: Scene = paper(r#"{"kind": "gmsh", "file": "part.msh"}"#);
    match compile_from(&scene, &MemoryFiles::new([("part.msh", &bytes[..])])) {
        Err(Error::Scene { path, found, .. }) => {
            assert_eq!(path, "clamped");
            assert!(found.contains("32 cells of [\"loose part\"]"), "{found}");
            assert!(
                found.contains("although 3 of their nodes stand where it has one too"),
                "{found}"
            );
        }
        other => panic!("{:?}", other.map(drop)),
    }
}
