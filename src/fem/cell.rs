//! The geometry of a cell and the gradients of its shape functions.
//!
//! Gradients are sums over the barycentric gradients, with the derivatives of the element's table as coefficients. The plane case
//! lives in three components with vanishing z: the code has one path, and the z unknowns never get numbers. Cells with bent sides
//! are isoparametric: gradients go through the Jacobian at every point of integration. Straight cells keep exact integrals.

use super::bent::{self, Points};
use crate::element::{Barycentric, Element, MOST_NODES};
use crate::material::{Form, GradientPair};
use crate::mesh::{Bent, Mesh};
use nalgebra::{Matrix3, Vector3};

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
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    element: &'static Element,
    simplex: Simplex,
    /// What a cell with bent sides has instead of the simplex.
    bent: Option<Box<Points>>,
}

impl Cell {
    /// The cell with these node numbers.
    pub fn new(mesh: &Mesh, cell: &[u32]) -> Cell {
        let element = mesh.element;
        let bent = Bent::new(mesh, cell).map(|bent| Box::new(Points::new(element, bent)));
        Cell {
            element,
            simplex: Simplex::new(mesh, cell),
            bent,
        }
    }

    /// Whether its sides are bent.
    pub fn is_bent(&self) -> bool {
        self.bent.is_some()
    }

    /// Area (m^2) or volume (m^3); not positive for a cell that is mirrored, flat, or turned inside out by its sides.
    pub fn volume(&self) -> f64 {
        match &self.bent {
            None => self.simplex.volume,
            Some(points) => {
                let [least, _] = points.bent.determinants();
                if least > 0.0 {
                    points.bent.measure()
                } else {
                    least
                }
            }
        }
    }

    /// Barycentric coordinates of a point of space with respect to the cell; `None` where a bent cell has none, far away.
    pub fn barycentric(&self, mesh: &Mesh, cell: &[u32], at: [f64; 3]) -> Option<Barycentric> {
        let straight = self.simplex.barycentric(mesh, cell, at);
        match &self.bent {
            None => Some(straight),
            Some(points) => points.bent.barycentric(Vector3::from(at), straight),
        }
    }

    /// Gradient of the shape function of a node at barycentric coordinates, 1/m.
    pub fn gradient(&self, node: usize, at: &Barycentric) -> Vector3<f64> {
        if let Some(points) = &self.bent {
            return bent::gradient(self.element, &points.bent.jacobian(at), node, at);
        }
        let slopes = (self.element.slopes)(node, at);
        let mut gradient = Vector3::zeros();
        for (slope, own) in slopes.iter().zip(&self.simplex.gradients) {
            // most vanish, and a flat cell has no finite gradients
            if *slope != 0.0 {
                gradient += own * *slope;
            }
        }
        gradient
    }

    /// Points that integrate products of two gradients, exactly in a straight cell: weight (m^2 or m^3) and gradients of the shape
    /// functions, zero where the cell has no such node.
    pub fn points(&self) -> impl Iterator<Item = (f64, [Vector3<f64>; MOST_NODES])> {
        let weight = self.weight();
        let (bent, straight) = match &self.bent {
            Some(points) => (&points.all[..], &[][..]),
            None => (&[][..], self.element.points),
        };
        let straight = straight.iter().map(move |at| {
            let mut gradients = [Vector3::zeros(); MOST_NODES];
            for (node, gradient) in gradients.iter_mut().take(self.element.nodes).enumerate() {
                *gradient = self.gradient(node, at);
            }
            (weight, gradients)
        });
        bent.iter().copied().chain(straight)
    }

    /// Points that integrate what is no polynomial: those of a bent cell, also in a straight one. All weights are positive.
    pub fn bent_points(&self) -> Vec<(f64, [Vector3<f64>; MOST_NODES])> {
        if self.bent.is_some() || self.element.bent_points.is_empty() {
            return self.points().collect();
        }
        let of_point = |(at, share): &(Barycentric, f64)| {
            let mut gradients = [Vector3::zeros(); MOST_NODES];
            for (node, gradient) in gradients.iter_mut().take(self.element.nodes).enumerate() {
                *gradient = self.gradient(node, at);
            }
            (self.simplex.volume * share, gradients)
        };
        self.element.bent_points.iter().map(of_point).collect()
    }

    /// Blocks (3 x 3, row of node `a`, column of node `b`, global axes) of the element matrices of two forms.
    pub fn blocks(&self, a: usize, b: usize, forms: &[Form; 2]) -> [Matrix3<f64>; 2] {
        let mut sums = [Matrix3::zeros(); 2];
        if let Some(points) = &self.bent {
            for (weight, gradients) in &points.all {
                let pair = GradientPair::new(&gradients[a], &gradients[b]);
                for (sum, form) in sums.iter_mut().zip(forms) {
                    form.add_block(sum, &pair, *weight);
                }
            }
            return sums;
        }
        let weight = self.weight();
        for at in self.element.points {
            let pair = GradientPair::new(&self.gradient(a, at), &self.gradient(b, at));
            for (sum, form) in sums.iter_mut().zip(forms) {
                form.add_block(sum, &pair, weight);
            }
        }
        sums
    }

    /// Integral of each shape function over the cell, m^2 or m^3.
    pub fn integrals(&self) -> impl Iterator<Item = f64> {
        let volume = self.simplex.volume;
        let (element, bent) = (self.element, self.bent.as_deref());
        let shares = element.integrals.iter().enumerate();
        shares.map(move |(node, share)| match bent {
            None => share.of(volume),
            Some(points) => {
                let values = element.bent_points.iter().zip(&points.all);
                values
                    .map(|((at, _), (weight, _))| weight * (element.shape)(node, at))
                    .sum()
            }
        })
    }

