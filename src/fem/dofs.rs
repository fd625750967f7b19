//! Numbers of the free displacement components.
//!
//! * Clamped nodes have none, nor have those of a part that is driven as a whole; such a node on the contact part is not a contact
//!   node.
//! * Nodes of a part that is driven along some directions have components along the others.
//! * A contact node keeps its tangential components, in the frame `(t1, t2, n)` (3D) or `(t1, n)` (2D): bilateral
//!   contact sets the normal one to zero. n is the unit outward normal, the mean of the adjacent contact faces weighted by
//!   their areas (where faces are bent, by their integrals with the shape function of the node); t1 is the projection of
//!   `contact.tangent` or else of the x axis (of the y axis where n is parallel to x); t2 = n x t1, so that (t1, t2, n) is right-handed: on a bottom (n = -y) t1 = x and t2 = z.
//! * Where the scene needs the normal motion ([`Scene::is_pressed`]) a contact node keeps a component along -n too, from the
//!   foundation into the body: forces that press are positive, and so is what opens the gap.
//! * Every other node has `dimension` components along the global axes.
//! * A node that follows another one (periodicity) has the numbers of its leader, and all conditions are put on the leader.
//!
//! The contact components come last, contact node by contact node, ordered along t1 and then t2: the trailing block of a
//! Cholesky factor is then the operator condensed onto the contact.

use super::cell::point;
use super::direction::direction;
use super::face::{face_integrals, face_normals};
use super::held::{Held, held_nodes};
use crate::error::{Error, Result};
use crate::mesh::{Mesh, bent_face};
use crate::message::cut;
use crate::refusal::scene_error;
use crate::scene::Scene;
use nalgebra::Vector3;
use std::ops::Range;

/// Mark of a node without numbers or without a frame.
const NONE: u32 = u32::MAX;

/// The global axes: the frame of every node that is not in contact.
const GLOBAL: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Length of the projection of a unit direction below which it counts as normal to the contact.
const PARALLEL: f64 = 1e-3;

/// Which free unknowns belong to each node.
#[derive(Debug, Clone, PartialEq)]
pub struct DofMap {
    dimension: usize,
    len: usize,
    contact_start: usize,
    /// Per node: number of the first component, `NONE` where all vanish. Equal for followers and leader.
    first: Vec<u32>,
    /// Per node: index of the contact node, `NONE` elsewhere. Equal for followers and leader.
    contact: Vec<u32>,
    /// Per contact node: node number (a leader).
    contact_nodes: Vec<u32>,
    /// Per contact node: free directions first, then the normal; unused ones are zero.
    frames: Vec<[[f64; 3]; 3]>,
    /// Free components of a contact node.
    contact_components: usize,
    /// Nodes that are free along some directions only, ascending, with their number and frame.
    partly_free: Vec<(u32, usize, [[f64; 3]; 3])>,
    /// Per contact node: integral of its shape function over the contact part, m or m^2.
    weights: Vec<f64>,
}

