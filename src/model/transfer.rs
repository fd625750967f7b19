//! The transfer matrix of the body between its ports, at one shift.
//!
//! Ports are the tangential contact dofs, the loads and the probes; `P` is their n x m matrix. For the projective shift
//! `(c, d)` with `c^2 + d^2 = 1`, and `B` scaled by the reference rate,
//!
//! ```text
//! X = (c A + d B)^-1 P,   H = P^T X,   H' = -X^T (-d A + c B) X   (derivative by the angle of the shift)
//! X^T A X = c H + d H',   X^T B X = d H - c H'
//! ```
//!
//! Angle 0 is the instantaneous (viscous) response, a quarter turn the long-time (elastic) one. Only one `X` is held.

use crate::error::Result;
use crate::fem::{Body, OperatorPair};
use crate::linalg::{SparseCholesky, mirror_lower};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

/// Columns multiplied together.
const BLOCK: usize = 32;

/// The ports of a body: contact dofs, then loads, then probes.
pub struct PortMatrix {
    /// Free dofs n.
    pub rows: usize,
    /// Contact dofs, the last ones of the body.
    pub contact_len: usize,
    /// Columns that follow the contact.
    pub others: Vec<Vec<(usize, f64)>>,
}

impl PortMatrix {
    pub fn new(body: &Body) -> PortMatrix {
        let loads = body.loads.iter().map(|l| l.entries.clone());
        let probes = body.probes.iter().flat_map(|p| p.rows.iter().cloned());
        PortMatrix {
            rows: body.len(),
            contact_len: body.contact_len(),
            others: loads.chain(probes).collect(),
        }
    }

    /// Number of ports m.
    pub fn len(&self) -> usize {
        self.contact_len + self.others.len()
    }

    /// `P y`, into `out`.
    pub fn expand(&self, y: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let interior = self.rows - self.contact_len;
        out[interior..].copy_from_slice(&y[..self.contact_len]);
        for (column, y) in self.others.iter().zip(&y[self.contact_len..]) {
            for &(dof, value) in column {
                out[dof] += value * y;
            }
        }
    }

    /// `P^T X`, symmetrised.
    fn project(&self, x: &Mat<f64>) -> Mat<f64> {
        let (m, interior) = (self.len(), self.rows - self.contact_len);
        let mut h = Mat::<f64>::zeros(m, m);
        for j in 0..m {
            let column = x.col(j);
            for i in 0..self.contact_len {
                h[(i, j)] = column[interior + i];
            }
            for (i, port) in self.others.iter().enumerate() {
                h[(self.contact_len + i, j)] =
                    port.iter().map(|&(dof, value)| value * column[dof]).sum();
            }
        }
        symmetrise(&mut h);
        h
    }
}

/// The transfer matrix and the Galerkin blocks at one shift.
pub struct Sample {
    /// Angle of the shift, 0 to a quarter turn.
    pub angle: f64,
    /// `H`, m x m.
    pub h: Mat<f64>,
    /// `X^T A X`.
    pub a: Mat<f64>,
    /// `X^T B X`, with B scaled by the reference rate.
    pub b: Mat<f64>,
}

/// `(c, d)` of a shift; exact at the two ends.
pub fn shift(angle: f64) -> (f64, f64) {
    if angle == std::f64::consts::FRAC_PI_2 {
        (0.0, 1.0)
    } else {
        (angle.cos(), angle.sin())
    }
}

/// Samples the transfer matrix at `angle`, with B divided by `reference_rate`.
///
/// # Errors
/// [`crate::Error::NotPositiveDefinite`] when the body is not held.
pub fn sample(
    ports: &PortMatrix,
    operators: &OperatorPair,
    cholesky: &SparseCholesky,
    reference_rate: f64,
    angle: f64,
) -> Result<Sample> {
    let (c, d) = shift(angle);
    let (n, m) = (ports.rows, ports.len());
    let mut memory = cholesky.scratch(m);
    let mut values = vec![0.0; operators.row_idx.len()];
    operators.combine(c, d / reference_rate, &mut values);
    let mut factor = vec![0.0; cholesky.len()];
    cholesky.factor(
        "the body operator c A + d B (is the body clamped or otherwise held?)",
        (&operators.col_ptr, &operators.row_idx),
        &values,
        &mut factor,
        &mut memory,
    )?;
    let mut x = Mat::<f64>::zeros(n, m);
    let mut unit = vec![0.0; m];
    for j in 0..m {
        unit[j] = 1.0;
        if let Some(column) = x.col_mut(j).try_as_col_major_mut() {
            ports.expand(&unit, column.as_slice_mut());
        }
        unit[j] = 0.0;
    }
    cholesky.solve(&factor, x.as_mut(), &mut memory);

    let h = ports.project(&x);
    operators.combine(-d, c / reference_rate, &mut values);
    let derivative = quadratic(operators, &values, &x);
    let mut a = Mat::<f64>::zeros(m, m);
    let mut b = Mat::<f64>::zeros(m, m);
    for j in 0..m {
        for i in 0..m {
            a[(i, j)] = c * h[(i, j)] - d * derivative[(i, j)];
            b[(i, j)] = d * h[(i, j)] + c * derivative[(i, j)];
        }
    }
    Ok(Sample { angle, h, a, b })
}

/// `X^T K X`, block of columns by block of columns.
fn quadratic(operators: &OperatorPair, values: &[f64], x: &Mat<f64>) -> Mat<f64> {
    let (n, m) = (x.nrows(), x.ncols());
    let mut out = Mat::<f64>::zeros(m, m);
    let mut column = vec![0.0; n];
    for first in (0..m).step_by(BLOCK) {
        let width = BLOCK.min(m - first);
        let mut kx = Mat::<f64>::zeros(n, width);
        for j in 0..width {
            column
                .iter_mut()
                .zip(x.col(first + j).iter())
                .for_each(|(to, from)| *to = *from);
            if let Some(to) = kx.col_mut(j).try_as_col_major_mut() {
                operators.apply(values, &column, to.as_slice_mut());
            }
        }
        // only the rows from the block on: the matrix is symmetric
        matmul(
            out.as_mut().submatrix_mut(first, first, m - first, width),
            Accum::Replace,
            x.as_ref().subcols(first, m - first).transpose(),
            &kx,
            1.0,
            Par::Seq,
        );
    }
    mirror_lower(out.as_mut());
    out
}

fn symmetrise(a: &mut Mat<f64>) {
    for j in 0..a.ncols() {
        for i in 0..j {
            let mean = 0.5 * (a[(i, j)] + a[(j, i)]);
            a[(i, j)] = mean;
            a[(j, i)] = mean;
        }
    }
}
