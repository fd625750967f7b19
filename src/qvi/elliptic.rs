//! The frozen inequality: find `u in K` such that for all `v in K`, with coefficients `c_i >= 0`,
//!
//! ```text
//! (T u - r) . (v - u) + sum_i c_i (rho_i(v_i) - rho_i(u_i)) >= 0
//! ```
//!
//! T a matrix: T is factored once. With E the components that parts and K touch, `C = E^T T^-1 E` and `w~ = E^T T^-1 r`,
//!
//! ```text
//! w = w~ - C Lambda,   Lambda in sum_i c_i d rho_i(w_i) + N_K(w),   u = T^-1 r - T^-1 E Lambda
//! ```
//!
//! is solved for w by Douglas-Rachford splitting, whose linear part is `(C + tau I) x = C z + tau w~`. It converges for every monotone
//! C, symmetric or not. Without touched components u is `T^-1 r`.
//!
//! T nonlinear: the contraction `u <- P(u - rho (T u - r))` with `rho = m / L^2`, which is how existence is proved; its factor is
//! `sqrt(1 - m^2 / L^2)`.

use super::matrix::Factor;
use super::prox::Nonsmooth;
use super::{Matrix, SolveError};
use nalgebra::{DMatrix, DVector, Dyn, LU};

const MOST_ITERATIONS: usize = 200_000;

/// A matrix T, factored, and condensed onto the components that are touched.
pub(super) struct Condensed {
    factor: Factor,
    touched: Vec<usize>,
    /// `T^-1 E`.
    columns: DMatrix<f64>,
    /// C.
    compliance: DMatrix<f64>,
    tau: f64,
    /// Of `C + tau I`.
    shifted: Option<LU<f64, Dyn, Dyn>>,
    dimension: usize,
}

impl Condensed {
    pub fn new(matrix: &Matrix, nonsmooth: Nonsmooth) -> Result<Condensed, SolveError> {
        let dimension = matrix.shape().0;
        let touched = nonsmooth.touched(dimension);
        let mut factor = Factor::new(matrix)?;
        let mut columns = DMatrix::zeros(dimension, touched.len());
        let mut unit = DVector::zeros(dimension);
        for (column, component) in touched.iter().enumerate() {
            unit.fill(0.0);
            unit[*component] = 1.0;
            factor.solve(&mut unit);
            columns.set_column(column, &unit);
        }
        let compliance = columns.select_rows(&touched);
        let (mut tau, mut shifted) = (0.0, None);
        if !touched.is_empty() {
            let values = compliance.singular_values();
            tau = (values.max() * values.min()).sqrt();
            let order = touched.len();
            let lu = (&compliance + DMatrix::from_diagonal_element(order, order, tau)).lu();
            shifted = Some(lu);
        }
        Ok(Condensed {
            factor,
            touched,
            columns,
            compliance,
            tau,
            shifted,
            dimension,
        })
    }

    /// Solves from a starting point.
    ///
    /// # Errors
    /// [`SolveError::InnerNotConverged`].
    pub fn solve(
        &mut self,
        r: &DVector<f64>,
        coefficients: &[f64],
        nonsmooth: Nonsmooth,
        start: &DVector<f64>,
        tolerance: f64,
    ) -> Result<DVector<f64>, SolveError> {
        let mut u = r.clone();
        self.factor.solve(&mut u);
        let Some(shifted) = &self.shifted else {
            return Ok(u);
        };
        let free = u.select_rows(&self.touched);
        let mut full = DVector::zeros(self.dimension);
        let mut prox = |z: &DVector<f64>| -> Result<DVector<f64>, SolveError> {
            for (component, z) in self.touched.iter().zip(z.iter()) {
                full[*component] = *z;
            }
            nonsmooth.prox(self.tau, coefficients, &mut full)?;
            Ok(full.select_rows(&self.touched))
        };
        let resolvent = |z: &DVector<f64>| {
            let mut x = &self.compliance * z + self.tau * &free;
            shifted.solve_mut(&mut x);
            x
        };
        let mut z = start.select_rows(&self.touched);
        for _ in 0..MOST_ITERATIONS {
            let x = resolvent(&z);
            let reflected = 2.0 * &x - &z;
            let y = prox(&reflected)?;
            let change = (&y - &x).amax();
            if change <= tolerance * y.amax().max(free.amax()).max(f64::MIN_POSITIVE) {
                // the force of the splitting belongs to y, and is that of the inequality
                let force = (reflected - &y) / self.tau;
                u -= &self.columns * force;
                // components at rest or on the boundary of K are so exactly
                for (component, y) in self.touched.iter().zip(y.iter()) {
                    u[*component] = *y;
                }
                return Ok(u);
            }
            z += y - x;
        }
        Err(SolveError::InnerNotConverged {
            change: f64::NAN,
            iterations: MOST_ITERATIONS,
        })
    }
}

/// The contraction for a nonlinear T with constants `[m, L]` in the coordinates.
///
/// # Errors
/// [`SolveError::InnerNotConverged`].
pub(super) fn contract(
    operator: impl Fn(&DVector<f64>) -> DVector<f64>,
    [m, l]: [f64; 2],
    r: &DVector<f64>,
    coefficients: &[f64],
    nonsmooth: Nonsmooth,
    start: &DVector<f64>,
    tolerance: f64,
) -> Result<DVector<f64>, SolveError> {
    let rho = m / (l * l);
    // where u vanishes the forces give the scale
    let scale = (rho * r.amax()).max(f64::MIN_POSITIVE);
    let mut u = start.clone();
    let mut change = f64::NAN;
    for _ in 0..MOST_ITERATIONS {
        let mut next = &u - rho * (operator(&u) - r);
        nonsmooth.prox(rho, coefficients, &mut next)?;
        change = (&next - &u).amax();
        u = next;
        if change <= tolerance * u.amax().max(scale) {
            return Ok(u);
        }
        if !change.is_finite() {
            break;
        }
    }
    Err(SolveError::InnerNotConverged {
        change,
        iterations: MOST_ITERATIONS,
    })
}