impl DofMap {
    /// Numbers the components of a mesh under the conditions of a scene.
    ///
    /// # Errors
    /// [`Error::Scene`] for a part the mesh does not have, a tangent that is normal to the contact, or clamped parts that leave no
    /// contact node; [`Error::Body`] when a contact normal is undefined.
    pub fn new(scene: &Scene, mesh: &Mesh) -> Result<DofMap> {
        let count = mesh.nodes.len();
        let leader = |node: u32| mesh.leader[node as usize] as usize;

        // A node of no cell has no stiffness, hence no unknowns.
        let mut is_held = vec![true; count];
        for &node in &mesh.cell_nodes {
            is_held[leader(node)] = false;
        }
        for (i, part) in scene.clamped.iter().enumerate() {
            for &node in mesh.faces(part, &format!("clamped[{i}]"))?.flatten() {
                is_held[leader(node)] = true;
            }
        }
        let mut partly_free = Vec::new();
        for (node, held) in held_nodes(scene, mesh, &is_held)? {
            match held {
                Held::Whole => is_held[node as usize] = true,
                Held::Partly(free, frame) => partly_free.push((node, free, frame)),
            }
        }

        let mut normal_sums = vec![Vector3::zeros(); count];
        let mut masses = vec![0.0; count];
        let mut is_contact = vec![false; count];
        let faces = mesh.faces(&scene.contact.part, "contact.part")?;
        let is_bent = faces.clone().any(|face| bent_face(mesh, face).is_some());
        for face in faces {
            let normals = face_normals(mesh, face, is_bent);
            for ((node, mass), (_, normal)) in face_integrals(mesh, face).zip(normals) {
                normal_sums[leader(node)] += normal;
                masses[leader(node)] += mass;
                is_contact[leader(node)] = true;
            }
        }
        let nodes: Vec<u32> = (0..count as u32)
            .filter(|&n| is_contact[n as usize] && !is_held[n as usize])
            .collect();
        if nodes.is_empty() {
            let allowed =
                "parts that leave nodes of contact.part free (or more cells between them)";
            let found = cut(&format!("{:?}", scene.clamped));
            return Err(scene_error("clamped", found, allowed.to_owned()));
        }
        if let Some((node, ..)) = partly_free.iter().find(|n| is_contact[n.0 as usize]) {
            let at = mesh.nodes[*node as usize];
            let found = format!(
                "a part with the contact node at {at:?} that is free along some directions"
            );
            let allowed = "parts without contact nodes, or driven along all directions";
            return Err(scene_error("driven", found, allowed.to_owned()));
        }
        let mut framed = Vec::with_capacity(nodes.len());
        for node in nodes {
            let frame = frame(scene, mesh, node, normal_sums[node as usize])?;
            framed.push((node, frame));
        }
        order_along_contact(mesh, &mut framed);
        let normal = mesh.dimension - 1;
        if scene.is_pressed() {
            for (_, frame) in &mut framed {
                frame[normal] = frame[normal].map(|n| 0.0 - n);
            }
        }

        let weights = framed
            .iter()
            .map(|(node, _)| masses[*node as usize])
            .collect();
        let contact_components = normal + usize::from(scene.is_pressed());
        Ok(DofMap::number(
            mesh,
            &is_held,
            partly_free,
            &framed,
            contact_components,
            weights,
        ))
    }

    /// Numbers the components of the nodes that are not held; those of the contact nodes with their frames come last.
    pub(super) fn number(
        mesh: &Mesh,
        is_held: &[bool],
        partly_free: Vec<(u32, usize, [[f64; 3]; 3])>,
        framed: &[(u32, [[f64; 3]; 3])],
        contact_components: usize,
        weights: Vec<f64>,
    ) -> DofMap {
        let count = mesh.nodes.len();
        let mut map = DofMap {
            dimension: mesh.dimension,
            len: 0,
            contact_start: 0,
            first: vec![NONE; count],
            contact: vec![NONE; count],
            contact_nodes: framed.iter().map(|(node, _)| *node).collect(),
            frames: framed.iter().map(|(_, frame)| *frame).collect(),
            contact_components,
            partly_free,
            weights,
        };
        for (i, &node) in map.contact_nodes.iter().enumerate() {
            map.contact[node as usize] = i as u32;
        }
        let mut next = 0;
        for (node, is_held) in is_held.iter().enumerate() {
            let is_leader = mesh.leader[node] as usize == node;
            if is_leader && !is_held && map.contact[node] == NONE {
                map.first[node] = next;
                next += map.partly(node as u32).map_or(mesh.dimension, |p| p.1) as u32;
            }
        }
        map.contact_start = next as usize;
        for &node in &map.contact_nodes {
            map.first[node as usize] = next;
            next += contact_components as u32;
        }
        map.len = next as usize;
        for node in 0..count {
            map.first[node] = map.first[mesh.leader[node] as usize];
            map.contact[node] = map.contact[mesh.leader[node] as usize];
        }
        map
    }

