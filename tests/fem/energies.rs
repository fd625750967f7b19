//! Energies and spectrum: exact for linear fields, on any side and in any frame, between the element rates.

use super::*;

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
