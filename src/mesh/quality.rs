//! What a mesh is made of and how good its cells are: for whoever looks at a file before there is a scene.

use super::Mesh;
use super::geometry::{Bent, bent_face, simplex_share};
use nalgebra::{Matrix3, Vector3};

/// A region of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionSize {
    pub name: String,
    pub cells: usize,
    /// Area (m^2) or volume (m^3).
    pub measure: f64,
}

/// A part of the boundary.
#[derive(Debug, Clone, PartialEq)]
pub struct PartSize {
    pub name: String,
    pub faces: usize,
    /// Length (m) or area (m^2).
    pub measure: f64,
}

/// Sizes and quality of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// Corners of the box around the nodes, m.
    pub bounds: [[f64; 3]; 2],
    /// Shortest and longest edge between two corners of a cell, m.
    pub edges: [f64; 2],
    /// Smallest angle of a cell, degrees: between two sides in the plane, between two faces in space.
    pub smallest_angle: f64,
    /// Centroid of the cell with the smallest angle, m.
    pub smallest_angle_at: [f64; 3],
    /// Largest ratio of the longest edge of a cell to its shortest height, 1 for a regular cell.
    pub worst_aspect: f64,
    /// Cells with bent sides.
    pub bent: usize,
    /// Smallest ratio of the least to the largest Jacobian of a bent cell: 1 for a straight one, not positive for one that is
    /// turned inside out.
    pub least_jacobian: f64,
    /// Pieces that share no node.
    pub pieces: usize,
    pub regions: Vec<RegionSize>,
    pub parts: Vec<PartSize>,
}

impl Mesh {
    /// Sizes of regions and parts, quality of the cells.
    pub fn quality(&self) -> Quality {
        let mut found = Quality {
            bounds: self.bounds(),
            edges: [f64::INFINITY, 0.0],
            smallest_angle: f64::INFINITY,
            smallest_angle_at: [0.0; 3],
            worst_aspect: 0.0,
            bent: 0,
            least_jacobian: 1.0,
            pieces: self
                .pieces()
                .into_iter()
                .max()
                .map_or(0, |last| last as usize + 1),
            regions: self
                .regions
                .iter()
                .map(|name| RegionSize {
                    name: name.clone(),
                    cells: 0,
                    measure: 0.0,
                })
                .collect(),
            parts: self
                .parts
                .iter()
                .map(|(name, faces)| PartSize {
                    name: name.clone(),
                    faces: faces.len() / self.element.face_nodes(),
                    measure: faces
                        .chunks_exact(self.element.face_nodes())
                        .map(|f| self.face_measure(f))
                        .sum(),
                })
                .collect(),
        };
        for (cell, &region) in self.cells().zip(&self.cell_regions) {
            let shape = Shape::of(self, cell);
            let mut measure = shape.measure;
            if let Some(bent) = Bent::new(self, cell) {
                let [least, most] = bent.determinants();
                found.bent += 1;
                found.least_jacobian = found.least_jacobian.min(least / most);
                measure = bent.measure();
            }
            found.edges = [
                found.edges[0].min(shape.edges[0]),
                found.edges[1].max(shape.edges[1]),
            ];
            found.worst_aspect = found.worst_aspect.max(shape.aspect);
            if shape.angle < found.smallest_angle {
                found.smallest_angle = shape.angle;
                found.smallest_angle_at = self.centroid(cell);
            }
            let region = &mut found.regions[region as usize];
            region.cells += 1;
            region.measure += measure;
        }
        found
    }

    /// Corners of the box around the nodes of the cells, m.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for &node in &self.cell_nodes {
            for (axis, x) in self.nodes[node as usize].into_iter().enumerate() {
                bounds[0][axis] = bounds[0][axis].min(x);
                bounds[1][axis] = bounds[1][axis].max(x);
            }
        }
        bounds
    }

    fn face_measure(&self, face: &[u32]) -> f64 {
        if let Some(points) = bent_face(self, face) {
            return points.map(|(_, normal)| normal.norm()).sum();
        }
        let p = |i: usize| Vector3::from(self.nodes[face[i] as usize]);
        match self.dimension {
            2 => (p(1) - p(0)).norm(),
            _ => (p(1) - p(0)).cross(&(p(2) - p(0))).norm() / 2.0,
        }
    }
}

