//! The shape functions of a cell and the isotropic form on it.
//!
//! On a cell K the form is `int_K lambda tr(eps u) tr(eps v) + two_mu eps(u) : eps(v)`, eps the symmetric gradient. With the
//! barycentric coordinates `l_i` the shape functions are
//!
//! ```text
//! linear     l_i
//! quadratic  l_i (2 l_i - 1) at the vertices, 4 l_i l_j at the midside nodes
//! ```
//!
//! Gradients are constant or linear on straight-sided cells: one point, or the middles of the three sides with a third of
//! the area each, integrate the form exactly. The plane case lives in three components with vanishing z: the code has one
//! path, and the z unknowns never get numbers.

use crate::mesh::{Mesh, TRIANGLE_FACES};
use crate::scene::ElementKind;
use nalgebra::{Matrix3, Vector3};

/// Coefficients of `lambda tr(eps u) tr(eps v) + two_mu eps(u) : eps(v)` (Pa, or Pa s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IsotropicForm {
    /// Coefficient of the traces.
    pub lambda: f64,
    /// Coefficient of the strains.
    pub two_mu: f64,
}

/// Most nodes of a cell: the quadratic triangle.
pub const MOST_NODES: usize = 6;

/// Geometry of one straight-sided cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simplex {
    /// Area (2D, m^2) or volume (3D, m^3); negative for a mirrored cell, not finite gradients for a flat one.
    pub volume: f64,
    /// Gradients of the barycentric coordinates, 1/m; the first `dimension + 1` are in use, z = 0 in 2D.
    pub gradients: [Vector3<f64>; 4],
}

impl Simplex {
    /// Geometry of a cell given by its node numbers, the `dimension + 1` corners first.
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

    /// Barycentric coordinates of a point with respect to the cell (as many as the cell has corners).
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

/// One cell with its shape functions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Area (2D, m^2) or volume (3D, m^3).
    pub volume: f64,
    /// Nodes of the cell.
    len: usize,
    points: usize,
    /// Gradients of the shape functions at the points of integration, 1/m; zero where a cell has no such node.
    gradients: [[Vector3<f64>; MOST_NODES]; 3],
}

impl Element {
    /// The element of a cell given by its node numbers.
    pub fn new(mesh: &Mesh, cell: &[u32]) -> Element {
        let simplex = Simplex::new(mesh, cell);
        let mut gradients = [[Vector3::zeros(); MOST_NODES]; 3];
        let points = match mesh.element {
            ElementKind::P1 => {
                gradients[0][..4].copy_from_slice(&simplex.gradients);
                1
            }
            ElementKind::P2 => {
                for (side, at_middle) in TRIANGLE_FACES.iter().zip(&mut gradients) {
                    let at = |i: usize| if side.contains(&i) { 0.5 } else { 0.0 };
                    *at_middle = quadratic_gradients(&simplex, [at(0), at(1), at(2)]);
                }
                3
            }
        };
        Element {
            volume: simplex.volume,
            len: cell.len(),
            points,
            gradients,
        }
    }

    /// Points that integrate products of two gradients exactly: weight (m^2 or m^3) and gradients of the shape functions.
    pub fn points(&self) -> impl Iterator<Item = (f64, &[Vector3<f64>])> {
        let weight = self.volume / self.points as f64;
        let points = &self.gradients[..self.points];
        points.iter().map(move |all| (weight, &all[..self.len]))
    }

    /// Blocks (3 x 3, row of node `a`, column of node `b`, global axes) of the element matrices of two forms.
    pub fn blocks(&self, a: usize, b: usize, forms: [IsotropicForm; 2]) -> [Matrix3<f64>; 2] {
        let mut sums = [Matrix3::zeros(); 2];
        for (weight, gradients) in self.points() {
            let (ga, gb) = (&gradients[a], &gradients[b]);
            // eps(u) : eps(v) = 1/2 (grad u : grad v + grad u : grad v^T)
            let outer = ga * gb.transpose();
            let crossed = outer.transpose() + Matrix3::from_diagonal_element(ga.dot(gb));
            for (sum, form) in sums.iter_mut().zip(forms) {
                *sum += outer * (weight * form.lambda) + crossed * (weight * form.two_mu / 2.0);
            }
        }
        sums
    }

    /// Integral of each shape function over the cell, m^2 or m^3. Those of the vertices of a quadratic triangle vanish.
    pub fn integrals(&self) -> impl Iterator<Item = f64> {
        let (len, volume) = (self.len, self.volume);
        (0..len).map(move |i| match (len, i) {
            (MOST_NODES, 0..3) => 0.0,
            (MOST_NODES, _) => volume / 3.0,
            _ => volume / len as f64,
        })
    }
}

/// Shape functions of a cell with `len` nodes at barycentric coordinates.
pub(super) fn shape_values(len: usize, at: [f64; 4]) -> [f64; MOST_NODES] {
    let mut values = [0.0; MOST_NODES];
    if len < MOST_NODES {
        values[..4].copy_from_slice(&at);
        return values;
    }
    let (vertices, middles) = values.split_at_mut(3);
    for (value, l) in vertices.iter_mut().zip(at) {
        *value = l * (2.0 * l - 1.0);
    }
    for (value, side) in middles.iter_mut().zip(TRIANGLE_FACES) {
        *value = 4.0 * at[side[0]] * at[side[1]];
    }
    values
}

