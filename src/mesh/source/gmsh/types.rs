//! The types of elements in MSH files, by their numbers.

use crate::element::{self, Element, ElementKind};

/// A type of element.
#[derive(Debug, PartialEq)]
pub(super) struct ElementType {
    pub number: i64,
    /// What messages call it.
    pub name: &'static str,
    /// Dimension of the element itself.
    pub dimension: usize,
    /// Nodes of one element.
    pub nodes: usize,
    /// Degree of its shape functions.
    pub order: usize,
}

const fn row(
    number: i64,
    name: &'static str,
    dimension: usize,
    nodes: usize,
    order: usize,
) -> ElementType {
    ElementType {
        number,
        name,
        dimension,
        nodes,
        order,
    }
}

/// Types whose number of nodes is known, so that what follows them can be read.
const TYPES: &[ElementType] = &[
    row(1, "line", 1, 2, 1),
    row(2, "triangle", 2, 3, 1),
    row(3, "quadrangle", 2, 4, 1),
    row(4, "tetrahedron", 3, 4, 1),
    row(5, "hexahedron", 3, 8, 1),
    row(6, "prism", 3, 6, 1),
    row(7, "pyramid", 3, 5, 1),
    row(8, "second-order line", 1, 3, 2),
    row(9, "second-order triangle", 2, 6, 2),
    row(10, "second-order quadrangle", 2, 9, 2),
    row(11, "second-order tetrahedron", 3, 10, 2),
    row(12, "second-order hexahedron", 3, 27, 2),
    row(13, "second-order prism", 3, 18, 2),
    row(14, "second-order pyramid", 3, 14, 2),
    row(15, "point", 0, 1, 0),
    row(16, "second-order quadrangle", 2, 8, 2),
    row(17, "second-order hexahedron", 3, 20, 2),
    row(18, "second-order prism", 3, 15, 2),
    row(19, "second-order pyramid", 3, 13, 2),
    row(20, "third-order triangle", 2, 9, 3),
    row(21, "third-order triangle", 2, 10, 3),
    row(22, "fourth-order triangle", 2, 12, 4),
    row(23, "fourth-order triangle", 2, 15, 4),
    row(24, "fifth-order triangle", 2, 15, 5),
    row(25, "fifth-order triangle", 2, 21, 5),
    row(26, "third-order line", 1, 4, 3),
    row(27, "fourth-order line", 1, 5, 4),
    row(28, "fifth-order line", 1, 6, 5),
    row(29, "third-order tetrahedron", 3, 20, 3),
    row(30, "fourth-order tetrahedron", 3, 35, 4),
    row(31, "fifth-order tetrahedron", 3, 56, 5),
    row(36, "third-order quadrangle", 2, 16, 3),
    row(92, "third-order hexahedron", 3, 64, 3),
];

/// For every midside node of Gmsh's second-order tetrahedron, its place among ours: the last two are exchanged.
const TETRAHEDRON: [usize; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8];

impl ElementType {
    /// The type with this number.
    pub fn of(number: i64) -> Option<&'static ElementType> {
        TYPES.iter().find(|t| t.number == number)
    }

    /// The element of the library whose cells it is.
    pub fn cell(&self) -> Option<&'static Element> {
        let kind = match (self.dimension, self.nodes) {
            (2, 3) | (3, 4) => ElementKind::P1,
            (2, 6) | (3, 10) => ElementKind::P2,
            _ => return None,
        };
        element::of(kind, self.dimension)
    }

    /// Whether it is a face of the cells of `element`.
    pub fn is_face_of(&self, element: &Element) -> bool {
        // of the same dimension and degree only quadrangles could have another number of corners
        self.dimension + 1 == element.dimension
            && self.order == element.order
            && self.nodes == element.face_nodes()
    }

    /// Where node `i` of our element stands among the nodes of this one.
    pub fn place(&self, i: usize) -> usize {
        match self.nodes {
            10 if self.dimension == 3 => TETRAHEDRON[i],
            _ => i,
        }
    }
}

/// What Gmsh calls an entity.
pub(super) fn entity_name(dimension: usize) -> &'static str {
    ["point", "curve", "surface", "volume"][dimension.min(3)]
}
