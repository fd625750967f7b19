//! Sizes, axes and named parts of the generated meshes, as far as the scene alone determines them.

use super::types::{Axis, ElementKind, MeshSpec, Refinement};
use super::validate::MAX_NODES;
use crate::message::number;

/// Parts of the generated meshes with the axis they are normal to; the lower side of each axis comes first.
const SIDES: [(&str, Axis); 6] = [
    ("left", Axis::X),
    ("right", Axis::X),
    ("bottom", Axis::Y),
    ("top", Axis::Y),
    ("back", Axis::Z),
    ("front", Axis::Z),
];

/// Share of the length of the body below which cells would be lost among the tolerances of points and matrices.
const THINNEST: f64 = 1e-7;

impl MeshSpec {
    /// Space dimension, 2 or 3.
    pub fn dimension(&self) -> usize {
        self.size().len()
    }

    /// Lengths along the axes, m.
    pub fn size(&self) -> &[f64] {
        match self {
            MeshSpec::Rectangle { size, .. } => size,
            MeshSpec::Box { size, .. } => size,
        }
    }

    /// Numbers of cells along the axes.
    pub fn cells(&self) -> &[u32] {
        match self {
            MeshSpec::Rectangle { cells, .. } => cells,
            MeshSpec::Box { cells, .. } => cells,
        }
    }

    /// Exponents of the grading along the axes; 1 is uniform.
    pub fn grading(&self) -> &[f64] {
        match self {
            MeshSpec::Rectangle { grading, .. } => grading,
            MeshSpec::Box { grading, .. } => grading,
        }
    }

    /// What is wrong with the grading along an axis and what would be right; `None` for a usable one.
    pub(crate) fn grading_fault(&self, axis: Axis) -> Option<(String, String)> {
        let i = axis.index();
        let (&exponent, &cells) = (self.grading().get(i)?, self.cells().get(i)?);
        if !(exponent.is_finite() && exponent >= 1.0) {
            let found = number(exponent).to_string();
            return Some((found, "a finite number >= 1".to_owned()));
        }
        if exponent == 1.0 {
            return None;
        }
        if self.periodic().contains(&axis) {
            let allowed = "1 along an axis of mesh.periodic: its ends are no boundary".to_owned();
            return Some((number(exponent).to_string(), allowed));
        }
        let first = 0.5 * (2.0 / f64::from(cells)).powf(exponent);
        (cells > 2 && first < THINNEST).then(|| {
            let most = (0.5 / THINNEST).ln() / (0.5 * f64::from(cells)).ln();
            (
                format!(
                    "{}, whose first cell is {first:.3e} of the length",
                    number(exponent)
                ),
                format!("at most {most:.3} with {cells} cells"),
            )
        })
    }

    /// Places where the triangles are bisected; none in 3D.
    pub fn refinements(&self) -> &[Refinement] {
        match self {
            MeshSpec::Rectangle { refine, .. } => refine,
            MeshSpec::Box { .. } => &[],
        }
    }

    /// Where, what and why not for the first refinement that cannot be: a key, what was found and what is allowed.
    pub(crate) fn refinement_fault(&self) -> Option<(String, String, String)> {
        let smallest = THINNEST * self.size().iter().copied().fold(0.0, f64::max);
        for (i, refinement) in self.refinements().iter().enumerate() {
            let Refinement { from, size, .. } = refinement;
            let fault = |key: &str, found: f64, allowed: String| {
                Some((
                    format!("mesh.refine[{i}].{key}"),
                    number(found).to_string(),
                    allowed,
                ))
            };
            let to = refinement.upper();
            for (axis, length) in self.size().iter().enumerate() {
                // written so that a number that is none is refused
                if !(0.0..=*length).contains(&from[axis]) {
                    let allowed = format!("0 to {}, inside the body", number(*length));
                    return fault(&format!("from[{axis}]"), from[axis], allowed);
                }
                if !(from[axis]..=*length).contains(&to[axis]) {
                    let (least, most) = (number(from[axis]), number(*length));
                    let allowed = format!("{least} (mesh.refine[{i}].from) to {most}");
                    return fault(&format!("to[{axis}]"), to[axis], allowed);
                }
            }
            if !(size.is_finite() && *size >= smallest) {
                return fault(
                    "size",
                    *size,
                    format!("a finite length of at least {smallest:e}"),
                );
            }
            // right triangles with this longest side, two for each node
            let nodes = 2.0 * (to[0] - from[0]) * (to[1] - from[1]) / (size * size);
            if nodes > f64::from(MAX_NODES) {
                let least = size * (nodes / f64::from(MAX_NODES)).sqrt();
                let allowed = format!("at least {least:e}, for {MAX_NODES} nodes in this box");
                return fault("size", *size, allowed);
            }
        }
        (!self.refinements().is_empty() && !self.periodic().is_empty()).then(|| {
            let allowed =
                "no refinement of a periodic mesh: its tied sides must stay alike".to_owned();
            (
                "mesh.refine".to_owned(),
                "places with mesh.periodic".to_owned(),
                allowed,
            )
        })
    }