/// Gradients of the quadratic shape functions at barycentric coordinates.
fn quadratic_gradients(simplex: &Simplex, at: [f64; 3]) -> [Vector3<f64>; MOST_NODES] {
    let g = &simplex.gradients;
    let mut gradients = [Vector3::zeros(); MOST_NODES];
    let (vertices, middles) = gradients.split_at_mut(3);
    for (i, gradient) in vertices.iter_mut().enumerate() {
        *gradient = g[i] * (4.0 * at[i] - 1.0);
    }
    for (gradient, side) in middles.iter_mut().zip(TRIANGLE_FACES) {
        let (i, j) = (side[0], side[1]);
        *gradient = (g[i] * at[j] + g[j] * at[i]) * 4.0;
    }
    gradients
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

/// Nodes of a face with the integral of their shape function over it (m or m^2): the row sums of its mass matrix. On the
/// side of a quadratic triangle they are the weights of Simpson's rule, 1/6 at the ends and 4/6 in the middle.
pub(super) fn face_integrals(mesh: &Mesh, face: &[u32]) -> impl Iterator<Item = (u32, f64)> {
    let area = area_vector(mesh, face).norm();
    let corners = mesh.dimension;
    let is_quadratic = face.len() > corners;
    face.iter().enumerate().map(move |(i, &node)| {
        let integral = match (is_quadratic, i < corners) {
            (false, _) => area / corners as f64,
            (true, true) => area / 6.0,
            (true, false) => area * 4.0 / 6.0,
        };
        (node, integral)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn cell(dimension: usize, element: ElementKind) -> Mesh {
        let nodes = [
            [0.1, 0.2, 0.0],
            [1.3, -0.1, 0.0],
            [0.4, 0.9, 0.0],
            [0.3, 0.5, 1.1],
        ];
        let mesh = Mesh {
            dimension,
            element: ElementKind::P1,
            nodes: nodes[..=dimension].to_vec(),
            cell_nodes: (0..=dimension as u32).collect(),
            parts: BTreeMap::new(),
            leader: (0..=dimension as u32).collect(),
        };
        mesh.for_element(element).unwrap()
    }

    fn cells() -> [Mesh; 3] {
        [
            cell(2, ElementKind::P1),
            cell(3, ElementKind::P1),
            cell(2, ElementKind::P2),
        ]
    }

    const FORM: IsotropicForm = IsotropicForm {
        lambda: 1.7,
        two_mu: 0.9,
    };

    fn energy(mesh: &Mesh, field: impl Fn(Vector3<f64>) -> Vector3<f64>) -> f64 {
        let element = Element::new(mesh, mesh.cell(0));
        let mut energy = 0.0;
        for a in 0..mesh.nodes.len() {
            for b in 0..mesh.nodes.len() {
                let [block, _] = element.blocks(a, b, [FORM; 2]);
                let (u, v) = (point(mesh, a as u32), point(mesh, b as u32));
                energy += field(u).dot(&(block * field(v)));
            }
        }
        energy
    }

    fn density(gradient: Matrix3<f64>) -> f64 {
        let strain = (gradient + gradient.transpose()) / 2.0;
        FORM.lambda * strain.trace() * strain.trace() + FORM.two_mu * strain.norm_squared()
    }

    #[test]
    fn energy_of_a_linear_field_is_exact() {
        for mesh in cells() {
            let volume = Element::new(&mesh, mesh.cell(0)).volume;
            let mut gradient = Matrix3::new(0.3, -0.2, 0.5, 0.7, 0.1, -0.4, 0.2, 0.6, -0.8);
            if mesh.dimension == 2 {
                gradient.row_mut(2).fill(0.0);
                gradient.column_mut(2).fill(0.0);
            }
            let exact = volume * density(gradient);
            assert!(volume > 0.0);
            assert!((energy(&mesh, |x| gradient * x) - exact).abs() < 1e-13 * exact);
        }
    }

    /// The strain of a quadratic field is linear, so three Gauss points of another rule (1/6, 1/6, 2/3) integrate exactly.
    #[test]
    fn energy_of_a_quadratic_field_is_exact() {
        let mesh = cell(2, ElementKind::P2);
        let volume = Element::new(&mesh, mesh.cell(0)).volume;
        let field = |p: Vector3<f64>| {
            let (x, y) = (p.x, p.y);
            Vector3::new(x * x - 0.7 * x * y + y, 0.4 * y * y + 0.3 * x * y - x, 0.0)
        };
        let gradient = |p: Vector3<f64>| {
            let (x, y) = (p.x, p.y);
            let (ux, uy) = (2.0 * x - 0.7 * y, 1.0 - 0.7 * x);
            let (vx, vy) = (0.3 * y - 1.0, 0.8 * y + 0.3 * x);
            Matrix3::new(ux, uy, 0.0, vx, vy, 0.0, 0.0, 0.0, 0.0)
        };
        let corners = [0, 1, 2].map(|i| point(&mesh, i));
        let exact: f64 = (0..3)
            .map(|i| {
                let at = corners.iter().sum::<Vector3<f64>>() / 6.0 + corners[i] / 2.0;
                volume / 3.0 * density(gradient(at))
            })
            .sum();
        assert!((energy(&mesh, field) - exact).abs() < 1e-13 * exact);
    }

    #[test]
    fn shape_functions_are_a_partition_of_unity_and_nodal() {
        for mesh in cells() {
            let cell = mesh.cell(0);
            let element = Element::new(&mesh, cell);
            for (_, gradients) in element.points() {
                assert!(gradients.iter().sum::<Vector3<f64>>().norm() < 1e-14);
            }
            assert!((element.integrals().sum::<f64>() - element.volume).abs() < 1e-15);
            let simplex = Simplex::new(&mesh, cell);
            for node in 0..cell.len() {
                let at = simplex.barycentric(&mesh, cell, mesh.nodes[node]);
                let values = shape_values(cell.len(), at);
                for (i, value) in values.iter().enumerate().take(cell.len()) {
                    assert!((value - f64::from(u8::from(i == node))).abs() < 1e-14);
                }
            }
        }
    }
}
