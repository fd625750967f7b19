//! The quadratic triangle.
//!
//! The integrals of the shape functions over a side are the weights of Simpson's rule, 1/6 at the ends and 4/6 in the middle:
//! all positive, so that friction acts at vertices and midside nodes alike.

use super::{
    Barycentric, Element, ElementKind, OnContact, Share, quadratic_shape, quadratic_slopes, rules,
};

const MIDSIDES: &[[usize; 2]] = &[[0, 1], [1, 2], [2, 0]];

pub(super) const TABLE: Element = Element {
    name: "tri6",
    kind: ElementKind::P2,
    dimension: 2,
    order: 2,
    nodes: 6,
    midsides: MIDSIDES,
    faces: &[&[0, 1], &[1, 2], &[2, 0]],
    face_midsides: &[[0, 1]],
    // gradients are linear: the middles of the sides
    points: &[
        [0.5, 0.5, 0.0, 0.0],
        [0.0, 0.5, 0.5, 0.0],
        [0.5, 0.0, 0.5, 0.0],
    ],
    bent_points: rules::TRIANGLE,
    bent_face_points: rules::LINE,
    shape,
    slopes,
    integrals: &[
        Share::new(0.0, 1.0),
        Share::new(0.0, 1.0),
        Share::new(0.0, 1.0),
        Share::new(1.0, 3.0),
        Share::new(1.0, 3.0),
        Share::new(1.0, 3.0),
    ],
    face_integrals: &[
        Share::new(1.0, 6.0),
        Share::new(1.0, 6.0),
        Share::new(4.0, 6.0),
    ],
    // about 12 neighbours, half of them below the diagonal
    row_entries: 13,
    vtk: 22,
    pieces: &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
    contact: OnContact::Nodes {
        shape: side,
        between,
    },
};

fn shape(node: usize, at: &Barycentric) -> f64 {
    quadratic_shape(3, MIDSIDES, node, at)
}

fn slopes(node: usize, at: &Barycentric) -> Barycentric {
    quadratic_slopes(3, MIDSIDES, node, at)
}

/// Shape functions of a side: both ends, then the middle.
fn side(node: usize, at: &[f64]) -> f64 {
    let (p, q) = (at[0], at[1]);
    match node {
        0 => p * (p - q),
        1 => q * (q - p),
        _ => 4.0 * p * q,
    }
}

/// Linear on each half of a side.
fn between(node: usize, at: &[f64]) -> f64 {
    let (p, q) = (at[0], at[1]);
    let (a, b) = ((p - q).max(0.0), (q - p).max(0.0));
    match node {
        0 => a,
        1 => b,
        _ => 1.0 - a - b,
    }
}
