//! Galerkin projection of the body on the responses to its ports at a few shifts, from samples of the transfer matrix alone.
//!
//! With `X_i = (c_i A + d_i B)^-1 P` and `det = c_i d_j - c_j d_i`, the projected pair is made of Loewner quotients, and on
//! the diagonal of the derivative by the angle, `H' = -X^T (-d A + c B) X`:
//!
//! ```text
//! i != j   X_i^T A X_j = (d_j H_j - d_i H_i) / det,   X_i^T B X_j = (c_i H_i - c_j H_j) / det
//! i == j   X_i^T A X_i = c_i H_i + d_i H'_i,          X_i^T B X_i = d_i H_i - c_i H'_i
//! ```
//!
//! Ports are first made comparable in energy: the contact by the Cholesky factor of its compliance at the middle sample, so
//! that forces of every wavelength count alike, the others by their own response. The eigenvectors of the Gram matrix
//! `X^T A X` then order combinations of the responses by what they add; the first r of them are kept and the pair is diagonalised:
//! `A = I`, `B = diag(rates)`.

use super::shifts::{Shifts, shift};
use crate::error::{Error, Result};
use crate::linalg::{multiply, multiply_transposed, symmetric_eigen};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, Mat, MatRef, Par, Side};

/// Combinations whose share of the scaled Gram matrix is below this are dependent to rounding.
const DEPENDENT: f64 = 1e-13;
/// Iterations of the power method for the norm of a truncation error; it only has to find its magnitude.
const POWER_ITERATIONS: usize = 12;

/// The projected pair on the independent responses.
pub struct Projection {
    /// Combinations of the responses that are orthonormal in A, strongest first: (shifts x ports) x rank.
    responses: Mat<f64>,
    /// Projected B on all responses.
    elasticity: Mat<f64>,
    /// What the orthonormal responses show at the ports: rank x ports.
    seen: Mat<f64>,
    /// Instantaneous transfer matrix.
    instantaneous: Mat<f64>,
    scaling: Scaling,
}

/// The modes of a projection.
pub struct Modes {
    /// Rates relative to the reference rate, ascending.
    pub rates: Vec<f64>,
    /// Port velocities of every mode: states x ports.
    pub ports: Mat<f64>,
    /// Port forces at every shift that make up a mode: (shifts x ports) x states.
    pub forces: Mat<f64>,
}

