//! Certificate of unique solvability.
//!
//! With the trace constant `c0` (`|v_tau|_{L2(contact)} <= c0 |eps(v)|`, (5.12)), the one-sided Lipschitz constant
//! `L_g` of the friction bound (5.16), the largest rate at which the bound of any node decreases with the slip rate, and the ellipticity constant `m_A` of the viscosity:
//!
//! With several materials `m_A` is the smallest and `L_B` the largest over the cells. The springs of memory count in `L_B`, as they
//! resist at once.
//! Where laws are not linear, the operators that are condensed are those of their lower tangents: what is proved for them holds
//! for every tangent.
//!
//! * the continuous problem has one solution when `c0^2 L_g < m_A` (Theorem 5.3; (2.6) with beta = c0^2 L_g, m = m_A);
//! * a trapezoidal step has one solution when also `k < (m_A - c0^2 L_g) / L_B` (3.6), `L_B` the norm of the elasticity;
//! * a step of this very mesh has one solution when the smallest eigenvalue of `Omega^-1/2 S Omega^-1/2` is above `L_g`,
//!   `S` the condensed operator of `A + theta k B`: sharp for a common slope of all nodes, and the one to look at.
//!
//! The discrete `c0` uses the lumped contact mass, as the friction terms do.
//!
//! Where contact has a normal component the constants are those of its tangential part: at given normal velocities where contact
//! is bilateral, at given normal forces, `1 / lambda_max(Omega^1/2 C_tt Omega^1/2)`, `C = S^-1`, where it opens or gives way.
//! Under Coulomb's law with the pressure P a step has one solution when
//!
//! ```text
//! max(P L_mu) / m + mu_max c < 1
//! ```
//!
//! with `m` that constant, `L_mu` the largest rate at which the coefficient decreases and `mu_max` its largest value; `c` measures
//! how far the normal forces follow the tangential ones: `|Omega^-1/2 S_nt S_tt^-1/2| / sqrt(m)` in bilateral contact, `sqrt(M / m)`
//! with `M = lambda_max(Omega^-1/2 S_nn Omega^-1/2)` otherwise. It proves, and is far from sharp on fine meshes.

use crate::contact::law::ContactLaw;
use crate::error::{Error, Result};
use crate::fem::{Body, ContactPatch, Forms};
use crate::linalg::{SparseCholesky, mirror_lower, symmetric_eigenvalues};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

/// What guarantees (or not) that every step has exactly one solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// Trace constant squared, m.
    pub c0_squared: f64,
    /// Largest rate at which the friction bound of any node decreases with the slip rate, Pa s/m; a bound that rises does no harm.
    pub l_g: f64,
    /// Ellipticity constant of the viscosity, Pa s.
    pub m_a: f64,
    /// Lipschitz constant of the viscosity, Pa s.
    pub l_a: f64,
    /// Lipschitz constant of the elasticity, with the springs of the memory, Pa.
    pub l_b: f64,
    /// Smallest eigenvalue of `Omega^-1/2 S Omega^-1/2` for A alone, Pa s/m; 0 where a material has no dashpot.
    pub sharp_instant: f64,
    /// The same for the largest internal step, Pa s/m.
    pub sharp_step: f64,
    /// What Coulomb's law adds; `None` for bounds that do not follow the pressure.
    pub coulomb: Option<CoulombConstants>,
}

/// Constants of Coulomb's law on a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoulombConstants {
    /// Largest coefficient of friction over nodes and slip rates; infinite where it rises without limit.
    pub coefficient: f64,
    /// Largest rate at which the coefficient of any node decreases with the slip rate, s/m.
    pub weakening: f64,
    /// c at the largest internal step.
    pub coupling: f64,
}

impl CoulombConstants {
    /// `mu_max c`: where it is below 1 and nothing weakens, every step has one solution.
    pub fn strength(&self) -> f64 {
        if self.coefficient == 0.0 {
            0.0
        } else {
            self.coefficient * self.coupling
        }
    }
}

impl Certificate {
    /// The same where nothing is proved of laws that weaken or follow the pressure.
    pub(super) fn without_proof(mut self) -> Certificate {
        self.sharp_step = Constants::UNBOUNDED.sharp;
        if let Some(coulomb) = &mut self.coulomb {
            coulomb.coupling = f64::MAX;
        }
        self
    }

    /// Theorem 5.3 and (2.6): the continuous problem has one solution.
    pub fn is_theorem_satisfied(&self) -> bool {
        self.coulomb.is_none() && self.c0_squared * self.l_g < self.m_a
    }

    /// Largest step for which (3.6) guarantees one solution; zero when no step does.
    pub fn step_limit(&self) -> f64 {
        ((self.m_a - self.c0_squared * self.l_g) / self.l_b).max(0.0)
    }

