//! Finite elements as tables: one file per element, one line each in the list below.
//!
//! All elements are simplices. With the barycentric coordinates `l_i` of a cell, which are linear in the position, a shape
//! function is a polynomial in the `l_i`, and its gradient is `sum_j (dN/dl_j) grad l_j`. So a table needs neither a reference
//! cell nor a Jacobian while cells have straight sides, with midside nodes in the middle of their edges. Bent cells have both
//! (`crate::mesh`), and points of integration of their own (`rules`).
//!
//! What is not here: the geometry of a cell (`crate::fem`), the numbering of nodes (`crate::mesh`).

mod rules;
mod tet10;
mod tet4;
mod tri3;
mod tri6;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// All elements. A new one is its table and a line here.
const TABLES: &[Element] = &[tri3::TABLE, tri6::TABLE, tet4::TABLE, tet10::TABLE];

/// All elements.
pub static ELEMENTS: &[Element] = TABLES;

/// Most nodes of a cell.
pub const MOST_NODES: usize = {
    let (mut most, mut i) = (0, 0);
    while i < TABLES.len() {
        if TABLES[i].nodes > most {
            most = TABLES[i].nodes;
        }
        i += 1;
    }
    most
};

/// Barycentric coordinates of a point of a cell; the first `dimension + 1` are in use.
pub type Barycentric = [f64; 4];

/// Finite element.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ElementKind {
    /// Linear simplex, in 2D and 3D.
    #[default]
    P1,
    /// Quadratic simplex, in 2D and 3D, with straight sides unless a mesh file bends them: about four (eight) times the unknowns of `p1` on
    /// the same cells, and errors of the next order wherever the solution is smooth. In 2D vertices and midside nodes are contact nodes,
    /// in 3D the midside nodes.
    P2,
}

impl ElementKind {
    /// What a scene calls it.
    pub fn name(self) -> &'static str {
        match self {
            ElementKind::P1 => "p1",
            ElementKind::P2 => "p2",
        }
    }
}

/// One element.
#[derive(Debug)]
pub struct Element {
    /// Name; no two elements have the same.
    pub name: &'static str,
    /// What a scene calls it; the dimension of the mesh tells elements of one kind apart.
    pub kind: ElementKind,
    /// Space dimension, 2 or 3.
    pub dimension: usize,
    /// Polynomials up to this degree are in its space.
    pub order: usize,
    /// Nodes of a cell: `dimension + 1` corners, then the midside nodes.
    pub nodes: usize,
    /// For every midside node the two corners that it stands between. The order is that of VTK.
    pub midsides: &'static [[usize; 2]],
    /// Corners of the faces of a positively oriented cell. The outward normal of an edge `(p, q)` is to the right of `q - p`, that
    /// of a triangle `(p, q, r)` is along `(q - p) x (r - p)`.
    pub faces: &'static [&'static [usize]],
    /// For every midside node of a face the two corners of the face that it stands between; they follow its `dimension` corners.
    pub face_midsides: &'static [[usize; 2]],
    /// Points of equal weight that integrate products of two gradients exactly.
    pub points: &'static [Barycentric],
    /// Points that integrate over bent cells, with their shares of the measure; none for an element that has no bent ones.
    pub bent_points: &'static [(Barycentric, f64)],
    /// The same over bent faces.
    pub bent_face_points: &'static [(Barycentric, f64)],
    /// Shape function of a node.
    pub shape: fn(usize, &Barycentric) -> f64,
    /// Derivatives of the shape function of a node by the barycentric coordinates.
    pub slopes: fn(usize, &Barycentric) -> Barycentric,
    /// Integral of every shape function over the cell.
    pub integrals: &'static [Share],
    /// Integral of the shape function of every node of a face over the face.
    pub face_integrals: &'static [Share],
    /// Entries of the lower triangle of an operator per unknown, about.
    pub row_entries: usize,
    /// Type of the cell in VTK files.
    pub vtk: u8,
    /// Triangles that a plane cell is drawn as; none for a solid one.
    pub pieces: &'static [[usize; 3]],
    /// What it may do on a contact part.
    pub contact: OnContact,
}

/// An integral as a share of the measure of the cell or face: `measure * times / over`.
#[derive(Debug, Clone, Copy)]
pub struct Share {
    /// Numerator.
    pub times: f64,
    /// Denominator.
    pub over: f64,
}

impl Share {
    /// A share of the measure.
    pub const fn new(times: f64, over: f64) -> Share {
        Share { times, over }
    }

