//! Conforming simplex meshes with named boundary parts and periodic identification.
//!
//! A mesh is plain data: coordinates, cells (triangles or tetrahedra) and the oriented faces of each named part.
//! Periodicity is kept as a map from every node to the node it follows; the finite element layer gives both the same
//! unknowns, so that a tie costs no equation. Quadratic triangles have straight sides: their midside nodes stand in the
//! middle. What is not here: adjacency, adaptivity, curved cells.

mod bisection;
mod boxes;
mod lines;
mod midside;
mod rectangle;

use crate::error::{Error, Result};
use crate::scene::{Axis, ElementKind, MeshSpec};
use lines::Lines;
use std::collections::BTreeMap;

/// A conforming mesh of triangles (2D) or tetrahedra (3D).
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Space dimension, 2 or 3.
    pub dimension: usize,
    /// Element of all cells; [`Mesh::for_element`] changes it.
    pub element: ElementKind,
    /// Coordinates of the nodes, m; z = 0 in 2D.
    pub nodes: Vec<[f64; 3]>,
    /// Node numbers of the cells, [`Mesh::nodes_per_cell`] each: `dimension + 1` corners, positively oriented (positive
    /// area or volume); in a quadratic triangle the midside nodes of its sides (0, 1), (1, 2), (2, 0) follow.
    pub cell_nodes: Vec<u32>,
    /// Faces of every named part of the boundary, [`Mesh::nodes_per_face`] node numbers each: `dimension` corners, then
    /// the midside node of a quadratic element. The outward normal of an edge `(p, q)` is to the right of `q - p`; that
    /// of a triangle `(p, q, r)` is along `(q - p) x (r - p)`.
    pub parts: BTreeMap<String, Vec<u32>>,
    /// Node that each node follows (periodicity); itself otherwise. A leader never follows another node.
    pub leader: Vec<u32>,
}

impl Mesh {
    /// Generates the mesh that a scene describes, with linear elements.
    ///
    /// # Errors
    /// [`Error::Scene`] for a size, a number of cells, a grading or a periodic axis that gives no mesh.
    pub fn generate(spec: &MeshSpec) -> Result<Mesh> {
        check(spec)?;
        match spec {
            MeshSpec::Rectangle {
                periodic, refine, ..
            } => rectangle::generate(&lines(spec), periodic, refine),
            MeshSpec::Box { periodic, .. } => Ok(boxes::generate(&lines(spec), periodic)),
        }
    }

    /// Nodes of a cell: `dimension + 1`, or 6 for the quadratic triangle.
    pub fn nodes_per_cell(&self) -> usize {
        match self.element {
            ElementKind::P1 => self.dimension + 1,
            ElementKind::P2 => 6,
        }
    }

    /// Nodes of a face of a part: `dimension`, or 3 for the side of a quadratic triangle.
    pub fn nodes_per_face(&self) -> usize {
        match self.element {
            ElementKind::P1 => self.dimension,
            ElementKind::P2 => 3,
        }
    }

    /// Node numbers of each cell.
    pub fn cells(&self) -> impl Iterator<Item = &[u32]> {
        self.cell_nodes.chunks_exact(self.nodes_per_cell())
    }

    /// Node numbers of cell `cell`.
    pub fn cell(&self, cell: usize) -> &[u32] {
        let n = self.nodes_per_cell();
        &self.cell_nodes[cell * n..(cell + 1) * n]
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.cell_nodes.len() / self.nodes_per_cell()
    }

    /// Node numbers of each face of a part.
    ///
    /// # Errors
    /// [`Error::Scene`] when the mesh has no such part; `path` is the place of the scene that names it.
    pub fn faces(&self, part: &str, path: &str) -> Result<impl Iterator<Item = &[u32]> + Clone> {
        match self.parts.get(part) {
            Some(faces) => Ok(faces.chunks_exact(self.nodes_per_face())),
            None => Err(scene_error(
                path,
                format!("{:?}", crate::message::cut(part)),
                format!(
                    "the parts of the mesh: {}",
                    self.parts.keys().cloned().collect::<Vec<_>>().join(", ")
                ),
            )),
        }
    }

    /// Names the outer faces of the cells by the sides on which all their nodes lie.
    ///
    /// `sides[node]` has bit `s` set where the node lies on side `s`; `names[s]` is the name of that side, or `None`
    /// where the side is tied to the opposite one and therefore is not a boundary.
    fn name_sides(&mut self, sides: &[u8], names: &[Option<&str>]) {
        let mut faces: Vec<Vec<u32>> = vec![Vec::new(); names.len()];
        let numbering: &[&[usize]] = match self.dimension {
            2 => &TRIANGLE_FACES,
            _ => &TETRAHEDRON_FACES,
        };
        for cell in self.cells() {
            for face in numbering {
                let common = face
                    .iter()
                    .fold(u8::MAX, |all, &i| all & sides[cell[i] as usize]);
                for (s, list) in faces.iter_mut().enumerate() {
                    if common & (1 << s) != 0 {
                        list.extend(face.iter().map(|&i| cell[i]));
                    }
                }
            }
        }
        for (name, list) in names.iter().zip(faces) {
            if let Some(name) = name {
                self.parts.insert((*name).to_string(), list);
            }
        }
    }
}

