//! Long memory: branches of a generalised Maxwell body (terms of a Prony series) beside viscosity and elasticity,
//! `sigma = A eps(u') + B eps(u) + sum_j int_0^t C_j exp(-(t - s) / tau_j) eps(u'(s)) ds`.
//!
//! A branch is a spring C in series with a dashpot of relaxation time tau. With the strain q of the dashpot,
//! `q' = (u - q) / tau`, its stress is `C eps(u - q)`, and all branches together make one symmetric pencil with A and B.

use super::form::Form;
use super::variation::Variation;
use super::voigt;
use super::{Law, Parameter, ParameterKind};
use crate::refusal::{Refusal, Verdict, ensure};
use nalgebra::{Cholesky, DMatrix};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most branches of a material.
pub const MOST_BRANCHES: usize = 64;
/// Share of the largest eigenvalue of a branch below which it does not see a strain.
const DEPENDENT: f64 = 1e-13;
/// Time of a dashpot that stands for none, in shortest relaxation times.
const SMALL: f64 = 1e-6;

/// A branch of the memory of a material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "law", rename_all = "snake_case")]
pub enum Branch {
    Isotropic(IsotropicBranch),
}

/// `C eps = (K - 2 G / 3) tr(eps) I + 2 G eps`, in 3D as in the plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IsotropicBranch {
    /// Relaxation time, s; positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub tau: f64,
    /// Shear modulus G, Pa; not negative.
    #[schemars(extend("minimum" = 0))]
    pub shear: f64,
    /// Bulk modulus K, Pa; not negative, and not 0 beside a shear modulus of 0.
    #[schemars(extend("minimum" = 0))]
    pub bulk: f64,
}

impl Branch {
    pub(super) fn law(&self) -> &dyn Law {
        match self {
            Branch::Isotropic(law) => law,
        }
    }

    pub(super) fn isotropic(&mut self) -> &mut IsotropicBranch {
        match self {
            Branch::Isotropic(law) => law,
        }
    }

    /// Relaxation time, s.
    pub fn tau(&self) -> f64 {
        match self {
            Branch::Isotropic(law) => law.tau,
        }
    }
}

impl Law for IsotropicBranch {
    fn parameters(&self, unit: &'static str) -> Vec<Parameter> {
        let parameter = |key: &str, unit, text| Parameter {
            key: key.to_owned(),
            kind: ParameterKind::Number(unit),
            text,
        };
        vec![
            parameter("tau", "s", "Memory: relaxation time of a branch."),
            parameter("shear", unit, "Memory: shear modulus of a branch."),
            parameter("bulk", unit, "Memory: bulk modulus of a branch."),
        ]
    }

    fn check(&self, _dimension: usize, path: &str) -> Verdict {
        let (lambda, two_mu) = (self.bulk - 2.0 * self.shear / 3.0, 2.0 * self.shear);
        ensure(self.shear > 0.0 || self.bulk > 0.0, || {
            let allowed = "a shear or bulk modulus > 0: otherwise the branch does nothing";
            Refusal::new(path, "shear = 0, bulk = 0", allowed)
        })?;
        let is_usable = lambda.is_finite() && two_mu.is_finite() && self.tau.recip().is_finite();
        ensure(is_usable, || {
            let found = format!(
                "tau = {:e}, shear = {:e}, bulk = {:e}",
                self.tau, self.shear, self.bulk
            );
            Refusal::new(
                path,
                found,
                "finite 1 / tau, 2 shear and bulk - 2 shear / 3",
            )
        })
    }

    fn form(&self) -> Form {
        form(self.bulk, self.shear)
    }

    fn variation(&self) -> Variation<'_> {
        Variation::default()
    }
}

/// `(K - 2 G / 3) tr(eps) I + 2 G eps`.
pub(super) fn form(bulk: f64, shear: f64) -> Form {
    Form::Isotropic {
        lambda: bulk - 2.0 * shear / 3.0,
        two_mu: 2.0 * shear,
    }
}

/// Refuses branches that a material cannot have; `path` is the place of the list in the scene.
pub(super) fn check(branches: &[Branch], path: &str) -> Verdict {
    ensure(branches.len() <= MOST_BRANCHES, || {
        let found = format!("{} branches", branches.len());
        Refusal::new(path, found, format!("at most {MOST_BRANCHES} branches"))
    })
}

/// Smallest and largest relaxation rate of a material, 1/s: the extreme eigenvalues of its little pencil
///
/// ```text
/// diag(A, tau_j C_j),   [[B + sum C_j, -C_j], [-C_j, C_j]]
/// ```
///
/// over all strains, between which the rates of every body of it lie. `branches` are pairs of relaxation time and form. Without a
/// dashpot (A = 0) the largest is infinite. Not numbers where A is neither 0 nor positive.
pub fn rates_with_memory(
    a: &Form,
    b: &Form,
    branches: &[(f64, Form)],
    dimension: usize,
) -> [f64; 2] {
    if *a != Form::ZERO {
        return extremes(a, b, branches, dimension);
    }
    let Some(shortest) = branches.iter().map(|(tau, _)| *tau).reduce(f64::min) else {
        return [f64::INFINITY; 2];
    };
    // a dashpot too small for the slowest rate to feel
    let [slowest, _] = extremes(&b.times(SMALL * shortest), b, branches, dimension);
    [slowest, f64::INFINITY]
}

