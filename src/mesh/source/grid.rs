//! The grid of a rectangle or a box: its rules, the names of its sides, the sizes of the criss-cross on it.

use super::lines::Lines;
use crate::element::Element;
use crate::mesh::MAX_NODES;
use crate::message::number;
use crate::refusal::{Refusal, Verdict, ensure, json};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A coordinate axis.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    /// 0, 1 or 2 for x, y or z.
    pub fn index(self) -> usize {
        match self {
            Axis::X => 0,
            Axis::Y => 1,
            Axis::Z => 2,
        }
    }
}

/// Sides with the axis they are normal to; the lower side of each axis comes first.
const SIDES: [(&str, Axis); 6] = [
    ("left", Axis::X),
    ("right", Axis::X),
    ("bottom", Axis::Y),
    ("top", Axis::Y),
    ("back", Axis::Z),
    ("front", Axis::Z),
];

/// Share of the length of the body below which cells would be lost among the tolerances of points and matrices.
pub(super) const THINNEST: f64 = 1e-7;

/// The grid of a generated mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid<'a> {
    /// Lengths along the axes, m.
    pub size: &'a [f64],
    /// Numbers of cells along the axes.
    pub cells: &'a [u32],
    /// Exponents of the grading along the axes; 1 is uniform.
    pub grading: &'a [f64],
    /// Axes along which the body is periodic.
    pub periodic: &'a [Axis],
}

