//! The nodes of a contact part: normals, tangents, weights and order.
//!
//! n is the unit outward normal at a node, the mean of those of the adjacent faces weighted by their areas (where faces are bent,
//! by their integrals with the shape function of the node); t1 is the projection of `tangent` or else of the x axis (of the y axis
//! where n is parallel to x); t2 = n x t1, so that (t1, t2, n) is right-handed: on a bottom (n = -y) t1 = x and t2 = z. A part has
//! one normal per node: where it bends by a large angle there is none, and the part is refused.
//!
//! On quadratic tetrahedra the contact nodes are the midside nodes, with the weights and normals of the midpoint rule. Vertices have
//! the mean normal of the adjacent faces there and are guided along the part, without friction. Where contact has a pressure they are free:
//! a constant pressure is then in balance, vertex by vertex.

use super::cell::point;
use super::direction::direction;
use super::face::{face_integrals, face_normal_at, face_normals};
use crate::error::{Error, Result};
use crate::mesh::{Mesh, bent_face};
use crate::message::cut;
use crate::refusal::scene_error;
use crate::scene::PlacedContact;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Length of the projection of a unit direction below which it counts as normal to the contact.
const PARALLEL: f64 = 1e-3;

/// Cosine of the angle by which the faces at a node may differ: 30 degrees.
pub(super) const LARGEST_BEND: f64 = 0.866;

/// Free directions of a contact node first, then the normal; unused ones are zero.
pub(super) type Frame = [[f64; 3]; 3];

/// The nodes of a contact part that are not held.
pub(super) struct ContactSurface {
    /// Contact nodes (leaders) in their order.
    pub nodes: Vec<(u32, Frame)>,
    /// Integral of the shape function of each over the part, m or m^2.
    pub weights: Vec<f64>,
    /// Nodes of the part without friction and pressure, ascending: the vertices of quadratic tetrahedra.
    pub guided: Vec<(u32, Frame)>,
}

impl ContactSurface {
    /// # Errors
    /// [`Error::Scene`] for a part the mesh does not have, of which no node is left, which bends by a large angle, or whose tangent
    /// is normal to it; [`Error::Body`] where a normal is undefined.
    pub fn new(
        contact: &PlacedContact,
        mesh: &Mesh,
        is_held: impl Fn(u32) -> bool,
    ) -> Result<ContactSurface> {
        let leader = |node: u32| mesh.leader[node as usize];
        let path = format!("{}.part", contact.path);
        let faces = mesh.faces(&contact.part, &path)?;
        let is_bent = faces.clone().any(|face| bent_face(mesh, face).is_some());
        let mut found: BTreeMap<u32, Sums> = BTreeMap::new();
        let mut add = |node: u32, (mass, normal), at| -> Result<()> {
            let node = leader(node);
            if !is_held(node) {
                let sums = found.entry(node).or_default();
                sums.normal += normal;
                sums.mass += mass;
                sums.refuse_bend(contact, mesh, node, at)?;
            }
            Ok(())
        };
        for face in faces {
            if !mesh.element.has_contact_at_all_nodes() {
                for (i, &node) in face.iter().enumerate() {
                    let at = face_normal_at(mesh, face, i);
                    let is_vertex = i < mesh.dimension;
                    let share = if is_vertex { 0.0 } else { at.norm() / 6.0 };
                    add(node, (share, at), at)?;
                }
                continue;
            }
            let normals = face_normals(mesh, face, is_bent);
            let all = face_integrals(mesh, face).zip(normals).enumerate();
            for (i, ((node, mass), (_, normal))) in all {
                add(node, (mass, normal), face_normal_at(mesh, face, i))?;
            }
        }
        let (mut nodes, mut guided) = (Vec::with_capacity(found.len()), Vec::new());
        for (node, sums) in &found {
            let framed = (*node, frame(contact, mesh, *node, sums.normal)?);
            match sums.mass > 0.0 {
                true => nodes.push(framed),
                false => guided.push(framed),
            }
        }
        order_along_contact(mesh, &mut nodes);
        Ok(ContactSurface {
            weights: nodes.iter().map(|(node, _)| found[node].mass).collect(),
            nodes,
            guided,
        })
    }
}

/// What the faces at a node sum up to.
#[derive(Default)]
struct Sums {
    normal: Vector3<f64>,
    mass: f64,
    /// Unit normals of the faces there.
    normals: Vec<Vector3<f64>>,
}