/// Faces of a positively oriented triangle, outward normal to the right; midside nodes have this order.
pub(crate) const TRIANGLE_FACES: [&[usize]; 3] = [&[0, 1], &[1, 2], &[2, 0]];

/// Faces of a positively oriented tetrahedron, outward normal by the right-hand rule.
const TETRAHEDRON_FACES: [&[usize]; 4] = [&[0, 2, 1], &[0, 1, 3], &[0, 3, 2], &[1, 2, 3]];

/// An error about the value at `path` of the scene.
pub(crate) fn scene_error(path: &str, found: String, allowed: String) -> Error {
    Error::Scene {
        source_name: "scene".to_string(),
        path: path.to_string(),
        found,
        allowed,
    }
}

/// The grid lines of every axis.
fn lines<const N: usize>(spec: &MeshSpec) -> [Lines; N] {
    std::array::from_fn(|i| Lines::new(spec.size()[i], spec.cells()[i], spec.grading()[i]))
}

/// Checks what would otherwise give an empty, inverted or unnumberable mesh.
fn check(spec: &MeshSpec) -> Result<()> {
    let (size, cells, periodic) = (spec.size(), spec.cells(), spec.periodic());
    for (i, &length) in size.iter().enumerate() {
        if !(length.is_finite() && length > 0.0) {
            return Err(scene_error(
                &format!("mesh.size[{i}]"),
                crate::message::number(length).to_string(),
                "a positive length".to_string(),
            ));
        }
    }
    for (i, &count) in cells.iter().enumerate() {
        if count == 0 {
            return Err(scene_error(
                &format!("mesh.cells[{i}]"),
                count.to_string(),
                "1 or more".to_string(),
            ));
        }
    }
    // The longest lists: four triangles per square, three tetrahedra per prism, four nodes each; three unknowns per node.
    let cells_total: f64 = cells.iter().map(|&n| f64::from(n)).product();
    let unknowns: f64 = 6.0 * cells.iter().map(|&n| f64::from(n) + 1.0).product::<f64>();
    if unknowns.max(48.0 * cells_total) > f64::from(u32::MAX) {
        return Err(scene_error(
            "mesh.cells",
            format!("{cells:?}"),
            "a mesh whose nodes and cells can be numbered with 32 bits".to_string(),
        ));
    }
    for axis in [Axis::X, Axis::Y, Axis::Z] {
        if let Some((found, allowed)) = spec.grading_fault(axis) {
            let path = format!("mesh.grading[{}]", axis.index());
            return Err(scene_error(&path, found, allowed));
        }
    }
    if let Some((path, found, allowed)) = spec.refinement_fault() {
        return Err(scene_error(&path, found, allowed));
    }
    if size.len() == 2 && periodic.contains(&Axis::Z) {
        return Err(scene_error(
            "mesh.periodic",
            "\"z\"".to_string(),
            "\"x\", \"y\"".to_string(),
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unusable_specifications_name_their_path() {
        let graded = |size, cells, grading, periodic| MeshSpec::Rectangle {
            size,
            cells,
            grading,
            refine: vec![],
            periodic,
        };
        let rectangle = |size, cells, periodic| graded(size, cells, [1.0; 2], periodic);
        for (spec, expected) in [
            (rectangle([1.0, 0.0], [1, 1], vec![]), "mesh.size[1]"),
            (rectangle([f64::NAN, 1.0], [1, 1], vec![]), "mesh.size[0]"),
            (rectangle([1.0, 1.0], [0, 1], vec![]), "mesh.cells[0]"),
            (rectangle([1.0, 1.0], [u32::MAX, 9], vec![]), "mesh.cells"),
            (
                rectangle([1.0, 1.0], [1, 1], vec![Axis::Z]),
                "mesh.periodic",
            ),
            (
                graded([1.0, 1.0], [4, 4], [2.0, 0.5], vec![]),
                "mesh.grading[1]",
            ),
            (
                graded([1.0, 1.0], [4, 4], [f64::NAN, 1.0], vec![]),
                "mesh.grading[0]",
            ),
            (
                graded([1.0, 1.0], [4, 4], [2.0, 2.0], vec![Axis::X]),
                "mesh.grading[0]",
            ),
            (
                graded([1.0, 1.0], [4, 4], [1.0, 30.0], vec![]),
                "mesh.grading[1]",
            ),
        ] {
            match Mesh::generate(&spec) {
                Err(Error::Scene { path, .. }) => assert_eq!(path, expected),
                other => panic!("{expected}: {other:?}"),
            }
        }
    }

    #[test]
    fn an_unknown_part_lists_the_parts() {
        let mesh = rectangle::uniform([1.0, 1.0], [1, 1], &[Axis::X]);
        let Err(Error::Scene { path, allowed, .. }) = mesh.faces("left", "contact.part").map(drop)
        else {
            panic!("a periodic axis has no parts");
        };
        assert_eq!(path, "contact.part");
        assert_eq!(allowed, "the parts of the mesh: bottom, top");
    }
}