    /// Weight of every point of integration of a straight cell.
    fn weight(&self) -> f64 {
        self.simplex.volume / self.element.points.len() as f64
    }
}

/// Coordinates of a node.
pub(super) fn point(mesh: &Mesh, node: u32) -> Vector3<f64> {
    Vector3::from(mesh.nodes[node as usize])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::{ELEMENTS, ElementKind, linear};

    fn cell(element: &Element) -> Mesh {
        let nodes = [
            [0.1, 0.2, 0.0],
            [1.3, -0.1, 0.0],
            [0.4, 0.9, 0.0],
            [0.3, 0.5, 1.1],
        ];
        let corners: Vec<u32> = (0..element.corners() as u32).collect();
        let nodes = nodes[..element.corners()].to_vec();
        let mesh = Mesh::new(linear(element.dimension), nodes, corners.clone(), corners);
        mesh.for_element(element.kind).unwrap()
    }

    /// The test cell of every element.
    fn cells() -> Vec<Mesh> {
        ELEMENTS.iter().map(cell).collect()
    }

    const LAMBDA: f64 = 1.7;
    const TWO_MU: f64 = 0.9;
    const FORM: Form = Form::Isotropic {
        lambda: LAMBDA,
        two_mu: TWO_MU,
    };

    fn energy(mesh: &Mesh, field: impl Fn(Vector3<f64>) -> Vector3<f64>) -> f64 {
        let element = Cell::new(mesh, mesh.cell(0));
        let mut energy = 0.0;
        for a in 0..mesh.nodes.len() {
            for b in 0..mesh.nodes.len() {
                let [block, _] = element.blocks(a, b, &[FORM; 2]);
                let (u, v) = (point(mesh, a as u32), point(mesh, b as u32));
                energy += field(u).dot(&(block * field(v)));
            }
        }
        energy
    }

    fn density(gradient: Matrix3<f64>) -> f64 {
        let strain = (gradient + gradient.transpose()) / 2.0;
        LAMBDA * strain.trace() * strain.trace() + TWO_MU * strain.norm_squared()
    }

    #[test]
    fn energy_of_a_linear_field_is_exact() {
        for mesh in cells() {
            let volume = Simplex::new(&mesh, mesh.cell(0)).volume;
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

    /// The strain of a quadratic field is linear and its energy density quadratic: the middles of the edges and the corners
    /// fix it (`int l_i (2 l_i - 1)`, `int 4 l_i l_j`).
    #[test]
    fn energy_of_a_quadratic_field_is_exact() {
        for mesh in cells().iter().filter(|m| m.element.kind == ElementKind::P2) {
            let d = mesh.dimension;
            let volume = Simplex::new(mesh, mesh.cell(0)).volume;
            let z = if d == 3 { 1.0 } else { 0.0 };
            let field = |p: Vector3<f64>| {
                let (x, y) = (p.x, p.y);
                Vector3::new(
                    x * x - 0.7 * x * y + y + 0.3 * p.z * x,
                    0.4 * y * y + 0.3 * x * y - x - 0.6 * p.z * p.z,
                    z * (0.8 * p.z * y - 0.2 * x * x),
                )
            };
            let gradient = |p: Vector3<f64>| {
                let (x, y) = (p.x, p.y);
                Matrix3::new(
                    2.0 * x - 0.7 * y + 0.3 * p.z,
                    1.0 - 0.7 * x,
                    z * 0.3 * x,
                    0.3 * y - 1.0,
                    0.8 * y + 0.3 * x,
                    z * -1.2 * p.z,
                    z * -0.4 * x,
                    z * 0.8 * p.z,
                    z * 0.8 * y,
                )
            };
            let corners: Vec<_> = (0..=d as u32).map(|i| point(mesh, i)).collect();
            // 2/((d+1)(d+2)) l_i^2 and half of it l_i l_j, times the volume; l_i alone 1/(d+1)
            let [square, one] = [2.0 / ((d + 1) * (d + 2)) as f64, 1.0 / (d + 1) as f64];
            let mut exact = 0.0;
            for i in 0..=d {
                exact += volume * (2.0 * square - one) * density(gradient(corners[i]));
                for j in 0..i {
                    let at = (corners[i] + corners[j]) / 2.0;
                    exact += volume * 2.0 * square * density(gradient(at));
                }
            }
            assert!((energy(mesh, field) - exact).abs() < 1e-13 * exact);
        }
    }

    #[test]
    fn gradients_are_those_of_the_shape_functions() {
        for mesh in cells() {
            let nodes = mesh.cell(0);
            let (cell, simplex) = (Cell::new(&mesh, nodes), Simplex::new(&mesh, nodes));
            assert!((cell.integrals().sum::<f64>() - simplex.volume).abs() < 1e-15);
            for (_, gradients) in cell.points() {
                assert!(gradients.iter().sum::<Vector3<f64>>().norm() < 1e-14);
            }
            let at = [0.5, 0.4, if mesh.dimension == 3 { 0.2 } else { 0.0 }];
            let value = |node: usize, at: [f64; 3]| {
                (mesh.element.shape)(node, &simplex.barycentric(&mesh, nodes, at))
            };
            for node in 0..nodes.len() {
                let place = simplex.barycentric(&mesh, nodes, at);
                let gradient = cell.gradient(node, &place);
                for axis in 0..mesh.dimension {
                    let shifted = |by: f64| {
                        let mut to = at;
                        to[axis] += by;
                        value(node, to)
                    };
                    // exact for polynomials of degree 2
                    let difference = (shifted(0.25) - shifted(-0.25)) / 0.5;
                    assert!((difference - gradient[axis]).abs() < 1e-13);
                }
                let own = mesh.nodes[nodes[node] as usize];
                assert!((value(node, own) - 1.0).abs() < 1e-14);
            }
        }
    }
}
