//! Sparse Cholesky of a symmetric matrix whose last dofs (the contact) are eliminated last.
//!
//! With `K = L L^T` and the trailing dofs kept last, the factor holds the whole contact problem: eliminating the
//! interior alone turns a load into the condensed load, the trailing block is a factor of the condensed operator, and
//! the substitution back starts from the contact velocities. One forward and one backward pass are a step.

use super::dense::mirror_lower;
use super::ordering::nested_dissection;
use super::reordered::Reordered;
use crate::error::{Error, Result};
use dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::perm::PermRef;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
    supernodal::{
        SupernodalLltRef, SymbolicSupernodalCholesky, factorize_supernodal_numeric_llt,
        factorize_supernodal_numeric_llt_scratch,
    },
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Accum, Conj, Mat, MatMut, Par, Side};

/// Symbolic factorization, shared by all matrices on one pattern; the numbers of a factor live with the caller.
pub struct SparseCholesky {
    symbolic: SymbolicCholesky<usize>,
    /// Position in the factor -> dof.
    order: Vec<usize>,
    trailing: usize,
    /// The matrix in the order of the factor: once for all that are factored.
    reordered: Reordered,
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
    /// [`Error::Body`] when the order is not a permutation or the factor would not fit into memory.
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
                what: format!("the fill-reducing ordering of {n} unknowns is not a permutation"),
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
            reordered: Reordered::new(col_ptr, row_idx, &inverse),
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
        let factoring = factorize_supernodal_numeric_llt_scratch::<usize, f64>(
            self.supernodes(),
            Par::Seq,
            Default::default(),
        );
        MemBuffer::new(StackReq::or(
            factoring.and(StackReq::new::<f64>(self.reordered.from.len())),
            self.symbolic
                .solve_in_place_scratch::<f64>(columns, Par::Seq),
        ))
    }

    /// Factors the matrix with the given lower-triangle values, on the pattern that was analysed, into `factor` (of length
    /// [`SparseCholesky::len`]).
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`] naming `what`.
    pub fn factor(
        &self,
        what: &'static str,
        values: &[f64],
        factor: &mut [f64],
        scratch: &mut MemBuffer,
    ) -> Result<()> {
        let Reordered {
            col_ptr,
            row_idx,
            from,
        } = &self.reordered;
        assert_eq!(values.len(), from.len());
        let stack = MemStack::new(scratch);
        let (values, stack) = stack.make_with(from.len(), |at| values[from[at]]);
        let n = self.order.len();
        let pattern = SymbolicSparseColMatRef::new_unsorted_checked(n, n, col_ptr, None, row_idx);
        let matrix = SparseColMatRef::new(pattern, &values);
        factorize_supernodal_numeric_llt(
            factor,
            matrix,
            Default::default(),
            self.supernodes(),
            Par::Seq,
            stack,
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

    /// Lower Cholesky factor of the condensed operator of the trailing dofs.
    pub fn trailing_factor(&self, factor: &[f64]) -> Mat<f64> {
        let mut lower = Mat::<f64>::zeros(self.trailing, self.trailing);
        self.copy_trailing(factor, lower.as_mut());
        lower
    }

    /// The same into the lower triangle of `lower`.
    fn copy_trailing(&self, factor: &[f64], mut lower: MatMut<f64>) {
        let interior = self.interior();
        lower.fill(0.0);
        let l = SupernodalLltRef::new(self.supernodes(), factor);
        for at in 0..self.supernodes().n_supernodes() {
            let node = l.supernode(at);
            let (start, columns) = (node.start(), node.val().ncols());
            for j in interior.saturating_sub(start)..columns {
                let rows = (start + j..start + columns).chain(node.pattern().iter().copied());
                for (row, l) in rows.zip(node.val().col(j).iter().skip(j)) {
                    lower[(row - interior, start + j - interior)] = *l;
                }
            }
        }
    }

    /// Condensed operator of the trailing dofs: the product of the trailing block of the factor with its transpose.
    pub fn condensed(&self, factor: &[f64], out: MatMut<f64>) {
        let mut lower = Mat::<f64>::zeros(self.trailing, self.trailing);
        self.condensed_with(factor, lower.as_mut(), out);
    }

    /// The same with `lower` as scratch, of the shape of `out`.
    pub fn condensed_with(&self, factor: &[f64], mut lower: MatMut<f64>, out: MatMut<f64>) {
        self.copy_trailing(factor, lower.rb_mut());
        let lower = lower.rb();
        let mut out = out;
        matmul(
            out.rb_mut(),
            BlockStructure::TriangularLower,
            Accum::Replace,
            lower,
            BlockStructure::TriangularLower,
            lower.transpose(),
            BlockStructure::TriangularUpper,
            1.0,
            Par::Seq,
        );
        mirror_lower(out);
    }

    pub(super) fn supernodes(&self) -> &SymbolicSupernodalCholesky<usize> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("the supernodal layout is forced in `with_order`");
        };
        symbolic
    }

    /// Dofs before the trailing ones.
    pub(super) fn interior(&self) -> usize {
        self.order.len() - self.trailing
    }
}

fn pattern<'a>(col_ptr: &'a [usize], row_idx: &'a [usize]) -> SymbolicSparseColMatRef<'a, usize> {
    let n = col_ptr.len() - 1;
    SymbolicSparseColMatRef::new_checked(n, n, col_ptr, None, row_idx)
}
