//! Numbers of the free displacement components.
//!
//! * Clamped nodes have none, nor have those of a part that is driven as a whole; such a node on the contact part is not a contact
//!   node.
//! * Nodes of a part that is driven along some directions have components along the others.
//! * Nodes of a part on rollers have components along it; where such a node is a contact node, the tangent that the rollers hold
//!   has no length, and nothing moves along it.
//! * A contact node keeps its tangential components, in the frame `(t1, t2, n)` (3D) or `(t1, n)` (2D) of its part (`surface`):
//!   bilateral contact sets the normal one to zero. So it does at the nodes of the part that have no friction.
//! * Where the scene needs the normal motion ([`Scene::is_pressed`]) a contact node keeps a component along -n too, from the
//!   foundation into the body: forces that press are positive, and so is what opens the gap.
//! * Every other node has `dimension` components along the global axes.
//! * A node that follows another one (periodicity) has the numbers of its leader, and all conditions are put on the leader.
//!
//! The contact components come last, contact by contact, node by node, ordered along t1 and then t2: the trailing block of a
//! Cholesky factor is then the operator condensed onto the contact.

use super::held::{Held, held_nodes};
use super::rollers::rollers;
use super::surface::ContactSurface;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::message::cut;
use crate::refusal::scene_error;
use crate::scene::{Foundation, PlacedContact, Scene};
use std::ops::Range;

/// Mark of a node without numbers or without a frame.
const NONE: u32 = u32::MAX;

/// The global axes: the frame of every node that is not in contact.
const GLOBAL: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

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
    /// Contact nodes of every contact of the scene.
    contact_ranges: Vec<Range<usize>>,
    /// Those of the nodes that are free along some directions which their contact alone holds, ascending.
    guided: Vec<u32>,
    /// Per contact node: free directions first, then the normal; unused ones are zero.
    frames: Vec<[[f64; 3]; 3]>,
    /// Free components of a contact node.
    contact_components: usize,
    /// Nodes that are free along some directions only (driven, or guided by a contact), ascending, with their number and frame.
    partly_free: Vec<(u32, usize, [[f64; 3]; 3])>,
    /// Per contact node: integral of its shape function over the contact part, m or m^2.
    weights: Vec<f64>,
}

impl DofMap {
    /// Numbers the components of a mesh under the conditions of a scene.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for a part the mesh does not have, a node on two contacts, a contact part that bends by a large angle
    /// at a node, a tangent that is normal to the contact, or clamped parts that leave no contact node; [`crate::Error::Body`] when a
    /// contact normal is undefined.
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