/// The shape of the straight cell between the corners.
struct Shape {
    measure: f64,
    edges: [f64; 2],
    /// Degrees.
    angle: f64,
    aspect: f64,
}

impl Shape {
    fn of(mesh: &Mesh, cell: &[u32]) -> Shape {
        let d = mesh.dimension;
        let p = |i: usize| Vector3::from(mesh.nodes[cell[i] as usize]);
        let edge = |i: usize| p(i) - p(0);
        let last = if d == 2 { Vector3::z() } else { edge(3) };
        let measure =
            Matrix3::from_columns(&[edge(1), edge(2), last]).determinant() / simplex_share(d);
        let mut edges = [f64::INFINITY, 0.0f64];
        for i in 0..=d {
            for j in 0..i {
                let length = (p(i) - p(j)).norm();
                edges = [edges[0].min(length), edges[1].max(length)];
            }
        }
        // outward normals of the faces, as long as these are large
        let normals: Vec<Vector3<f64>> = mesh
            .element
            .faces
            .iter()
            .map(|face| match d {
                2 => (p(face[1]) - p(face[0])).cross(&Vector3::z()),
                _ => (p(face[1]) - p(face[0])).cross(&(p(face[2]) - p(face[0]))) / 2.0,
            })
            .collect();
        let largest = normals.iter().map(|n| n.norm()).fold(0.0, f64::max);
        let height = d as f64 * measure / largest;
        let regular = if d == 2 {
            0.75f64.sqrt()
        } else {
            (2.0f64 / 3.0).sqrt()
        };
        let mut angle = f64::INFINITY;
        for (i, a) in normals.iter().enumerate() {
            for b in &normals[..i] {
                let between = a.cross(b).norm().atan2(-a.dot(b));
                angle = angle.min(between.to_degrees());
            }
        }
        Shape {
            measure,
            edges,
            angle,
            aspect: regular * edges[1] / height,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::source::ungraded;
    use super::super::{BoxMesh, MeshSpec};
    use super::*;
    use crate::element::ElementKind;

    #[test]
    fn a_criss_cross_has_right_angles_and_its_sizes() {
        let mesh = ungraded([2.0, 1.0], [4, 2], &[]);
        let found = mesh.quality();
        assert_eq!(found.bounds, [[0.0; 3], [2.0, 1.0, 0.0]]);
        assert!((found.smallest_angle - 45.0).abs() < 1e-12);
        // hypotenuse over its height, 2, against 2/sqrt 3
        assert!((found.worst_aspect - 3f64.sqrt()).abs() < 1e-12);
        assert_eq!(
            (found.bent, found.pieces, found.regions[0].cells),
            (0, 1, 32)
        );
        assert!((found.regions[0].measure - 2.0).abs() < 1e-14);
        let top = found.parts.iter().find(|p| p.name == "top").unwrap();
        assert_eq!((top.faces, top.measure), (4, 2.0));
        let mut quadratic = mesh.for_element(ElementKind::P2).unwrap();
        let before = quadratic.quality();
        assert_eq!(before.bent, 0);
        let middle = quadratic.parts["top"][2] as usize;
        quadratic.nodes[middle][1] += 0.05;
        let after = quadratic.quality();
        assert_eq!(after.bent, 1);
        // a parabola of height f over the chord c adds 2 f c / 3
        let added = after.regions[0].measure - before.regions[0].measure;
        assert!((added - 2.0 / 3.0 * 0.05 * 0.5).abs() < 1e-14);
        assert!(after.least_jacobian > 0.0 && after.least_jacobian < 1.0);
    }

    #[test]
    fn tetrahedra_are_measured_by_their_dihedral_angles() {
        let mesh = Mesh::generate(&MeshSpec::Box(BoxMesh {
            size: [1.0, 2.0, 3.0],
            cells: [2, 2, 2],
            ..BoxMesh::default()
        }));
        let found = mesh.unwrap().quality();
        assert!((found.regions[0].measure - 6.0).abs() < 1e-13);
        assert!(found.smallest_angle > 5.0 && found.smallest_angle < 60.0);
        let back = found.parts.iter().find(|p| p.name == "back").unwrap();
        assert!((back.measure - 2.0).abs() < 1e-14);
    }
}
