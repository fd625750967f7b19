//! P7: finite elements of a bar (0, 1), held at 0, with friction at 1.
//!
//! ```text
//! sigma = a w_x + b int w_x,   -sigma_x = f0,   w(0) = 0,   f2 - sigma = g(|w|) sgn w at x = 1
//! w = cos t (x + sin(pi x)/2),   g(r) = 0.4 exp(-r) + 0.2,   a = 1,   b = 2
//! ```
//!
//! X has the inner product `int u_x v_x`, so that m = L = a, alpha = b, and beta is the steepest fall of g: `|v(1)| <= |v|`.

use crate::qvi::{
    Coefficients, HistoryOperator, Inequality, Kernel, LinearPhi, Matrix, Part, Quadrature,
    Settings, SolveError, Solver, Space, SparseSymmetric, solve,
};
use nalgebra::DVector;
use std::f64::consts::PI;

const A: f64 = 1.0;
const B: f64 = 2.0;

/// The bar on cells of equal length.
pub struct Bar {
    cells: usize,
    pub problem: Inequality,
}

fn bound(r: f64) -> f64 {
    0.4 * (-r).exp() + 0.2
}

impl Bar {
    /// # Errors
    /// [`SolveError::Value`] for no cell.
    pub fn new(cells: usize) -> Result<Bar, SolveError> {
        if cells == 0 {
            return Err(SolveError::Value {
                what: "cells of the bar".to_owned(),
                found: 0.0,
                allowed: "1 or more",
            });
        }
        let h = 1.0 / cells as f64;
        // unknowns at x = h, 2h, ..., 1
        let (mut col_ptr, mut row_idx, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..cells {
            let is_last = j + 1 == cells;
            row_idx.push(j);
            values.push(if is_last { 1.0 } else { 2.0 } / h);
            if !is_last {
                row_idx.push(j + 1);
                values.push(-1.0 / h);
            }
            col_ptr.push(row_idx.len());
        }
        let stiffness = Matrix::Sparse(SparseSymmetric::new(col_ptr, row_idx, values)?);
        let multiple = |factor: f64| stiffness.plus(factor - 1.0, &stiffness);
        let shape = DVector::from_fn(cells, |i, _| {
            let x = (i + 1) as f64 * h;
            x + (PI * x).sin() / 2.0
        });
        // interpolation is orthogonal in this inner product, so these are the exact loads
        let forces = stiffness.apply(&shape);
        let load = move |t: f64| {
            let mut f = &forces * (A * t.cos() + B * t.sin());
            f[cells - 1] += bound(t.cos());
            f
        };
        let space = Space::with_product(stiffness.clone())?;
        let mut problem = Inequality::new(space, multiple(A), load);
        problem.histories = vec![HistoryOperator::new(
            Kernel::constant(1.0),
            DVector::zeros(cells),
        )];
        problem.phi = Box::new(LinearPhi(vec![Some(multiple(B))]));
        problem.parts = vec![Part::friction(cells - 1..cells)];
        problem.j = Box::new(Coefficients::new(
            0.4,
            move |at: &[DVector<f64>], c: &mut [f64]| c[0] += bound(at[0][cells - 1].abs()),
        ));
        Ok(Bar { cells, problem })
    }

    /// `|w_x - (w_h)_x|` in L2 at the time t.
    pub fn error_at(&self, w: &DVector<f64>, t: f64) -> f64 {
        // Gauss points and weights of degree 9 on (-1, 1)
        const POINTS: [(f64, f64); 5] = [
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.906_179_845_938_664, 0.236_926_885_056_189_08),
            (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
        ];
        let h = 1.0 / self.cells as f64;
        let mut sum = 0.0;
        for cell in 0..self.cells {
            let left = if cell == 0 { 0.0 } else { w[cell - 1] };
            let slope = (w[cell] - left) / h;
            for (point, weight) in POINTS {
                let x = (cell as f64 + 0.5 * (point + 1.0)) * h;
                let exact = t.cos() * (1.0 + PI * (PI * x).cos() / 2.0);
                sum += weight * 0.5 * h * (exact - slope).powi(2);
            }
        }
        sum.sqrt()
    }

    /// Largest of these errors over the points of N steps on `[0, 1]`.
    ///
    /// # Errors
    /// Those of [`solve`].
    pub fn error(&self, rule: &Quadrature, steps: usize) -> Result<f64, SolveError> {
        let settings = Settings::new(Solver::Direct);
        let run = solve(&self.problem, rule, (1.0, steps), settings)?;
        let errors = run.times.iter().zip(&run.u);
        let errors = errors.map(|(t, u)| self.error_at(u, *t));
        Ok(errors.fold(0.0, f64::max))
    }
}
