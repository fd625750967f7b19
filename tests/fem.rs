//! The assembled body: exactness for linear fields, frames, periodicity, contact weights, loads and probes.

use nalgebra::{DMatrix, Matrix3, Rotation3, Vector3};
use serde_json::{Value, json};
use stickslip::fem::{Body, OperatorPair};
use stickslip::mesh::Mesh;
use stickslip::scene::Scene;
use stickslip::{Error, Result};

/// The example of the paper (Section 7) on `m x m/2` cells.
fn paper(m: u32) -> Value {
    json!({
        "schema_version": 1,
        "name": "paper",
        "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [m, m / 2]},
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
            "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "kazmi2014"}
        },
        "clamped": ["left"],
        "contact": {
            "part": "bottom",
            "friction": {"law": "exponential", "a": 0.003, "b": 0.001, "alpha": 100.0}
        },
        "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": [0.0, -2.0], "start": 0.3}],
        "time": {"step": 0.03125}
    })
}

fn assemble(scene: &Value) -> Result<Body> {
    Body::assemble(&parse(scene))
}

fn parse(scene: &Value) -> Scene {
    serde_json::from_value(scene.clone()).expect("the scene of a test is well formed")
}

/// Free components of a field given by its vector at each point, which must satisfy the conditions.
fn project(body: &Body, field: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Vec<f64> {
    let mut free = vec![0.0; body.len()];
    for (node, point) in body.mesh.nodes.iter().enumerate() {
        let value = field(Vector3::from(*point));
        let node = node as u32;
        if body.mesh.leader[node as usize] == node {
            for (dof, axis) in body.dofs.range(node).zip(body.dofs.frame(node)) {
                free[dof] = Vector3::from(*axis).dot(&value);
            }
        }
    }
    free
}

/// Exact densities of x.Ax and x.Bx for the gradient of a linear field, material of the paper.
fn densities(gradient: Matrix3<f64>) -> [f64; 2] {
    let strain = (gradient + gradient.transpose()) / 2.0;
    [[0.05, 0.1], [0.3 / 0.28, 1.0 / 1.3]].map(|[lambda, two_mu]| {
        lambda * strain.trace() * strain.trace() + two_mu * strain.norm_squared()
    })
}

fn dense(pair: &OperatorPair, values: &[f64]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(pair.n, pair.n);
    for j in 0..pair.n {
        for at in pair.col_ptr[j]..pair.col_ptr[j + 1] {
            matrix[(pair.row_idx[at], j)] = values[at];
            matrix[(j, pair.row_idx[at])] = values[at];
        }
    }
    matrix
}

/// Ascending eigenvalues of `A^-1 B`.
fn rates(body: &Body) -> Vec<f64> {
    let pair = &body.operators;
    let factor = dense(pair, &pair.a).cholesky().expect("the body is held");
    let half = factor
        .l()
        .solve_lower_triangular(&dense(pair, &pair.b))
        .expect("a regular factor");
    let full = factor
        .l()
        .solve_lower_triangular(&half.transpose())
        .expect("a regular factor");
    let mut values: Vec<f64> = full.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Reproducible numbers in (-1, 1).
fn noise(n: usize) -> Vec<f64> {
    (0..n)
        .map(|i| ((i as f64 * 12.9898 + 4.1).sin() * 43_758.545_3).fract())
        .collect()
}

#[track_caller]
fn assert_close(found: f64, expected: f64, relative: f64) {
    let scale = expected.abs().max(1e-300);
    assert!(
        (found - expected).abs() <= relative * scale,
        "found {found}, expected {expected}"
    );
}

#[test]
fn the_example_of_the_paper_has_its_unknowns_and_weights() -> Result<()> {
    let body = assemble(&paper(32))?;
    let h = 1.0 / 32.0;
    // 1073 nodes less 17 clamped ones, two components each, less the normal ones of 32 contact nodes.
    assert_eq!(body.len(), 2080);
    assert_eq!(body.contact_len(), 32);
    assert_eq!(body.dofs.contact_start(), 2048);
    assert_eq!(body.contact.faces, 32);
    assert_eq!(2 * body.mesh.nodes.len() + 2 * body.contact.faces, 2210);
    for (i, (point, weight)) in body
        .contact
        .points
        .iter()
        .zip(&body.contact.weights)
        .enumerate()
    {
        assert_eq!(*point, [(i + 1) as f64 * h, 0.0, 0.0]);
        assert_close(*weight, if i == 31 { h / 2.0 } else { h }, 1e-14);
        assert_eq!(body.contact.tangents[i], [[1.0, 0.0, 0.0], [0.0; 3]]);
        assert_eq!(body.dofs.range(body.contact.nodes[i]), 2048 + i..2049 + i);
    }
    // The clamped node keeps half a face.
    let total: f64 = body.contact.weights.iter().sum();
    assert_close(total, 1.0 - h / 2.0, 1e-14);

    let load = &body.loads[0];
    assert_close(load.measure, 1.0, 1e-14);
    assert_eq!(load.start, 0.3);
    let sum: f64 = load.entries.iter().map(|(_, value)| value).sum();
    assert_close(sum, -(1.0 - h / 2.0), 1e-14);
    assert!(load.entries.is_sorted_by(|a, b| a.0 < b.0));

    let [low, high] = body.element_rates;
    assert_close(low, 10.0 / 1.3, 1e-14);
    assert_close(high, (0.6 / 0.28 + 1.0 / 1.3) / 0.2, 1e-14);
    Ok(())
}

#[test]
fn energies_of_a_curved_field_match_an_independent_assembly() -> Result<()> {
    // A script that sums over the triangles of the same criss-cross the area times (lambda tr^2 + two_mu eps:eps), m = 8.
    let body = assemble(&paper(8))?;
    let x = project(&body, |p| {
        Vector3::new((3.0 * p.x + p.y).sin(), (2.0 * p.y - p.x).cos(), 0.0)
    });
    let (a, b) = body.operators.product(&x, &x);
    assert_close(a, 2.5197214174823417, 1e-12);
    assert_close(b, 28.782496423673912, 1e-12);
    Ok(())
}

/// A distorted and turned copy of the mesh: interior nodes move, then everything turns.
fn distort(mesh: &mut Mesh, spacing: f64, turn: Rotation3<f64>) -> Vec<bool> {
    let mut is_interior = vec![true; mesh.nodes.len()];
    for faces in mesh.parts.values() {
        for &node in faces {
            is_interior[node as usize] = false;
        }
    }
    for (i, node) in mesh.nodes.iter_mut().enumerate() {
        let mut point = Vector3::from(*node);
        if is_interior[i] {
            for c in 0..mesh.dimension {
                point[c] += 0.2 * spacing * ((7 * i + 3 * c) as f64).sin();
            }
        }
        *node = (turn * point).into();
    }
    is_interior
}

#[test]
fn linear_fields_pass_the_patch_test_on_a_distorted_turned_mesh() -> Result<()> {
    let box_mesh = json!({"kind": "box", "size": [1.0, 1.0, 1.0], "cells": [3, 3, 3]});
    let cases = [
        (
            json!({"kind": "rectangle", "size": [1.0, 1.0], "cells": [4, 4]}),
            Rotation3::from_euler_angles(0.0, 0.0, 0.4),
            1.0 / 8.0,
        ),
        (
            box_mesh,
            Rotation3::from_euler_angles(0.3, -0.2, 0.4),
            1.0 / 12.0,
        ),
    ];
    for (mesh, turn, spacing) in cases {
        let mut value = paper(4);
        value["mesh"] = mesh;
        value["clamped"] = json!([]);
        value["loads"] = json!([]);
        let scene = parse(&value);
        let mut mesh = Mesh::generate(&scene.mesh)?;
        let is_interior = distort(&mut mesh, spacing, turn);
        let body = Body::assemble_on(&scene, mesh)?;

        // The displacement normal to the bottom grows with the distance from it only.
        let mut gradient = Matrix3::new(0.3, -0.2, 0.5, 0.0, 0.1, 0.0, 0.2, 0.6, -0.8);
        if body.mesh.dimension == 2 {
            gradient.row_mut(2).fill(0.0);
            gradient.column_mut(2).fill(0.0);
        }
        let gradient = turn * gradient * turn.inverse();
        let x = project(&body, |p| gradient * p);
        for (found, point) in body.displacement(&x).iter().zip(&body.mesh.nodes) {
            let exact = gradient * Vector3::from(*point);
            assert!((Vector3::from(*found) - exact).norm() < 1e-14);
        }

        let energy: (f64, f64) = body.operators.product(&x, &x);
        let [exact_a, exact_b] = densities(gradient);
        assert_close(energy.0, exact_a, 1e-13);
        assert_close(energy.1, exact_b, 1e-13);

        let pair = &body.operators;
        let mut force = vec![0.0; body.len()];
        pair.apply(&pair.b, &x, &mut force);
        let mut interior = 0;
        for (node, is_interior) in is_interior.iter().enumerate() {
            if *is_interior {
                interior += 1;
                for dof in body.dofs.range(node as u32) {
                    assert!(force[dof].abs() < 1e-14, "node {node}: {}", force[dof]);
                }
            }
        }
        assert!(interior > 20);
    }
    Ok(())
}

const SIDES: [(&str, usize, f64); 6] = [
    ("left", 0, 0.0),
    ("right", 0, 1.0),
    ("bottom", 1, 0.0),
    ("top", 1, 1.0),
    ("back", 2, 0.0),
    ("front", 2, 1.0),
];

#[test]
fn contact_on_any_side_keeps_the_energies_of_linear_fields() -> Result<()> {
    for (dimension, sides) in [(2, &SIDES[..4]), (3, &SIDES[..])] {
        for &(side, axis, at) in sides {
            let mut value = paper(4);
            value["mesh"] = match dimension {
                2 => json!({"kind": "rectangle", "size": [1.0, 1.0], "cells": [3, 2]}),
                _ => json!({"kind": "box", "size": [1.0, 1.0, 1.0], "cells": [3, 2, 2]}),
            };
            value["clamped"] = json!([]);
            value["loads"] = json!([]);
            value["contact"]["part"] = json!(side);
            let body = assemble(&value)?;
            let mut gradient = Matrix3::new(0.3, -0.2, 0.5, 0.4, 0.1, -0.7, 0.2, 0.6, -0.8);
            if dimension == 2 {
                gradient.row_mut(2).fill(0.0);
                gradient.column_mut(2).fill(0.0);
            }
            for c in (0..3).filter(|&c| c != axis) {
                gradient[(axis, c)] = 0.0;
            }
            let mut origin = Vector3::zeros();
            origin[axis] = at;
            let x = project(&body, |p| gradient * (p - origin));
            for (found, point) in body.displacement(&x).iter().zip(&body.mesh.nodes) {
                let exact = gradient * (Vector3::from(*point) - origin);
                assert!((Vector3::from(*found) - exact).norm() < 1e-14, "{side}");
            }
            let (a, b) = body.operators.product(&x, &x);
            let exact = densities(gradient);
            assert_close(a, exact[0], 1e-13);
            assert_close(b, exact[1], 1e-13);
            // Right-handed: t1 x t2 is the outward normal; in the plane t1 is perpendicular to it.
            let outward = if at == 0.0 { -1.0 } else { 1.0 };
            for tangents in &body.contact.tangents {
                let [t1, t2] = tangents.map(Vector3::from);
                assert_eq!(t1[axis], 0.0);
                assert_close(t1.norm(), 1.0, 1e-15);
                if dimension == 3 {
                    assert_eq!(t1.cross(&t2)[axis], outward, "{side}");
                }
            }
            let area: f64 = body.contact.weights.iter().sum();
            assert_close(area, 1.0, 1e-14);
        }
    }
    Ok(())
}

#[test]
fn the_square_has_one_spectrum_and_it_lies_between_the_element_rates() -> Result<()> {
    let mut first: Option<Vec<f64>> = None;
    for (clamped, contact) in [
        ("top", "bottom"),
        ("bottom", "top"),
        ("right", "left"),
        ("left", "right"),
    ] {
        let mut value = paper(4);
        value["mesh"]["size"] = json!([1.0, 1.0]);
        value["mesh"]["cells"] = json!([3, 3]);
        value["clamped"] = json!([clamped]);
        value["loads"] = json!([]);
        value["contact"]["part"] = json!(contact);
        let body = assemble(&value)?;
        let found = rates(&body);
        assert!(found[0] >= body.element_rates[0] * (1.0 - 1e-12));
        assert!(found[found.len() - 1] <= body.element_rates[1] * (1.0 + 1e-12));
        let first = first.get_or_insert_with(|| found.clone());
        assert_eq!(first.len(), found.len());
        for (x, y) in first.iter().zip(&found) {
            assert_close(*x, *y, 1e-12);
        }
    }
    Ok(())
}

#[test]
fn energies_stay_between_the_element_rates_in_space() -> Result<()> {
    let mut value = paper(4);
    value["mesh"] =
        json!({"kind": "box", "size": [1.0, 0.5, 0.7], "cells": [3, 2, 2], "periodic": ["z"]});
    value["material"]["elasticity"]["convention"] = json!("three_dimensional");
    value["loads"] = json!([]);
    let body = assemble(&value)?;
    let [low, high] = body.element_rates;
    for shift in 0..20 {
        let x = &noise(body.len() + shift)[shift..];
        let (a, b) = body.operators.product(x, x);
        assert!(low * a <= b && b <= high * a);
    }
    Ok(())
}

#[test]
fn a_slice_periodic_in_z_is_plane_strain() -> Result<()> {
    let thickness = 0.3;
    let mut value = paper(6);
    value["material"]["elasticity"]["convention"] = json!("plane_strain");
    let plane = assemble(&value)?;
    value["mesh"] = json!({"kind": "box", "size": [1.0, 0.5, thickness], "cells": [6, 3, 1], "periodic": ["z"]});
    value["material"]["elasticity"]["convention"] = json!("three_dimensional");
    value["loads"][0]["direction"] = json!([0.0, -1.0, 0.0]);
    let slice = assemble(&value)?;
    assert_eq!(slice.contact.nodes, plane.contact.nodes);
    for (found, expected) in slice.contact.weights.iter().zip(&plane.contact.weights) {
        assert_close(*found, thickness * expected, 1e-13);
    }

    // The numbers of the layer z = 0 are those of the plane; the last component of each node is along z.
    let d = plane.mesh.dimension;
    let mut of_plane = vec![None; slice.len()];
    for node in 0..plane.mesh.nodes.len() as u32 {
        for (p, s) in plane.dofs.range(node).zip(slice.dofs.range(node)) {
            of_plane[s] = Some(p);
        }
        assert_eq!(
            slice.dofs.range(node).len(),
            match plane.dofs.range(node).len() {
                0 => 0,
                n => n + 3 - d,
            }
        );
    }
    for (space, flat) in [
        (&slice.operators.a, &plane.operators.a),
        (&slice.operators.b, &plane.operators.b),
    ] {
        let space = dense(&slice.operators, space);
        let flat = dense(&plane.operators, flat);
        for i in 0..slice.len() {
            for j in 0..slice.len() {
                let expected = match (of_plane[i], of_plane[j]) {
                    (Some(p), Some(q)) => thickness * flat[(p, q)],
                    (None, None) => continue,
                    _ => 0.0,
                };
                assert!((space[(i, j)] - expected).abs() < 1e-14);
            }
        }
    }
    Ok(())
}

#[test]
fn a_periodic_body_shares_components_and_weights() -> Result<()> {
    for cells in [[1, 1], [3, 2]] {
        let mut value = paper(4);
        value["mesh"]["cells"] = json!(cells);
        value["mesh"]["periodic"] = json!(["x"]);
        value["clamped"] = json!(["top"]);
        value["loads"] = json!([]);
        let body = assemble(&value)?;
        let nx = cells[0] as usize;
        assert_eq!(body.contact.nodes.len(), nx);
        for weight in &body.contact.weights {
            assert_close(*weight, 1.0 / nx as f64, 1e-14);
        }
        for (node, &leader) in body.mesh.leader.iter().enumerate() {
            assert_eq!(body.dofs.range(node as u32), body.dofs.range(leader));
        }
        // Uniform shear satisfies all conditions: it vanishes at the clamped top and has no normal component.
        let shear = Matrix3::new(0.0, -0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let x = project(&body, |p| shear * (p - Vector3::y() * 0.5));
        let (a, b) = body.operators.product(&x, &x);
        let exact = densities(shear);
        assert_close(a, 0.5 * exact[0], 1e-13);
        assert_close(b, 0.5 * exact[1], 1e-13);
        // Seen by the contact alone: the force balances on every free component above it.
        let mut force = vec![0.0; body.len()];
        body.operators.apply(&body.operators.a, &x, &mut force);
        let (inner, contact) = force.split_at(body.dofs.contact_start());
        assert!(inner.iter().all(|f| f.abs() < 1e-15));
        // Shear stress two_mu / 2 * rate on the length of each node.
        for (force, weight) in contact.iter().zip(&body.contact.weights) {
            assert_close(*force, 0.05 * 0.4 * weight, 1e-13);
        }
    }
    Ok(())
}

#[test]
fn a_column_periodic_in_x_and_z_carries_uniform_shear_with_one_cell() -> Result<()> {
    for cells in [[1, 2, 1], [3, 2, 2]] {
        let mut value = paper(4);
        value["mesh"] =
            json!({"kind": "box", "size": [1.0, 0.5, 0.7], "cells": cells, "periodic": ["x", "z"]});
        value["clamped"] = json!(["top"]);
        value["loads"] = json!([]);
        let body = assemble(&value)?;
        let shear = Vector3::new(-0.4, 0.0, 0.3);
        let x = project(&body, |p| shear * (p.y - 0.5));
        let mut force = vec![0.0; body.len()];
        body.operators.apply(&body.operators.a, &x, &mut force);
        let (inner, contact) = force.split_at(body.dofs.contact_start());
        assert!(inner.iter().all(|f| f.abs() < 1e-15));
        for (i, weight) in body.contact.weights.iter().enumerate() {
            assert!((contact[2 * i] - 0.05 * 0.4 * weight).abs() < 1e-15);
            assert!((contact[2 * i + 1] + 0.05 * 0.3 * weight).abs() < 1e-15);
        }
        let area: f64 = body.contact.weights.iter().sum();
        assert_close(area, 0.7, 1e-14);
    }
    Ok(())
}

#[test]
fn probes_read_linear_fields_anywhere_in_the_body() -> Result<()> {
    let mut value = paper(4);
    value["mesh"] = json!({"kind": "box", "size": [1.0, 0.5, 0.5], "cells": [3, 2, 1]});
    value["loads"] = json!([]);
    value["contact"]["tangent"] = json!([1.0, 0.0, 1.0]);
    let points = [
        [1.0, 0.0, 0.5],
        [0.37, 0.21, 0.11],
        [0.5, 0.0, 0.25],
        [1.0, 0.5, 0.5],
        [0.0, 0.2, 0.2],
    ];
    value["probes"] = points
        .iter()
        .enumerate()
        .map(|(i, at)| json!({"name": format!("p{i}"), "at": at}))
        .collect();
    let body = assemble(&value)?;
    // Zero on the left, and no displacement along y: both conditions hold.
    let slope = Vector3::new(0.8, 0.0, -0.3);
    let x = project(&body, |p| slope * p.x);
    for (probe, at) in body.probes.iter().zip(points) {
        for axis in 0..3 {
            let value: f64 = probe.rows[axis].iter().map(|(dof, w)| w * x[*dof]).sum();
            assert!(
                (value - slope[axis] * at[0]).abs() < 1e-14,
                "{}",
                probe.name
            );
        }
    }
    // A probe at a contact node sees that node alone, in its frame.
    let diagonal = f64::sqrt(0.5);
    let row = &body.probes[0].rows[0];
    assert_eq!(row.len(), 2);
    assert_close(row[0].1, diagonal, 1e-14);
    assert!(body.probes[0].rows[1].is_empty());
    Ok(())
}

#[test]
fn loads_sum_to_the_area_and_the_volume() -> Result<()> {
    let mut value = paper(4);
    value["mesh"] =
        json!({"kind": "box", "size": [1.0, 0.5, 0.7], "cells": [3, 2, 2], "periodic": ["z"]});
    value["clamped"] = json!([]);
    value["loads"] = json!([
        {"name": "right", "kind": "traction", "part": "right", "direction": [3.0, 0.0, 4.0]},
        {"name": "weight", "kind": "body_force", "direction": [2.0, 0.0, 0.0], "interpolation": "hold"}
    ]);
    let body = assemble(&value)?;
    let along_x = project(&body, |_| Vector3::x());
    let work = |i: usize| -> f64 {
        body.loads[i]
            .entries
            .iter()
            .map(|(d, v)| v * along_x[*d])
            .sum()
    };
    assert_close(body.loads[0].measure, 0.35, 1e-14);
    assert_close(work(0), 0.6 * 0.35, 1e-14);
    assert_close(body.loads[1].measure, 0.35, 1e-14);
    assert_close(work(1), 0.35, 1e-14);
    Ok(())
}

#[test]
fn the_tangent_of_the_scene_turns_the_frame() -> Result<()> {
    let mut value = paper(4);
    value["mesh"] = json!({"kind": "box", "size": [1.0, 0.5, 0.5], "cells": [2, 1, 2]});
    value["loads"] = json!([]);
    let plain = assemble(&value)?;
    assert_eq!(
        plain.contact.tangents[0],
        [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    );
    assert_eq!(plain.contact.components, 2);
    // Along x first, then along z.
    let points: Vec<_> = plain.contact.points.iter().map(|p| (p[0], p[2])).collect();
    assert!(points.is_sorted());
    assert_eq!(points.len(), 6);

    value["contact"]["tangent"] = json!([0.0, 5.0, 2.0]);
    let turned = assemble(&value)?;
    assert_eq!(
        turned.contact.tangents[0],
        [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]]
    );
    let points: Vec<_> = turned
        .contact
        .points
        .iter()
        .map(|p| (p[2], -p[0]))
        .collect();
    assert!(points.is_sorted());
    Ok(())
}

#[test]
fn products_agree_with_the_dense_matrices() -> Result<()> {
    let body = assemble(&paper(4))?;
    let pair = &body.operators;
    let mut values = vec![0.0; pair.a.len()];
    pair.combine(0.7, -0.2, &mut values);
    let k = dense(pair, &pair.a) * 0.7 - dense(pair, &pair.b) * 0.2;
    let x = noise(pair.n);
    let y = nalgebra::DVector::from_vec(noise(pair.n + 5).split_off(5));
    let mut kx = vec![0.0; pair.n];
    pair.apply(&values, &x, &mut kx);
    let expected = &k * nalgebra::DVector::from_vec(x.clone());
    for (found, expected) in kx.iter().zip(expected.iter()) {
        assert!((found - expected).abs() < 1e-14);
    }
    let (xay, xby) = pair.product(&x, y.as_slice());
    assert!((0.7 * xay - 0.2 * xby - expected.dot(&y)).abs() < 1e-13);
    for j in 0..pair.n {
        let rows = &pair.row_idx[pair.col_ptr[j]..pair.col_ptr[j + 1]];
        assert_eq!(rows[0], j);
        assert!(rows.is_sorted_by(|a, b| a < b));
    }
    assert_eq!(assemble(&paper(4))?, body);
    Ok(())
}

#[test]
fn unusable_bodies_say_where() {
    let path_of = |change: &dyn Fn(&mut Value)| {
        let mut value = paper(4);
        change(&mut value);
        match assemble(&value) {
            Err(Error::Scene { path, .. }) => path,
            Err(other) => other.to_string(),
            Ok(_) => "a body".to_string(),
        }
    };
    assert_eq!(
        path_of(&|v| v["clamped"] = json!(["left", "lid"])),
        "clamped[1]"
    );
    assert_eq!(
        path_of(&|v| v["contact"]["part"] = json!("front")),
        "contact.part"
    );
    assert_eq!(
        path_of(&|v| v["contact"]["tangent"] = json!([0.0, 1.0])),
        "contact.tangent"
    );
    assert_eq!(
        path_of(&|v| v["loads"][0]["part"] = json!("lid")),
        "loads[0].part"
    );
    assert_eq!(
        path_of(&|v| v["loads"][0]["part"] = json!(null)),
        "loads[0].part"
    );
    assert_eq!(
        path_of(&|v| v["loads"][0]["direction"] = json!([0.0, 0.0])),
        "loads[0].direction"
    );
    assert_eq!(
        path_of(&|v| v["probes"] =
            json!([{"name": "in", "at": [1.0, 0.5]}, {"name": "out", "at": [1.01, 0.5]}])),
        "probes[1].at"
    );
    assert_eq!(
        path_of(&|v| v["clamped"] = json!(["bottom"])),
        "the scene gives no usable body: every node of the contact part \"bottom\" is clamped"
    );
}
