//! A factor where a few nodes do something else by now: its matrix with rows and columns taken out, put in and replaced.
//!
//! The matrix M of the factor gets a border, with a number y for every row or column that is not what it was:
//!
//! ```text
//! M x + C y = b          taken out    C = e_i   R = e_i^T          x_i = 0, and y takes the place of the equation
//! R x + D y = c          replaced     C = e_i   R = the new row    y takes the place of the old equation
//!                        put in       C, R, D from the new column and row; y is the new unknown
//! ```
//!
//! so a solve is one with M, a few products and one with the small matrix `D - R M^-1 C`. The columns `M^-1 C` are remembered;
//! each is a function of the factor and of one change, so remembering never changes a result.

use super::entries::{Entries, Unknown, fill, own, reduce};
use super::problem::PressedProblem;
use crate::linalg::{DenseLu, add_scaled, dot};

/// Most rows and columns of a border.
const LARGEST: usize = 16;
/// A border has at most this share of the order of the matrix: beyond it a factorization is as cheap.
const SHARE: usize = 4;

/// Most rows and columns of the border of a matrix of this order.
pub(super) fn largest(order: usize) -> usize {
    LARGEST.min(order / SHARE)
}

/// What becomes of an unknown of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Change {
    Out(Unknown),
    Replaced(Unknown),
    In(Unknown),
}

/// Calls `f` with the changes of a node from one set of entries to another.
pub(super) fn changes(components: usize, old: Entries, new: Entries, mut f: impl FnMut(Change)) {
    for kind in [Unknown::Along, Unknown::Across, Unknown::Normal] {
        match (old.has(components, kind), new.has(components, kind)) {
            (true, false) => f(Change::Out(kind)),
            (false, true) => f(Change::In(kind)),
            (true, true) if old.has_same_row(new, kind) => {}
            // the column of a slip rate in space depends on its direction
            (true, true) if components == 2 && kind != Unknown::Normal => {
                f(Change::Out(kind));
                f(Change::In(kind));
            }
            (true, true) => f(Change::Replaced(kind)),
            (false, false) => {}
        }
    }
}

/// How many rows and columns the changes of a node take.
pub(super) fn count_changes(components: usize, old: Entries, new: Entries) -> usize {
    let mut count = 0;
    changes(components, old, new, |_| count += 1);
    count
}

/// A row and column of the border.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// Takes the unknown at this place out.
    Out(usize),
    /// Replaces the row at this place.
    Replaced(usize),
    /// A new unknown.
    In(usize, Unknown),
}

/// What a remembered column is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Column {
    Unit(usize),
    Of(usize, Unknown),
}

/// The factored matrix, and what its rows are made of.
pub(super) struct Inner<'a> {
    pub lu: &'a DenseLu,
    pub unknowns: &'a [(usize, Unknown)],
    /// Entries of the nodes, one after the other.
    pub nodes: &'a [f64],
}

/// The border of one factor.
pub(super) struct Border {
    /// Entries of the nodes that the border was made for.
    nodes: Vec<f64>,
    is_made: bool,
    places: Vec<Place>,
    /// Memory of every row and column of the border.
    slots: [usize; LARGEST],
    remembered: [Option<Column>; LARGEST],
    /// `M^-1 C`, a column per slot.
    columns: Vec<f64>,
    /// R, a row per place.
    rows: Vec<f64>,
    stride: usize,
    small: DenseLu,
    values: Vec<f64>,
    forces: Vec<f64>,
    /// Solves with the factor for columns made so far.
    pub solves: u64,
}

impl Border {
    /// For matrices up to the order `len`, and as many entries of nodes.
    pub fn new(len: usize, entries: usize) -> Border {
        let stride = DenseLu::padded(len);
        Border {
            nodes: vec![0.0; entries],
            is_made: false,
            places: Vec::with_capacity(LARGEST),
            slots: [0; LARGEST],
            remembered: [None; LARGEST],
            columns: vec![0.0; LARGEST * stride],
            rows: vec![0.0; LARGEST * stride],
            stride,
            small: DenseLu::new(LARGEST),
            values: vec![0.0; DenseLu::padded(LARGEST)],
            forces: vec![0.0; len],
            solves: 0,
        }
    }

