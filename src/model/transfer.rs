//! The transfer matrix of the body between its ports, from one sparse factorization and no dense basis.
//!
//! Ports are the tangential contact dofs, the loads and the probes; `P` is their n x m matrix. For the projective shift
//! `(c, d)` with `c^2 + d^2 = 1`, and `B` scaled by the reference rate, `H = P^T (c A + d B)^-1 P`. With the contact eliminated
//! last, the trailing block L of the factor is that of the contact, `H_cc = (L L^T)^-1`, and the other ports need one
//! elimination each:
//!
//! ```text
//! y_j = L_ii^-1 p_i,   r_j = p_c - L_ci y_j,   H_cj = L^-T L^-1 r_j,   H_jk = y_j . y_k + L^-1 r_j . L^-1 r_k
//! ```
//!
//! The derivative by the angle, `H' = -X^T (-d A + c B) X`, is had column by column with one more substitution and elimination
//! each, for these ports and for a few contact forces of the caller:
//!
//! ```text
//! x_j = L^-T [y_j, L_cc^-1 r_j],   v_j = (-d A + c B) x_j,   H'_cj = -L_cc^-T (L^-1 v_j)_c,   H'_jk = -x_j . v_k
//! ```
//!
//! Angle 0 is the instantaneous (viscous) response, a quarter turn the long-time (elastic) one.

use super::shifts::shift;
use crate::error::Result;
use crate::fem::{Body, OperatorPair};
use crate::linalg::{SparseCholesky, column, dot};
use dyn_stack::MemBuffer;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Mat, Par};

/// Columns that go through the factor together: a pass over it costs more than the arithmetic on one column.
const WIDTH: usize = 8;

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

    /// Dofs that are not in contact.
    fn interior(&self) -> usize {
        self.rows - self.contact_len
    }

    /// `P y`, into `out`.
    pub fn expand(&self, y: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        out[self.interior()..].copy_from_slice(&y[..self.contact_len]);
        for (column, y) in self.others.iter().zip(&y[self.contact_len..]) {
            for &(dof, value) in column {
                out[dof] += value * y;
            }
        }
    }
}

/// The transfer matrix at one angle, in factors.
pub struct Sample {
    /// Trailing block L of the factor, lower triangular: contact x contact.
    pub lower: Mat<f64>,
    /// `L^-1 r_j` of the ports that follow the contact: contact x others.
    pub condensed: Mat<f64>,
    /// `y_j . y_k`: what these ports do with the contact held: others x others.
    pub inside: Mat<f64>,
}

/// Columns of the derivative by the angle, for the ports that follow the contact and then the contact forces given.
pub struct Derivative {
    /// `(L^-1 v_j)_c`, so that `H'_cj = -L^-T` of it: contact x columns.
    pub condensed: Mat<f64>,
    /// `x_j . v_k`, minus `H'_jk`: others x columns.
    pub inside: Mat<f64>,
}

