//! Faces of cells: normals, and integrals of their shape functions, straight or bent.

use super::cell::point;
use crate::mesh::{Mesh, bent_face};
use nalgebra::Vector3;

/// Outward normal of a face times its length (2D, m) or area (3D, m^2).
pub(super) fn area_vector(mesh: &Mesh, face: &[u32]) -> Vector3<f64> {
    let p = point(mesh, face[0]);
    let along = point(mesh, face[1]) - p;
    if mesh.dimension == 2 {
        along.cross(&Vector3::z())
    } else {
        along.cross(&(point(mesh, face[2]) - p)) / 2.0
    }
}

/// Nodes of a face with the integral of their shape function over it (m or m^2): the row sums of its mass matrix.
pub(super) fn face_integrals(mesh: &Mesh, face: &[u32]) -> impl Iterator<Item = (u32, f64)> {
    let area = area_vector(mesh, face).norm();
    let bent = bent_face(mesh, face).map(|points| {
        let mut sums = vec![0.0; face.len()];
        for (shapes, normal) in points {
            let length = normal.norm();
            for (sum, shape) in sums.iter_mut().zip(shapes) {
                *sum += shape * length;
            }
        }
        sums
    });
    let shares = mesh.element.face_integrals.iter().enumerate();
    face.iter().zip(shares).map(move |(&node, (i, share))| {
        let integral = bent.as_ref().map_or_else(|| share.of(area), |sums| sums[i]);
        (node, integral)
    })
}

/// Nodes of a face with the integral of their shape function times the outward normal (m or m^2). In a part without bent faces the
/// area vector of the face stands for it, the same at all nodes: normals are sums of these, and only their direction matters.
pub(super) fn face_normals(
    mesh: &Mesh,
    face: &[u32],
    is_part_bent: bool,
) -> impl Iterator<Item = (u32, Vector3<f64>)> {
    let area = area_vector(mesh, face);
    let mut normals = vec![area; face.len()];
    if is_part_bent {
        match bent_face(mesh, face) {
            Some(points) => {
                normals.fill(Vector3::zeros());
                for (shapes, normal) in points {
                    for (sum, shape) in normals.iter_mut().zip(shapes) {
                        *sum += normal * shape;
                    }
                }
            }
            None => {
                for (normal, share) in normals.iter_mut().zip(mesh.element.face_integrals) {
                    *normal = area * share.of(1.0);
                }
            }
        }
    }
    face.iter().copied().zip(normals)
}

/// Outward normal of a face at one of its nodes, of any length.
pub(super) fn face_normal_at(mesh: &Mesh, face: &[u32], node: usize) -> Vector3<f64> {
    let (element, d) = (mesh.element, mesh.dimension);
    let mut at = [0.0; 4];
    match node.checked_sub(d) {
        None => at[node] = 1.0,
        Some(midside) => element.face_midsides[midside]
            .iter()
            .for_each(|i| at[*i] = 0.5),
    }
    let mut along = [Vector3::zeros(); 2];
    for (i, &of) in face.iter().enumerate() {
        let slopes = element.face_slopes(i, &at);
        for (j, along) in along.iter_mut().take(d - 1).enumerate() {
            *along += point(mesh, of) * (slopes[j + 1] - slopes[0]);
        }
    }
    match d {
        2 => along[0].cross(&Vector3::z()),
        _ => along[0].cross(&along[1]),
    }
}
