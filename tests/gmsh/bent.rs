//! Second-order cells with the midside nodes of the file: a ring, whose contact is a circle.

use crate::read;
use crate::versions::paper;
use crate::writer::{File, Format};
use std::f64::consts::TAU;
use stickslip::element::ElementKind;
use stickslip::fem::Body;
use stickslip::linalg::SparseCholesky;
use stickslip::mesh::Mesh;
use stickslip::{MemoryFiles, Scene, compile_from};

const INNER: f64 = 0.5;
const OUTER: f64 = 1.0;

/// The file of the ring in n layers; the midside nodes stand on the circles, or in the middle of the chords.
fn ring(n: u32, kind: ElementKind, is_bent: bool) -> File {
    let spec = format!(
        r#"{{"kind": "rectangle", "size": [1.0, 1.0], "cells": [{}, {n}]}}"#,
        10 * n
    );
    let round = |p: [f64; 3]| {
        let (angle, radius) = (TAU * p[0], INNER + (OUTER - INNER) * p[1]);
        // the right end is the left one
        let angle = if p[0] == 1.0 { 0.0 } else { angle };
        [radius * angle.cos(), radius * angle.sin(), 0.0]
    };
    let mesh = crate::generated(&spec, ElementKind::P1);
    let straight = Mesh {
        nodes: mesh.nodes.iter().map(|p| round(*p)).collect(),
        ..mesh.clone()
    };
    let mut flat = mesh.for_element(kind).unwrap();
    match is_bent {
        true => flat.nodes.iter_mut().for_each(|p| *p = round(*p)),
        false => flat = straight.for_element(kind).unwrap(),
    }
    let mut file = File::of(&flat);
    // nodes of the right end become those of the left
    let key = |p: &[f64; 3]| [(p[0] * 1e9).round() as i64, (p[1] * 1e9).round() as i64];
    let mut first = std::collections::BTreeMap::new();
    let same: Vec<usize> = (0..)
        .zip(&file.nodes)
        .map(|(i, p)| *first.entry(key(p)).or_insert(i))
        .collect();
    for block in &mut file.blocks {
        block.cells.iter_mut().flatten().for_each(|n| *n = same[*n]);
    }
    let is_end = |name: &str| ["left", "right"].contains(&name);
    let ends: Vec<i32> = file
        .names
        .iter()
        .filter(|n| is_end(&n.2))
        .map(|n| n.1)
        .collect();
    file.blocks
        .retain(|b| b.groups.len() != 1 || !ends.contains(&b.groups[0]));
    file.names.retain(|n| !is_end(&n.2));
    file
}

const GMSH: &str = r#"{"kind": "gmsh", "file": "part.msh"}"#;

/// The ring held inside, in contact outside.
fn held(kind: Option<ElementKind>) -> Scene {
    let mut scene = paper(GMSH);
    scene.element = kind;
    scene.clamped = vec!["bottom".into()];
    let contact = scene.contact.as_mut().expect("one contact");
    contact.part = "top".into();
    scene.loads.clear();
    scene.run.signals.clear();
    scene.probes.clear();
    scene
}

/// Error of the displacement of the outer circle under a tangential stress, against the closed form
/// `tau R2^2 / (2 G) (R2 / R1^2 - 1 / R2)`, relative.
fn error(n: u32, kind: ElementKind, is_bent: bool) -> f64 {
    let mesh = read(&ring(n, kind, is_bent).write(Format::Text4)).unwrap();
    let scene = held(Some(kind));
    let body = Body::assemble_on(&scene, mesh).unwrap();
    let contact = &body.contact;
    let around = |i: usize| {
        let (p, t) = (contact.points[i], contact.tangents[i][0]);
        (t[1] * p[0] - t[0] * p[1]) / p[0].hypot(p[1])
    };
    // as exact as the normal is
    assert!((0..contact.nodes.len()).all(|i| (around(i).abs() - 1.0).abs() < 1e-2));
    let start = body.dofs.contact_start();
    let mut force = vec![0.0; body.len()];
    for i in 0..contact.nodes.len() {
        force[start + i] = contact.weights[i] * around(i);
    }
    let operators = &body.operators;
    let cholesky = SparseCholesky::new(
        &operators.col_ptr,
        &operators.row_idx,
        &body.interior_places(),
    )
    .unwrap();
    let (mut factor, mut memory) = (vec![0.0; cholesky.len()], cholesky.scratch(1));
    cholesky
        .factor("B", &operators.b, &mut factor, &mut memory)
        .unwrap();
    let right_side = faer::ColMut::from_slice_mut(&mut force).as_mat_mut();
    cholesky.solve(&factor, right_side, &mut memory);
    // two_mu of B: young 1, poisson 0.3
    let shear = 1.0 / (2.0 * 1.3);
    let exact = OUTER * OUTER / (2.0 * shear) * (OUTER / (INNER * INNER) - 1.0 / OUTER);
    (0..contact.nodes.len())
        .map(|i| (force[start + i] * around(i) / exact - 1.0).abs())
        .fold(0.0, f64::max)
}