    /// The sharp discrete condition at the largest internal step; under Coulomb's law the one that holds at any pressure.
    pub fn is_step_unique(&self) -> bool {
        self.margin() > 0.0
    }

    /// Pressure, Pa, below which a step at the largest size has one solution under Coulomb's law; infinite where any will do, 0
    /// where nothing is proved.
    pub fn largest_pressure(&self) -> f64 {
        match self.coulomb {
            None => f64::INFINITY,
            Some(coulomb) => {
                let left = (1.0 - coulomb.strength() - self.l_g / self.sharp_step).max(0.0);
                match coulomb.weakening {
                    0.0 if left > 0.0 => f64::INFINITY,
                    0.0 => 0.0,
                    weakening => self.sharp_step * left / weakening,
                }
            }
        }
    }

    /// `sharp_step / L_g - 1`: by what share the slope of the law could grow before uniqueness is lost (negative: it is
    /// not guaranteed); infinite for a bound that never decreases with the slip rate. Under Coulomb's law `1 / (mu_max c) - 1`, or -1
    /// where it depends on the pressure.
    pub fn margin(&self) -> f64 {
        if let Some(coulomb) = self.coulomb {
            return if self.largest_pressure() == f64::INFINITY {
                1.0 / (coulomb.strength() + self.l_g / self.sharp_step) - 1.0
            } else {
                -1.0
            };
        }
        if self.l_g == 0.0 {
            f64::INFINITY
        } else {
            self.sharp_step / self.l_g - 1.0
        }
    }
}

/// What a law says to the certificate.
#[derive(Debug, Clone, Copy)]
pub struct LawConstants {
    /// Largest rate at which a bound in Pa decreases with the slip rate.
    pub weakening: f64,
    /// The same of a coefficient of friction, and the largest coefficient, where a law is Coulomb's.
    pub coulomb: Option<[f64; 2]>,
}

impl LawConstants {
    /// Those of all laws of a contact, in stages where the accumulated slip grows by `per_rate` times the slip rate.
    pub fn of(laws: &ContactLaw, per_rate: f64) -> LawConstants {
        let mut all = LawConstants {
            weakening: 0.0,
            coulomb: None,
        };
        for part in laws.parts() {
            let bounds = part.law.bounds();
            let weakening = bounds.weakening(part.law.kernel().largest_per_rate(per_rate));
            if !part.law.is_coulomb() {
                all.weakening = all.weakening.max(weakening);
                continue;
            }
            let nodes = 0..part.nodes.len();
            let largest = nodes.map(|node| bounds.extremes(node)[0]);
            let [falls, most] = all.coulomb.unwrap_or([0.0; 2]);
            all.coulomb = Some([falls.max(weakening), largest.fold(most, f64::max)]);
        }
        all
    }
}

/// What a certificate takes of the materials of a body.
#[derive(Debug, Clone, Copy)]
pub struct MaterialConstants {
    pub m_a: f64,
    pub l_a: f64,
    pub l_b: f64,
    /// Whether all have a dashpot.
    pub have_dashpots: bool,
}

impl MaterialConstants {
    /// Those of the forms of a body of this dimension.
    pub fn of(forms: &Forms, dimension: usize) -> MaterialConstants {
        let [m_a, l_a, l_b] = forms.constants(dimension);
        MaterialConstants {
            m_a,
            l_a,
            l_b,
            have_dashpots: forms.have_dashpots(),
        }
    }
}

/// The certificate for a law and the implicit weight `theta_k` (s) of the largest step; `constants(x, y)` are those of the
/// condensed operator of `x A + y B`, `of_strains` those of the strain norm.
///
/// # Errors
/// Those of `constants`.
pub fn certify(
    material: MaterialConstants,
    of_strains: Constants,
    law: LawConstants,
    theta_k: f64,
    mut constants: impl FnMut(f64, f64) -> Result<Constants>,
) -> Result<Certificate> {
    let step = constants(1.0, theta_k)?;
    Ok(Certificate {
        c0_squared: 1.0 / of_strains.sharp,
        l_g: law.weakening,
        m_a: material.m_a,
        l_a: material.l_a,
        l_b: material.l_b,
        sharp_instant: match material.have_dashpots {
            true => constants(1.0, 0.0)?.sharp,
            false => 0.0,
        },
        sharp_step: step.sharp,
        coulomb: law
            .coulomb
            .map(|[weakening, coefficient]| CoulombConstants {
                coefficient,
                weakening,
                coupling: step.coupling,
            }),
    })
}

/// Constants of a condensed contact operator.
#[derive(Debug, Clone, Copy)]
pub struct Constants {
    /// Smallest eigenvalue of the resistance to slip, Pa s/m.
    pub sharp: f64,
    /// c; 0 without normal components.
    pub coupling: f64,
}

