//! The transfer matrix of the body between its ports, from one sparse factorization and no dense basis.
//!
//! Ports are the tangential contact dofs, the loads and the probes; `P` is their n x m matrix. For the projective shift
//! `(c, d)` with `c^2 + d^2 = 1`, and `B` scaled by the reference rate, `H = P^T (c A + d B)^-1 P`. With the contact eliminated
//! last, `K = L L^T` holds the block of the contact in its trailing block: `(L_cc L_cc^T)^-1`. The other ports need one
//! elimination each:
//!
//! ```text
//! y = L_ii^-1 p_i,   r = p_c - L_ci y,   H_cj = (L_cc L_cc^T)^-1 r_j,   H_jk = y_j . y_k + r_j . H_ck
//! ```
//!
//! Angle 0 is the instantaneous (viscous) response, a quarter turn the long-time (elastic) one.

use super::shifts::shift;
use crate::error::Result;
use crate::fem::{Body, OperatorPair};
use crate::linalg::{DenseCholesky, SparseCholesky, column, dot, multiply};
use dyn_stack::MemBuffer;
use faer::Mat;

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
}

/// Samples the transfer matrix, with B divided by a reference rate; its memory serves all samples.
pub struct Sampler<'a> {
    ports: &'a PortMatrix,
    operators: &'a OperatorPair,
    cholesky: &'a SparseCholesky,
    reference_rate: f64,
    values: Vec<f64>,
    factor: Vec<f64>,
    memory: MemBuffer,
    dense: DenseCholesky,
    load: Vec<f64>,
    eliminated: Vec<Vec<f64>>,
}

impl<'a> Sampler<'a> {
    pub fn new(
        ports: &'a PortMatrix,
        operators: &'a OperatorPair,
        cholesky: &'a SparseCholesky,
        reference_rate: f64,
    ) -> Sampler<'a> {
        Sampler {
            ports,
            operators,
            cholesky,
            reference_rate,
            values: vec![0.0; operators.row_idx.len()],
            factor: vec![0.0; cholesky.len()],
            memory: cholesky.scratch(1),
            dense: DenseCholesky::new(ports.contact_len),
            load: vec![0.0; ports.rows],
            eliminated: vec![vec![0.0; ports.rows]; ports.others.len()],
        }
    }

    /// `H` at `angle`, m x m, exactly symmetric.
    ///
    /// # Errors
    /// [`crate::Error::NotPositiveDefinite`] when the body is not held.
    pub fn sample(&mut self, angle: f64) -> Result<Mat<f64>> {
        let (c, d) = shift(angle);
        let operators = self.operators;
        operators.combine(c, d / self.reference_rate, &mut self.values);
        self.cholesky.factor(
            "the body operator c A + d B (is the body clamped or otherwise held?)",
            (&operators.col_ptr, &operators.row_idx),
            &self.values,
            &mut self.factor,
            &mut self.memory,
        )?;
        let (m, contact) = (self.ports.len(), self.ports.contact_len);
        let interior = self.ports.rows - contact;
        self.dense
            .adopt(self.cholesky.trailing_factor(&self.factor).as_ref());
        let mut h = Mat::<f64>::zeros(m, m);
        self.dense
            .inverse(h.as_mut().submatrix_mut(0, 0, contact, contact));
        for (port, eliminated) in self.ports.others.iter().zip(&mut self.eliminated) {
            self.load.fill(0.0);
            for &(dof, value) in port {
                self.load[dof] += value;
            }
            self.cholesky.reorder(&self.load, eliminated);
        }
        let mut loads: Vec<&mut [f64]> =
            self.eliminated.iter_mut().map(Vec::as_mut_slice).collect();
        self.cholesky.eliminate_reordered(&self.factor, &mut loads);
        let compliance = h.as_ref().submatrix(0, 0, contact, contact).to_owned();
        for (j, y) in self.eliminated.iter().enumerate() {
            let at = contact + j;
            let (inside, condensed) = y.split_at(interior);
            let seen = h.as_mut().submatrix_mut(0, at, contact, 1).col_mut(0);
            if let Some(seen) = seen.try_as_col_major_mut() {
                multiply(compliance.as_ref(), condensed, seen.as_slice_mut());
            }
            for (i, other) in self.eliminated[..=j].iter().enumerate() {
                let (other_inside, other_condensed) = other.split_at(interior);
                let through = dot(&column(h.as_ref(), at)[..contact], other_condensed);
                h[(contact + i, at)] = dot(inside, other_inside) + through;
            }
        }
        for j in 0..m {
            for i in j.max(contact)..m {
                h[(i, j)] = h[(j, i)];
            }
        }
        Ok(h)
    }
}
