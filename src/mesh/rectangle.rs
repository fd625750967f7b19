//! The criss-cross mesh of a rectangle: every cell is cut into four triangles by both diagonals.
//!
//! Nodes: the corners of the cells row by row (x fastest), then the centres of the cells row by row.

use super::lines::Lines;
use super::{Mesh, bisection};
use crate::error::Result;
use crate::scene::{Axis, ElementKind, Refinement};
use std::collections::BTreeMap;

/// Bits of the sides in the order left, right, bottom, top.
pub(super) const LEFT: u8 = 1;
pub(super) const RIGHT: u8 = 2;
pub(super) const BOTTOM: u8 = 4;
pub(super) const TOP: u8 = 8;

/// Names of the four sides, `None` along a periodic axis.
pub(super) fn side_names(periodic: &[Axis]) -> [Option<&'static str>; 4] {
    let free = |axis, name| (!periodic.contains(&axis)).then_some(name);
    [
        free(Axis::X, "left"),
        free(Axis::X, "right"),
        free(Axis::Y, "bottom"),
        free(Axis::Y, "top"),
    ]
}

/// The criss-cross in the plane, before the sides are named: also the base of the extruded box.
pub(super) struct CrissCross {
    pub nodes: Vec<[f64; 3]>,
    /// Triangles, counter-clockwise; the first two nodes are a side of the grid.
    pub triangles: Vec<[u32; 3]>,
    /// Sides on which each node lies (bits).
    pub sides: Vec<u8>,
    /// Node that each node follows.
    pub leader: Vec<u32>,
}

impl CrissCross {
    /// The counts fit 32 bits: checked by [`Mesh::generate`].
    pub fn new(x: &Lines, y: &Lines, periodic: &[Axis]) -> CrissCross {
        let (nx, ny) = (x.cells(), y.cells());
        let corner = |i: u32, j: u32| j * (nx + 1) + i;
        let corners = (nx + 1) * (ny + 1);
        let centre = |i: u32, j: u32| corners + j * nx + i;
        let count = (corners + nx * ny) as usize;
        let mut mesh = CrissCross {
            nodes: Vec::with_capacity(count),
            triangles: Vec::with_capacity(4 * (nx * ny) as usize),
            sides: Vec::with_capacity(count),
            leader: Vec::with_capacity(count),
        };
        for j in 0..=ny {
            for i in 0..=nx {
                mesh.nodes.push([x.at[i as usize], y.at[j as usize], 0.0]);
                let bit = |is_there: bool, side: u8| if is_there { side } else { 0 };
                mesh.sides.push(
                    bit(i == 0, LEFT)
                        | bit(i == nx, RIGHT)
                        | bit(j == 0, BOTTOM)
                        | bit(j == ny, TOP),
                );
                let i0 = if i == nx && periodic.contains(&Axis::X) {
                    0
                } else {
                    i
                };
                let j0 = if j == ny && periodic.contains(&Axis::Y) {
                    0
                } else {
                    j
                };
                mesh.leader.push(corner(i0, j0));
            }
        }
        for j in 0..ny {
            for i in 0..nx {
                let (x, y) = (x.middles[i as usize], y.middles[j as usize]);
                mesh.nodes.push([x, y, 0.0]);
                mesh.sides.push(0);
                let c = centre(i, j);
                mesh.leader.push(c);
                let square = [
                    corner(i, j),
                    corner(i + 1, j),
                    corner(i + 1, j + 1),
                    corner(i, j + 1),
                ];
                for s in 0..4 {
                    mesh.triangles.push([square[s], square[(s + 1) % 4], c]);
                }
            }
        }
        mesh
    }
}

/// Generates the mesh of `MeshSpec::Rectangle` from the lines of its axes.
///
/// # Errors
/// Those of [`bisection::refine`].
pub(super) fn generate(
    axes: &[Lines; 2],
    periodic: &[Axis],
    refinements: &[Refinement],
) -> Result<Mesh> {
    let mut plane = CrissCross::new(&axes[0], &axes[1], periodic);
    bisection::refine(&mut plane, refinements)?;
    let mut mesh = Mesh {
        dimension: 2,
        element: ElementKind::P1,
        nodes: plane.nodes,
        cell_nodes: plane.triangles.into_iter().flatten().collect(),
        parts: BTreeMap::new(),
        leader: plane.leader,
    };
    mesh.name_sides(&plane.sides, &side_names(periodic));
    Ok(mesh)
}

/// An ungraded rectangle.
#[cfg(test)]
pub(super) fn uniform(size: [f64; 2], cells: [u32; 2], periodic: &[Axis]) -> Mesh {
    let axis = |i: usize| Lines::new(size[i], cells[i], 1.0);
    generate(&[axis(0), axis(1)], periodic, &[]).expect("nothing to refine")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_of_the_paper() {
        // Kazmi et al. 2014, Section 7: 2 dofs per node and 2 per contact face.
        for (m, triangles, nodes, dofs) in [(32, 2048, 1073, 2210), (256, 131_072, 65_921, 132_354)]
        {
            let mesh = uniform([1.0, 0.5], [m, m / 2], &[]);
            assert_eq!(mesh.cell_count(), triangles);
            assert_eq!(mesh.nodes.len(), nodes);
            let faces = mesh.parts["bottom"].len() / 2;
            assert_eq!(2 * nodes + 2 * faces, dofs);
        }
    }

    #[test]
    fn faces_point_outward_and_close_the_boundary() {
        let mesh = uniform([2.0, 1.0], [4, 3], &[]);
        let normals = [
            ("left", [-1.0, 0.0], 1.0),
            ("right", [1.0, 0.0], 1.0),
            ("bottom", [0.0, -1.0], 2.0),
            ("top", [0.0, 1.0], 2.0),
        ];
        for (part, normal, length) in normals {
            let mut sum = [0.0; 2];
            for face in mesh.parts[part].chunks_exact(2) {
                let (p, q) = (mesh.nodes[face[0] as usize], mesh.nodes[face[1] as usize]);
                sum[0] += q[1] - p[1];
                sum[1] -= q[0] - p[0];
            }
            for c in 0..2 {
                assert!((sum[c] - length * normal[c]).abs() < 1e-14, "{part}");
            }
        }
    }

    #[test]
    fn periodic_nodes_follow_the_opposite_side() {
        let mesh = uniform([2.0, 1.0], [3, 2], &[Axis::X, Axis::Y]);
        assert!(mesh.parts.is_empty());
        for (node, &leader) in mesh.leader.iter().enumerate() {
            assert_eq!(mesh.leader[leader as usize], leader);
            let (p, q) = (mesh.nodes[node], mesh.nodes[leader as usize]);
            assert_eq!(q[0], if p[0] == 2.0 { 0.0 } else { p[0] });
            assert_eq!(q[1], if p[1] == 1.0 { 0.0 } else { p[1] });
        }
    }
}