impl Constants {
    /// Those of a norm that does not see a motion of the body.
    pub(super) const UNBOUNDED: Constants = Constants {
        sharp: f64::MIN_POSITIVE,
        coupling: 0.0,
    };
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

/// Those of the condensed contact operator of `x A + y B`, by a factorization.
///
/// # Errors
/// [`Error::NotPositiveDefinite`] when the body is not held.
pub fn factored_constants(
    body: &Body,
    cholesky: &SparseCholesky,
    (x, y): (f64, f64),
) -> Result<Constants> {
    let mut values = vec![0.0; body.operators.row_idx.len()];
    body.operators.combine(x, y, &mut values);
    constants_of(body, cholesky, &values)
}

/// The same for the operator with these entries.
///
/// # Errors
/// [`Error::NotPositiveDefinite`] when the body is not held.
pub fn constants_of(body: &Body, cholesky: &SparseCholesky, values: &[f64]) -> Result<Constants> {
    let s = condensed(body, cholesky, values)?;
    if !body.contact.has_normal {
        let values = scaled_eigenvalues(&body.contact, &s, |omega| 1.0 / omega.sqrt())?;
        let sharp = positive(values.first().copied())?;
        return Ok(Constants {
            sharp,
            coupling: 0.0,
        });
    }
    let mut s = s;
    mirror_lower(s.as_mut());
    normal_constants(&body.contact, &s, &inverse(&s)?)
}

/// The same from the contact compliance `C = S^-1` (lower triangle).
///
/// # Errors
/// [`Error::Body`] for a compliance that is not positive.
pub fn constants_of_compliance(contact: &ContactPatch, compliance: &Mat<f64>) -> Result<Constants> {
    if !contact.has_normal {
        let values = scaled_eigenvalues(contact, compliance, f64::sqrt)?;
        let sharp = positive(values.last().map(|largest| 1.0 / largest))?;
        return Ok(Constants {
            sharp,
            coupling: 0.0,
        });
    }
    let mut c = compliance.clone();
    mirror_lower(c.as_mut());
    normal_constants(contact, &inverse(&c)?, &c)
}

/// With normal components, from S and its inverse.
fn normal_constants(contact: &ContactPatch, s: &Mat<f64>, c: &Mat<f64>) -> Result<Constants> {
    let (stride, components) = (contact.stride(), contact.components);
    let places = |is_normal: bool| -> Vec<usize> {
        let all = 0..contact.force_len();
        all.filter(|i| (i % stride == components) == is_normal)
            .collect()
    };
    let (tangential, normal) = (places(false), places(true));
    let root = |i: usize| contact.weights[i / stride].sqrt();
    let block = |from: &Mat<f64>, rows: &[usize], columns: &[usize], power: i32| {
        Mat::from_fn(rows.len(), columns.len(), |i, j| {
            let (i, j) = (rows[i], columns[j]);
            from[(i, j)] * (root(i) * root(j)).powi(power)
        })
    };
    let what = "the condensed contact operator";
    let largest = |matrix: &Mat<f64>| -> Result<f64> {
        let values = symmetric_eigenvalues(what, matrix.as_ref())?;
        positive(values.last().copied())
    };
    if contact.gaps.is_empty() {
        let own = block(s, &tangential, &tangential, -1);
        let values = symmetric_eigenvalues(what, own.as_ref())?;
        let sharp = positive(values.first().copied())?;
        // |N S_tt^-1/2|^2 is the largest eigenvalue of N S_tt^-1 N^T, all scaled
        let n = block(s, &normal, &tangential, -1);
        let followed = &n * inverse(&own)? * n.transpose();
        let followed = symmetric_eigenvalues(what, followed.as_ref())?;
        let followed = followed.last().copied().unwrap_or(0.0).max(0.0);
        return Ok(Constants {
            sharp,
            coupling: (followed / sharp).sqrt(),
        });
    }
    let sharp = 1.0 / largest(&block(c, &tangential, &tangential, 1))?;
    let stiffest = largest(&block(s, &normal, &normal, -1))?;
    Ok(Constants {
        sharp,
        coupling: (stiffest / sharp).sqrt(),
    })
}

fn inverse(matrix: &Mat<f64>) -> Result<Mat<f64>> {
    let factor = matrix
        .llt(Side::Lower)
        .map_err(|_| Error::NotPositiveDefinite {
            what: "the condensed contact operator",
            pivot: 0,
        })?;
    Ok(factor.solve(Mat::<f64>::identity(matrix.nrows(), matrix.nrows())))
}

fn scaled_eigenvalues(
    contact: &ContactPatch,
    matrix: &Mat<f64>,
    scale: impl Fn(f64) -> f64,
) -> Result<Vec<f64>> {
    let c = contact.components;
    let scale: Vec<f64> = (0..matrix.nrows())
        .map(|i| scale(contact.weights[i / c]))
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
