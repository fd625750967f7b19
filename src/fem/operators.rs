//! The viscosity matrix A and the elasticity matrix B on one shared sparse pattern.
//!
//! Both are symmetric; the lower triangle is kept in compressed columns: column j has the rows
//! `row_idx[col_ptr[j]..col_ptr[j + 1]]`, ascending, the first one j itself. An entry that vanishes in one matrix or both
//! (decoupled components) keeps its place, so that `c A + d B` has the same pattern, and one symbolic factorization, for all c, d.

use super::cell::Cell;
use super::dofs::DofMap;
use super::forms::Forms;
use crate::linalg::add_scaled;
use crate::mesh::Mesh;
use nalgebra::Matrix3;

/// A and B, `n x n`: lower triangles in compressed columns on one pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct OperatorPair {
    /// Number of rows and columns.
    pub n: usize,
    /// First entry of each column, `n + 1` values.
    pub col_ptr: Vec<usize>,
    /// Row of each entry, ascending within a column, not less than the column.
    pub row_idx: Vec<usize>,
    /// Entries of A (viscosity), N s/m (2D: per metre of depth).
    pub a: Vec<f64>,
    /// Entries of B (elasticity), N/m (2D: per metre of depth).
    pub b: Vec<f64>,
    /// Branches of the memory, ascending in their relaxation times. Default: none.
    pub memory: Vec<BranchOperator>,
}

/// One branch of the memory: `C (u - q)`, `q' = (u - q) / tau`.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchOperator {
    /// Relaxation time, s.
    pub tau: f64,
    /// Entries of C, N/m (2D: per metre of depth).
    pub c: Vec<f64>,
}

/// The coupling of one column node with one row node, summed over the cells they share.
struct Coupling {
    first: usize,
    node: u32,
    blocks: [Matrix3<f64>; 2],
}

impl OperatorPair {
    /// Assembles both matrices from the forms of A and B in every cell of the mesh.
    ///
    /// Works node column by node column, gathering the cells around the node: no list of element entries has to be sorted,
    /// and the order of every sum is that of the cells, so that equal input gives equal bits.
    pub fn from_elements(mesh: &Mesh, dofs: &DofMap, forms: &Forms) -> OperatorPair {
        let (start, around) = cells_around(mesh);
        let n = dofs.len();
        let estimate = n * mesh.element.row_entries;
        let mut pair = OperatorPair {
            n,
            col_ptr: Vec::with_capacity(n + 1),
            row_idx: Vec::with_capacity(estimate),
            a: Vec::with_capacity(estimate),
            b: Vec::with_capacity(estimate),
            memory: Vec::new(),
        };
        pair.col_ptr.push(0);

        const ABSENT: u32 = u32::MAX;
        let mut place = vec![ABSENT; mesh.nodes.len()];
        let mut couplings: Vec<Coupling> = Vec::new();
        for column in column_order(mesh, dofs) {
            let columns = dofs.range(column);
            couplings.clear();
            let range = start[column as usize]..start[column as usize + 1];
            for &(cell, local) in &around[range] {
                let nodes = mesh.cell(cell as usize);
                let shapes = Cell::new(mesh, nodes);
                let forms = forms.of(cell as usize);
                for (i, &node) in nodes.iter().enumerate() {
                    let node = mesh.leader[node as usize];
                    let rows = dofs.range(node);
                    // Clamped, or above the diagonal: the transposed block is gathered with the other column.
                    if rows.is_empty() || rows.start < columns.start {
                        continue;
                    }
                    let slot = &mut place[node as usize];
                    if *slot == ABSENT {
                        *slot = couplings.len() as u32;
                        couplings.push(Coupling {
                            first: rows.start,
                            node,
                            blocks: [Matrix3::zeros(); 2],
                        });
                    }
                    let sum = &mut couplings[*slot as usize].blocks;
                    let [block_a, block_b] = shapes.blocks(i, local as usize, &forms);
                    sum[0] += block_a;
                    sum[1] += block_b;
                }
            }
            for coupling in &mut couplings {
                place[coupling.node as usize] = ABSENT;
                coupling.turn(dofs, column);
            }
            couplings.sort_unstable_by_key(|coupling| coupling.first);
            pair.push_columns(dofs, columns.start, columns.len(), &couplings);
        }
        pair.fill_held(dofs);
        pair
    }

