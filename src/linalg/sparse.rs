//! Sparse Cholesky of a symmetric matrix whose last dofs (the contact) are eliminated last.
//!
//! With `K = L L^T` and the trailing dofs kept last, the factor holds the whole contact problem: eliminating the
//! interior alone turns a load into the condensed load, the trailing block is a factor of the condensed operator, and
//! the substitution back starts from the contact velocities. One forward and one backward pass are a step.

use super::dense::mirror_lower;
use super::ordering::nested_dissection;
use crate::error::{Error, Result};
use dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::perm::PermRef;
use faer::reborrow::ReborrowMut;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky, supernodal::SupernodalLltRef,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Accum, Conj, Mat, MatMut, Par, Side};

/// Symbolic factorization, shared by all matrices on one pattern; the numbers of a factor live with the caller.
pub struct SparseCholesky {
    symbolic: SymbolicCholesky<usize>,
    /// Position in the factor -> dof.
    order: Vec<usize>,
    trailing: usize,
}

impl SparseCholesky {
    /// Analyses the pattern (lower triangle by columns, of order `col_ptr.len() - 1`). The dofs with a place (coordinates of
    /// their nodes) are eliminated in an order of nested dissection, the trailing ones after them in their own order.
    ///
    /// # Errors
    /// [`Error::Body`] when the factor would not fit into memory.
    pub fn new(
        col_ptr: &[usize],
        row_idx: &[usize],
        places: &[[f64; 3]],
    ) -> Result<SparseCholesky> {
        let mut order = nested_dissection(col_ptr, row_idx, places);
        order.extend(places.len()..col_ptr.len() - 1);
        SparseCholesky::with_order(col_ptr, row_idx, order, col_ptr.len() - 1 - places.len())
    }

