//! Conforming simplex meshes with regions, named boundary parts and periodic identification.
//!
//! A mesh is plain data: coordinates, cells of one element with their regions, the oriented faces of each named part.
//! Periodicity is kept as a map from every node to the node it follows; the finite element layer gives both the same
//! unknowns, so that a tie costs no equation. Midside nodes that the library makes stand in the middle of straight sides; those of a
//! file may bend them (`geometry`). What is not here: adaptivity, cells of several elements.

mod geometry;
mod midside;
mod pieces;
mod quality;
mod source;

pub use geometry::{Bent, bent_face};
pub use quality::{PartSize, Quality, RegionSize};
pub use source::{
    Axis, BODY, BoxMesh, Extent, GmshMesh, Grid, MeshSpec, Rectangle, Refinement, RegionBox,
};

use crate::element::{Element, linear};
use crate::error::Result;
use crate::files::{Files, NoFiles};
use crate::message::cut;
use crate::refusal::scene_error;
use std::collections::BTreeMap;

/// Largest number of mesh nodes: with three unknowns per node, every index still fits 32 bits.
pub const MAX_NODES: u32 = 1 << 30;

/// A conforming mesh of triangles (2D) or tetrahedra (3D).
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Space dimension, 2 or 3.
    pub dimension: usize,
    /// Element of all cells; [`Mesh::for_element`] changes it.
    pub element: &'static Element,
    /// Coordinates of the nodes, m; z = 0 in 2D.
    pub nodes: Vec<[f64; 3]>,
    /// Node numbers of the cells, as many each as the element has nodes: corners, positively oriented (positive area or
    /// volume), then the midside nodes.
    pub cell_nodes: Vec<u32>,
    /// Names of the regions; every one has a cell.
    pub regions: Vec<String>,
    /// Region of every cell, a place in `regions`.
    pub cell_regions: Vec<u32>,
    /// Faces of every named part of the boundary, as many node numbers each as a face of the element has: corners, whose order
    /// gives the outward normal as in [`Element::faces`], then midside nodes.
    pub parts: BTreeMap<String, Vec<u32>>,
    /// Names in the file of a mesh that are no parts although they could be meant so, and why.
    pub unusable: BTreeMap<String, String>,
    /// Node that each node follows (periodicity); itself otherwise. A leader never follows another node.
    pub leader: Vec<u32>,
}

impl Mesh {
    /// Generates the mesh that a scene describes, with linear elements.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for a size, a number of cells, a grading, a periodic axis or a region that gives no mesh, and for a
    /// mesh that comes from a file.
    pub fn generate(spec: &MeshSpec) -> Result<Mesh> {
        Mesh::read(spec, &NoFiles)
    }

    /// The mesh that a scene describes: generated with linear elements, or read from its file with those of the file.
    ///
    /// # Errors
    /// Those of [`Mesh::generate`]; [`crate::Error::Scene`] at `mesh.file` for a file that is not there or holds no mesh.
    pub fn read(spec: &MeshSpec, files: &dyn Files) -> Result<Mesh> {
        let source = spec.source();
        let checked = source.check(linear(source.dimension().unwrap_or(2)));
        checked.map_err(|refusal| refusal.of("scene"))?;
        source.mesh(files)
    }

    /// A mesh of one region without parts.
    pub(crate) fn new(
        element: &'static Element,
        nodes: Vec<[f64; 3]>,
        cell_nodes: Vec<u32>,
        leader: Vec<u32>,
    ) -> Mesh {
        Mesh {
            dimension: element.dimension,
            element,
            nodes,
            regions: vec![BODY.to_owned()],
            cell_regions: vec![0; cell_nodes.len() / element.nodes],
            cell_nodes,
            parts: BTreeMap::new(),
            unusable: BTreeMap::new(),
            leader,
        }
    }

    /// Node numbers of each cell.
    pub fn cells(&self) -> impl Iterator<Item = &[u32]> {
        self.cell_nodes.chunks_exact(self.element.nodes)
    }

    /// Node numbers of cell `cell`.
    pub fn cell(&self, cell: usize) -> &[u32] {
        let n = self.element.nodes;
        &self.cell_nodes[cell * n..(cell + 1) * n]
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.cell_nodes.len() / self.element.nodes
    }

    /// Mean of the corners of a cell, m.
    pub fn centroid(&self, cell: &[u32]) -> [f64; 3] {
        let corners = &cell[..self.element.corners()];
        let mean = |axis: usize| {
            let sum: f64 = corners.iter().map(|n| self.nodes[*n as usize][axis]).sum();
            sum / corners.len() as f64
        };
        std::array::from_fn(mean)
    }

    /// Node numbers of each face of a part.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] when the mesh has no such part; `path` is the place of the scene that names it.
    pub fn faces(&self, part: &str, path: &str) -> Result<impl Iterator<Item = &[u32]> + Clone> {
        match self.parts.get(part) {
            Some(faces) => Ok(faces.chunks_exact(self.element.face_nodes())),
            None => Err(scene_error(
                path,
                match self.unusable.get(part) {
                    Some(why) => format!("{:?}, which is no part: {why}", cut(part)),
                    None => format!("{:?}", cut(part)),
                },
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
        for cell in self.cells() {
            for face in self.element.faces {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    #[test]
    fn unusable_specifications_name_their_path() {
        let graded = |size, cells, grading, periodic| {
            MeshSpec::Rectangle(Rectangle {
                size,
                cells,
                grading,
                periodic,
                ..Rectangle::default()
            })
        };
        let rectangle = |size, cells, periodic| graded(size, cells, [1.0; 2], periodic);
        for (spec, expected) in [
            (rectangle([1.0, 0.0], [1, 1], vec![]), "mesh.size[1]"),
            (rectangle([f64::NAN, 1.0], [1, 1], vec![]), "mesh.size[0]"),
            (rectangle([1.0, 1.0], [0, 1], vec![]), "mesh.cells[0]"),
            (rectangle([1.0, 1.0], [u32::MAX, 9], vec![]), "mesh.cells"),
            (
                rectangle([1.0, 1.0], [1, 1], vec![Axis::Z]),
                "mesh.periodic[0]",
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
        let mesh = source::ungraded([1.0, 1.0], [1, 1], &[Axis::X]);
        let Err(Error::Scene { path, allowed, .. }) = mesh.faces("left", "contact.part").map(drop)
        else {
            panic!("a periodic axis has no parts");
        };
        assert_eq!(path, "contact.part");
        assert_eq!(allowed, "the parts of the mesh: bottom, top");
    }
}