    /// Contact components along which rollers hold their node have no entries: they take those of another component of the node, or of
    /// the body where it has none.
    fn fill_held(&mut self, dofs: &DofMap) {
        let is_held = |axis: &[f64; 3]| *axis == [0.0; 3];
        let parts = |node: u32| dofs.range(node).zip(dofs.frame(node));
        let free = |node: u32| parts(node).find(|(_, axis)| !is_held(axis));
        for &node in dofs.contact_nodes() {
            for (dof, _) in parts(node).filter(|(_, axis)| is_held(axis)) {
                let others = || dofs.contact_nodes().iter().find_map(|other| free(*other));
                let other = match (free(node), dofs.contact_start()) {
                    (Some((own, _)), _) => Some(own),
                    (None, 0) => others().map(|(dof, _)| dof),
                    (None, _) => Some(0),
                };
                if let Some(other) = other {
                    let (at, from) = (self.col_ptr[dof], self.col_ptr[other]);
                    self.a[at] = self.a[from];
                    self.b[at] = self.b[from];
                }
            }
        }
    }

    fn push_columns(&mut self, dofs: &DofMap, first: usize, count: usize, couplings: &[Coupling]) {
        for l in 0..count {
            for coupling in couplings {
                for (k, row) in dofs.range(coupling.node).enumerate() {
                    if row >= first + l {
                        self.row_idx.push(row);
                        self.a.push(coupling.blocks[0][(k, l)]);
                        self.b.push(coupling.blocks[1][(k, l)]);
                    }
                }
            }
            self.col_ptr.push(self.row_idx.len());
        }
    }

    /// Writes the entries of `ca A + cb B`, with the memory eliminated, `+ sum_j ca cb tau_j / (ca tau_j + cb) C_j` (same pattern),
    /// to `out`, which has the length of `a`.
    pub fn combine(&self, ca: f64, cb: f64, out: &mut [f64]) {
        debug_assert_eq!(out.len(), self.a.len());
        for ((out, a), b) in out.iter_mut().zip(&self.a).zip(&self.b) {
            *out = ca * a + cb * b;
        }
        for branch in &self.memory {
            let weight = ca * branch.lag_weight(ca, cb) * cb;
            if weight != 0.0 {
                add_scaled(out, weight, &branch.c);
            }
        }
    }

    /// Writes the derivative of [`OperatorPair::combine`] at the shift `(c, d)` along `(by_c, by_d)` to `out`.
    pub fn combine_slope(&self, (c, d): (f64, f64), (by_c, by_d): (f64, f64), out: &mut [f64]) {
        for ((out, a), b) in out.iter_mut().zip(&self.a).zip(&self.b) {
            *out = by_c * a + by_d * b;
        }
        for branch in &self.memory {
            let scale = c * branch.tau + d;
            let (of_c, of_d) = (d / scale, c * branch.tau / scale);
            let weight = by_c * branch.tau * of_c * of_c + by_d * of_d * of_d;
            add_scaled(out, weight, &branch.c);
        }
    }

    /// `y = K x` for the symmetric matrix K whose lower triangle has the entries `values` on this pattern.
    pub fn apply(&self, values: &[f64], x: &[f64], y: &mut [f64]) {
        self.apply_rows(values, x.as_chunks::<1>().0, y.as_chunks_mut::<1>().0);
    }

    /// `y = K x` for N columns at once, given row by row.
    pub fn apply_rows<const N: usize>(&self, values: &[f64], x: &[[f64; N]], y: &mut [[f64; N]]) {
        debug_assert_eq!(values.len(), self.row_idx.len());
        debug_assert_eq!((x.len(), y.len()), (self.n, self.n));
        y.fill([0.0; N]);
        let add = |to: &mut [f64; N], value: f64, from: &[f64; N]| {
            for (to, from) in to.iter_mut().zip(from) {
                *to += value * from;
            }
        };
        for (j, (rows, values)) in self.columns(values).enumerate() {
            let xj = &x[j];
            let mut sum = [0.0; N];
            for (&i, &value) in rows.iter().zip(values) {
                if i == j {
                    add(&mut sum, value, xj);
                } else {
                    add(&mut y[i], value, xj);
                    add(&mut sum, value, &x[i]);
                }
            }
            add(&mut y[j], 1.0, &sum);
        }
    }

    /// `y += factor K x` for the symmetric matrix K whose lower triangle has the entries `values` on this pattern.
    pub fn add_product(&self, factor: f64, values: &[f64], x: &[f64], y: &mut [f64]) {
        debug_assert_eq!((values.len(), x.len()), (self.row_idx.len(), self.n));
        for (j, (rows, values)) in self.columns(values).enumerate() {
            let own = factor * x[j];
            let mut sum = 0.0;
            for (&i, &value) in rows.iter().zip(values) {
                if i == j {
                    sum += value * x[j];
                } else {
                    y[i] += value * own;
                    sum += value * x[i];
                }
            }
            y[j] += factor * sum;
        }
    }

