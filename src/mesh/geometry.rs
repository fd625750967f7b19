//! Geometry of second-order cells and faces whose midside nodes bend their sides.
//!
//! Such a cell is the image of the straight one under its own shape functions, `x = sum_i N_i(l) x_i`: it is isoparametric, and its
//! integrals need quadrature. A cell whose midside nodes stand in the middle is straight and is not treated here, so that its
//! integrals stay exact.

use super::Mesh;
use crate::element::{Barycentric, Element, MOST_NODES};
use nalgebra::{Matrix3, Vector3};

/// Share of a side up to which a midside node stands in its middle: what the digits of a file leave.
const STRAIGHT: f64 = 1e-9;
/// Most nodes of a face.
const MOST_FACE_NODES: usize = 6;
/// Steps of Newton's method for the coordinates of a point; it needs a handful.
const MOST_STEPS: usize = 30;

/// A cell with bent sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Bent {
    element: &'static Element,
    places: [Vector3<f64>; MOST_NODES],
}

impl Bent {
    /// The cell with these nodes; `None` for a straight one.
    pub fn new(mesh: &Mesh, cell: &[u32]) -> Option<Bent> {
        let (element, corners) = (mesh.element, mesh.element.corners());
        let is_straight = is_straight(mesh, cell, corners, element.midsides);
        (!is_straight).then(|| {
            let mut places = [Vector3::zeros(); MOST_NODES];
            for (place, &node) in places.iter_mut().zip(cell) {
                *place = point(mesh, node);
            }
            Bent { element, places }
        })
    }

    /// The point at barycentric coordinates, m.
    pub fn place(&self, at: &Barycentric) -> Vector3<f64> {
        let nodes = self.places.iter().take(self.element.nodes).enumerate();
        nodes
            .map(|(i, place)| place * (self.element.shape)(i, at))
            .sum()
    }

    /// Derivatives of the point by the coordinates of the second and following corners, in columns; the unit vector along z
    /// completes those of a plane cell. Its determinant is twice the area or six times the volume.
    pub fn jacobian(&self, at: &Barycentric) -> Matrix3<f64> {
        let dimension = self.element.dimension;
        let mut columns = Matrix3::zeros();
        for (i, place) in self.places.iter().take(self.element.nodes).enumerate() {
            let slopes = (self.element.slopes)(i, at);
            for j in 0..dimension {
                let slope = slopes[j + 1] - slopes[0];
                if slope != 0.0 {
                    let sum = columns.column(j) + place * slope;
                    columns.set_column(j, &sum);
                }
            }
        }
        if dimension == 2 {
            columns[(2, 2)] = 1.0;
        }
        columns
    }

    /// Smallest and largest determinant of the Jacobian at the points of integration and at the nodes; not positive for a cell that
    /// its sides turn inside out.
    pub fn determinants(&self) -> [f64; 2] {
        let corners = self.element.corners();
        let mut places: Vec<Barycentric> =
            self.element.bent_points.iter().map(|(at, _)| *at).collect();
        for i in 0..corners {
            let mut at = [0.0; 4];
            at[i] = 1.0;
            places.push(at);
        }
        for [i, j] in self.element.midsides {
            let mut at = [0.0; 4];
            (at[*i], at[*j]) = (0.5, 0.5);
            places.push(at);
        }
        let values = places.iter().map(|at| self.jacobian(at).determinant());
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            // a value that is no number must not be lost
            if x.is_nan() {
                [x, x]
            } else {
                [low.min(x), high.max(x)]
            }
        })
    }

    /// Area (m^2) or volume (m^3).
    pub fn measure(&self) -> f64 {
        let points = self.element.bent_points.iter();
        let sum: f64 = points
            .map(|(at, share)| share * self.jacobian(at).determinant())
            .sum();
        sum / simplex_share(self.element.dimension)
    }

    /// Barycentric coordinates of a point, by Newton's method from a first guess; `None` where it finds none, far outside.
    pub fn barycentric(&self, point: Vector3<f64>, guess: Barycentric) -> Option<Barycentric> {
        let mut at = guess;
        for _ in 0..MOST_STEPS {
            let step = self.jacobian(&at).try_inverse()? * (point - self.place(&at));
            let dimension = self.element.dimension;
            let mut sum = 0.0;
            for j in 0..dimension {
                at[j + 1] += step[j];
                sum += at[j + 1];
            }
            at[0] = 1.0 - sum;
            if !at.iter().all(|x| x.abs() < 1e3) {
                return None;
            }
            if step.amax() < 1e-14 {
                break;
            }
        }
        Some(at)
    }
}

/// Reciprocal of the measure of the simplex between the origin and the unit vectors.
pub(crate) fn simplex_share(dimension: usize) -> f64 {
    if dimension == 2 { 2.0 } else { 6.0 }
}

/// A point of integration on a bent face: values of the shape functions of its nodes, and the outward normal times the share of
/// the length (m) or area (m^2).
pub type FacePoint = ([f64; MOST_FACE_NODES], Vector3<f64>);

/// The points of integration of a face; `None` for a straight one.
pub fn bent_face<'m>(
    mesh: &'m Mesh,
    face: &'m [u32],
) -> Option<impl Iterator<Item = FacePoint> + 'm> {
    let (element, d) = (mesh.element, mesh.dimension);
    if is_straight(mesh, face, d, element.face_midsides) {
        return None;
    }
    Some(element.bent_face_points.iter().map(move |(at, share)| {
        let mut shapes = [0.0; MOST_FACE_NODES];
        let mut along = [Vector3::zeros(); 2];
        for (i, (&node, shape)) in face.iter().zip(&mut shapes).enumerate() {
            *shape = element.face_shape(i, at);
            let slopes = element.face_slopes(i, at);
            for (j, along) in along.iter_mut().take(d - 1).enumerate() {
                *along += point(mesh, node) * (slopes[j + 1] - slopes[0]);
            }
        }
        let normal = match d {
            2 => along[0].cross(&Vector3::z()),
            _ => along[0].cross(&along[1]) / 2.0,
        };
        (shapes, normal * *share)
    }))
}

fn point(mesh: &Mesh, node: u32) -> Vector3<f64> {
    Vector3::from(mesh.nodes[node as usize])
}

/// Whether all midside nodes, which follow the corners, stand in the middle of their sides.
fn is_straight(mesh: &Mesh, nodes: &[u32], corners: usize, midsides: &[[usize; 2]]) -> bool {
    midsides
        .iter()
        .zip(&nodes[corners..])
        .all(|([i, j], &middle)| {
            let (p, q) = (point(mesh, nodes[*i]), point(mesh, nodes[*j]));
            let off = point(mesh, middle) - (p + q) / 2.0;
            // a coordinate that is not a number is no middle either
            off.norm_squared() <= STRAIGHT * STRAIGHT * (q - p).norm_squared()
        })
}