fn extremes(a: &Form, b: &Form, branches: &[(f64, Form)], dimension: usize) -> [f64; 2] {
    little_pencil(a, b, branches, dimension).map_or([f64::NAN; 2], voigt::extreme_eigenvalues)
}

/// The pencil as one symmetric matrix: A is made the identity by its factor, `tau_j C_j` by a root of C_j, without the strains
/// that C_j does not see.
fn little_pencil(
    a: &Form,
    b: &Form,
    branches: &[(f64, Form)],
    dimension: usize,
) -> Option<DMatrix<f64>> {
    let matrix = |form: &Form| voigt::metric(&form.voigt(), dimension);
    let factor = Cholesky::new(matrix(a))?.l();
    let m = factor.nrows();
    let mut own = matrix(b);
    let mut couplings = Vec::new();
    for (tau, form) in branches {
        own += matrix(form);
        let coupling = factor.solve_lower_triangular(&root(matrix(form))?)?;
        couplings.push((tau, coupling / -tau.sqrt()));
    }
    let half = factor.solve_lower_triangular(&own)?;
    let own = factor.solve_lower_triangular(&half.transpose())?;
    let size = m + couplings.iter().map(|(_, c)| c.ncols()).sum::<usize>();
    let mut pencil = DMatrix::zeros(size, size);
    pencil
        .view_mut((0, 0), (m, m))
        .copy_from(&((&own + own.transpose()) / 2.0));
    let mut at = m;
    for (tau, coupling) in couplings {
        let count = coupling.ncols();
        pencil.view_mut((0, at), (m, count)).copy_from(&coupling);
        pencil
            .view_mut((at, 0), (count, m))
            .copy_from(&coupling.transpose());
        for i in at..at + count {
            pencil[(i, i)] = 1.0 / tau;
        }
        at += count;
    }
    Some(pencil)
}

/// R with `R R^T` a matrix that is not negative, of as many columns as it has eigenvalues that are not 0.
fn root(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let eigen = voigt::eigen(matrix)?;
    let largest = eigen.eigenvalues.amax();
    let kept: Vec<usize> = (0..eigen.eigenvalues.len())
        .filter(|&i| eigen.eigenvalues[i] > DEPENDENT * largest)
        .collect();
    Some(DMatrix::from_fn(
        eigen.eigenvalues.len(),
        kept.len(),
        |i, j| eigen.eigenvectors[(i, kept[j])] * eigen.eigenvalues[kept[j]].sqrt(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(lambda: f64, two_mu: f64) -> Form {
        Form::Isotropic { lambda, two_mu }
    }

    /// With everything proportional every strain has the same rates: the roots of `b - a s = sum c s tau / (1 - s tau)`.
    #[test]
    fn proportional_branches_have_the_rates_of_one_number() {
        let times = |factor: f64| form(1.7 * factor, 0.9 * factor);
        let branches = [(0.05, times(0.5)), (0.4, times(0.3))];
        for dimension in [2, 3] {
            let [low, high] = rates_with_memory(&times(0.1), &times(1.0), &branches, dimension);
            assert!((low - 1.79947).abs() < 1e-5, "{low}");
            assert!((high - 29.17743).abs() < 1e-5, "{high}");
        }
    }

    /// A branch of shear alone leaves the spherical strain with the rate of A and B.
    #[test]
    fn a_branch_without_bulk_leaves_the_spherical_rate() {
        let (a, b) = (form(0.2, 0.5), form(30.0, 2.0));
        let branch = IsotropicBranch {
            tau: 0.5,
            shear: 3.0,
            bulk: 0.0,
        };
        let [low, high] = rates_with_memory(&a, &b, &[(0.5, branch.form())], 3);
        assert!((high - (3.0 * 30.0 + 2.0) / (3.0 * 0.2 + 0.5)).abs() < 1e-10);
        // shear: 2 - 0.5 s = 6 (0.5 s) / (1 - 0.5 s)
        let shear = |s: f64| (2.0 - 0.5 * s) * (1.0 - 0.5 * s) - 3.0 * s;
        assert!(shear(low).abs() < 1e-10);
        let (none, plain) = (rates_with_memory(&a, &b, &[], 3), Form::rates(&a, &b, 3));
        assert!(
            none.iter()
                .zip(plain)
                .all(|(x, y)| (x / y - 1.0).abs() < 1e-13)
        );
    }
}