        let contacts = scene.contacts();
        refuse_shared_nodes(&contacts, mesh, &is_held)?;
        let (mut framed, mut weights, mut ranges) = (Vec::new(), Vec::new(), Vec::new());
        let mut guided = Vec::new();
        for contact in &contacts {
            let surface = ContactSurface::new(contact, mesh, |node| is_held[node as usize])?;
            if surface.nodes.is_empty() {
                let allowed = format!(
                    "parts that leave nodes of {}.part free (or more cells between them)",
                    contact.path
                );
                let found = cut(&format!("{:?}", scene.clamped));
                return Err(scene_error("clamped", found, allowed));
            }
            let first = framed.len();
            framed.extend(surface.nodes);
            weights.extend(surface.weights);
            guided.extend(surface.guided);
            ranges.push(first..framed.len());
        }
        let is_partly_free = |node: u32| partly_free.iter().any(|partly| partly.0 == node);
        let mut rolling = Vec::new();
        for roller in rollers(scene, mesh, &is_held)? {
            if is_partly_free(roller.node) {
                let at = &mesh.nodes[roller.node as usize][..mesh.dimension];
                let found = format!(
                    "{:?}, which shares the node at {at:?} with a driven part",
                    cut(&scene.rollers[roller.part])
                );
                let allowed = "parts without a node of a driven part".to_owned();
                let path = format!("rollers[{}]", roller.part);
                return Err(scene_error(&path, found, allowed));
            }
            if let Some((_, frame)) = framed.iter_mut().find(|(node, _)| *node == roller.node) {
                refuse_sliding(scene, mesh, (roller.node, roller.part))?;
                roller.hold(scene, mesh, frame)?;
                continue;
            }
            let (free, frame) = roller.free(mesh.dimension);
            match free {
                0 => is_held[roller.node as usize] = true,
                _ => rolling.push((roller.node, free, frame)),
            }
        }
        let mut of_contact = framed.iter().chain(&guided);
        if let Some((node, _)) = of_contact.find(|(node, _)| is_partly_free(*node)) {
            let at = mesh.nodes[*node as usize];
            let found = format!(
                "a part with the contact node at {at:?} that is free along some directions"
            );
            let allowed = "parts without contact nodes, or driven along all directions";
            return Err(scene_error("driven", found, allowed.to_owned()));
        }
        let normal = mesh.dimension - 1;
        if scene.is_pressed() {
            for (_, frame) in &mut framed {
                frame[normal] = frame[normal].map(|n| 0.0 - n);
            }
            guided.clear();
        }
        if let Some((node, ..)) =
            (rolling.iter()).find(|(rolling, ..)| guided.iter().any(|(node, _)| node == rolling))
        {
            let found = format!(
                "a part with the vertex at {:?} of quadratic cells in contact",
                mesh.nodes[*node as usize]
            );
            let allowed = "parts without nodes of a contact of quadratic cells".to_owned();
            return Err(scene_error("rollers", found, allowed));
        }
        partly_free.extend(rolling);
        guided.sort_by_key(|(node, _)| *node);
        let along = guided.iter().map(|(node, frame)| (*node, normal, *frame));
        partly_free.extend(along);
        partly_free.sort_by_key(|(node, ..)| *node);
        let is_guided = |node: u32| guided.binary_search_by_key(&node, |(n, _)| *n).is_ok();
        let contact_components = normal + usize::from(scene.is_pressed());
        let map = DofMap::number(
            mesh,
            &is_held,
            partly_free,
            &framed,
            contact_components,
            weights,
        );
        Ok(DofMap {
            contact_ranges: ranges,
            guided: (0..count as u32)
                .filter(|node| is_guided(mesh.leader[*node as usize]))
                .collect(),
            ..map
        })
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
            contact_ranges: Vec::new(),
            guided: Vec::new(),
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
        let mut following = Vec::new();
        for node in 0..count {
            let leader = mesh.leader[node];
            map.first[node] = map.first[leader as usize];
            map.contact[node] = map.contact[leader as usize];
            if leader as usize != node {
                let partly = map.partly(leader);
                following.extend(partly.map(|(_, free, frame)| (node as u32, *free, *frame)));
            }
        }
        map.partly_free.append(&mut following);
        map.partly_free.sort_by_key(|(node, ..)| *node);
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
        let is_guided = || self.guided.binary_search(&node).is_ok();
        self.range(node).is_empty() || (self.partly(node).is_some() && !is_guided())
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

    /// Contact nodes of every contact of the scene, in its order.
    pub fn contact_ranges(&self) -> &[Range<usize>] {
        &self.contact_ranges
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

/// A contact node that rollers hold cannot slide on a foundation that moves.
fn refuse_sliding(scene: &Scene, mesh: &Mesh, (node, part): (u32, usize)) -> Result<()> {
    for contact in scene.contacts() {
        let moves = contact.foundation.iter();
        let is_sliding = moves
            .clone()
            .any(|m| !matches!(m, Foundation::Approach { .. }));
        let path = format!("{}.part", contact.path);
        let mut nodes = mesh.faces(&contact.part, &path)?.flatten();
        if is_sliding && nodes.any(|own| mesh.leader[*own as usize] == node) {
            let found = format!(
                "{:?}, which shares the contact node at {:?} with a foundation that slides",
                cut(&scene.rollers[part]),
                &mesh.nodes[node as usize][..mesh.dimension]
            );
            let allowed = "parts that end short of a contact whose foundation slides or turns: the friction there would act on the rollers";
            return Err(scene_error(
                &format!("rollers[{part}]"),
                found,
                allowed.to_owned(),
            ));
        }
    }
    Ok(())
}

/// A node on two contact parts would have two normals.
fn refuse_shared_nodes(contacts: &[PlacedContact], mesh: &Mesh, is_held: &[bool]) -> Result<()> {
    let mut owners = vec![NONE; mesh.nodes.len()];
    for (index, contact) in contacts.iter().enumerate() {
        let path = format!("{}.part", contact.path);
        for node in mesh.faces(&contact.part, &path)?.flatten() {
            let node = mesh.leader[*node as usize] as usize;
            let owner = std::mem::replace(&mut owners[node], index as u32);
            if is_held[node] || owner == NONE || owner == index as u32 {
                continue;
            }
            let found = format!(
                "{:?}, which shares the node at {:?} with {}.part",
                cut(&contact.part),
                &mesh.nodes[node][..mesh.dimension],
                contacts[owner as usize].path
            );
            let allowed =
                "a part of which no free node is on another contact: it would have two normals";
            return Err(scene_error(&path, found, allowed.to_owned()));
        }
    }
    Ok(())
}