impl Projection {
    /// Projects on the shifts, from the samples at all angles.
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`] when a sample is not the compliance of a body that is held.
    pub fn new(shifts: &Shifts, samples: &[Mat<f64>], contact_len: usize) -> Result<Projection> {
        let scaling = Scaling::new(&samples[samples.len() / 2], contact_len)?;
        let samples: Vec<_> = samples.iter().map(|h| scaling.apply(h)).collect();
        let (a, b) = loewner(shifts, &samples);
        let (size, m) = (a.nrows(), samples[0].nrows());

        let (gram, vectors) = symmetric_eigen("the Gram matrix of the reduction", a.as_ref())?;
        let largest = gram.last().copied().unwrap_or(0.0);
        let rank = gram.iter().filter(|g| **g > DEPENDENT * largest).count();
        // strongest first
        let responses = Mat::from_fn(size, rank, |i, j| {
            let at = size - 1 - j;
            vectors[(i, at)] / gram[at].sqrt()
        });
        let mut stacked = Mat::<f64>::zeros(size, m);
        for i in 0..shifts.count() {
            let mut rows = stacked.as_mut().subrows_mut(i * m, m);
            rows.copy_from(&samples[shifts.at(i)]);
        }
        Ok(Projection {
            seen: responses.transpose() * &stacked,
            responses,
            elasticity: b,
            instantaneous: samples[0].clone(),
            scaling,
        })
    }

    /// Responses that are independent to rounding.
    pub fn rank(&self) -> usize {
        self.responses.ncols()
    }

    /// The fewest responses whose instantaneous transfer matrix is right to `tolerance` in energy.
    pub fn rank_for(&self, tolerance: f64) -> usize {
        let (mut low, mut high) = (1, self.rank());
        while low < high {
            let middle = (low + high) / 2;
            if self.truncation_error(middle) <= tolerance {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        low
    }

    /// Norm of what the first `rank` responses miss of the instantaneous transfer matrix, which is never negative.
    fn truncation_error(&self, rank: usize) -> f64 {
        let seen = self.seen.get(..rank, ..);
        let m = seen.ncols();
        // no symmetry of a mesh is orthogonal to this start
        let mut v: Vec<f64> = (0..m).map(|i| 1.0 + (i as f64 + 1.0).sin()).collect();
        let (mut modes, mut back, mut missed) = (vec![0.0; rank], vec![0.0; m], vec![0.0; m]);
        let mut norm = 0.0;
        for _ in 0..POWER_ITERATIONS {
            let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
            v.iter_mut().for_each(|v| *v /= length);
            multiply(self.instantaneous.as_ref(), &v, &mut missed);
            multiply(seen, &v, &mut modes);
            multiply_transposed(seen, &modes, &mut back);
            for ((v, missed), back) in v.iter_mut().zip(&missed).zip(&back) {
                *v = missed - back;
            }
            norm = v.iter().map(|v| v * v).sum::<f64>().sqrt();
            if norm == 0.0 {
                break;
            }
        }
        norm
    }

    /// The modes on the first `rank` responses.
    ///
    /// # Errors
    /// [`Error::Body`] when the eigenvalues cannot be computed.
    pub fn modes(&self, rank: usize) -> Result<Modes> {
        let basis = self.responses.get(.., ..rank);
        let half = &self.elasticity * basis;
        let mut pair = Mat::<f64>::zeros(rank, rank);
        matmul(
            pair.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Replace,
            basis.transpose(),
            BlockStructure::Rectangular,
            half.as_ref(),
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
        let (rates, rotation) = symmetric_eigen("the reduced elasticity", pair.as_ref())?;
        let ports = rotation.transpose() * self.seen.get(..rank, ..);
        let mut forces = basis * rotation;
        let m = self.seen.ncols();
        for shift in 0..forces.nrows() / m {
            let rows = forces.as_mut().subrows_mut(shift * m, m);
            self.scaling.apply_to_forces(rows);
        }
        Ok(Modes {
            rates,
            ports: self.scaling.unapply(&ports),
            forces,
        })
    }
}

/// The projected pair `(X^T A X, X^T B X)` over all shifts, from samples of the transfer matrix.
fn loewner(shifts: &Shifts, samples: &[Mat<f64>]) -> (Mat<f64>, Mat<f64>) {
    let (m, count) = (samples[0].nrows(), shifts.count());
    let size = count * m;
    let (mut a, mut b) = (Mat::<f64>::zeros(size, size), Mat::<f64>::zeros(size, size));
    for i in 0..count {
        let hi = &samples[shifts.at(i)];
        let (ci, di) = shift(shifts.angles[shifts.at(i)]);
        for j in 0..count {
            let derivative = (i == j).then(|| shifts.derivative(i, samples));
            let hj = derivative.as_ref().unwrap_or(&samples[shifts.at(j)]);
            let (cj, dj) = shift(shifts.angles[shifts.at(j)]);
            // weights of H_i and of H_j, or of H' on the diagonal
            let (a_weights, b_weights) = if i == j {
                ((ci, di), (di, -ci))
            } else {
                let det = ci * dj - cj * di;
                ((-di / det, dj / det), (ci / det, -cj / det))
            };
            for q in 0..m {
                for p in 0..m {
                    let (hi, hj) = (hi[(p, q)], hj[(p, q)]);
                    a[(i * m + p, j * m + q)] = a_weights.0 * hi + a_weights.1 * hj;
                    b[(i * m + p, j * m + q)] = b_weights.0 * hi + b_weights.1 * hj;
                }
            }
        }
    }
    (a, b)
}

/// Scales of the ports: `L` of the contact compliance `L L^T`, and roots of the own responses of the other ports.
struct Scaling {
    lower: Mat<f64>,
    others: Vec<f64>,
}

impl Scaling {
    fn new(h: &Mat<f64>, contact_len: usize) -> Result<Scaling> {
        Ok(Scaling {
            lower: compliance_factor(h.get(..contact_len, ..contact_len))?,
            others: (contact_len..h.nrows())
                .map(|i| {
                    if h[(i, i)] > 0.0 {
                        h[(i, i)].sqrt()
                    } else {
                        1.0
                    }
                })
                .collect(),
        })
    }

    /// `T^-1 H T^-T`, `T = diag(L, scales)`; exactly symmetric.
    fn apply(&self, h: &Mat<f64>) -> Mat<f64> {
        let contact = self.lower.nrows();
        let mut scaled = h.clone();
        for _ in 0..2 {
            let rows = scaled.as_mut().subrows_mut(0, contact);
            solve_lower_triangular_in_place(self.lower.as_ref(), rows, Par::Seq);
            for (i, scale) in self.others.iter().enumerate() {
                let row = scaled.row_mut(contact + i);
                row.iter_mut().for_each(|v| *v /= scale);
            }
            scaled = scaled.transpose().to_owned();
        }
        for j in 0..scaled.ncols() {
            for i in 0..j {
                let mean = 0.5 * (scaled[(i, j)] + scaled[(j, i)]);
                scaled[(i, j)] = mean;
                scaled[(j, i)] = mean;
            }
        }
        scaled
    }

    /// `Y T^T`: port velocities of modes (states x ports) back from scaled ports.
    fn unapply(&self, ports: &Mat<f64>) -> Mat<f64> {
        let contact = self.lower.nrows();
        let mut out = ports.clone();
        let product = ports.get(.., ..contact) * self.lower.transpose();
        out.as_mut().subcols_mut(0, contact).copy_from(&product);
        for (i, scale) in self.others.iter().enumerate() {
            let column = out.col_mut(contact + i);
            column.iter_mut().for_each(|v| *v *= scale);
        }
        out
    }

    /// `T^-T F`, in place: forces at the ports from forces at the scaled ports.
    fn apply_to_forces(&self, mut forces: faer::MatMut<f64>) {
        let contact = self.lower.nrows();
        solve_upper_triangular_in_place(
            self.lower.transpose(),
            forces.as_mut().subrows_mut(0, contact),
            Par::Seq,
        );
        for (i, scale) in self.others.iter().enumerate() {
            let row = forces.as_mut().row_mut(contact + i);
            row.iter_mut().for_each(|v| *v /= scale);
        }
    }
}

/// Lower Cholesky factor of a contact compliance.
///
/// # Errors
/// [`Error::NotPositiveDefinite`].
pub fn compliance_factor(compliance: MatRef<f64>) -> Result<Mat<f64>> {
    let factor = compliance
        .llt(Side::Lower)
        .map_err(|_| Error::NotPositiveDefinite {
            what: "the contact compliance",
            pivot: 0,
        })?;
    Ok(factor.L().to_owned())
}