    /// Axes along which the body is periodic.
    pub fn periodic(&self) -> &[Axis] {
        match self {
            MeshSpec::Rectangle { periodic, .. } | MeshSpec::Box { periodic, .. } => periodic,
        }
    }

    /// Names of the parts of the boundary, in the order left, right, bottom, top, back, front. The sides across a
    /// periodic axis are not parts.
    pub fn parts(&self) -> Vec<&'static str> {
        SIDES
            .iter()
            .filter(|(part, _)| self.normal_axis(part).is_some())
            .map(|(part, _)| *part)
            .collect()
    }

    /// Axis that a part is normal to; `None` if this mesh has no such part.
    pub fn normal_axis(&self, part: &str) -> Option<Axis> {
        SIDES
            .iter()
            .find(|(name, _)| *name == part)
            .map(|(_, axis)| *axis)
            .filter(|axis| axis.index() < self.dimension() && !self.periodic().contains(axis))
    }

    /// Number of mesh nodes before refinement, those joined by periodicity counted twice: the corners of the cells, in every layer the
    /// centres of the x-y cells, and for quadratic elements the middles of all edges.
    pub fn node_bound(&self, element: ElementKind) -> u128 {
        let n: Vec<u128> = self.cells().iter().map(|&n| u128::from(n)).collect();
        let layer = |x: u128, y: u128| (x + 1) * (y + 1) + x * y;
        match (n.as_slice(), element) {
            (&[x, y], ElementKind::P1) => layer(x, y),
            (&[x, y], ElementKind::P2) => layer(x, y) + x * (y + 1) + (x + 1) * y + 4 * x * y,
            (&[x, y, z], _) => layer(x, y) * (z + 1),
            _ => 0,
        }
    }
}

impl Refinement {
    /// The corner of the box with the larger coordinates, m.
    pub fn upper(&self) -> [f64; 2] {
        self.to.unwrap_or(self.from)
    }
}

impl ElementKind {
    /// Why cells of this dimension cannot have the element, and what they can have; `None` where they can.
    pub(crate) fn fault(self, dimension: usize) -> Option<(String, String)> {
        (self == ElementKind::P2 && dimension != 2).then(|| {
            let found = format!("\"p2\" in {dimension} dimensions");
            let allowed = "\"p1\", with mesh.grading for accuracy: the lumped contact weights of a quadratic \
                           triangle vanish at its vertices, so that friction would not act there";
            (found, allowed.to_owned())
        })
    }

    /// Nodes along an edge that is cut into this many cells.
    pub fn nodes_along(self, cells: u32) -> u64 {
        match self {
            ElementKind::P1 => u64::from(cells) + 1,
            ElementKind::P2 => 2 * u64::from(cells) + 1,
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn box_mesh(periodic: Vec<Axis>) -> MeshSpec {
        MeshSpec::Box {
            size: [1.0, 2.0, 3.0],
            cells: [2, 3, 4],
            grading: [1.0; 3],
            periodic,
        }
    }

    #[test]
    fn periodic_sides_are_not_parts() {
        let parts = box_mesh(vec![Axis::X]).parts();
        assert_eq!(parts, ["bottom", "top", "back", "front"]);
        assert_eq!(box_mesh(vec![Axis::X]).normal_axis("left"), None);
        assert_eq!(box_mesh(vec![]).normal_axis("left"), Some(Axis::X));
    }

    #[test]
    fn nodes_are_corners_and_centres() {
        assert_eq!(
            box_mesh(vec![]).node_bound(ElementKind::P1),
            (3 * 4 + 2 * 3) * 5
        );
        let square = MeshSpec::Rectangle {
            size: [1.0, 1.0],
            cells: [1, 1],
            grading: [1.0; 2],
            refine: vec![],
            periodic: vec![],
        };
        assert_eq!(square.node_bound(ElementKind::P1), 5);
        assert_eq!(square.node_bound(ElementKind::P2), 13);
        assert_eq!(square.parts(), ["left", "right", "bottom", "top"]);
    }
}