    /// Analyses the pattern for the elimination `order` (position -> dof), whose last `trailing` entries are the contact.
    ///
    /// # Errors
    /// [`Error::Body`] when the order is none or the factor would not fit into memory.
    pub fn with_order(
        col_ptr: &[usize],
        row_idx: &[usize],
        order: Vec<usize>,
        trailing: usize,
    ) -> Result<SparseCholesky> {
        let n = col_ptr.len() - 1;
        let mut inverse = vec![usize::MAX; n];
        for (at, &dof) in order.iter().enumerate() {
            if let Some(place) = inverse.get_mut(dof) {
                *place = at;
            }
        }
        let is_permutation = order.len() == n && inverse.iter().all(|&at| at != usize::MAX);
        if !is_permutation || trailing > n {
            return Err(Error::Body {
                what: format!("the elimination order of {n} dofs is none"),
            });
        }
        let symbolic = factorize_symbolic_cholesky(
            pattern(col_ptr, row_idx),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&order, &inverse, n)),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .map_err(|e| Error::Body {
            what: format!("the sparse factor of {n} dofs cannot be laid out ({e:?})"),
        })?;
        Ok(SparseCholesky {
            symbolic,
            order,
            trailing,
        })
    }

    /// Elimination order: position in the factor -> dof.
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// Length of the numbers of one factor.
    pub fn len(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Whether there is nothing to factor.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Scratch for factoring and for solving with up to `columns` right-hand sides.
    pub fn scratch(&self, columns: usize) -> MemBuffer {
        MemBuffer::new(StackReq::or(
            self.symbolic
                .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()),
            self.symbolic
                .solve_in_place_scratch::<f64>(columns, Par::Seq),
        ))
    }

    /// Factors the matrix with the given lower-triangle values into `factor` (of length [`SparseCholesky::len`]).
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`] naming `what`.
    pub fn factor(
        &self,
        what: &'static str,
        (col_ptr, row_idx): (&[usize], &[usize]),
        values: &[f64],
        factor: &mut [f64],
        scratch: &mut MemBuffer,
    ) -> Result<()> {
        let matrix = SparseColMatRef::new(pattern(col_ptr, row_idx), values);
        self.symbolic
            .factorize_numeric_llt(
                factor,
                matrix,
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(scratch),
                Default::default(),
            )
            .map(|_| ())
            .map_err(
                |LltError::NonPositivePivot { index }| Error::NotPositiveDefinite {
                    what,
                    pivot: index,
                },
            )
    }

    /// Solves in place, for every column of `rhs`.
    pub fn solve(&self, factor: &[f64], rhs: MatMut<f64>, scratch: &mut MemBuffer) {
        LltRef::new(&self.symbolic, factor).solve_in_place_with_conj(
            Conj::No,
            rhs,
            Par::Seq,
            MemStack::new(scratch),
        );
    }

    /// Eliminates the interior from the load `x` (by dofs) into `y` (in the order of the factor); the last entries of
    /// `y` are then the condensed load.
    pub fn eliminate(&self, factor: &[f64], x: &[f64], y: &mut [f64]) {
        self.reorder(x, y);
        self.eliminate_rows(factor, y.as_chunks_mut::<1>().0);
    }

    /// Substitutes back from the trailing values given in `y` (order of the factor); the solution goes to `x` (by dofs).
    pub fn substitute_back(&self, factor: &[f64], y: &mut [f64], x: &mut [f64]) {
        self.substitute_back_rows(factor, y.as_chunks_mut::<1>().0);
        self.restore(y, x);
    }

    /// Brings `x` (by dofs) into the order of the factor.
    pub fn reorder<T: Copy>(&self, x: &[T], y: &mut [T]) {
        for (y, &dof) in y.iter_mut().zip(&self.order) {
            *y = x[dof];
        }
    }

    /// Brings `y` (in the order of the factor) back into that of the dofs.
    pub fn restore<T: Copy>(&self, y: &[T], x: &mut [T]) {
        for (y, &dof) in y.iter().zip(&self.order) {
            x[dof] = *y;
        }
    }

    /// Eliminates the interior from N loads at once, given row by row in the order of the factor.
    pub fn eliminate_rows<const N: usize>(&self, factor: &[f64], y: &mut [[f64; N]]) {
        let interior = self.interior();
        self.for_columns(factor, false, |column, diagonal, same, pattern, below| {
            // the load of a part of the boundary leaves most of the factor untouched
            if column >= interior || y[column] == [0.0; N] {
                return;
            }
            let pivot = y[column].map(|value| value / diagonal);
            y[column] = pivot;
            let (block, rest) = below.split_at(same);
            let contiguous = &mut y[column + 1..column + 1 + same];
            for (y, l) in contiguous.iter_mut().zip(block) {
                subtract(y, *l, &pivot);
            }
            for (&row, l) in pattern.iter().zip(rest) {
                subtract(&mut y[row], *l, &pivot);
            }
        });
    }

    /// Substitutes back from the trailing rows of `y`, N columns at once, in the order of the factor.
    pub fn substitute_back_rows<const N: usize>(&self, factor: &[f64], y: &mut [[f64; N]]) {
        let interior = self.interior();
        self.for_columns(factor, true, |column, diagonal, same, pattern, below| {
            if column >= interior {
                return;
            }
            let (block, rest) = below.split_at(same);
            let mut sum = y[column];
            for (y, l) in y[column + 1..column + 1 + same].iter().zip(block) {
                subtract(&mut sum, *l, y);
            }
            for (&row, l) in pattern.iter().zip(rest) {
                subtract(&mut sum, *l, &y[row]);
            }
            y[column] = sum.map(|value| value / diagonal);
        });
    }

    /// Lower Cholesky factor of the condensed operator of the trailing dofs.
    pub fn trailing_factor(&self, factor: &[f64]) -> Mat<f64> {
        let interior = self.interior();
        let mut lower = Mat::<f64>::zeros(self.trailing, self.trailing);
        self.for_columns(factor, false, |column, diagonal, same, pattern, below| {
            let Some(j) = column.checked_sub(interior) else {
                return;
            };
            lower[(j, j)] = diagonal;
            let rows = (column + 1..column + 1 + same).chain(pattern.iter().copied());
            for (row, l) in rows.zip(below) {
                lower[(row - interior, j)] = *l;
            }
        });
        lower
    }

    /// Condensed operator of the trailing dofs: the product of the trailing block of the factor with its transpose.
    pub fn condensed(&self, factor: &[f64], out: MatMut<f64>) {
        let lower = self.trailing_factor(factor);
        let mut out = out;
        matmul(
            out.rb_mut(),
            BlockStructure::TriangularLower,
            Accum::Replace,
            &lower,
            BlockStructure::TriangularLower,
            lower.transpose(),
            BlockStructure::TriangularUpper,
            1.0,
            Par::Seq,
        );
        mirror_lower(out);
    }

    fn interior(&self) -> usize {
        self.order.len() - self.trailing
    }

    /// Calls `visit(column, diagonal, same, pattern, below)` for every column: of the entries `below` the diagonal the
    /// first `same` stand in the rows that follow directly, the others in the rows of `pattern`.
    fn for_columns(
        &self,
        factor: &[f64],
        is_reversed: bool,
        mut visit: impl FnMut(usize, f64, usize, &[usize], &[f64]),
    ) {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("the supernodal layout is forced in `new`");
        };
        let l = SupernodalLltRef::new(symbolic, factor);
        let count = symbolic.n_supernodes();
        for at in 0..count {
            let node = l.supernode(if is_reversed { count - 1 - at } else { at });
            let columns = node.val().ncols();
            for at in 0..columns {
                let j = if is_reversed { columns - 1 - at } else { at };
                let values = column_slice(node.val(), j);
                visit(
                    node.start() + j,
                    values[j],
                    columns - 1 - j,
                    node.pattern(),
                    &values[j + 1..],
                );
            }
        }
    }
}

/// `to -= factor * from`.
#[inline(always)]
fn subtract<const N: usize>(to: &mut [f64; N], factor: f64, from: &[f64; N]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to -= factor * from;
    }
}

/// A column of a column-major block as a slice.
fn column_slice(block: faer::MatRef<'_, f64>, j: usize) -> &[f64] {
    // the blocks of a factor are column-major by construction; an empty slice would be a change in faer's layout
    block
        .col(j)
        .try_as_col_major()
        .map_or(&[], |c| c.as_slice())
}

fn pattern<'a>(col_ptr: &'a [usize], row_idx: &'a [usize]) -> SymbolicSparseColMatRef<'a, usize> {
    let n = col_ptr.len() - 1;
    SymbolicSparseColMatRef::new_checked(n, n, col_ptr, None, row_idx)
}
