//! The criss-cross mesh of a rectangle, extruded along z and cut into tetrahedra.
//!
//! Every triangle of the plane becomes, in every layer, a prism of three vertical columns. With its columns ordered
//! a < b < c and 0, 1 the lower and upper ends, the prism is cut into `a0 b0 c0 c1`, `a0 b0 b1 c1`, `a0 a1 b1 c1`, so the
//! diagonal of the vertical face over an edge (a, b) runs from a0 to b1. Two prisms conform when they order the columns
//! of their common edge alike. The order is that of the numbers in the plane: corners before centres, and along an edge
//! of the grid the corner with the smaller coordinate first. This rule does not change under a translation by one cell, so
//! the cut also conforms across periodic sides, for any number of cells.
//!
//! Nodes: layer by layer from z = 0, inside a layer as in the plane.

use super::criss_cross::{CrissCross, side_names};
use super::grid::{Axis, Grid};
use super::{Extent, MeshSource, RegionBox, regions};
use crate::element::{Element, linear};
use crate::error::Result;
use crate::files::Files;
use crate::mesh::Mesh;
use crate::refusal::Verdict;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `(0, size[0]) x (0, size[1]) x (0, size[2])`: the criss-cross of `rectangle` in the x-y plane, extruded along
/// z; every prism is cut into three tetrahedra that conform with their neighbours. Parts: left, right (x), bottom,
/// top (y), back, front (z).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxMesh {
    /// Lengths along x, y and z, m; positive.
    #[schemars(extend("items" = {"type": "number", "exclusiveMinimum": 0}))]
    pub size: [f64; 3],
    /// Number of cells along x, y and z; at least 1 each.
    #[schemars(inner(range(min = 1)))]
    pub cells: [u32; 3],
    /// Grading of the grid lines to both ends of the x, the y and the z axis: an exponent p >= 1 each puts them at
    /// `L/2 (2 i/n)^p` up to the middle and mirrors them beyond. 1 is uniform, and the only choice along a periodic
    /// axis. Clamped and contact parts end in corners where the stress concentrates and a uniform mesh converges slowly:
    /// with as many unknowns, 2 (linear elements) or 2 to 2.5 (quadratic ones) makes the error two to eight times
    /// smaller. The cells in the middle become p times as long, and far from corners resolve less. Default: 1 each.
    #[serde(default = "uniform")]
    #[schemars(inner(range(min = 1)))]
    pub grading: [f64; 3],
    /// Axes along which the body is periodic (the two opposite sides move together, so
    /// that they are no longer parts). Default: none.
    #[serde(default)]
    pub periodic: Vec<Axis>,
    /// Regions of the body, for `materials`. Default: none, the whole body is the region `body`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<RegionBox>,
}

/// No grading.
fn uniform() -> [f64; 3] {
    [1.0; 3]
}

impl BoxMesh {
    /// The grid that the mesh is cut from.
    fn lattice(&self) -> Grid<'_> {
        Grid {
            size: &self.size,
            cells: &self.cells,
            grading: &self.grading,
            periodic: &self.periodic,
        }
    }
}

const BACK: u8 = 16;
const FRONT: u8 = 32;

impl MeshSource for BoxMesh {
    fn dimension(&self) -> Option<usize> {
        Some(3)
    }

    fn check(&self, element: &Element) -> Verdict {
        self.lattice().check(element)?;
        regions::check(&self.regions, 3)
    }

    fn parts(&self) -> Option<Vec<&str>> {
        Some(self.lattice().parts())
    }

    fn part_fault(&self, part: &str) -> Option<String> {
        self.lattice().part_fault(part)
    }

    fn regions(&self) -> Option<Vec<&str>> {
        Some(regions::names(&self.regions))
    }

    fn extent(&self, element: &Element, contact: &str) -> Option<Extent> {
        let grid = self.lattice();
        Some(Extent {
            nodes: grid.nodes(element),
            refined: 0.0,
            contact: grid.nodes_on(element, contact),
        })
    }

