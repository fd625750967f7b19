//! What laws add to the linear operators of a body: forces, potential and tangents of the excess of every cell whose law is not
//! linear.
//!
//! ```text
//! C_A(w) = sum over points  weight B^T psi_A(|dev eps(w)|) dev eps(w)       and C_B(u) alike
//! ```
//!
//! The operators A and B of the body are those of the lower tangents, so that a stage is `A w + B u + C_A(w) + C_B(u) + E Lambda = F`
//! with all four parts monotone. A cell is kept as its unknowns (a free component and its direction), the gradients of its shape
//! functions at the points of integration, and the places of its pairs of unknowns in the sparse pattern: a linearisation
//! needs no mesh.
//!
//! Where the body starts displaced, displacements are relative to that, and the laws see the whole.
//!
//! The tangents belong to a *point*: the velocities of the unknowns whose viscosity is not linear, and the displacements of those
//! whose elasticity is not.

mod assembly;
mod bytes;
mod points;

use crate::material::{Excess, ExcessPoint};
use nalgebra::Vector6;
pub use points::{points_len, take_point};

/// Viscosity and elasticity among the operators.
pub const VISCOUS: usize = 0;
pub const ELASTIC: usize = 1;

/// What both laws of a material add to their forms.
pub type Laws = [Option<Excess>; 2];

/// The cells in which a law is not linear.
pub struct Nonlinear {
    /// Of every material of the scene.
    laws: Vec<Laws>,
    cells: Vec<NonlinearCell>,
    /// Unknowns of the cells, one cell after the other.
    unknowns: Vec<Unknown>,
    /// Directions of unknowns.
    axes: Vec<[f64; 3]>,
    /// Points of integration and nodes of a cell.
    points: usize,
    nodes: usize,
    /// Weights of the points, m^2 or m^3.
    weights: Vec<f64>,
    /// Gradients of the shape functions at the points, node by node, 1/m.
    gradients: Vec<[f64; 3]>,
    /// Entry of the lower triangle of every pair of unknowns of a cell, row by row up to the diagonal.
    places: Vec<u32>,
    /// Unknowns, ascending, in cells whose viscosity or elasticity is not linear.
    touched: [Vec<u32>; 2],
    /// Free components of the body.
    len: usize,
    /// The displacement that the body starts with, by free components, which displacements are relative to; empty for none.
    start: Vec<f64>,
    /// Energy that the laws store there beyond that of B, J.
    start_potential: f64,
}

/// A cell.
#[derive(Debug, Clone, Copy, PartialEq)]
struct NonlinearCell {
    /// Its material, by its place in the scene.
    material: u32,
    /// Its unknowns: from here to the first of the next cell.
    first: u32,
    /// First place of its pairs.
    pairs: usize,
    /// Factors of A and B there.
    factors: [f64; 2],
}

/// One component of the motion of a node of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Unknown {
    dof: u32,
    node: u16,
    /// Its direction.
    axis: u32,
}

/// What the visitor of points sees.
struct Place<'a> {
    excess: &'a Excess,
    /// Weight of the point times the factor of the cell.
    weight: f64,
    unknowns: &'a [Unknown],
    gradients: &'a [[f64; 3]],
    axes: &'a [[f64; 3]],
    /// First place of the pairs of the cell.
    pairs: usize,
    /// The field that others are relative to; empty for none.
    start: &'a [f64],
}

impl Place<'_> {
    /// Strain by a unit of an unknown.
    #[inline(always)]
    fn shape(&self, unknown: &Unknown) -> Vector6<f64> {
        let g = &self.gradients[usize::from(unknown.node)];
        let a = &self.axes[unknown.axis as usize];
        Vector6::new(
            g[0] * a[0],
            g[1] * a[1],
            g[2] * a[2],
            g[1] * a[2] + g[2] * a[1],
            g[0] * a[2] + g[2] * a[0],
            g[0] * a[1] + g[1] * a[0],
        )
    }

    /// Strain of a field.
    fn strain(&self, x: &[f64]) -> Vector6<f64> {
        let mut strain = Vector6::zeros();
        for unknown in self.unknowns {
            strain += self.shape(unknown) * x[unknown.dof as usize];
        }
        strain
    }

    fn at(&self, x: &[f64]) -> ExcessPoint {
        let own = self.strain(x);
        match self.start {
            [] => self.excess.at(&own),
            start => self.excess.at(&(own + self.strain(start))),
        }
    }

    /// Adds the forces of a stress.
    fn add(&self, stress: &Vector6<f64>, out: &mut [f64]) {
        for unknown in self.unknowns {
            out[unknown.dof as usize] += self.weight * self.shape(unknown).dot(stress);
        }
    }
}

