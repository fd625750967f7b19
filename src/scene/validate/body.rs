//! Rules of the body: mesh, material, what is clamped and what is in contact.

use super::super::friction;
use super::super::types::*;
use super::check_vector;
use crate::message::cut;
use crate::refusal::{Refusal, Verdict, ensure, json};

pub(super) fn check_mesh(scene: &Scene, dimension: Option<usize>) -> Verdict {
    let element = scene.element_in(dimension.unwrap_or(2));
    let is_studied = scene.fidelity.target_error.is_some();
    ensure(!is_studied || element.has_contact_at_all_nodes(), || {
        let found =
            "a value with quadratic tetrahedra, whose contact has no field between its nodes";
        Refusal::new(
            "fidelity.target_error",
            found,
            "a target with element p1 in 3D",
        )
    })?;
    scene.mesh.source().check(element)
}

/// One material for the whole body, or one for every region.
pub(super) fn check_materials(scene: &Scene, dimension: Option<usize>) -> Verdict {
    let regions = scene.mesh.source().regions();
    let materials = scene.materials();
    ensure(!materials.is_empty(), || {
        Refusal::new(
            "material",
            "nothing",
            "an object with the keys elasticity, viscosity; or materials, by region",
        )
    })?;
    ensure(
        scene.material.is_none() || scene.materials.is_empty(),
        || {
            let found = "a list beside material";
            Refusal::new(
                "materials",
                found,
                "material for the whole body, or materials by region",
            )
        },
    )?;
    for (i, material) in materials.iter().enumerate() {
        if let Some(region) = material.region {
            let path = format!("{}.region", material.path);
            if let Some(regions) = &regions {
                ensure(regions.contains(&region), || {
                    let allowed = format!("the regions {}", cut(&regions.join(", ")));
                    Refusal::new(&path, json(region), allowed)
                })?;
            }
            ensure(
                materials[..i].iter().all(|m| m.region != Some(region)),
                || {
                    let found = format!("{:?} a second time", cut(region));
                    Refusal::new(&path, found, "each region once")
                },
            )?;
        }
        if let Some(dimension) = dimension {
            material.operators.check(dimension, &material.path)?;
        }
    }
    // whether cells are left to the region of no box, the mesh knows
    let has_material = |region: &&str| {
        *region == crate::mesh::BODY
            || materials
                .iter()
                .any(|m| m.region.is_none_or(|of| of == *region))
    };
    let known = regions.unwrap_or_default();
    match known.iter().find(|region| !has_material(region)) {
        None => Ok(()),
        Some(region) => {
            let found = format!("none for the region {:?}", cut(region));
            Err(Refusal::new(
                "materials",
                found,
                "a material for every region",
            ))
        }
    }
}

/// A part that the mesh has.
pub(super) fn check_part(mesh: &MeshSpec, part: &str, path: &str) -> Verdict {
    match mesh.source().part_fault(part) {
        None => Ok(()),
        Some(allowed) => Err(Refusal::new(path, json(part), allowed)),
    }
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
        refuse_contact(scene, part, &path, "parts that are not in contact")?;
    }
    for (i, part) in scene.rollers.iter().enumerate() {
        let path = format!("rollers[{i}]");
        check_part(&scene.mesh, part, &path)?;
        let is_driven = scene.driven.iter().any(|driven| driven.part == *part);
        for (is_taken, what) in [
            (scene.rollers[..i].contains(part), "a second time"),
            (scene.clamped.contains(part), "which is clamped"),
            (is_driven, "which is driven"),
        ] {
            ensure(!is_taken, || {
                let allowed = "parts that are neither clamped nor driven, each once";
                Refusal::new(&path, format!("{:?} {what}", cut(part)), allowed)
            })?;
        }
        refuse_contact(scene, part, &path, "parts that are not in contact")?;
    }
    Ok(())
}

pub(super) fn check_contact(scene: &Scene, dimension: Option<usize>) -> Verdict {
    let contacts = scene.contacts();
    ensure(!contacts.is_empty(), || {
        let allowed = "an object with the keys friction, part; or contacts, a list of such";
        Refusal::new("contact", "nothing", allowed)
    })?;
    ensure(scene.contact.is_none() || scene.contacts.is_empty(), || {
        let found = "a list beside contact";
        Refusal::new(
            "contacts",
            found,
            "contact for one, or contacts for several",
        )
    })?;
    for (i, contact) in contacts.iter().enumerate() {
        let path = format!("{}.part", contact.path);
        check_part(&scene.mesh, &contact.part, &path)?;
        ensure(contacts[..i].iter().all(|c| c.part != contact.part), || {
            let found = format!("{:?} a second time", cut(&contact.part));
            Refusal::new(&path, found, "each part once")
        })?;
        friction::check(contact)?;
        if let Some(tangent) = &contact.tangent {
            check_vector(dimension, tangent, &format!("{}.tangent", contact.path))?;
        }
    }
    Ok(())
}

/// Refuses a part that is in contact.
pub(super) fn refuse_contact(scene: &Scene, part: &str, path: &str, allowed: &str) -> Verdict {
    let contacts = scene.contacts();
    match contacts.iter().find(|contact| contact.part == part) {
        None => Ok(()),
        Some(contact) => {
            let found = format!("{:?}, which is {}.part", cut(part), contact.path);
            Err(Refusal::new(path, found, allowed))
        }
    }
}
