//! The quadratic tetrahedron.
//!
//! The integral of a vertex function over a face vanishes, and over the cell it is negative. For tractions and body forces these
//! integrals are the consistent loads, and as contact weights they let friction act at the midside nodes alone: other weights
//! (equal ones, or those of a lumped mass) are not in equilibrium with a constant traction, and the stress does not converge.

use super::{
    Barycentric, Element, ElementKind, OnContact, Share, quadratic_shape, quadratic_slopes, rules,
};

const MIDSIDES: &[[usize; 2]] = &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// Coordinates of the four points of degree 2: `(5 - sqrt 5) / 20` three times, `(5 + 3 sqrt 5) / 20` once.
const A: f64 = 0.138_196_601_125_010_5;
const B: f64 = 0.585_410_196_624_968_5;

pub(super) const TABLE: Element = Element {
    name: "tet10",
    kind: ElementKind::P2,
    dimension: 3,
    order: 2,
    nodes: 10,
    midsides: MIDSIDES,
    faces: &[&[0, 2, 1], &[0, 1, 3], &[0, 3, 2], &[1, 2, 3]],
    face_midsides: &[[0, 1], [1, 2], [2, 0]],
    // gradients are linear, their products quadratic
    points: &[[B, A, A, A], [A, B, A, A], [A, A, B, A], [A, A, A, B]],
    bent_points: rules::TETRAHEDRON,
    bent_face_points: rules::TRIANGLE,
    shape,
    slopes,
    integrals: &[
        Share::new(-1.0, 20.0),
        Share::new(-1.0, 20.0),
        Share::new(-1.0, 20.0),
        Share::new(-1.0, 20.0),
        Share::new(1.0, 5.0),
        Share::new(1.0, 5.0),
        Share::new(1.0, 5.0),
        Share::new(1.0, 5.0),
        Share::new(1.0, 5.0),
        Share::new(1.0, 5.0),
    ],
    face_integrals: &[
        Share::new(0.0, 1.0),
        Share::new(0.0, 1.0),
        Share::new(0.0, 1.0),
        Share::new(1.0, 3.0),
        Share::new(1.0, 3.0),
        Share::new(1.0, 3.0),
    ],
    // about 28 neighbours, half of them below the diagonal
    row_entries: 45,
    vtk: 24,
    pieces: &[],
    contact: OnContact::Midsides,
};

fn shape(node: usize, at: &Barycentric) -> f64 {
    quadratic_shape(4, MIDSIDES, node, at)
}

fn slopes(node: usize, at: &Barycentric) -> Barycentric {
    quadratic_slopes(4, MIDSIDES, node, at)
}
