//! The linear triangle.

use super::{Element, ElementKind, OnContact, Share, linear_face, linear_shape, linear_slopes};

pub(super) const TABLE: Element = Element {
    name: "tri3",
    kind: ElementKind::P1,
    dimension: 2,
    order: 1,
    nodes: 3,
    midsides: &[],
    faces: &[&[0, 1], &[1, 2], &[2, 0]],
    face_midsides: &[],
    // gradients are constant: one point, the centroid
    points: &[[1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 0.0]],
    bent_points: &[],
    bent_face_points: &[],
    shape: linear_shape,
    slopes: linear_slopes,
    integrals: &[Share::new(1.0, 3.0); 3],
    face_integrals: &[Share::new(1.0, 2.0); 2],
    // about 7 neighbours, half of them below the diagonal
    row_entries: 8,
    vtk: 5,
    pieces: &[[0, 1, 2]],
    contact: OnContact::Nodes {
        shape: linear_face,
        between: linear_face,
    },
};
