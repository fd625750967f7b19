//! The contact surface of a discretisation, and its fields at the contact nodes of another one.
//!
//! A slip rate is a finite element function: the trace of the body on the faces of the contact part. So its value at a
//! point is the sum of the shape functions of the face there times the nodal values, in the plane and in space alike. At
//! clamped nodes, which are no contact nodes, it vanishes. A tangential stress is a nodal force over a nodal weight: linear
//! between neighbouring nodes (midside nodes among them), and at clamped nodes continued from the contact nodes beside them.
//! A point beside the surface, as on a coarse curved contact, is projected onto the nearest face.

use crate::element::{Element, OnContact};
use crate::fem::{Body, ContactPatch};
use crate::scene::Scene;
use crate::{Error, Result};
use nalgebra::Vector3;

/// The contact faces of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    faces: Vec<Face>,
    /// Contact nodes: points, tangents, weights.
    pub contact: ContactPatch,
}

/// A segment (2D) or triangle (3D).
#[derive(Debug, Clone, PartialEq)]
struct Face {
    /// Element of the cell.
    element: &'static Element,
    corners: Vec<Vector3<f64>>,
    /// Contact node of every node of the face; `None` where it is clamped.
    nodes: Vec<Option<usize>>,
}

/// What a nodal field is at clamped nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Vanishes: slip rate and slip.
    Kinematic,
    /// Continued from the contact nodes: stress.
    Static,
}

/// A sparse matrix: for every component at the nodes of one surface, the components at another's that make it up.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    rows: Vec<Vec<(usize, f64)>>,
}

impl Surface {
    /// The contact surface of an assembled scene.
    ///
    /// # Errors
    /// [`Error::Scene`] when the mesh has no such part; not for a body of this scene.
    pub fn of(scene: &Scene, body: &Body) -> Result<Surface> {
        let face = |nodes: &[u32]| Face {
            element: body.mesh.element,
            corners: nodes
                .iter()
                .take(body.mesh.dimension)
                .map(|&n| Vector3::from(body.mesh.nodes[n as usize]))
                .collect(),
            nodes: nodes.iter().map(|&n| body.dofs.contact_index(n)).collect(),
        };
        let mut faces = Vec::new();
        for contact in scene.contacts() {
            let path = format!("{}.part", contact.path);
            faces.extend(body.mesh.faces(&contact.part, &path)?.map(face));
        }
        Ok(Surface {
            faces,
            contact: body.contact.clone(),
        })
    }

    /// How fields of this surface are read at the contact nodes of `to`, in its tangents.
    ///
    /// # Errors
    /// [`Error::Body`] for a surface without faces; not for that of a body.
    pub fn transfer(&self, to: &ContactPatch, kind: Kind) -> Result<Transfer> {
        let mut rows = Vec::with_capacity(to.len());
        for (point, tangents) in to.points.iter().zip(&to.tangents) {
            let shares = self.shares(Vector3::from(*point), kind)?;
            for tangent in &tangents[..to.components] {
                let along = Vector3::from(*tangent);
                let mut row = Vec::new();
                for &(node, share) in &shares {
                    for c in 0..self.contact.components {
                        let own = Vector3::from(self.contact.tangents[node][c]);
                        let value = share * own.dot(&along);
                        if value != 0.0 {
                            row.push((node * self.contact.components + c, value));
                        }
                    }
                }
                rows.push(row);
            }
        }
        Ok(Transfer { rows })
    }

    /// Contact nodes and their shares in the value at the point of the surface nearest to `at`.
    fn shares(&self, at: Vector3<f64>, kind: Kind) -> Result<Vec<(usize, f64)>> {
        let mut nearest: Option<(f64, &Face, Vec<f64>)> = None;
        for face in &self.faces {
            let place = face.nearest(at);
            let distance = (face.point(&place) - at).norm_squared();
            if nearest.as_ref().is_none_or(|(d, _, _)| distance < *d) {
                nearest = Some((distance, face, place));
            }
        }
        let Some((_, face, place)) = nearest else {
            return Err(Error::Body {
                what: "the contact part has no faces".to_owned(),
            });
        };
        let values = face.values(&place, kind);
        let shares = face.nodes.iter().zip(values);
        let mut shares: Vec<(usize, f64)> = shares
            .filter_map(|(node, value)| node.map(|n| (n, value)))
            .collect();
        let sum: f64 = shares.iter().map(|(_, value)| value).sum();
        if kind == Kind::Static {
            let count = shares.len() as f64;
            for (_, value) in &mut shares {
                // at a clamped corner all of them vanish
                *value = if sum > 1e-9 {
                    *value / sum
                } else {
                    1.0 / count
                };
            }
        }
        Ok(shares)
    }
}

impl Face {
    /// The point with the given barycentric coordinates.
    fn point(&self, place: &[f64]) -> Vector3<f64> {
        let corners = self.corners.iter().zip(place);
        corners.map(|(corner, value)| corner * *value).sum()
    }

    /// Barycentric coordinates of the point of the face nearest to `at`.
    fn nearest(&self, at: Vector3<f64>) -> Vec<f64> {
        match *self.corners {
            [a, b] => {
                let s = along(a, b, at);
                vec![1.0 - s, s]
            }
            [a, b, c] => nearest_of_triangle([a, b, c], at).to_vec(),
            _ => vec![1.0 / self.corners.len() as f64; self.corners.len()],
        }
    }

    /// Shares of the nodes in the value at a place.
    fn values(&self, place: &[f64], kind: Kind) -> Vec<f64> {
        let OnContact::Nodes { shape, between } = self.element.contact else {
            // such an element is not studied
            return Vec::new();
        };
        let value = match kind {
            Kind::Kinematic => shape,
            Kind::Static => between,
        };
        (0..self.nodes.len())
            .map(|node| value(node, place))
            .collect()
    }
}

