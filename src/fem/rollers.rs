//! Parts on rollers: no motion along their normal, none but friction's business along their tangents.

use super::face::face_normal_at;
use super::held::complement;
use super::surface::{Frame, LARGEST_BEND};
use crate::error::Result;
use crate::mesh::Mesh;
use crate::message::cut;
use crate::refusal::scene_error;
use crate::scene::Scene;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Length of what is left of a normal beside others below which it adds no direction.
const DEPENDENT: f64 = 1e-6;
/// Cosine above which a roller and a tangent of a contact are along each other.
const ALONG: f64 = 1.0 - 1e-9;

/// What the rollers hold of a node: orthonormal directions, one per plane that it moves in.
pub(super) struct Roller {
    pub node: u32,
    /// The part, by its place in the scene.
    pub part: usize,
    pub held: Vec<Vector3<f64>>,
}

impl Roller {
    /// Free directions, those first, and how many they are.
    pub fn free(&self, dimension: usize) -> (usize, Frame) {
        complement(&self.held, dimension)
    }

    /// Takes the held directions out of the frame of a contact node: its axes along them become nothing.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for a roller that is neither along a tangent of the contact nor at a right angle to it.
    pub fn hold(&self, scene: &Scene, mesh: &Mesh, frame: &mut Frame) -> Result<()> {
        for held in &self.held {
            let tangents = &mut frame[..mesh.dimension - 1];
            let along = |axis: &[f64; 3]| Vector3::from(*axis).dot(held).abs() > ALONG;
            let Some(axis) = tangents.iter_mut().find(|axis| along(axis)) else {
                let at = &mesh.nodes[self.node as usize][..mesh.dimension];
                let found = format!(
                    "{:?}, which holds the contact node at {at:?} along {:?}",
                    cut(&scene.rollers[self.part]),
                    &held.as_slice()[..mesh.dimension]
                );
                let allowed = "rollers along a tangent of the contact where they share nodes with it (contact.tangent turns the tangents)";
                let path = format!("rollers[{}]", self.part);
                return Err(scene_error(&path, found, allowed.to_owned()));
            };
            *axis = [0.0; 3];
        }
        Ok(())
    }
}

/// The nodes of the parts on rollers, ascending, that are not held anyway.
///
/// # Errors
/// [`crate::Error::Scene`] for an unknown part and for one that bends by a large angle at a node.
pub(super) fn rollers(scene: &Scene, mesh: &Mesh, is_held: &[bool]) -> Result<Vec<Roller>> {
    let mut all: BTreeMap<u32, Roller> = BTreeMap::new();
    for (part, name) in scene.rollers.iter().enumerate() {
        let path = format!("rollers[{part}]");
        let mut normals: BTreeMap<u32, (Vector3<f64>, Vector3<f64>)> = BTreeMap::new();
        for face in mesh.faces(name, &path)? {
            for (i, &node) in face.iter().enumerate() {
                let node = mesh.leader[node as usize];
                let normal = face_normal_at(mesh, face, i);
                let Some(unit) = normal.try_normalize(0.0) else {
                    continue;
                };
                let (sum, first) = normals.entry(node).or_insert((Vector3::zeros(), unit));
                *sum += normal;
                if first.dot(&unit) < LARGEST_BEND {
                    let at = &mesh.nodes[node as usize][..mesh.dimension];
                    let found = format!("{:?}, which bends by a large angle at {at:?}", cut(name));
                    let allowed = "a part that bends by at most 30 degrees at a node: list the sides of an edge as parts of their own";
                    return Err(scene_error(&path, found, allowed.to_owned()));
                }
            }
        }
        for (node, (sum, _)) in normals {
            let Some(normal) = sum.try_normalize(0.0).filter(|_| !is_held[node as usize]) else {
                continue;
            };
            let roller = all.entry(node).or_insert(Roller {
                node,
                part,
                held: Vec::new(),
            });
            let known = roller.held.iter();
            let rest = known.fold(normal, |rest, held| rest - held * held.dot(&normal));
            if rest.norm() > DEPENDENT {
                roller.held.push(rest.normalize());
            }
        }
    }
    Ok(all.into_values().collect())
}