impl Sums {
    /// Takes note of the normal of a face at the node, unless it differs too much from that of another one.
    fn refuse_bend(
        &mut self,
        contact: &PlacedContact,
        mesh: &Mesh,
        node: u32,
        normal: Vector3<f64>,
    ) -> Result<()> {
        // where there is no normal, that is said of the sum
        let Some(unit) = normal.try_normalize(0.0) else {
            return Ok(());
        };
        let least = self.normals.iter().map(|n| n.dot(&unit));
        let least = least.fold(1.0, f64::min);
        if least < LARGEST_BEND {
            let found = format!(
                "{:?}, which bends by {:.0} degrees at {:?}",
                cut(&contact.part),
                least.acos().to_degrees(),
                &mesh.nodes[node as usize][..mesh.dimension]
            );
            let allowed = "a part that bends by at most 30 degrees at a node: finer cells, or a contact of its own on each side of the edge";
            return Err(scene_error(
                &format!("{}.part", contact.path),
                found,
                allowed.to_owned(),
            ));
        }
        self.normals.push(unit);
        Ok(())
    }
}

/// The frame of a contact node from the sum of its area vectors.
fn frame(contact: &PlacedContact, mesh: &Mesh, node: u32, sum: Vector3<f64>) -> Result<Frame> {
    let at = || mesh.nodes[node as usize];
    let length = sum.norm();
    if !(length.is_finite() && length > 0.0) {
        return Err(Error::Body {
            what: format!(
                "the contact part \"{}\" has no normal at {:?}",
                contact.part,
                at()
            ),
        });
    }
    let n = sum / length;
    let project = |direction: Vector3<f64>| {
        let along = direction - n * n.dot(&direction);
        let length = along.norm();
        (length > PARALLEL).then(|| along / length)
    };
    let t1 = match &contact.tangent {
        Some(values) => {
            let path = format!("{}.tangent", contact.path);
            let given = direction(values, &path)?;
            project(given).ok_or_else(|| {
                scene_error(
                    &path,
                    format!("{values:?}"),
                    format!(
                        "a direction that is not normal to the contact (as it is at {:?})",
                        at()
                    ),
                )
            })?
        }
        // Two axes cannot both be parallel to n, so that the second one always has a projection.
        None => project(Vector3::x())
            .or_else(|| project(Vector3::y()))
            .unwrap_or_else(Vector3::y),
    };
    Ok(if mesh.dimension == 2 {
        [t1.into(), n.into(), [0.0; 3]]
    } else {
        [t1.into(), n.cross(&t1).into(), n.into()]
    })
}

/// Orders the contact nodes by the coordinate along t1, those level with each other by the coordinate along t2.
///
/// The directions are those of the middle of the patch: on a curved contact the frames of the nodes differ.
fn order_along_contact(mesh: &Mesh, framed: &mut [(u32, Frame)]) {
    let mean = |axis: usize| -> Vector3<f64> {
        framed
            .iter()
            .map(|(_, frame)| Vector3::from(frame[axis]))
            .sum()
    };
    let t1 = mean(0);
    // In 2D this is the mean normal, which separates nodes of a closed contact with equal coordinate along t1.
    let t2 = mean(1);
    let along = |node: u32, axis: &Vector3<f64>| axis.dot(&point(mesh, node));
    let by = |axis: &Vector3<f64>, a: u32, b: u32| {
        along(a, axis)
            .total_cmp(&along(b, axis))
            .then_with(|| a.cmp(&b))
    };
    framed.sort_by(|(a, _), (b, _)| by(&t1, *a, *b));
    let extent = match (framed.first(), framed.last()) {
        (Some((a, _)), Some((b, _))) => along(*b, &t1) - along(*a, &t1),
        _ => 0.0,
    };
    // Rows are level when rounding alone separates them: a gap above the tolerance starts the next row.
    let tolerance = 1e-9 * extent;
    let mut start = 0;
    for end in 1..=framed.len() {
        let is_new_row = end == framed.len()
            || along(framed[end].0, &t1) - along(framed[end - 1].0, &t1) > tolerance;
        if is_new_row {
            framed[start..end].sort_by(|(a, _), (b, _)| by(&t2, *a, *b));
            start = end;
        }
    }
}
