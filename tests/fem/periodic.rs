//! Periodic sides.

use super::*;

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
