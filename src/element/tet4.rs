//! The linear tetrahedron.

use super::{Element, ElementKind, OnContact, Share, linear_face, linear_shape, linear_slopes};

pub(super) const TABLE: Element = Element {
    name: "tet4",
    kind: ElementKind::P1,
    dimension: 3,
    order: 1,
    nodes: 4,
    midsides: &[],
    faces: &[&[0, 2, 1], &[0, 1, 3], &[0, 3, 2], &[1, 2, 3]],
    face_midsides: &[],
    // gradients are constant: one point, the centroid
    points: &[[0.25; 4]],
    bent_points: &[],
    bent_face_points: &[],
    shape: linear_shape,
    slopes: linear_slopes,
    integrals: &[Share::new(1.0, 4.0); 4],
    face_integrals: &[Share::new(1.0, 3.0); 3],
    // about 15 neighbours, half of them below the diagonal
    row_entries: 24,
    vtk: 10,
    pieces: &[],
    contact: OnContact::Nodes {
        shape: linear_face,
        between: linear_face,
    },
};
