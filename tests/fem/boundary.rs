//! Unknowns, contact weights, frames, loads and probes; bodies that cannot be used.

use super::*;

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
    assert_eq!(path_of(&|v| v["clamped"] = json!(["bottom"])), "clamped");
}
