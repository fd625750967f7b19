//! The criss-cross mesh of a rectangle: every cell is cut into four triangles by both diagonals.
//!
//! Nodes: the corners of the cells row by row (x fastest), then the centres of the cells row by row.

use super::criss_cross::{CrissCross, side_names};
use super::grid::{Axis, Grid, THINNEST};
use super::refinement::Refinement;
use super::{Extent, MeshSource, RegionBox, bisection, regions};
use crate::element::{Element, linear};
use crate::error::Result;
use crate::files::Files;
use crate::mesh::{MAX_NODES, Mesh};
use crate::message::number;
use crate::refusal::{Refusal, Verdict};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `(0, size[0]) x (0, size[1])`, cut into cells, each cell into four triangles by both diagonals. Parts: left,
/// right (x), bottom, top (y).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rectangle {
    /// Lengths along x and y, m; positive.
    #[schemars(extend("items" = {"type": "number", "exclusiveMinimum": 0}))]
    pub size: [f64; 2],
    /// Number of cells along x and y; at least 1 each.
    #[schemars(inner(range(min = 1)))]
    pub cells: [u32; 2],
    /// Grading of the grid lines to both ends of the x and the y axis: an exponent p >= 1 each puts them at
    /// `L/2 (2 i/n)^p` up to the middle and mirrors them beyond. 1 is uniform, and the only choice along a periodic
    /// axis. Clamped and contact parts end in corners where the stress concentrates and a uniform mesh converges slowly:
    /// with as many unknowns, 2 (linear elements) or 2 to 2.5 (quadratic ones) makes the error two to eight times
    /// smaller. The cells in the middle become p times as long, and far from corners resolve less. Default: 1 each.
    #[serde(default = "uniform")]
    #[schemars(inner(range(min = 1)))]
    pub grading: [f64; 2],
    /// Places where the triangles are bisected until they are small. Default: none.
    #[serde(default)]
    pub refine: Vec<Refinement>,
    /// Axes along which the body is periodic (the two opposite sides move together, so
    /// that they are no longer parts). Default: none.
    #[serde(default)]
    pub periodic: Vec<Axis>,
    /// Regions of the body, for `materials`. Default: none, the whole body is the region `body`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<RegionBox>,
}

/// No grading.
fn uniform() -> [f64; 2] {
    [1.0; 2]
}

impl Rectangle {
    /// The grid that the mesh is cut from.
    fn lattice(&self) -> Grid<'_> {
        Grid {
            size: &self.size,
            cells: &self.cells,
            grading: &self.grading,
            periodic: &self.periodic,
        }
    }

    fn check_refinements(&self) -> Verdict {
        let smallest = THINNEST * self.size.iter().copied().fold(0.0, f64::max);
        for (i, refinement) in self.refine.iter().enumerate() {
            let Refinement { from, size, .. } = refinement;
            let refuse = |key: &str, found: f64, allowed: String| {
                let path = format!("mesh.refine[{i}].{key}");
                Err(Refusal::new(path, number(found), allowed))
            };
            let to = refinement.upper();
            for (axis, length) in self.size.iter().enumerate() {
                // written so that a number that is none is refused
                if !(0.0..=*length).contains(&from[axis]) {
                    let allowed = format!("0 to {}, inside the body", number(*length));
                    return refuse(&format!("from[{axis}]"), from[axis], allowed);
                }
                if !(from[axis]..=*length).contains(&to[axis]) {
                    let (least, most) = (number(from[axis]), number(*length));
                    let allowed = format!("{least} (mesh.refine[{i}].from) to {most}");
                    return refuse(&format!("to[{axis}]"), to[axis], allowed);
                }
            }
            if !(size.is_finite() && *size >= smallest) {
                let allowed = format!("a finite length of at least {smallest:e}");
                return refuse("size", *size, allowed);
            }
            let nodes = refinement.nodes();
            if nodes > f64::from(MAX_NODES) {
                let least = size * (nodes / f64::from(MAX_NODES)).sqrt();
                let allowed = format!("at least {least:e}, for {MAX_NODES} nodes in this box");
                return refuse("size", *size, allowed);
            }
        }
        if self.refine.is_empty() || self.periodic.is_empty() {
            return Ok(());
        }
        Err(Refusal::new(
            "mesh.refine",
            "places with mesh.periodic",
            "no refinement of a periodic mesh: its tied sides must stay alike",
        ))
    }
}

impl MeshSource for Rectangle {
    fn dimension(&self) -> Option<usize> {
        Some(2)
    }

    fn check(&self, element: &Element) -> Verdict {
        self.lattice().check(element)?;
        self.check_refinements()?;
        regions::check(&self.regions, 2)
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
            refined: self.refine.iter().map(Refinement::nodes).sum(),
            contact: grid.nodes_on(element, contact),
        })
    }

    fn grid(&self) -> Option<Grid<'_>> {
        Some(self.lattice())
    }

    fn mesh(&self, _files: &dyn Files) -> Result<Mesh> {
        let [x, y] = self.lattice().lines();
        let mut plane = CrissCross::new(&x, &y, &self.periodic);
        bisection::refine(&mut plane, &self.refine)?;
        let cells = plane.triangles.into_iter().flatten().collect();
        let mut mesh = Mesh::new(linear(2), plane.nodes, cells, plane.leader);
        mesh.name_sides(&plane.sides, &side_names(&self.periodic));
        regions::assign(&self.regions, mesh)
    }
}

#[cfg(test)]
impl Default for Rectangle {
    fn default() -> Rectangle {
        Rectangle {
            size: [1.0; 2],
            cells: [1; 2],
            grading: uniform(),
            refine: Vec::new(),
            periodic: Vec::new(),
            regions: Vec::new(),
        }
    }
}

/// An ungraded rectangle.
#[cfg(test)]
pub(in crate::mesh) fn ungraded(size: [f64; 2], cells: [u32; 2], periodic: &[Axis]) -> Mesh {
    use crate::files::NoFiles;
    let source = Rectangle {
        size,
        cells,
        periodic: periodic.to_vec(),
        ..Rectangle::default()
    };
    source.mesh(&NoFiles).expect("nothing to refine")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_of_the_paper() {
        // Kazmi et al. 2014, Section 7: 2 dofs per node and 2 per contact face.
        for (m, triangles, nodes, dofs) in [(32, 2048, 1073, 2210), (256, 131_072, 65_921, 132_354)]
        {
            let mesh = ungraded([1.0, 0.5], [m, m / 2], &[]);
            assert_eq!(mesh.cell_count(), triangles);
            assert_eq!(mesh.nodes.len(), nodes);
            let faces = mesh.parts["bottom"].len() / 2;
            assert_eq!(2 * nodes + 2 * faces, dofs);
        }
    }

    #[test]
    fn faces_point_outward_and_close_the_boundary() {
        let mesh = ungraded([2.0, 1.0], [4, 3], &[]);
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
        let mesh = ungraded([2.0, 1.0], [3, 2], &[Axis::X, Axis::Y]);
        assert!(mesh.parts.is_empty());
        for (node, &leader) in mesh.leader.iter().enumerate() {
            assert_eq!(mesh.leader[leader as usize], leader);
            let (p, q) = (mesh.nodes[node], mesh.nodes[leader as usize]);
            assert_eq!(q[0], if p[0] == 2.0 { 0.0 } else { p[0] });
            assert_eq!(q[1], if p[1] == 1.0 { 0.0 } else { p[1] });
        }
    }
}