/// Straight sides cost the order that the quadratic cells would have.
#[test]
fn a_ring_converges_with_the_order_of_bent_cells() {
    let bent: Vec<f64> = [2, 4, 8].map(|n| error(n, ElementKind::P2, true)).to_vec();
    let straight: Vec<f64> = [2, 4, 8].map(|n| error(n, ElementKind::P2, false)).to_vec();
    let linear: Vec<f64> = [2, 4, 8].map(|n| error(n, ElementKind::P1, false)).to_vec();
    println!("bent {bent:?}\nstraight {straight:?}\nlinear {linear:?}");
    for errors in bent.windows(2) {
        assert!(errors[1] < errors[0] / 8.0, "{bent:?}");
    }
    assert!(bent[2] < 1e-5, "{bent:?}");
    for errors in straight.windows(2) {
        assert!(
            (2.0..7.0).contains(&(errors[0] / errors[1])),
            "{straight:?}"
        );
    }
    assert!(straight[2] > 50.0 * bent[2] && linear[2] < 1e-2);
}

/// Areas, lengths and loads of bent cells and sides, and a probe inside one.
#[test]
fn bent_cells_are_measured_along_their_sides() {
    let file = ring(4, ElementKind::P2, true);
    let mesh = read(&file.write(Format::Binary2(false))).unwrap();
    let quality = mesh.quality();
    let area = TAU / 2.0 * (OUTER * OUTER - INNER * INNER);
    assert!(quality.bent > 0 && quality.least_jacobian > 0.5);
    // a parabola through three points of an arc of angle a lacks a^5 / 960 of its radius squared
    let arc = TAU / 40.0;
    let lack = arc.powi(4) / 480.0;
    assert!((quality.regions[0].measure / area - 1.0 + lack).abs() < 0.01 * lack);
    for (part, radius) in [("bottom", INNER), ("top", OUTER)] {
        let found = quality.parts.iter().find(|p| p.name == part).unwrap();
        assert!(
            (found.measure / (TAU * radius) - 1.0).abs() < 1e-6,
            "{part}"
        );
    }
    let mut scene = held(None);
    let probes = paper(GMSH).probes;
    let mut weight = paper(GMSH).loads[0].clone();
    (weight.kind, weight.part) = (stickslip::scene::LoadKind::BodyForce, None);
    scene.loads.push(weight);
    // between the chord and the arc; inside, among nodes that are free; outside
    let angle = TAU / 80.0;
    let between = OUTER - 0.3 * OUTER * (1.0 - angle.cos());
    let at = |radius: f64, angle: f64| vec![radius * angle.cos(), radius * angle.sin()];
    for place in [at(between, angle), at(0.7, 0.33)] {
        let mut probe = probes[0].clone();
        probe.name = format!("p{}", scene.probes.len());
        probe.at = place;
        scene.probes.push(probe);
    }
    let body = Body::assemble_on(&scene, mesh).unwrap();
    assert!((body.loads[0].measure / area - 1.0 + lack).abs() < 0.01 * lack);
    // the shape functions at a point give the point back
    for (axis, row) in body.probes[1].rows.iter().enumerate() {
        let mut places = vec![f64::NAN; body.len()];
        for node in 0..body.mesh.nodes.len() as u32 {
            for (c, dof) in body.dofs.range(node).enumerate() {
                places[dof] = body.mesh.nodes[node as usize][c];
            }
        }
        let found: f64 = row.iter().map(|(dof, value)| value * places[*dof]).sum();
        assert!((found - scene.probes[1].at[axis]).abs() < 1e-14, "{axis}");
    }
    assert!(body.probes[0].rows.iter().all(|row| !row.is_empty()));
    scene.probes[0].at = at(OUTER + 1e-6, angle);
    let files = MemoryFiles::new([("part.msh", &file.write(Format::Text2)[..])]);
    let error = compile_from(&scene, &files)
        .map(drop)
        .unwrap_err()
        .to_string();
    assert!(error.contains("at probes[0].at"), "{error}");
    scene.probes.clear();
    let model = compile_from(&scene, &files).unwrap();
    assert_eq!(model.scene().element, Some(ElementKind::P2));
}

#[test]
fn cells_that_their_sides_turn_inside_out_are_refused() {
    let mut mesh = read(&ring(2, ElementKind::P2, true).write(Format::Text4)).unwrap();
    let face = mesh.parts["top"][..3].to_vec();
    let corner = mesh.nodes[face[0] as usize];
    // a midside node close to a corner folds the side
    mesh.nodes[face[2] as usize] = corner.map(|x| 0.999 * x);
    assert!(mesh.quality().least_jacobian < 0.0);
    let mut scene = held(None);
    let error = Body::assemble_on(&scene, mesh).unwrap_err().to_string();
    assert!(
        error.contains("the bent sides of the cell at [") && error.contains("inside out"),
        "{error}"
    );
    // linear cells are not what the file has
    let bytes = ring(2, ElementKind::P2, true).write(Format::Text4);
    scene.element = Some(ElementKind::P1);
    let error = compile_from(&scene, &MemoryFiles::new([("part.msh", &bytes[..])]))
        .map(drop)
        .unwrap_err();
    assert!(error.to_string().contains(
        "at element: found \"p1\", while the mesh has second-order cells; allowed: \"p2\""
    ));
}