    /// Forgets everything: the factor is another one.
    pub fn clear(&mut self) {
        self.is_made = false;
        self.places.clear();
        self.remembered = [None; LARGEST];
    }

    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// Whether the border does not keep the row at a place of the factor.
    pub fn drops_row(&self, at: usize) -> bool {
        self.places
            .iter()
            .any(|place| matches!(place, Place::Out(i) | Place::Replaced(i) if *i == at))
    }

    /// Right-hand sides of the border, then its unknowns.
    pub fn values(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Makes the border for nodes with the entries that `now` writes, no more than [`LARGEST`] changes; false where the matrix is
    /// singular.
    pub fn make(
        &mut self,
        problem: &PressedProblem,
        inner: &Inner,
        mut now: impl FnMut(usize, &mut [f64]),
    ) -> bool {
        let len = inner.nodes.len() / problem.nodes();
        let mut is_same = self.is_made;
        for (node, entries) in self.nodes.chunks_exact_mut(len).enumerate() {
            let mut new = [0.0; 8];
            now(node, &mut new[..len]);
            is_same &= entries
                .iter()
                .zip(&new)
                .all(|(a, b)| a.to_bits() == b.to_bits());
            entries.copy_from_slice(&new[..len]);
        }
        if !is_same {
            self.set_places(problem, inner, len);
            self.set_columns(problem, inner, len);
            self.is_made = self.factor(problem, inner, len);
        }
        self.is_made
    }

    fn set_places(&mut self, problem: &PressedProblem, inner: &Inner, len: usize) {
        let Border { nodes, places, .. } = self;
        places.clear();
        let mut at = 0;
        for node in 0..problem.nodes() {
            let range = node * len..(node + 1) * len;
            let old = Entries::new(&inner.nodes[range.clone()]);
            let new = Entries::new(&nodes[range]);
            let own = inner.unknowns[at..].iter().take_while(|u| u.0 == node);
            let count = own.clone().count();
            let place = |kind| at + own.clone().take_while(|u| u.1 != kind).count();
            changes(problem.components, old, new, |change| {
                places.push(match change {
                    Change::Out(kind) => Place::Out(place(kind)),
                    Change::Replaced(kind) => Place::Replaced(place(kind)),
                    Change::In(kind) => Place::In(node, kind),
                });
            });
            at += count;
        }
    }

    /// Finds the columns that are remembered, and solves for the others.
    fn set_columns(&mut self, problem: &PressedProblem, inner: &Inner, len: usize) {
        let c = problem.components;
        let column_of = |place: &Place| match *place {
            Place::Out(at) | Place::Replaced(at) => Column::Unit(at),
            Place::In(node, kind) => Column::Of(node, kind),
        };
        let is_reusable = |column: Column| {
            c == 1 || !matches!(column, Column::Of(_, kind) if kind != Unknown::Normal)
        };
        let mut is_taken = [false; LARGEST];
        let mut is_found = [false; LARGEST];
        for (i, place) in self.places.iter().enumerate() {
            let column = column_of(place);
            let known = self
                .remembered
                .iter()
                .position(|known| *known == Some(column));
            if let Some(slot) = known.filter(|_| is_reusable(column)) {
                (self.slots[i], is_found[i], is_taken[slot]) = (slot, true, true);
            }
        }
        for (i, place) in self.places.iter().enumerate() {
            if is_found[i] {
                continue;
            }
            let slot = is_taken.iter().position(|taken| !taken).unwrap_or(0);
            is_taken[slot] = true;
            let column = column_of(place);
            (self.slots[i], self.remembered[slot]) = (slot, Some(column));
            let x = &mut self.columns[slot * self.stride..][..inner.lu.padded_order()];
            x.fill(0.0);
            match column {
                Column::Unit(at) => x[at] = 1.0,
                Column::Of(node, kind) => {
                    let entries = Entries::new(&self.nodes[node * len..][..len]);
                    fill(problem, entries, node, kind, &mut self.forces);
                    for (x, &(row, row_kind)) in x.iter_mut().zip(inner.unknowns) {
                        let entries = Entries::new(&inner.nodes[row * len..][..len]);
                        *x = reduce(problem, entries, row, row_kind, &self.forces);
                    }
                }
            }
            self.solves += 1;
            inner.lu.solve(x);
        }
    }

    /// Makes the rows and the small matrix, and factors that.
    fn factor(&mut self, problem: &PressedProblem, inner: &Inner, len: usize) -> bool {
        let Border {
            nodes,
            places,
            slots,
            columns,
            rows,
            stride,
            small,
            forces,
            ..
        } = self;
        let c = problem.components;
        let order = inner.unknowns.len();
        let at = |node: usize| Entries::new(&nodes[node * len..][..len]);
        let mut corner = [[0.0; LARGEST]; LARGEST];
        for (p, place) in places.iter().enumerate() {
            let row = &mut rows[p * *stride..][..order];
            let (node, kind) = match *place {
                Place::Out(i) => {
                    row.fill(0.0);
                    row[i] = 1.0;
                    continue;
                }
                Place::Replaced(i) => inner.unknowns[i],
                Place::In(node, kind) => (node, kind),
            };
            set_row(problem, at(node), node, kind, forces);
            for (entry, &(column, column_kind)) in row.iter_mut().zip(inner.unknowns) {
                let entries = Entries::new(&inner.nodes[column * len..][..len]);
                *entry = along(problem, entries, column, column_kind, forces);
            }
            if let Place::Replaced(i) = *place {
                row[i] += own(at(node), kind, c);
            }
            for (q, other) in places.iter().enumerate() {
                if let Place::In(column, column_kind) = *other {
                    corner[q][p] = along(problem, at(column), column, column_kind, forces);
                    if p == q {
                        corner[q][p] += own(at(node), kind, c);
                    }
                }
            }
        }
        small.factor(places.len(), |q, column| {
            let z = &columns[slots[q] * *stride..][..order];
            for (p, entry) in column.iter_mut().enumerate() {
                *entry = corner[q][p] - dot(&rows[p * *stride..][..order], z);
            }
        })
    }

    /// From the solution `x` with the factor to that with the border; right-hand sides in `values`, which become the unknowns of
    /// the border.
    pub fn solve(&mut self, x: &mut [f64], order: usize) {
        let count = self.places.len();
        let values = &mut self.values[..self.small.padded_order()];
        values[count..].fill(0.0);
        for (p, value) in values[..count].iter_mut().enumerate() {
            *value -= dot(&self.rows[p * self.stride..][..order], &x[..order]);
        }
        self.small.solve(values);
        for (value, slot) in values[..count].iter().zip(&self.slots) {
            let column = &self.columns[slot * self.stride..][..order];
            add_scaled(&mut x[..order], -value, column);
        }
        for place in &self.places {
            if let Place::Out(i) = *place {
                x[i] = 0.0;
            }
        }
    }
}

/// The row of an unknown over all components: S is symmetric, so rows of it are columns.
fn set_row(
    problem: &PressedProblem,
    entries: Entries,
    node: usize,
    kind: Unknown,
    row: &mut [f64],
) {
    let first = problem.at(node).start;
    row.fill(0.0);
    let mut add = |factor: f64, i: usize| {
        if factor != 0.0 {
            add_scaled(row, factor, problem.column(i));
        }
    };
    match (kind, problem.components) {
        (Unknown::Normal, c) => add(1.0, first + c),
        (_, 1) => {
            add(1.0, first);
            add(entries.by_force(), first + 1);
        }
        (kind, _) => {
            let [x, y] = entries.direction();
            let [x, y] = match kind {
                Unknown::Across => [-y, x],
                _ => [x, y],
            };
            add(x, first);
            add(y, first + 1);
            if kind == Unknown::Along {
                add(entries.by_force(), first + 2);
            }
        }
    }
}

/// A row over all components, for a unit of an unknown.
fn along(
    problem: &PressedProblem,
    entries: Entries,
    node: usize,
    kind: Unknown,
    row: &[f64],
) -> f64 {
    let row = &row[problem.at(node)];
    match (kind, problem.components) {
        (Unknown::Normal, c) => row[c],
        (_, 1) => row[0],
        (kind, _) => {
            let ([x, y], [share, _]) = (entries.direction(), entries.turn());
            match kind {
                Unknown::Across => share * (x * row[1] - y * row[0]),
                _ => x * row[0] + y * row[1],
            }
        }
    }
}