    /// The share of this measure.
    pub fn of(self, measure: f64) -> f64 {
        measure * self.times / self.over
    }
}

/// What an element may do on a contact part.
#[derive(Debug)]
pub enum OnContact {
    /// Friction acts at every node of a face, with the integral of its shape function as weight.
    Nodes {
        /// Shape function of a node of the face at barycentric coordinates of the face: how velocities go.
        shape: fn(usize, &[f64]) -> f64,
        /// Linear interpolation between the neighbouring nodes of the face: how stresses go.
        between: fn(usize, &[f64]) -> f64,
    },
    /// Friction and pressure act at the midside nodes of a face alone, each with the share of the midpoint rule: the integral of the
    /// shape function of a vertex vanishes.
    Midsides,
}

impl PartialEq for Element {
    fn eq(&self, other: &Element) -> bool {
        self.name == other.name
    }
}

impl Element {
    /// Nodes of a face: its corners, then its midside nodes.
    pub fn face_nodes(&self) -> usize {
        self.dimension + self.face_midsides.len()
    }

    /// Shape function of a node of a face at barycentric coordinates of the face.
    pub fn face_shape(&self, node: usize, at: &Barycentric) -> f64 {
        match self.face_midsides {
            [] => linear_shape(node, at),
            midsides => quadratic_shape(self.dimension, midsides, node, at),
        }
    }

    /// Derivatives of the shape function of a node of a face by the barycentric coordinates of the face.
    pub fn face_slopes(&self, node: usize, at: &Barycentric) -> Barycentric {
        match self.face_midsides {
            [] => linear_slopes(node, at),
            midsides => quadratic_slopes(self.dimension, midsides, node, at),
        }
    }

    /// Corners of a cell.
    pub fn corners(&self) -> usize {
        self.dimension + 1
    }

    /// Nodes along an edge of the body that is cut into this many cells.
    pub fn nodes_along(&self, cells: u32) -> u64 {
        self.order as u64 * u64::from(cells) + 1
    }

    /// Whether friction acts at every node of a face.
    pub fn has_contact_at_all_nodes(&self) -> bool {
        matches!(self.contact, OnContact::Nodes { .. })
    }
}

/// The element of a kind in 2 or 3 dimensions; `None` where there is none.
pub fn of(kind: ElementKind, dimension: usize) -> Option<&'static Element> {
    ELEMENTS
        .iter()
        .find(|e| e.kind == kind && e.dimension == dimension)
}

/// The linear element of a dimension, which has the corners of a cell alone; triangles for a dimension that is not 3.
pub fn linear(dimension: usize) -> &'static Element {
    let is_linear = |e: &&Element| e.dimension == dimension && e.midsides.is_empty();
    ELEMENTS.iter().find(is_linear).unwrap_or(&ELEMENTS[0])
}

/// The elements whose contact fields are those of all nodes of a face, in the order of the list: what studies choose from.
pub fn with_contact(dimension: usize) -> impl Iterator<Item = &'static Element> {
    ELEMENTS
        .iter()
        .filter(move |e| e.dimension == dimension && e.has_contact_at_all_nodes())
}

/// Shape function `l_node`.
fn linear_shape(node: usize, at: &Barycentric) -> f64 {
    at[node]
}

fn linear_slopes(node: usize, _at: &Barycentric) -> Barycentric {
    let mut slopes = [0.0; 4];
    slopes[node] = 1.0;
    slopes
}

/// `l (2 l - 1)` at a corner, `4 l_i l_j` at a midside node.
fn quadratic_shape(corners: usize, midsides: &[[usize; 2]], node: usize, at: &Barycentric) -> f64 {
    match node.checked_sub(corners) {
        None => at[node] * (2.0 * at[node] - 1.0),
        Some(midside) => {
            let [i, j] = midsides[midside];
            4.0 * at[i] * at[j]
        }
    }
}

fn quadratic_slopes(
    corners: usize,
    midsides: &[[usize; 2]],
    node: usize,
    at: &Barycentric,
) -> Barycentric {
    let mut slopes = [0.0; 4];
    match node.checked_sub(corners) {
        None => slopes[node] = 4.0 * at[node] - 1.0,
        Some(midside) => {
            let [i, j] = midsides[midside];
            (slopes[i], slopes[j]) = (4.0 * at[j], 4.0 * at[i]);
        }
    }
    slopes
}

/// The same in the shape of a face and of what lies between its corners.
fn linear_face(node: usize, at: &[f64]) -> f64 {
    at[node]
}

#[cfg(test)]
mod tests;