impl Nonlinear {
    /// Visits the points at which the viscosity or the elasticity is not linear.
    fn visit(&self, which: usize, mut see: impl FnMut(Place)) {
        let ends = self.cells.iter().skip(1).map(|cell| cell.first as usize);
        let ends = ends.chain([self.unknowns.len()]);
        for (i, (cell, end)) in self.cells.iter().zip(ends).enumerate() {
            let Some(excess) = &self.laws[cell.material as usize][which] else {
                continue;
            };
            for at in i * self.points..(i + 1) * self.points {
                see(Place {
                    excess,
                    weight: self.weights[at] * cell.factors[which],
                    unknowns: &self.unknowns[cell.first as usize..end],
                    gradients: &self.gradients[at * self.nodes..(at + 1) * self.nodes],
                    axes: &self.axes,
                    pairs: cell.pairs,
                    start: match which {
                        ELASTIC => &self.start,
                        _ => &[],
                    },
                });
            }
        }
    }

    /// Adds the forces of one operator in the field `x`, N, to `out`; returns its potential.
    pub fn add_forces(&self, which: usize, x: &[f64], out: &mut [f64]) -> f64 {
        let mut potential = 0.0;
        self.visit(which, |place| {
            let found = place.at(x);
            potential += place.weight * found.potential;
            place.add(&found.stress, out);
        });
        potential
    }

    /// What a displacement from the start stores beyond the energy of B and that of the start, J.
    pub fn stored(&self, displacement: &[f64]) -> f64 {
        self.energy(displacement) - self.start_potential
    }

    /// Energy that the laws store at the start beyond that of B, J.
    pub fn start_potential(&self) -> f64 {
        self.start_potential
    }

    fn energy(&self, displacement: &[f64]) -> f64 {
        let mut energy = 0.0;
        self.visit(ELASTIC, |place| {
            energy += place.weight * place.at(displacement).potential;
        });
        energy
    }

    /// Free components of the body.
    pub fn len(&self) -> usize {
        self.len
    }

    /// The displacement that the body starts with, by free components.
    fn set_start(&mut self, start: Vec<f64>) {
        if self.bends(ELASTIC) && !start.is_empty() {
            self.start = start;
            self.start_potential = self.energy(&vec![0.0; self.len]);
        }
    }

    /// Adds the tangent of one operator in the field `at`, times `along`, to `out`.
    pub fn add_slopes(&self, which: usize, at: &[f64], along: &[f64], out: &mut [f64]) {
        self.visit(which, |place| {
            let stress = place.at(at).tangent() * place.strain(along);
            place.add(&stress, out);
        });
    }

    /// Adds the entries of the tangent of one operator in the field `at`, times `scale`, to `out` (lower triangle).
    fn add_tangent(&self, which: usize, at: &[f64], scale: f64, out: &mut [f64]) {
        self.visit(which, |place| {
            let tangent = place.at(at).tangent() * (scale * place.weight);
            let mut entry = place.pairs;
            for (i, row) in place.unknowns.iter().enumerate() {
                let stress = tangent * place.shape(row);
                for (j, column) in place.unknowns[..=i].iter().enumerate() {
                    let value = stress.dot(&place.shape(column));
                    // two unknowns of one number (a cell that meets itself through a periodic side) are both orders of a pair
                    let both = i != j && row.dof == column.dof;
                    out[self.places[entry] as usize] += if both { 2.0 * value } else { value };
                    entry += 1;
                }
            }
        });
    }

    /// The entries of `T_A(w) + theta_k T_B(u)` on the pattern of the operators.
    pub fn tangent(&self, theta_k: f64, [w, u]: [&[f64]; 2], out: &mut [f64]) {
        out.fill(0.0);
        self.add_tangent(VISCOUS, w, 1.0, out);
        if theta_k > 0.0 {
            self.add_tangent(ELASTIC, u, theta_k, out);
        }
    }

    /// Numbers of a point.
    pub fn point_len(&self) -> usize {
        self.touched.iter().map(Vec::len).sum()
    }

    /// The point of a velocity and a displacement.
    pub fn gather(&self, fields: [&[f64]; 2], point: &mut [f64]) {
        let dofs = self.touched.iter().zip(fields);
        let values = dofs.flat_map(|(dofs, field)| dofs.iter().map(|dof| field[*dof as usize]));
        for (to, value) in point.iter_mut().zip(values) {
            *to = value;
        }
    }

    /// A velocity and a displacement that have this point; what the laws do not look at is left as it is.
    pub fn scatter(&self, point: &[f64], fields: [&mut [f64]; 2]) {
        let mut values = point.iter();
        for (dofs, field) in self.touched.iter().zip(fields) {
            for (dof, value) in dofs.iter().zip(&mut values) {
                field[*dof as usize] = *value;
            }
        }
    }

    /// Whether the viscosity or the elasticity is not linear anywhere.
    pub fn bends(&self, which: usize) -> bool {
        !self.touched[which].is_empty()
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let word = std::mem::size_of::<f64>();
        let halves = self.places.len() + self.touched.iter().map(Vec::len).sum::<usize>();
        word * (self.weights.len() + 3 * (self.gradients.len() + self.axes.len()) + halves / 2)
            + std::mem::size_of_val(&self.cells[..])
            + std::mem::size_of_val(&self.unknowns[..])
    }
}