    /// `x . K x` for the symmetric matrix K whose lower triangle has the entries `values` on this pattern, without allocation.
    pub fn square(&self, values: &[f64], x: &[f64]) -> f64 {
        debug_assert_eq!((values.len(), x.len()), (self.row_idx.len(), self.n));
        let mut sum = 0.0;
        for (j, (rows, values)) in self.columns(values).enumerate() {
            for (&i, &value) in rows.iter().zip(values) {
                let twice = if i == j { 1.0 } else { 2.0 };
                sum += twice * value * x[i] * x[j];
            }
        }
        sum
    }

    /// `(x . A y, x . B y)` in one pass, without allocation.
    pub fn product(&self, x: &[f64], y: &[f64]) -> (f64, f64) {
        debug_assert_eq!((x.len(), y.len()), (self.n, self.n));
        let (mut sum_a, mut sum_b) = (0.0, 0.0);
        for j in 0..self.n {
            let range = self.col_ptr[j]..self.col_ptr[j + 1];
            for at in range {
                let i = self.row_idx[at];
                let weight = if i == j {
                    x[j] * y[j]
                } else {
                    x[i] * y[j] + x[j] * y[i]
                };
                sum_a += self.a[at] * weight;
                sum_b += self.b[at] * weight;
            }
        }
        (sum_a, sum_b)
    }

    /// `(x - y) . K (x - y)` for the symmetric matrix K whose lower triangle has the entries `values` on this pattern.
    pub fn square_of_difference(&self, values: &[f64], x: &[f64], y: &[f64]) -> f64 {
        debug_assert_eq!((values.len(), x.len()), (self.row_idx.len(), self.n));
        let mut sum = 0.0;
        for (j, (rows, values)) in self.columns(values).enumerate() {
            let own = x[j] - y[j];
            for (&i, &value) in rows.iter().zip(values) {
                let twice = if i == j { 1.0 } else { 2.0 };
                sum += twice * value * (x[i] - y[i]) * own;
            }
        }
        sum
    }

    fn columns<'s>(&'s self, values: &'s [f64]) -> impl Iterator<Item = (&'s [usize], &'s [f64])> {
        self.col_ptr.windows(2).map(move |ends| {
            let range = ends[0]..ends[1];
            (&self.row_idx[range.clone()], &values[range])
        })
    }
}

impl BranchOperator {
    /// `tau / (c tau + d)`: what a shift `(c, d)` leaves of a lag `u - q`, s; a stage with the implicit weight theta k is the shift
    /// `(1, theta k)`. At the two ends, where nothing is left of the branch in the operator, 0 beside an infinite time is 0.
    pub fn lag_weight(&self, c: f64, d: f64) -> f64 {
        self.tau / (c * self.tau + d)
    }
}

impl Coupling {
    /// Turns the blocks from global axes into the frames of the two nodes.
    fn turn(&mut self, dofs: &DofMap, column: u32) {
        if !dofs.is_turned(self.node) && !dofs.is_turned(column) {
            return;
        }
        // A frame lists its directions: as a matrix by rows it takes global components to local ones.
        let rows = |node| Matrix3::from(*dofs.frame(node)).transpose();
        let (left, right) = (rows(self.node), rows(column).transpose());
        for block in &mut self.blocks {
            *block = left * *block * right;
        }
    }
}

/// Nodes with free components, ascending in their numbers.
fn column_order(mesh: &Mesh, dofs: &DofMap) -> impl Iterator<Item = u32> {
    let is_inner = |node: &u32| {
        mesh.leader[*node as usize] == *node
            && dofs.contact_index(*node).is_none()
            && !dofs.range(*node).is_empty()
    };
    (0..mesh.nodes.len() as u32)
        .filter(is_inner)
        .chain(dofs.contact_nodes().iter().copied())
}

/// For every leader the cells around it and its place in each, in the order of the cells: compressed rows.
fn cells_around(mesh: &Mesh) -> (Vec<usize>, Vec<(u32, u8)>) {
    let mut start = vec![0; mesh.nodes.len() + 1];
    for &node in &mesh.cell_nodes {
        start[mesh.leader[node as usize] as usize + 1] += 1;
    }
    for i in 1..start.len() {
        start[i] += start[i - 1];
    }
    let mut next = start.clone();
    let mut around = vec![(0, 0); mesh.cell_nodes.len()];
    for (c, cell) in mesh.cells().enumerate() {
        for (local, &node) in cell.iter().enumerate() {
            let at = &mut next[mesh.leader[node as usize] as usize];
            around[*at] = (c as u32, local as u8);
            *at += 1;
        }
    }
    (start, around)
}