/// Place on the segment from `a` to `b` nearest to `at`, 0 to 1.
fn along(a: Vector3<f64>, b: Vector3<f64>, at: Vector3<f64>) -> f64 {
    let axis = b - a;
    ((at - a).dot(&axis) / axis.norm_squared()).clamp(0.0, 1.0)
}

/// Barycentric coordinates of the point of a triangle nearest to `at`.
fn nearest_of_triangle([a, b, c]: [Vector3<f64>; 3], at: Vector3<f64>) -> [f64; 3] {
    let (e1, e2, d) = (b - a, c - a, at - a);
    let (aa, ab, bb) = (e1.norm_squared(), e1.dot(&e2), e2.norm_squared());
    let (p, q) = (d.dot(&e1), d.dot(&e2));
    let determinant = aa * bb - ab * ab;
    let (v, w) = (
        (bb * p - ab * q) / determinant,
        (aa * q - ab * p) / determinant,
    );
    if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
        return [1.0 - v - w, v, w];
    }
    let sides = [
        (along(a, b, at), [0, 1]),
        (along(b, c, at), [1, 2]),
        (along(c, a, at), [2, 0]),
    ];
    let corners = [a, b, c];
    let mut best = ([0.0; 3], f64::INFINITY);
    for (s, [from, to]) in sides {
        let point = corners[from] * (1.0 - s) + corners[to] * s;
        let distance = (point - at).norm_squared();
        if distance < best.1 {
            let mut values = [0.0; 3];
            (values[from], values[to]) = (1.0 - s, s);
            best = (values, distance);
        }
    }
    best.0
}

impl Transfer {
    /// The field at the nodes of the other surface, components inner.
    pub fn apply(&self, field: &[f64]) -> Vec<f64> {
        let value = |row: &Vec<(usize, f64)>| row.iter().map(|&(i, v)| v * field[i]).sum();
        self.rows.iter().map(value).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::example;

    fn surface(name: &str, cells: &str) -> Surface {
        let changes = [("mesh.cells".to_owned(), cells.to_owned())];
        let scene = Scene::with_overrides(example(name).unwrap(), name, &changes).unwrap();
        Surface::of(&scene, &Body::assemble(&scene).unwrap()).unwrap()
    }

    /// Nodal values of a function of the position.
    fn nodal(surface: &Surface, f: impl Fn([f64; 3], usize) -> f64) -> Vec<f64> {
        let components = surface.contact.components;
        let points = surface.contact.points.iter();
        points
            .flat_map(|p| (0..components).map(|c| f(*p, c)).collect::<Vec<_>>())
            .collect()
    }

    /// A field linear along the contact that vanishes where the body is clamped is met exactly, by non-nested meshes too.
    #[test]
    fn linear_fields_are_reproduced() {
        for (name, coarse, fine) in [
            ("kazmi2014", "[6, 3]", "[31, 2]"),
            ("brake_pad_3d", "[3, 1, 2]", "[7, 2, 5]"),
        ] {
            let (coarse, fine) = (surface(name, coarse), surface(name, fine));
            let f = |p: [f64; 3], c: usize| (1.0 + c as f64) * p[0] + 3.0 * p[2];
            let expected = nodal(&fine, f);
            for kind in [Kind::Kinematic, Kind::Static] {
                let transfer = coarse.transfer(&fine.contact, kind).unwrap();
                let found = transfer.apply(&nodal(&coarse, f));
                let is_exact = |(i, (a, b)): (usize, (&f64, &f64))| {
                    let x = fine.contact.points[i / fine.contact.components][0];
                    // between the clamped corner of the paper's example and its first contact node a stress is constant
                    let is_continued = name == "kazmi2014" && x < 1.0 / 6.0;
                    (a - b).abs() < 1e-13 || (is_continued && kind == Kind::Static)
                };
                assert!(found.iter().zip(&expected).enumerate().all(is_exact));
            }
            let ones = coarse.transfer(&fine.contact, Kind::Static).unwrap();
            let ones = ones.apply(&nodal(&coarse, |_, _| 1.0));
            assert!(ones.iter().all(|v| (v - 1.0).abs() < 1e-13));
        }
    }

    /// Followers of periodicity belong to the node they follow.
    #[test]
    fn a_periodic_contact_closes() {
        let coarse = surface("sheared_column", "[1, 4]");
        let fine = surface("sheared_column", "[4, 4]");
        assert_eq!(coarse.contact.len(), 1);
        for kind in [Kind::Kinematic, Kind::Static] {
            let transfer = coarse.transfer(&fine.contact, kind).unwrap();
            assert_eq!(transfer.apply(&[2.0]), [2.0; 4]);
        }
    }

    #[test]
    fn the_nearest_point_of_a_triangle_is_nearest() {
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.1, 0.0], [0.3, 1.0, 0.4]].map(Vector3::from);
        let face = Face {
            element: crate::element::linear(3),
            corners: corners.to_vec(),
            nodes: vec![None; 3],
        };
        for at in [
            [0.5, 0.3, 1.0],
            [-1.0, 0.2, 0.0],
            [3.0, -1.0, 0.2],
            [1.5, 1.5, 0.0],
        ] {
            let at = Vector3::from(at);
            let found = face.nearest(at);
            assert!((found.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            let distance = (face.point(&found) - at).norm();
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let (v, w) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                    let other = face.point(&[1.0 - v - w, v, w]);
                    assert!((other - at).norm() >= distance - 1e-12);
                }
            }
        }
    }
}
