//! The motions of driven parts, and which components they hold.

use super::direction::{axis_of, direction};
use crate::error::Result;
use crate::mesh::Mesh;
use crate::message::cut;
use crate::refusal::scene_error;
use crate::scene::{DrivenDirection, RotationAxis, Scene};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// What is held of a node.
pub(super) enum Held {
    Whole,
    /// Number of free directions, and the frame, those first.
    Partly(usize, [[f64; 3]; 3]),
}

/// One motion of a driven part.
pub(super) struct Motion<'a> {
    pub name: &'a str,
    pub part: &'a str,
    pub path: String,
    shape: Shape,
}

enum Shape {
    Translation(Vector3<f64>),
    Rotation {
        centre: Vector3<f64>,
        axis: Vector3<f64>,
    },
}

impl Motion<'_> {
    /// Displacement of a point by a unit of the motion.
    pub fn at(&self, point: [f64; 3]) -> Vector3<f64> {
        match &self.shape {
            Shape::Translation(along) => *along,
            Shape::Rotation { centre, axis } => axis.cross(&(Vector3::from(point) - centre)),
        }
    }
}

/// The motions of a scene, in the order of its inputs.
pub(super) fn motions(scene: &Scene) -> Result<Vec<Motion<'_>>> {
    let mut motions = Vec::new();
    for (i, driven) in scene.driven.iter().enumerate() {
        for (name, given) in &driven.directions {
            let path = format!("driven[{i}].directions.{name}");
            let shape = match given {
                DrivenDirection::Translation(values) => {
                    Shape::Translation(direction(values, &path)?)
                }
                DrivenDirection::Rotation(RotationAxis { centre, axis }) => {
                    let (centre, axis) = axis_of((centre, axis.as_deref()), &path)?;
                    Shape::Rotation { centre, axis }
                }
            };
            let (part, name) = (driven.part.as_str(), name.as_str());
            motions.push(Motion {
                name,
                part,
                path,
                shape,
            });
        }
    }
    Ok(motions)
}

/// The nodes of driven parts, ascending, and what is held of them. `is_clamped`, by nodes, is those that are held anyway.
///
/// # Errors
/// [`crate::Error::Scene`] for an unknown part and for nodes that belong to two parts.
pub(super) fn held_nodes(
    scene: &Scene,
    mesh: &Mesh,
    is_clamped: &[bool],
) -> Result<Vec<(u32, Held)>> {
    let mut owners: BTreeMap<u32, usize> = BTreeMap::new();
    for (i, driven) in scene.driven.iter().enumerate() {
        let path = format!("driven[{i}].part");
        for node in mesh.faces(&driven.part, &path)?.flatten() {
            let node = mesh.leader[*node as usize];
            let other = owners.insert(node, i).filter(|other| *other != i);
            if other.is_some() || is_clamped[node as usize] {
                let at = mesh.nodes[node as usize];
                let found = format!(
                    "{:?}, which shares the node at {at:?} with a clamped or another driven part",
                    cut(&driven.part)
                );
                let allowed = "a part of which no node belongs to another one".to_owned();
                return Err(scene_error(&path, found, allowed));
            }
        }
    }
    let motions = motions(scene)?;
    let mut held = Vec::with_capacity(scene.driven.len());
    for driven in &scene.driven {
        let of_part = motions.iter().filter(|m| m.part == driven.part);
        let shapes: Vec<&Shape> = of_part.map(|m| &m.shape).collect();
        let translations: Vec<Vector3<f64>> = shapes
            .iter()
            .filter_map(|shape| match shape {
                Shape::Translation(along) => Some(*along),
                Shape::Rotation { .. } => None,
            })
            .collect();
        let is_whole = translations.len() < shapes.len() || translations.len() >= mesh.dimension;
        held.push((!is_whole).then(|| complement(&translations, mesh.dimension)));
    }
    let of = |(node, part): (u32, usize)| match &held[part] {
        None => (node, Held::Whole),
        Some((free, frame)) => (node, Held::Partly(*free, *frame)),
    };
    Ok(owners.into_iter().map(of).collect())
}

/// Orthonormal directions, those at right angles to the given orthonormal ones first; and how many these are.
pub(super) fn complement(held: &[Vector3<f64>], dimension: usize) -> (usize, [[f64; 3]; 3]) {
    let mut basis: Vec<Vector3<f64>> = held.to_vec();
    for axis in [Vector3::x(), Vector3::y(), Vector3::z()]
        .iter()
        .take(dimension)
    {
        let rest = basis.iter().fold(*axis, |rest, b| rest - b * b.dot(&rest));
        // of the axes some have at least this much outside any proper subspace
        if basis.len() < dimension && rest.norm() > 0.5 {
            basis.push(rest.normalize());
        }
    }
    basis.rotate_left(held.len());
    let mut frame = [[0.0; 3]; 3];
    for (to, from) in frame.iter_mut().zip(&basis) {
        *to = (*from).into();
    }
    (dimension - held.len(), frame)
}
