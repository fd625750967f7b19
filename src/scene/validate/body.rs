//! Rules of the body: mesh, material, what is clamped and what is in contact.

use super::super::friction;
use super::super::refusal::Refusal;
use super::super::types::*;
use super::{MAX_NODES, Verdict, check_vector, ensure, json, length};
use crate::message::{cut, number};

pub(super) fn check_mesh(scene: &Scene) -> Verdict {
    let mesh = &scene.mesh;
    if let Some((found, allowed)) = scene.element.fault(mesh.dimension()) {
        return Err(Refusal::new("element", found, allowed));
    }
    let axes = ["x", "y", "z"];
    let axes = &axes[..mesh.dimension()];
    for (i, axis) in mesh.periodic().iter().enumerate() {
        let path = format!("mesh.periodic[{i}]");
        let found = json(axis);
        ensure(axis.index() < mesh.dimension(), || {
            Refusal::new(
                &path,
                &found,
                format!("the axes of the mesh: {}", axes.join(", ")),
            )
        })?;
        ensure(!mesh.periodic()[..i].contains(axis), || {
            Refusal::new(&path, format!("{found} a second time"), "each axis once")
        })?;
    }
    for axis in [Axis::X, Axis::Y, Axis::Z] {
        if let Some((found, allowed)) = mesh.grading_fault(axis) {
            let path = format!("mesh.grading[{}]", axis.index());
            return Err(Refusal::new(path, found, allowed));
        }
    }
    if let Some((path, found, allowed)) = mesh.refinement_fault() {
        return Err(Refusal::new(path, found, allowed));
    }
    let nodes = mesh.node_bound(scene.element);
    ensure(nodes <= u128::from(MAX_NODES), || {
        let found = format!("{}, which makes {nodes} nodes", json(&mesh.cells()));
        Refusal::new("mesh.cells", found, format!("at most {MAX_NODES} nodes"))
    })
}

pub(super) fn check_material(scene: &Scene) -> Verdict {
    let dimension = scene.mesh.dimension();
    // Both operators are `c tr(tau) I + d tau`: on symmetric tensors they are positive iff d > 0 and dim c + d > 0.
    let trace = |(c, d): (f64, f64)| dimension as f64 * c + d;
    let positive = |value: f64| value.is_finite() && value > 0.0;

    let viscosity = scene.material.viscosity.coefficients();
    ensure(positive(trace(viscosity)), || {
        let found = format!(
            "{} ({dimension} mu1 + mu2 = {})",
            number(viscosity.0),
            number(trace(viscosity))
        );
        let allowed =
            format!("{dimension} mu1 + mu2 finite and > 0: otherwise the body gains energy");
        Refusal::new("material.viscosity.mu1", found, allowed)
    })?;

    let Elasticity::Isotropic { convention, .. } = scene.material.elasticity;
    let allowed = match dimension {
        2 => [
            Convention::Kazmi2014,
            Convention::PlaneStrain,
            Convention::PlaneStress,
        ]
        .as_slice(),
        _ => [Convention::Kazmi2014, Convention::ThreeDimensional].as_slice(),
    };
    ensure(allowed.contains(&convention), || {
        let found = format!("{} in {dimension} dimensions", json(&convention));
        let names: Vec<String> = allowed.iter().map(json).collect();
        Refusal::new("material.elasticity.convention", found, names.join(", "))
    })?;
    let elasticity = scene.material.elasticity.coefficients();
    ensure(
        positive(elasticity.1) && positive(trace(elasticity)),
        || {
            let (lambda, two_mu) = elasticity;
            let (lambda, two_mu) = (number(lambda), number(two_mu));
            let found = format!("lambda = {lambda}, 2 mu = {two_mu}");
            let allowed = format!("2 mu and {dimension} lambda + 2 mu finite and > 0");
            Refusal::new("material.elasticity", found, allowed)
        },
    )
}

/// A part that the mesh has.
pub(super) fn check_part(mesh: &MeshSpec, part: &str, path: &str) -> Verdict {
    ensure(mesh.normal_axis(part).is_some(), || {
        let allowed = match (mesh.parts(), mesh.periodic()) {
            (parts, []) => format!("the parts {}", parts.join(", ")),
            (parts, _) if parts.is_empty() => {
                "no part, because mesh.periodic closes every axis".to_owned()
            }
            (parts, periodic) => {
                let periodic = json(&periodic);
                format!(
                    "the parts {} (mesh.periodic is {periodic})",
                    parts.join(", ")
                )
            }
        };
        Refusal::new(path, json(&part), allowed)
    })
}

pub(super) fn check_clamped(scene: &Scene) -> Verdict {
    for (i, part) in scene.clamped.iter().enumerate() {
        let path = format!("clamped[{i}]");
        check_part(&scene.mesh, part, &path)?;
        ensure(!scene.clamped[..i].contains(part), || {
            Refusal::new(
                &path,
                format!("{:?} a second time", cut(part)),
                "each part once",
            )
        })?;
        ensure(*part != scene.contact.part, || {
            let found = format!("{:?}, which is contact.part", cut(part));
            Refusal::new(&path, found, "parts that are not in contact")
        })?;
    }
    Ok(())
}

pub(super) fn check_contact(scene: &Scene) -> Verdict {
    let (mesh, contact) = (&scene.mesh, &scene.contact);
    check_part(mesh, &contact.part, "contact.part")?;
    let Some(normal) = mesh.normal_axis(&contact.part) else {
        return Ok(());
    };
    ensure(has_free_contact_node(scene, normal), || {
        let allowed = "parts that leave nodes of contact.part free (or more cells between them)";
        Refusal::new("clamped", json(&scene.clamped), allowed)
    })?;
    friction::check(scene)?;
    if let Some(tangent) = &contact.tangent {
        let path = "contact.tangent";
        check_vector(mesh, tangent, path)?;
        let mut along = tangent.clone();
        along[normal.index()] = 0.0;
        // Below this the direction left in the contact plane would be rounding error.
        ensure(length(&along) > 1e-8 * length(tangent), || {
            let allowed = format!(
                "a direction that is not normal to the contact ({})",
                json(&normal)
            );
            Refusal::new(path, json(tangent), allowed)
        })?;
    }
    Ok(())
}

/// Whether a node of the contact part is on no clamped part. The nodes of a part normal to z include centres of cells,
/// which no other part touches; those of the other parts are a grid.
fn has_free_contact_node(scene: &Scene, normal: Axis) -> bool {
    let in_plane = [Axis::X, Axis::Y, Axis::Z]
        .into_iter()
        .zip(scene.mesh.cells());
    normal == Axis::Z
        || in_plane
            .filter(|(axis, _)| *axis != normal)
            .all(|(axis, &cells)| {
                let is_across = |part: &&String| scene.mesh.normal_axis(part) == Some(axis);
                let clamped = scene.clamped.iter().filter(is_across).count();
                scene.element.nodes_along(cells) > clamped as u64
            })
}
