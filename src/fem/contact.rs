//! The contact nodes of a body.

use super::rigid::Pin;
use std::ops::Range;

/// One contact of a scene among the contact nodes of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPart {
    /// Name of the contact.
    pub name: String,
    /// Its nodes.
    pub nodes: Range<usize>,
    /// Whether it can open or give way.
    pub can_open: bool,
}

/// The contact nodes, in the order of their components (the last `nodes.len() * components` free components).
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPatch {
    /// Node numbers; of periodic nodes the leader.
    pub nodes: Vec<u32>,
    /// Coordinates of the nodes, m; z = 0 in 2D.
    pub points: Vec<[f64; 3]>,
    /// omega: integral of the shape function of each node over the contact part (m in 2D, m^2 in 3D), the share of
    /// periodic followers included. The share of clamped nodes belongs to no one.
    pub weights: Vec<f64>,
    /// First and second tangent of each node, unit, global axes; the second is zero in 2D.
    pub tangents: Vec<[[f64; 3]; 2]>,
    /// Tangential components per node: dimension - 1.
    pub components: usize,
    /// Whether the normal component is kept: forces and velocities then have it after the tangential ones, directed into the body.
    pub has_normal: bool,
    /// Unit normals from the foundation into the body.
    pub normals: Vec<[f64; 3]>,
    /// Gap of the undeformed body, m, >= 0 unless the foundation gives way, 0 in a contact that is bilateral; empty where all are.
    pub gaps: Vec<f64>,
    /// Number of faces of the contact parts.
    pub faces: usize,
    /// The contacts of the scene, in its order: their nodes follow each other.
    pub parts: Vec<ContactPart>,
    /// What A has beyond the body's own where nothing but contact holds that along the normal; none for a body that is held.
    pub pins: Vec<Pin>,
}

impl ContactPatch {
    /// Number of contact nodes.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Number of tangential components: nodes times components.
    pub fn len(&self) -> usize {
        self.nodes.len() * self.components
    }

    /// Components of forces and velocities per node: the tangential ones and, where it is kept, the normal one.
    pub fn stride(&self) -> usize {
        self.components + usize::from(self.has_normal)
    }

    /// Number of components of forces and velocities.
    pub fn force_len(&self) -> usize {
        self.nodes.len() * self.stride()
    }

    /// One contact of the scene alone.
    pub fn of_part(&self, part: usize) -> ContactPatch {
        let own = self.parts[part].nodes.clone();
        let mut gaps = Vec::new();
        if self.parts[part].can_open {
            gaps.extend_from_slice(&self.gaps[own.clone()]);
        }
        ContactPatch {
            nodes: self.nodes[own.clone()].to_vec(),
            points: self.points[own.clone()].to_vec(),
            weights: self.weights[own.clone()].to_vec(),
            tangents: self.tangents[own.clone()].to_vec(),
            normals: self.normals[own.clone()].to_vec(),
            gaps,
            components: self.components,
            has_normal: self.has_normal,
            faces: self.faces,
            // they are of the whole body
            pins: Vec::new(),
            parts: vec![ContactPart {
                nodes: 0..own.len(),
                ..self.parts[part].clone()
            }],
        }
    }

    /// The contact of a node, by its place in the scene.
    pub fn part_of(&self, node: usize) -> usize {
        let later = self.parts.iter().rposition(|part| node >= part.nodes.start);
        later.unwrap_or(0)
    }

    /// Whether contact can open or give way at a node.
    pub fn can_open_at(&self, node: usize) -> bool {
        !self.gaps.is_empty() && self.parts[self.part_of(node)].can_open
    }

    /// Whether nothing is in contact; never so for an assembled body.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Tangential stress on the body, Pa, at component `i` under the contact force Lambda = `force` (N).
    pub fn stress(&self, i: usize, force: f64) -> f64 {
        // 0 and not -0 without friction
        (0.0 - force) / self.weights[i / self.components]
    }
}
