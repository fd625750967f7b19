//! Substitutions with a supernodal factor whose last dofs are left out, several right-hand sides at once.
//!
//! A pass moves the factor through the memory once, whatever the number of right-hand sides, and COLUMNS of it at a time
//! through the rows of the right-hand sides: these are read and written once per COLUMNS.

use super::products::column;
use super::sparse::SparseCholesky;
use faer::MatRef;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use pulp::{Arch, Simd, WithSimd};

/// Columns of a supernode that are taken together.
const COLUMNS: usize = 4;

impl SparseCholesky {
    /// Eliminates the interior from N loads at once, given row by row in the order of the factor.
    pub fn eliminate_rows<const N: usize>(&self, factor: &[f64], y: &mut [[f64; N]]) {
        Arch::new().dispatch(Elimination(Nodes::of(self, factor), y));
    }

    /// Substitutes back from the trailing rows of `y`, N columns at once, in the order of the factor.
    pub fn substitute_back_rows<const N: usize>(&self, factor: &[f64], y: &mut [[f64; N]]) {
        Arch::new().dispatch(BackSubstitution(Nodes::of(self, factor), y));
    }
}

struct Elimination<'a, const N: usize>(Nodes<'a>, &'a mut [[f64; N]]);

impl<const N: usize> WithSimd for Elimination<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Elimination(nodes, y) = self;
        for at in 0..nodes.len() {
            let node = nodes.get(at);
            for j in (0..node.whole).step_by(COLUMNS) {
                node.eliminate::<COLUMNS, N>(j, y);
            }
            for j in node.whole..node.eliminated {
                node.eliminate::<1, N>(j, y);
            }
        }
    }
}

struct BackSubstitution<'a, const N: usize>(Nodes<'a>, &'a mut [[f64; N]]);

impl<const N: usize> WithSimd for BackSubstitution<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let BackSubstitution(nodes, y) = self;
        for at in (0..nodes.len()).rev() {
            let node = nodes.get(at);
            for j in (0..node.whole).step_by(COLUMNS) {
                node.gather::<COLUMNS, N>(j, y);
            }
            for j in node.whole..node.eliminated {
                node.gather::<1, N>(j, y);
            }
            for j in (node.whole..node.eliminated).rev() {
                node.substitute_back::<1, N>(j, y);
            }
            for j in (0..node.whole).step_by(COLUMNS).rev() {
                node.substitute_back::<COLUMNS, N>(j, y);
            }
        }
    }
}

/// The supernodes of a factor.
struct Nodes<'a> {
    factor: SupernodalLltRef<'a, usize, f64>,
    /// Columns that are eliminated: the others are left out.
    interior: usize,
}

impl<'a> Nodes<'a> {
    fn of(cholesky: &'a SparseCholesky, factor: &'a [f64]) -> Nodes<'a> {
        Nodes {
            factor: SupernodalLltRef::new(cholesky.supernodes(), factor),
            interior: cholesky.interior(),
        }
    }

    fn len(&self) -> usize {
        self.factor.symbolic().n_supernodes()
    }

    #[inline(always)]
    fn get(&self, at: usize) -> Supernode<'a> {
        let node = self.factor.supernode(at);
        let columns = node.val().ncols();
        let eliminated = self.interior.saturating_sub(node.start()).min(columns);
        Supernode {
            values: node.val(),
            start: node.start(),
            pattern: node.pattern(),
            eliminated,
            whole: eliminated - eliminated % COLUMNS,
        }
    }
}

/// Columns of the factor with the same rows below their dense triangle.
struct Supernode<'a> {
    /// The triangle, then the rows of the pattern.
    values: MatRef<'a, f64>,
    start: usize,
    pattern: &'a [usize],
    /// Columns that are not left out, and how many of them make whole groups.
    eliminated: usize,
    whole: usize,
}

impl<'a> Supernode<'a> {
    /// The columns from `j` on, below row `j` of the triangle.
    #[inline(always)]
    fn columns<const K: usize>(&self, j: usize) -> [&'a [f64]; K] {
        std::array::from_fn(|a| &column(self.values, j + a)[j..])
    }

    #[inline(always)]
    fn eliminate<const K: usize, const N: usize>(&self, j: usize, y: &mut [[f64; N]]) {
        let first = self.start + j;
        // the load of a part of the boundary leaves most of the factor untouched
        if y[first..first + K].iter().all(|row| *row == [0.0; N]) {
            return;
        }
        let columns = self.columns::<K>(j);
        let mut pivots = [[0.0; N]; K];
        for a in 0..K {
            let row = &mut y[first + a];
            for b in 0..a {
                *row = less(*row, columns[b][a], pivots[b]);
            }
            pivots[a] = row.map(|value| value / columns[a][a]);
            *row = pivots[a];
        }
        let below = self.values.ncols() - j;
        for (i, row) in y[first + K..first + below].iter_mut().enumerate() {
            for a in 0..K {
                *row = less(*row, columns[a][K + i], pivots[a]);
            }
        }
        let rest = columns.map(|column| &column[below..][..self.pattern.len()]);
        for (i, &row) in self.pattern.iter().enumerate() {
            let row = &mut y[row];
            for a in 0..K {
                *row = less(*row, rest[a][i], pivots[a]);
            }
        }
    }

    /// What the rows of the pattern contribute to the columns, in the order in which these stand in the memory.
    #[inline(always)]
    fn gather<const K: usize, const N: usize>(&self, j: usize, y: &mut [[f64; N]]) {
        let (first, columns) = (self.start + j, self.columns::<K>(j));
        let mut sums: [[f64; N]; K] = std::array::from_fn(|a| y[first + a]);
        let below = self.values.ncols() - j;
        let rest = columns.map(|column| &column[below..][..self.pattern.len()]);
        for (i, &row) in self.pattern.iter().enumerate() {
            let row = y[row];
            sums = std::array::from_fn(|a| less(sums[a], rest[a][i], row));
        }
        y[first..first + K].copy_from_slice(&sums);
    }

    /// Substitutes back within the triangle.
    #[inline(always)]
    fn substitute_back<const K: usize, const N: usize>(&self, j: usize, y: &mut [[f64; N]]) {
        let (first, columns) = (self.start + j, self.columns::<K>(j));
        let mut sums: [[f64; N]; K] = std::array::from_fn(|a| y[first + a]);
        let below = self.values.ncols() - j;
        for (i, row) in y[first + K..first + below].iter().enumerate() {
            sums = std::array::from_fn(|a| less(sums[a], columns[a][K + i], *row));
        }
        for a in (0..K).rev() {
            for b in a + 1..K {
                sums[a] = less(sums[a], columns[a][b], sums[b]);
            }
            sums[a] = sums[a].map(|value| value / columns[a][a]);
        }
        y[first..first + K].copy_from_slice(&sums);
    }
}

/// `from - factor * x`.
#[inline(always)]
fn less<const N: usize>(from: [f64; N], factor: f64, x: [f64; N]) -> [f64; N] {
    std::array::from_fn(|n| from[n] - factor * x[n])
}
