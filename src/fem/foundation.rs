//! How the motions of the foundation are seen at the contact nodes, and the gap of the undeformed body.

use super::contact::ContactPatch;
use super::direction::{axis_of, direction};
use crate::error::Result;
use crate::expression::{COORDINATES, Program};
use crate::mesh::Mesh;
use crate::message::number;
use crate::refusal::scene_error;
use crate::scene::{Condition, Foundation, Gap, PlacedContact, Scene};
use nalgebra::Vector3;
use std::ops::Range;

/// Largest share of a motion of the foundation that is normal to its surface at a contact node: facets of a curved surface have
/// that much, a motion that leaves its surface more.
const MOST_NORMAL: f64 = 0.5;

/// Velocities of the foundation at the contact components by a unit of each motion: per motion one value per component. A motion
/// that approaches has 1 along the normals.
pub(super) fn motions(scene: &Scene, contact: &ContactPatch) -> Result<Vec<Vec<f64>>> {
    let mut columns = Vec::new();
    for (path, nodes, motion) in all_motions(scene, contact) {
        let velocity: Box<dyn Fn(Vector3<f64>) -> Vector3<f64>> = match motion {
            Foundation::Sliding { direction: d, .. } => {
                let along = direction(d, &format!("{path}.direction"))?;
                Box::new(move |_| along)
            }
            Foundation::Rotation { centre, axis, .. } => {
                let (centre, axis) = axis_of((centre, axis.as_deref()), &path)?;
                Box::new(move |point| axis.cross(&(point - centre)))
            }
            Foundation::Approach { .. } => {
                let stride = contact.stride();
                let is_normal = |i: usize| {
                    let is_moved =
                        i % stride == contact.components && nodes.contains(&(i / stride));
                    f64::from(u8::from(is_moved))
                };
                columns.push((0..contact.force_len()).map(is_normal).collect());
                continue;
            }
        };
        let mut column = vec![0.0; contact.force_len()];
        for node in nodes {
            let at = velocity(Vector3::from(contact.points[node]));
            let normal = Vector3::from(contact.normals[node]);
            if at.dot(&normal).abs() > MOST_NORMAL * at.norm() {
                let found = format!("a motion out of the contact at {:?}", contact.points[node]);
                let allowed = "a motion of the foundation in its own surface".to_owned();
                return Err(scene_error(&path, found, allowed));
            }
            for (c, tangent) in contact.tangents[node][..contact.components]
                .iter()
                .enumerate()
            {
                column[node * contact.stride() + c] = at.dot(&Vector3::from(*tangent));
            }
        }
        columns.push(column);
    }
    Ok(columns)
}

/// Every motion of the foundation with its place in the scene and the contact nodes that it moves under.
fn all_motions<'a>(
    scene: &'a Scene,
    contact: &ContactPatch,
) -> Vec<(String, Range<usize>, &'a Foundation)> {
    let mut all = Vec::new();
    for ((of, placed), part) in scene
        .each_contact()
        .zip(scene.contacts())
        .zip(&contact.parts)
    {
        for (i, motion) in of.foundation.iter().enumerate() {
            let path = format!("{}.foundation[{i}]", placed.path);
            all.push((path, part.nodes.clone(), motion));
        }
    }
    all
}

/// Gap of the undeformed body at every contact node, m, 0 where contact is bilateral; empty where all is.
pub(super) fn initial_gaps(scene: &Scene, mesh: &Mesh, contact: &ContactPatch) -> Result<Vec<f64>> {
    let mut gaps = Vec::new();
    if !scene.can_open() {
        return Ok(gaps);
    }
    for (of, part) in scene.contacts().iter().zip(&contact.parts) {
        gaps.extend(initial_gap(of, mesh, contact, part.nodes.clone())?);
    }
    Ok(gaps)
}

/// The same of one contact, which has these nodes.
fn initial_gap(
    of: &PlacedContact,
    mesh: &Mesh,
    contact: &ContactPatch,
    nodes: Range<usize>,
) -> Result<Vec<f64>> {
    let count = nodes.len();
    let Some(gap) = of.condition.gap() else {
        return Ok(vec![0.0; count]);
    };
    let path = &format!("{}.condition.gap", of.path);
    let gaps = match gap {
        Gap::Uniform(value) => vec![*value; count],
        Gap::Nodal(given) if given.nodes.len() == count => given.nodes.clone(),
        Gap::Nodal(given) => {
            let found = format!("{} numbers", given.nodes.len());
            let allowed = format!("one number per contact node: {count}");
            return Err(scene_error(&format!("{path}.nodes"), found, allowed));
        }
        Gap::Expression(given) => {
            let path = format!("{path}.expression");
            let program = Program::parse(&given.expression, &COORDINATES)
                .map_err(|fault| scene_error(&path, fault.found_there(), fault.allowed))?;
            let points = contact.points[nodes].iter();
            let gaps: Vec<f64> = points.map(|at| program.value(at)).collect();
            if let Some(node) = gaps.iter().position(|gap| !gap.is_finite()) {
                let found = format!("{} at contact node {node}", number(gaps[node]));
                return Err(scene_error(&path, found, "finite numbers".to_owned()));
            }
            gaps
        }
        Gap::Shape(_) => {
            // weighted by the areas of the faces, as the nodal normals are
            let sum = |sum: Vector3<f64>, i: usize| {
                sum + Vector3::from(contact.normals[i]) * contact.weights[i]
            };
            let mean = nodes.clone().fold(Vector3::zeros(), sum);
            let area = contact.weights[nodes.clone()].iter().sum::<f64>();
            let Some(up) = mean.try_normalize(1e-3 * area) else {
                let found = "\"geometry\" on a contact part without a mean normal";
                let allowed = "a number, or one per contact node".to_owned();
                return Err(scene_error(path, found.to_owned(), allowed));
            };
            let part_path = format!("{}.part", of.path);
            let faces = mesh.faces(&of.part, &part_path)?.flatten();
            let height = |node: u32| up.dot(&Vector3::from(mesh.nodes[node as usize]));
            let lowest = faces.map(|n| height(*n)).fold(f64::INFINITY, f64::min);
            let heights = contact.nodes[nodes].iter().map(|n| height(*n));
            heights.map(|height| height - lowest).collect()
        }
    };
    check(of, gaps)
}

/// With rigid contact nothing can begin inside the foundation.
fn check(of: &PlacedContact, gaps: Vec<f64>) -> Result<Vec<f64>> {
    let may_penetrate = matches!(of.condition, Condition::Compliance { .. });
    match gaps.iter().position(|gap| *gap < 0.0 && !may_penetrate) {
        None => Ok(gaps),
        Some(node) => Err(scene_error(
            &format!("{}.condition.gap", of.path),
            format!("{} at contact node {node}", number(gaps[node])),
            "a gap >= 0: a rigid foundation lets nothing in".to_owned(),
        )),
    }
}
