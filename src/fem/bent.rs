//! Points of integration of cells with bent sides: gradients of the shape functions go through the Jacobian of each.

use crate::element::{Barycentric, Element, MOST_NODES};
use crate::mesh::Bent;
use nalgebra::{Matrix3, Vector3};

/// The points of integration of a bent cell.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Points {
    pub bent: Bent,
    /// Weight (m^2 or m^3) and gradients of the shape functions at every point.
    pub all: Vec<(f64, [Vector3<f64>; MOST_NODES])>,
}

impl Points {
    pub fn new(element: &Element, bent: Bent) -> Points {
        let measure = if element.dimension == 2 { 2.0 } else { 6.0 };
        let at_point = |(at, share): &(Barycentric, f64)| {
            let jacobian = bent.jacobian(at);
            let mut gradients = [Vector3::zeros(); MOST_NODES];
            for (node, gradient) in gradients.iter_mut().take(element.nodes).enumerate() {
                *gradient = self::gradient(element, &jacobian, node, at);
            }
            (share * jacobian.determinant() / measure, gradients)
        };
        Points {
            all: element.bent_points.iter().map(at_point).collect(),
            bent,
        }
    }
}

/// Gradient of a shape function at a point with this Jacobian; not finite where it is singular.
pub(super) fn gradient(
    element: &Element,
    jacobian: &Matrix3<f64>,
    node: usize,
    at: &Barycentric,
) -> Vector3<f64> {
    let slopes = (element.slopes)(node, at);
    let mut by_corner = Vector3::zeros();
    for j in 0..element.dimension {
        by_corner[j] = slopes[j + 1] - slopes[0];
    }
    match jacobian.try_inverse() {
        Some(inverse) => inverse.tr_mul(&by_corner),
        None => Vector3::repeat(f64::NAN),
    }
}