impl Grid<'_> {
    /// Space dimension, 2 or 3.
    pub fn dimension(&self) -> usize {
        self.size.len()
    }

    /// Refuses what would give an empty, inverted or unnumberable mesh.
    pub(super) fn check(&self, element: &Element) -> Verdict {
        for (i, &length) in self.size.iter().enumerate() {
            ensure(length.is_finite() && length > 0.0, || {
                Refusal::new(
                    format!("mesh.size[{i}]"),
                    number(length),
                    "a positive length",
                )
            })?;
        }
        for (i, &count) in self.cells.iter().enumerate() {
            ensure(count > 0, || {
                Refusal::new(format!("mesh.cells[{i}]"), count, "1 or more")
            })?;
        }
        self.check_periodic()?;
        for axis in 0..self.dimension() {
            self.check_grading(axis)?;
        }
        let nodes = self.nodes(element);
        ensure(nodes <= u128::from(MAX_NODES), || {
            let found = format!("{}, which makes {nodes} nodes", json(self.cells));
            Refusal::new("mesh.cells", found, format!("at most {MAX_NODES} nodes"))
        })?;
        let cells = self.cell_count();
        ensure(cells <= u128::from(u32::MAX), || {
            let found = format!("{}, which makes {cells} tetrahedra", json(self.cells));
            Refusal::new(
                "mesh.cells",
                found,
                "cells that can be numbered with 32 bits",
            )
        })
    }

    fn check_periodic(&self) -> Verdict {
        let axes = ["x", "y", "z"];
        let axes = &axes[..self.dimension()];
        for (i, axis) in self.periodic.iter().enumerate() {
            let path = format!("mesh.periodic[{i}]");
            let found = json(axis);
            ensure(axis.index() < self.dimension(), || {
                let allowed = format!("the axes of the mesh: {}", axes.join(", "));
                Refusal::new(&path, &found, allowed)
            })?;
            ensure(!self.periodic[..i].contains(axis), || {
                Refusal::new(&path, format!("{found} a second time"), "each axis once")
            })?;
        }
        Ok(())
    }

    fn check_grading(&self, axis: usize) -> Verdict {
        let path = format!("mesh.grading[{axis}]");
        let (exponent, cells) = (self.grading[axis], self.cells[axis]);
        ensure(exponent.is_finite() && exponent >= 1.0, || {
            Refusal::new(&path, number(exponent), "a finite number >= 1")
        })?;
        if exponent == 1.0 {
            return Ok(());
        }
        ensure(!self.periodic.iter().any(|p| p.index() == axis), || {
            let allowed = "1 along an axis of mesh.periodic: its ends are no boundary";
            Refusal::new(&path, number(exponent), allowed)
        })?;
        let first = 0.5 * (2.0 / f64::from(cells)).powf(exponent);
        ensure(cells <= 2 || first >= THINNEST, || {
            let most = (0.5 / THINNEST).ln() / (0.5 * f64::from(cells)).ln();
            let exponent = number(exponent);
            Refusal::new(
                &path,
                format!("{exponent}, whose first cell is {first:.3e} of the length"),
                format!("at most {most:.3} with {cells} cells"),
            )
        })
    }

    /// The lines of every axis.
    pub(super) fn lines<const N: usize>(&self) -> [Lines; N] {
        std::array::from_fn(|i| Lines::new(self.size[i], self.cells[i], self.grading[i]))
    }

    /// Names of the sides, in the order left, right, bottom, top, back, front. The sides across a periodic axis are none.
    pub(super) fn parts(&self) -> Vec<&'static str> {
        SIDES
            .iter()
            .filter(|(part, _)| self.normal_axis(part).is_some())
            .map(|(part, _)| *part)
            .collect()
    }

    /// What is allowed instead of a part that there is not.
    pub(super) fn part_fault(&self, part: &str) -> Option<String> {
        if self.normal_axis(part).is_some() {
            return None;
        }
        let parts = self.parts().join(", ");
        Some(match (parts.as_str(), self.periodic) {
            (_, []) => format!("the parts {parts}"),
            ("", _) => "no part, because mesh.periodic closes every axis".to_owned(),
            (_, periodic) => format!("the parts {parts} (mesh.periodic is {})", json(periodic)),
        })
    }

    /// Axis that a side is normal to.
    fn normal_axis(&self, part: &str) -> Option<Axis> {
        SIDES
            .iter()
            .find(|(name, _)| *name == part)
            .map(|(_, axis)| *axis)
            .filter(|axis| axis.index() < self.dimension() && !self.periodic.contains(axis))
    }

    /// Number of mesh nodes, those joined by periodicity counted twice: the corners of the cells, in every layer the centres of the
    /// x-y cells, and for quadratic elements the middles of all edges.
    pub(super) fn nodes(&self, element: &Element) -> u128 {
        let count = |i: usize| u128::from(self.cells.get(i).copied().unwrap_or(0));
        let (x, y, z) = (count(0), count(1), count(2));
        let layer = (x + 1) * (y + 1) + x * y;
        let corners = layer * (z + 1);
        if element.midsides.is_empty() {
            return corners;
        }
        // sides and half diagonals of the plane; over every one of them a diagonal, over every node a vertical edge
        let plane = x * (y + 1) + (x + 1) * y + 4 * x * y;
        corners + plane * (2 * z + 1) + layer * z
    }

    fn cell_count(&self) -> u128 {
        let grid: u128 = self.cells.iter().map(|n| u128::from(*n)).product();
        // four triangles to a square, three tetrahedra to the prism over each
        match self.dimension() {
            2 => 4 * grid,
            _ => 12 * grid,
        }
    }

    /// Nodes on a side, about.
    pub(super) fn nodes_on(&self, element: &Element, part: &str) -> f64 {
        let axis = self.normal_axis(part).map(Axis::index);
        let along = self.cells.iter().enumerate();
        let corners: f64 = along
            .filter(|(i, _)| Some(*i) != axis)
            .map(|(_, &n)| element.nodes_along(n) as f64)
            .product();
        // sides normal to z have the centres of the cells too
        if axis == Some(2) {
            2.0 * corners
        } else {
            corners
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::{ELEMENTS, linear};
    use crate::mesh::Mesh;
    use crate::mesh::source::{BoxMesh, MeshSpec, Rectangle};

    const SIZE: [f64; 3] = [1.0, 2.0, 3.0];

    fn grid<'a>(cells: &'a [u32], periodic: &'static [Axis]) -> Grid<'a> {
        Grid {
            size: &SIZE[..cells.len()],
            cells,
            grading: &[1.0; 3][..cells.len()],
            periodic,
        }
    }

    #[test]
    fn periodic_sides_are_not_parts() {
        let parts = grid(&[2, 3, 4], &[Axis::X]).parts();
        assert_eq!(parts, ["bottom", "top", "back", "front"]);
        assert!(grid(&[2, 3, 4], &[Axis::X]).part_fault("left").is_some());
        assert_eq!(grid(&[2, 3, 4], &[]).part_fault("left"), None);
        assert_eq!(
            grid(&[1, 1], &[]).parts(),
            ["left", "right", "bottom", "top"]
        );
    }

    /// The counts are those of the meshes.
    #[test]
    fn nodes_and_cells_are_counted_before_there_is_a_mesh() {
        assert_eq!(grid(&[2, 3, 4], &[]).nodes(linear(3)), (3 * 4 + 2 * 3) * 5);
        for element in ELEMENTS {
            for cells in [[1, 1, 1], [2, 3, 1], [3, 1, 2]] {
                let spec = match element.dimension {
                    2 => MeshSpec::Rectangle(Rectangle {
                        size: [1.0, 2.0],
                        cells: [cells[0], cells[1]],
                        ..Rectangle::default()
                    }),
                    _ => MeshSpec::Box(BoxMesh {
                        size: SIZE,
                        cells,
                        ..BoxMesh::default()
                    }),
                };
                let mesh = Mesh::generate(&spec).unwrap();
                let mesh = mesh.for_element(element.kind).unwrap();
                let grid = grid(&cells[..element.dimension], &[]);
                assert_eq!(
                    grid.nodes(element),
                    mesh.nodes.len() as u128,
                    "{}",
                    element.name
                );
                assert_eq!(grid.cell_count(), mesh.cell_count() as u128);
            }
        }
    }
}