    fn grid(&self) -> Option<Grid<'_>> {
        Some(self.lattice())
    }

    fn mesh(&self, _files: &dyn Files) -> Result<Mesh> {
        regions::assign(&self.regions, extruded(&self.lattice()))
    }
}

/// The mesh of a grid.
fn extruded(grid: &Grid) -> Mesh {
    let ([x, y, z], periodic) = (&grid.lines(), grid.periodic);
    let plane = CrissCross::new(x, y, periodic);
    let per_layer = plane.nodes.len() as u32;
    let nz = z.cells();
    let is_periodic_z = periodic.contains(&Axis::Z);

    let mut nodes = Vec::with_capacity(plane.nodes.len() * (nz as usize + 1));
    let mut sides = Vec::with_capacity(nodes.capacity());
    let mut leader = Vec::with_capacity(nodes.capacity());
    for (layer, &z) in (0..=nz).zip(&z.at) {
        let first = if layer == nz && is_periodic_z {
            0
        } else {
            layer * per_layer
        };
        nodes.extend(plane.nodes.iter().map(|p| [p[0], p[1], z]));
        leader.extend(plane.leader.iter().map(|&n| first + n));
        let ends = if layer == 0 { BACK } else { 0 } | if layer == nz { FRONT } else { 0 };
        sides.extend(plane.sides.iter().map(|&s| s | ends));
    }

    let mut cell_nodes = Vec::with_capacity(12 * plane.triangles.len() * nz as usize);
    for layer in 0..nz {
        let (low, high) = (layer * per_layer, (layer + 1) * per_layer);
        for triangle in &plane.triangles {
            let (columns, is_counter_clockwise) = ordered(*triangle);
            let [a, b, c] = columns;
            // Each cell is positive when a, b, c turn counter-clockwise; an exchange of two nodes mirrors it.
            for mut cell in [
                [low + a, low + b, low + c, high + c],
                [low + a, low + b, high + c, high + b],
                [low + a, high + a, high + b, high + c],
            ] {
                if !is_counter_clockwise {
                    cell.swap(2, 3);
                }
                cell_nodes.extend(cell);
            }
        }
    }

    let mut mesh = Mesh::new(linear(3), nodes, cell_nodes, leader);
    let [left, right, bottom, top] = side_names(periodic);
    let along_z = |name| (!is_periodic_z).then_some(name);
    mesh.name_sides(
        &sides,
        &[left, right, bottom, top, along_z("back"), along_z("front")],
    );
    mesh
}

/// The columns of a counter-clockwise triangle in ascending order, and whether that order turns counter-clockwise too.
fn ordered(triangle: [u32; 3]) -> ([u32; 3], bool) {
    let [p, q, r] = triangle;
    // Turn the smallest to the front (keeps the sense), then the order of the other two decides.
    let [a, b, c] = if p < q && p < r {
        [p, q, r]
    } else if q < r {
        [q, r, p]
    } else {
        [r, p, q]
    };
    if b < c {
        ([a, b, c], true)
    } else {
        ([a, c, b], false)
    }
}

