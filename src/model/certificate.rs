//! Certificate of unique solvability.
//!
//! With the trace constant `c0` (`|v_tau|_{L2(contact)} <= c0 |eps(v)|`, (5.12)), the one-sided Lipschitz constant
//! `L_g` of the friction bound (5.16), the largest rate at which the bound of any node decreases with the slip rate, and the ellipticity constant `m_A` of the viscosity:
//!
//! With several materials `m_A` is the smallest and `L_B` the largest over the regions.
//!
//! * the continuous problem has one solution when `c0^2 L_g < m_A` (Theorem 5.3; (2.6) with beta = c0^2 L_g, m = m_A);
//! * a trapezoidal step has one solution when also `k < (m_A - c0^2 L_g) / L_B` (3.6), `L_B` the norm of the elasticity;
//! * a step of this very mesh has one solution when the smallest eigenvalue of `Omega^-1/2 S Omega^-1/2` is above `L_g`,
//!   `S` the condensed operator of `A + theta k B`: sharp for a common slope of all nodes, and the one to look at.
//!
//! The discrete `c0` uses the lumped contact mass, as the friction terms do.

use crate::error::{Error, Result};
use crate::fem::{Body, StrainNorm};
use crate::linalg::{SparseCholesky, symmetric_eigenvalues};
use faer::Mat;

/// What guarantees (or not) that every step has exactly one solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// Trace constant squared, m.
    pub c0_squared: f64,
    /// Largest rate at which the friction bound of any node decreases with the slip rate, Pa s/m; a bound that rises does no harm.
    pub l_g: f64,
    /// Ellipticity constant of the viscosity, Pa s.
    pub m_a: f64,
    /// Lipschitz constant of the elasticity, Pa.
    pub l_b: f64,
    /// Smallest eigenvalue of `Omega^-1/2 S Omega^-1/2` for A alone, Pa s/m.
    pub sharp_instant: f64,
    /// The same for the largest internal step, Pa s/m.
    pub sharp_step: f64,
}

impl Certificate {
    /// Theorem 5.3 and (2.6): the continuous problem has one solution.
    pub fn is_theorem_satisfied(&self) -> bool {
        self.c0_squared * self.l_g < self.m_a
    }

    /// Largest step for which (3.6) guarantees one solution; zero when no step does.
    pub fn step_limit(&self) -> f64 {
        ((self.m_a - self.c0_squared * self.l_g) / self.l_b).max(0.0)
    }

    /// The sharp discrete condition at the largest internal step.
    pub fn is_step_unique(&self) -> bool {
        self.margin() > 0.0
    }

    /// `sharp_step / L_g - 1`: by what share the slope of the law could grow before uniqueness is lost (negative: it is
    /// not guaranteed); infinite for a bound that never decreases with the slip rate.
    pub fn margin(&self) -> f64 {
        if self.l_g == 0.0 {
            f64::INFINITY
        } else {
            self.sharp_step / self.l_g - 1.0
        }
    }
}

/// The certificate for a law that weakens at the rate `l_g` at most and the implicit weight `theta_k` (s) of the largest step;
/// `sharp_constant(x, y)` is the smallest eigenvalue of `Omega^-1/2 S Omega^-1/2`, S the condensed operator of `x A + y B`.
///
/// # Errors
/// Those of `sharp_constant` and of [`sharp_constant_of`].
pub fn certify(
    body: &Body,
    cholesky: &SparseCholesky,
    l_g: f64,
    theta_k: f64,
    mut sharp_constant: impl FnMut(f64, f64) -> Result<f64>,
) -> Result<Certificate> {
    let of_strains = match &body.strain {
        StrainNorm::Combination(x, y) => sharp_constant(*x, *y)?,
        StrainNorm::Assembled(values) => sharp_constant_of(body, cholesky, values)?,
    };
    let extremes = |which: usize, extreme: usize| {
        let of = body.forms.iter().map(move |forms| forms[which]);
        of.map(move |form| form.extremes(body.mesh.dimension)[extreme])
    };
    Ok(Certificate {
        c0_squared: 1.0 / of_strains,
        l_g,
        m_a: extremes(0, 0).fold(f64::INFINITY, f64::min),
        l_b: extremes(1, 1).fold(0.0, f64::max),
        sharp_instant: sharp_constant(1.0, 0.0)?,
        sharp_step: sharp_constant(1.0, theta_k)?,
    })
}

/// Condensed contact operator of the operator with these entries.
fn condensed(body: &Body, cholesky: &SparseCholesky, values: &[f64]) -> Result<Mat<f64>> {
    let mut factor = vec![0.0; cholesky.len()];
    cholesky.factor(
        "the contact operator (is the body clamped or otherwise held?)",
        values,
        &mut factor,
        &mut cholesky.scratch(1),
    )?;
    let mut s = Mat::zeros(body.contact_len(), body.contact_len());
    cholesky.condensed(&factor, s.as_mut());
    Ok(s)
}

/// Smallest eigenvalue of `Omega^-1/2 S Omega^-1/2`, S the condensed contact operator of `x A + y B`, by a factorization.
///
/// # Errors
/// [`Error::NotPositiveDefinite`] when the body is not held.
pub fn sharp_constant(body: &Body, cholesky: &SparseCholesky, (x, y): (f64, f64)) -> Result<f64> {
    let mut values = vec![0.0; body.operators.row_idx.len()];
    body.operators.combine(x, y, &mut values);
    sharp_constant_of(body, cholesky, &values)
}

/// The same for the operator with these entries.
///
/// # Errors
/// [`Error::NotPositiveDefinite`] when the body is not held.
pub fn sharp_constant_of(body: &Body, cholesky: &SparseCholesky, values: &[f64]) -> Result<f64> {
    let s = condensed(body, cholesky, values)?;
    let values = scaled_eigenvalues(body, &s, |omega| 1.0 / omega.sqrt())?;
    positive(values.first().copied())
}

/// The same from the contact compliance `C = S^-1`: one over the largest eigenvalue of `Omega^1/2 C Omega^1/2`.
///
/// # Errors
/// [`Error::Body`] for a compliance that is not positive.
pub fn sharp_constant_of_compliance(body: &Body, compliance: &Mat<f64>) -> Result<f64> {
    let values = scaled_eigenvalues(body, compliance, f64::sqrt)?;
    positive(values.last().map(|largest| 1.0 / largest))
}

fn scaled_eigenvalues(
    body: &Body,
    matrix: &Mat<f64>,
    scale: impl Fn(f64) -> f64,
) -> Result<Vec<f64>> {
    let c = body.contact.components;
    let scale: Vec<f64> = (0..matrix.nrows())
        .map(|i| scale(body.contact.weights[i / c]))
        .collect();
    let scaled = Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
        matrix[(i, j)] * scale[i] * scale[j]
    });
    symmetric_eigenvalues("the condensed contact operator", scaled.as_ref())
}

fn positive(found: Option<f64>) -> Result<f64> {
    match found {
        Some(smallest) if smallest > 0.0 => Ok(smallest),
        found => Err(Error::Body {
            what: format!("the condensed contact operator has the eigenvalue {found:?}"),
        }),
    }
}