/// Samples the transfer matrix, with B divided by a reference rate; its memory serves all samples.
pub struct Sampler<'a> {
    ports: &'a PortMatrix,
    operators: &'a OperatorPair,
    cholesky: &'a SparseCholesky,
    reference_rate: f64,
    angle: f64,
    values: Vec<f64>,
    factor: Vec<f64>,
    memory: MemBuffer,
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
            angle: 0.0,
            values: vec![0.0; operators.row_idx.len()],
            factor: vec![0.0; cholesky.len()],
            memory: cholesky.scratch(1),
            load: vec![0.0; ports.rows],
            eliminated: vec![vec![0.0; ports.rows]; ports.others.len()],
        }
    }

    /// The sample at `angle`.
    ///
    /// # Errors
    /// [`crate::Error::NotPositiveDefinite`] when the body is not held.
    pub fn sample(&mut self, angle: f64) -> Result<Sample> {
        let (c, d) = shift(angle);
        self.angle = angle;
        let operators = self.operators;
        operators.combine(c, d / self.reference_rate, &mut self.values);
        self.cholesky.factor(
            "the body operator c A + d B (is the body clamped or otherwise held?)",
            (&operators.col_ptr, &operators.row_idx),
            &self.values,
            &mut self.factor,
            &mut self.memory,
        )?;
        for (port, eliminated) in self.ports.others.iter().zip(&mut self.eliminated) {
            self.load.fill(0.0);
            for &(dof, value) in port {
                self.load[dof] += value;
            }
            self.cholesky.reorder(&self.load, eliminated);
        }
        let lower = self.cholesky.trailing_factor(&self.factor);
        let condensed = eliminate(self.cholesky, &self.factor, &lower, &mut self.eliminated);
        let (others, interior) = (self.eliminated.len(), self.ports.interior());
        let inside = Mat::from_fn(others, others, |i, j| {
            let (yi, yj) = (&self.eliminated[i], &self.eliminated[j]);
            dot(&yi[..interior], &yj[..interior])
        });
        Ok(Sample {
            lower,
            condensed,
            inside,
        })
    }

    /// Columns of the derivative at the angle of the last `sample`, for the ports that follow the contact and for contact
    /// `forces` (contact x columns).
    pub fn derivative(&self, sample: &Sample, forces: &Mat<f64>) -> Derivative {
        let (n, contact, interior) = (self.ports.rows, forces.nrows(), self.ports.interior());
        let others = self.eliminated.len();
        let (c, d) = shift(self.angle);
        let mut turned = vec![0.0; self.values.len()];
        self.operators
            .combine(-d, c / self.reference_rate, &mut turned);

        // contact parts of the solutions: L_cc^-T of what is condensed
        let mut on_contact = Mat::<f64>::zeros(contact, others + forces.ncols());
        let mut of_others = on_contact.as_mut().subcols_mut(0, others);
        of_others.copy_from(&sample.condensed);
        let mut of_forces = on_contact.as_mut().subcols_mut(others, forces.ncols());
        of_forces.copy_from(forces);
        solve_lower_triangular_in_place(sample.lower.as_ref(), of_forces, Par::Seq);
        let upper = sample.lower.transpose();
        solve_upper_triangular_in_place(upper, on_contact.as_mut(), Par::Seq);

        let mut images: Vec<Vec<f64>> = vec![vec![0.0; n]; on_contact.ncols()];
        let mut solutions: Vec<Vec<f64>> = vec![vec![0.0; n]; others];
        let (mut rows, mut by_dofs) = (vec![[0.0; WIDTH]; n], vec![[0.0; WIDTH]; n]);
        for from in (0..images.len()).step_by(WIDTH) {
            rows.fill([0.0; WIDTH]);
            for (lane, j) in (from..images.len().min(from + WIDTH)).enumerate() {
                if let Some(eliminated) = self.eliminated.get(j) {
                    set_column(&mut rows[..interior], lane, eliminated);
                }
                let trailing = column(on_contact.as_ref(), j);
                set_column(&mut rows[interior..], lane, trailing);
            }
            self.cholesky.substitute_back_rows(&self.factor, &mut rows);
            for (lane, solution) in solutions.iter_mut().skip(from).take(WIDTH).enumerate() {
                get_column(&rows, lane, solution);
            }
            self.cholesky.restore(&rows, &mut by_dofs);
            self.operators.apply_rows(&turned, &by_dofs, &mut rows);
            by_dofs.copy_from_slice(&rows);
            self.cholesky.reorder(&by_dofs, &mut rows);
            for (lane, image) in images.iter_mut().skip(from).take(WIDTH).enumerate() {
                get_column(&rows, lane, image);
            }
        }
        let inside = Mat::from_fn(others, images.len(), |i, j| dot(&solutions[i], &images[j]));
        Derivative {
            condensed: eliminate(self.cholesky, &self.factor, &sample.lower, &mut images),
            inside,
        }
    }
}

/// Eliminates loads (in the order of the factor) down to the contact, and the contact too: `(L^-1 load)_c`, contact x loads.
fn eliminate(
    cholesky: &SparseCholesky,
    factor: &[f64],
    lower: &Mat<f64>,
    loads: &mut [Vec<f64>],
) -> Mat<f64> {
    let contact = lower.nrows();
    for loads in loads.chunks_mut(WIDTH) {
        let mut rows = vec![[0.0; WIDTH]; loads[0].len()];
        for (lane, load) in loads.iter().enumerate() {
            set_column(&mut rows, lane, load);
        }
        cholesky.eliminate_rows(factor, &mut rows);
        for (lane, load) in loads.iter_mut().enumerate() {
            get_column(&rows, lane, load);
        }
    }
    let mut condensed = Mat::from_fn(contact, loads.len(), |i, j| {
        loads[j][loads[j].len() - contact + i]
    });
    solve_lower_triangular_in_place(lower.as_ref(), condensed.as_mut(), Par::Seq);
    condensed
}

fn set_column(rows: &mut [[f64; WIDTH]], lane: usize, column: &[f64]) {
    for (row, value) in rows.iter_mut().zip(column) {
        row[lane] = *value;
    }
}

fn get_column(rows: &[[f64; WIDTH]], lane: usize, column: &mut [f64]) {
    for (value, row) in column.iter_mut().zip(rows) {
        *value = row[lane];
    }
}