#[cfg(test)]
impl Default for BoxMesh {
    fn default() -> BoxMesh {
        BoxMesh {
            size: [1.0; 3],
            cells: [1; 3],
            grading: uniform(),
            periodic: Vec::new(),
            regions: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    fn graded(size: [f64; 3], cells: [u32; 3], grading: [f64; 3], periodic: &[Axis]) -> Mesh {
        extruded(&Grid {
            size: &size,
            cells: &cells,
            grading: &grading,
            periodic,
        })
    }

    fn volume(mesh: &Mesh, cell: &[u32]) -> f64 {
        let p = |i: usize| mesh.nodes[cell[i] as usize];
        let d = |i: usize| std::array::from_fn::<f64, 3, _>(|c| p(i)[c] - p(0)[c]);
        let (u, v, w) = (d(1), d(2), d(3));
        (u[0] * (v[1] * w[2] - v[2] * w[1])
            + u[1] * (v[2] * w[0] - v[0] * w[2])
            + u[2] * (v[0] * w[1] - v[1] * w[0]))
            / 6.0
    }

    /// A face on the torus of the periodic axes: the middles of its edges, sorted, and its centroid. Nodes alone do not
    /// tell faces apart where an axis has one or two cells.
    fn key(mesh: &Mesh, face: [u32; 3], size: [f64; 3], periodic: &[Axis]) -> Vec<[i64; 3]> {
        let p = face.map(|n| mesh.nodes[n as usize]);
        let point = |weights: [f64; 3]| {
            std::array::from_fn(|c| {
                let x: f64 = (0..3).map(|i| weights[i] * p[i][c]).sum();
                let micro = |x: f64| (x * 1e6).round() as i64;
                if periodic.contains(&[Axis::X, Axis::Y, Axis::Z][c]) {
                    micro(x).rem_euclid(micro(size[c]))
                } else {
                    micro(x)
                }
            })
        };
        let mut points = vec![
            point([0.5, 0.5, 0.0]),
            point([0.0, 0.5, 0.5]),
            point([0.5, 0.0, 0.5]),
        ];
        points.sort_unstable();
        points.push(point([1.0 / 3.0; 3]));
        points
    }

    #[test]
    fn tetrahedra_conform_and_the_parts_are_the_boundary() {
        use Axis::{X, Y, Z};
        let size = [1.0, 0.75, 0.5];
        for cells in [[1, 1, 1], [2, 3, 1], [3, 2, 2]] {
            for periodic in [
                vec![],
                vec![X],
                vec![Y],
                vec![Z],
                vec![X, Z],
                vec![X, Y],
                vec![X, Y, Z],
            ] {
                let axes = [Axis::X, Axis::Y, Axis::Z];
                let exponents = axes.map(|a| if periodic.contains(&a) { 1.0 } else { 1.7 });
                let mesh = graded(size, cells, exponents, &periodic);
                let total: f64 = mesh.cells().map(|c| volume(&mesh, c)).sum();
                assert!(mesh.cells().all(|c| volume(&mesh, c) > 0.0));
                assert!((total - 0.375).abs() < 1e-14);

                let mut uses: HashMap<_, u32> = HashMap::new();
                for cell in mesh.cells() {
                    for face in mesh.element.faces {
                        let face = [cell[face[0]], cell[face[1]], cell[face[2]]];
                        *uses.entry(key(&mesh, face, size, &periodic)).or_default() += 1;
                    }
                }
                let mut outer = 0;
                for faces in mesh.parts.values() {
                    for face in faces.chunks_exact(3) {
                        let face = [face[0], face[1], face[2]];
                        assert_eq!(uses[&key(&mesh, face, size, &periodic)], 1);
                        outer += 1;
                    }
                }
                assert_eq!(mesh.parts.len(), 6 - 2 * periodic.len());
                assert_eq!(uses.values().filter(|&&n| n == 1).count(), outer);
                assert!(uses.values().all(|&n| n <= 2), "{cells:?} {periodic:?}");
            }
        }
    }

    #[test]
    fn areas_of_the_parts() {
        let mesh = graded([1.0, 0.75, 0.5], [2, 3, 2], [1.0; 3], &[]);
        for (part, expected) in [
            ("left", [-0.375, 0.0, 0.0]),
            ("right", [0.375, 0.0, 0.0]),
            ("bottom", [0.0, -0.5, 0.0]),
            ("top", [0.0, 0.5, 0.0]),
            ("back", [0.0, 0.0, -0.75]),
            ("front", [0.0, 0.0, 0.75]),
        ] {
            let mut sum = nalgebra::Vector3::zeros();
            for face in mesh.parts[part].chunks_exact(3) {
                let p = |i: usize| nalgebra::Vector3::from(mesh.nodes[face[i] as usize]);
                sum += (p(1) - p(0)).cross(&(p(2) - p(0))) / 2.0;
            }
            assert!(
                (sum - nalgebra::Vector3::from(expected)).norm() < 1e-14,
                "{part}"
            );
        }
    }
}
