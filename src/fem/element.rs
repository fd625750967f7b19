//! The linear simplex (triangle, tetrahedron) and the isotropic form on it.
//!
//! On a cell K the form is `int_K lambda tr(eps u) tr(eps v) + two_mu eps(u) : eps(v)`, eps the symmetric gradient. The
//! gradients of the shape functions are constant, so the integral is a product with the area or volume and exact. The
//! plane case lives in three components with vanishing z: the code has one path, and the z unknowns never get numbers.

use crate::mesh::Mesh;
use nalgebra::{Matrix3, Vector3};

/// Coefficients of `lambda tr(eps u) tr(eps v) + two_mu eps(u) : eps(v)` (Pa, or Pa s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IsotropicForm {
    /// Coefficient of the traces.
    pub lambda: f64,
    /// Coefficient of the strains.
    pub two_mu: f64,
}

/// Geometry of one linear cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simplex {
    /// Area (2D, m^2) or volume (3D, m^3); negative for a mirrored cell, not finite gradients for a flat one.
    pub volume: f64,
    /// Gradients of the shape functions, 1/m; the first `dimension + 1` are in use, z = 0 in 2D.
    pub gradients: [Vector3<f64>; 4],
}

impl Simplex {
    /// Geometry of a cell given by its `dimension + 1` node numbers.
    pub fn new(mesh: &Mesh, cell: &[u32]) -> Simplex {
        let origin = point(mesh, cell[0]);
        let e1 = point(mesh, cell[1]) - origin;
        let e2 = point(mesh, cell[2]) - origin;
        let is_plane = mesh.dimension == 2;
        // The unit vector along z completes the plane cell to a parallelepiped of the same determinant.
        let e3 = if is_plane {
            Vector3::z()
        } else {
            point(mesh, cell[3]) - origin
        };
        let determinant = e1.dot(&e2.cross(&e3));
        let g1 = e2.cross(&e3) / determinant;
        let g2 = e3.cross(&e1) / determinant;
        let (g3, volume) = if is_plane {
            (Vector3::zeros(), determinant / 2.0)
        } else {
            (e1.cross(&e2) / determinant, determinant / 6.0)
        };
        Simplex {
            volume,
            gradients: [-(g1 + g2 + g3), g1, g2, g3],
        }
    }

    /// Blocks (3 x 3, row of node `a`, column of node `b`, global axes) of the element matrices of two forms.
    pub fn blocks(&self, a: usize, b: usize, forms: [IsotropicForm; 2]) -> [Matrix3<f64>; 2] {
        let (ga, gb) = (&self.gradients[a], &self.gradients[b]);
        // eps(u) : eps(v) = 1/2 (grad u : grad v + grad u : grad v^T)
        let outer = ga * gb.transpose();
        let crossed = outer.transpose() + Matrix3::from_diagonal_element(ga.dot(gb));
        forms.map(|form| {
            outer * (self.volume * form.lambda) + crossed * (self.volume * form.two_mu / 2.0)
        })
    }

    /// Barycentric coordinates of a point with respect to the cell (as many as the cell has nodes).
    pub fn barycentric(&self, mesh: &Mesh, cell: &[u32], at: [f64; 3]) -> [f64; 4] {
        let from_origin = Vector3::from(at) - point(mesh, cell[0]);
        let mut values = [0.0; 4];
        let mut rest = 1.0;
        // The unused gradient of the plane case is zero.
        for (value, gradient) in values.iter_mut().zip(&self.gradients).skip(1) {
            *value = gradient.dot(&from_origin);
            rest -= *value;
        }
        values[0] = rest;
        values
    }
}

/// Coordinates of a node.
pub(super) fn point(mesh: &Mesh, node: u32) -> Vector3<f64> {
    Vector3::from(mesh.nodes[node as usize])
}

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

/// Integral of each shape function of a face over the face: the row sums of its mass matrix.
pub(super) fn lumped_mass(mesh: &Mesh, face: &[u32]) -> f64 {
    area_vector(mesh, face).norm() / mesh.dimension as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn cell(dimension: usize) -> Mesh {
        let nodes = [
            [0.1, 0.2, 0.0],
            [1.3, -0.1, 0.0],
            [0.4, 0.9, 0.0],
            [0.3, 0.5, 1.1],
        ];
        Mesh {
            dimension,
            nodes: nodes[..=dimension].to_vec(),
            cell_nodes: (0..=dimension as u32).collect(),
            parts: BTreeMap::new(),
            leader: (0..=dimension as u32).collect(),
        }
    }

    #[test]
    fn energy_of_a_linear_field_is_exact() {
        let form = IsotropicForm {
            lambda: 1.7,
            two_mu: 0.9,
        };
        for dimension in [2, 3] {
            let mesh = cell(dimension);
            let simplex = Simplex::new(&mesh, mesh.cell(0));
            let mut gradient = Matrix3::new(0.3, -0.2, 0.5, 0.7, 0.1, -0.4, 0.2, 0.6, -0.8);
            if dimension == 2 {
                gradient.row_mut(2).fill(0.0);
                gradient.column_mut(2).fill(0.0);
            }
            let strain = (gradient + gradient.transpose()) / 2.0;
            let exact = simplex.volume
                * (form.lambda * strain.trace() * strain.trace()
                    + form.two_mu * strain.norm_squared());
            let mut energy = 0.0;
            for a in 0..=dimension {
                for b in 0..=dimension {
                    let [block, _] = simplex.blocks(a, b, [form; 2]);
                    let (u, v) = (point(&mesh, a as u32), point(&mesh, b as u32));
                    energy += (gradient * u).dot(&(block * (gradient * v)));
                }
            }
            assert!(simplex.volume > 0.0);
            assert!((energy - exact).abs() < 1e-13 * exact);
        }
    }

    #[test]
    fn shape_functions_are_a_partition_of_unity_and_nodal() {
        for dimension in [2, 3] {
            let mesh = cell(dimension);
            let simplex = Simplex::new(&mesh, mesh.cell(0));
            assert!(simplex.gradients.iter().sum::<Vector3<f64>>().norm() < 1e-14);
            for node in 0..=dimension {
                let values = simplex.barycentric(&mesh, mesh.cell(0), mesh.nodes[node]);
                for (i, value) in values.iter().enumerate().take(dimension + 1) {
                    assert!((value - f64::from(u8::from(i == node))).abs() < 1e-14);
                }
            }
        }
    }
}