    /// Number of free components.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether no component is free; never so for a map made by [`DofMap::new`].
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Number of the first contact component: the contact has the numbers from here to [`DofMap::len`].
    pub fn contact_start(&self) -> usize {
        self.contact_start
    }

    /// Numbers of the free components of a node, in the order of [`DofMap::frame`]; empty for a clamped node.
    pub fn range(&self, node: u32) -> Range<usize> {
        let first = self.first[node as usize];
        if first == NONE {
            return 0..0;
        }
        let components = match self.contact_index(node) {
            Some(_) => self.contact_components,
            None => self.partly(node).map_or(self.dimension, |p| p.1),
        };
        first as usize..first as usize + components
    }

    /// What is free of a node that is free along some directions only.
    fn partly(&self, node: u32) -> Option<&(u32, usize, [[f64; 3]; 3])> {
        let at = self.partly_free.binary_search_by_key(&node, |p| p.0).ok()?;
        self.partly_free.get(at)
    }

    /// Number of a local component of a node; `None` where it vanishes.
    pub fn dof(&self, node: u32, component: usize) -> Option<usize> {
        self.range(node).nth(component)
    }

    /// Directions (global coordinates, unit) of the local components of a node: the global axes, `t1[, t2], n` at a
    /// contact node (-n where it has a normal component), those that are free first at a node that is driven along the others.
    pub fn frame(&self, node: u32) -> &[[f64; 3]; 3] {
        match self.contact_index(node) {
            Some(i) => &self.frames[i],
            None => self.partly(node).map_or(&GLOBAL, |p| &p.2),
        }
    }

    /// Whether a node is clamped or driven, along some directions at least.
    pub(super) fn is_held(&self, node: u32) -> bool {
        self.range(node).is_empty() || self.partly(node).is_some()
    }

    /// Whether the frame of a node is not that of the global axes.
    pub(super) fn is_turned(&self, node: u32) -> bool {
        self.contact_index(node).is_some() || self.partly(node).is_some()
    }

    /// Free components of a contact node.
    pub fn contact_components(&self) -> usize {
        self.contact_components
    }

    /// Index of a node among the contact nodes; a follower has that of its leader.
    pub fn contact_index(&self, node: u32) -> Option<usize> {
        let index = self.contact[node as usize];
        (index != NONE).then_some(index as usize)
    }

    /// Node numbers of the contact nodes, in the order of their components.
    pub fn contact_nodes(&self) -> &[u32] {
        &self.contact_nodes
    }

    /// Integral of the shape function of each contact node over the contact part (m in 2D, m^2 in 3D).
    pub fn contact_weights(&self) -> &[f64] {
        &self.weights
    }

    /// The vector (global axes) at a node of a field of free components.
    pub fn vector(&self, node: u32, field: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (dof, axis) in self.range(node).zip(self.frame(node)) {
            for c in 0..3 {
                sum[c] += field[dof] * axis[c];
            }
        }
        sum
    }
}

/// The frame of a contact node from the sum of its area vectors.
fn frame(scene: &Scene, mesh: &Mesh, node: u32, sum: Vector3<f64>) -> Result<[[f64; 3]; 3]> {
    let at = || mesh.nodes[node as usize];
    let length = sum.norm();
    if !(length.is_finite() && length > 0.0) {
        return Err(Error::Body {
            what: format!(
                "the contact part \"{}\" has no normal at {:?}",
                scene.contact.part,
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
    let t1 = match &scene.contact.tangent {
        Some(values) => {
            let given = direction(values, "contact.tangent")?;
            project(given).ok_or_else(|| {
                scene_error(
                    "contact.tangent",
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
fn order_along_contact(mesh: &Mesh, framed: &mut [(u32, [[f64; 3]; 3])]) {
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
