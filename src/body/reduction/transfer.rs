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
//! Angle 0 is the instantaneous (viscous) response, a quarter turn the long-time (elastic) one.
//!
//! Where a material has no dashpot A is singular. Then `A + sigma B` stands for A, with a time sigma far below the implicit weights of
//! steps: a change of the shift, `c A + d B = c (A + sigma B) + (d - c sigma) B`, that makes an infinite rate `1 / sigma`.
//!
//! With memory the pencil is that of `crate::body`, `A_ext = diag(A, tau_j C_j)`, `B_ext = [[B + sum C_j, -C_j], [-C_j, C_j]]`, its
//! branches eliminated: `M(c, d) = c A + d B + sum_j c d tau_j / (c tau_j + d) C_j` stands for `c A + d B`, and a field x of the body
//! with its branches (x_j) is responded to by
//!
//! ```text
//! M u = A x + sum_j d tau_j / (c tau_j + d) C_j x_j,   q_j = (tau_j x_j + d u) / (c tau_j + d)
//! ```

use super::port_matrix::PortMatrix;
use super::shifts::shift;
use crate::error::Result;
use crate::fem::OperatorPair;
use crate::linalg::SparseCholesky;
use dyn_stack::MemBuffer;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::reborrow::ReborrowMut;
use faer::{Mat, MatMut, MatRef, Par, Scale, unzip, zip};

/// Columns that go through the factor together: a pass over it costs more than the arithmetic on one column.
const WIDTH: usize = 4;
/// Columns whose responses are held at a time.
const BLOCK: usize = 32;
/// Rows whose products are summed by themselves first.
const PIECE: usize = 256;

/// The transfer matrix at one angle, in factors.
pub struct Sample {
    /// Trailing block L of the factor, lower triangular: contact x contact.
    pub lower: Mat<f64>,
    /// `L^-1 r_j` of the ports that follow the contact: contact x others.
    pub condensed: Mat<f64>,
    /// `y_j . y_k`: what these ports do with the contact held: others x others.
    pub inside: Mat<f64>,
}

/// WIDTH columns that go through the factor together, row by row in the order of the factor.
type Group = Vec<[f64; WIDTH]>;

/// Samples the transfer matrix, with B divided by a reference rate; its memory serves all samples.
pub struct Sampler<'a> {
    ports: &'a PortMatrix,
    operators: &'a OperatorPair,
    cholesky: &'a SparseCholesky,
    reference_rate: f64,
    /// sigma, s; 0 where A is positive.
    sigma: f64,
    angle: f64,
    values: Vec<f64>,
    factor: Vec<f64>,
    memory: MemBuffer,
    /// The ports that follow the contact, by dofs and, eliminated at the angle, in the order of the factor.
    loads: Vec<Group>,
    eliminated: Vec<Group>,
    by_dofs: Group,
    rows: Group,
}

impl<'a> Sampler<'a> {
    pub fn new(
        ports: &'a PortMatrix,
        operators: &'a OperatorPair,
        cholesky: &'a SparseCholesky,
        (reference_rate, sigma): (f64, f64),
    ) -> Sampler<'a> {
        let empty = || vec![[0.0; WIDTH]; ports.rows];
        let of_group = |columns: &[Vec<(usize, f64)>]| {
            let mut load = empty();
            for (lane, column) in columns.iter().enumerate() {
                for &(dof, value) in column {
                    load[dof][lane] += value;
                }
            }
            load
        };
        let loads: Vec<Group> = ports.others.chunks(WIDTH).map(of_group).collect();
        Sampler {
            ports,
            operators,
            cholesky,
            reference_rate,
            sigma,
            angle: 0.0,
            values: vec![0.0; operators.row_idx.len()],
            factor: vec![0.0; cholesky.len()],
            memory: cholesky.scratch(1),
            eliminated: loads.iter().map(|_| empty()).collect(),
            loads,
            by_dofs: empty(),
            rows: empty(),
        }
    }

    /// The sample at `angle`.
    ///
    /// # Errors
    /// [`crate::Error::NotPositiveDefinite`] when the body is not held.
    pub fn sample(&mut self, angle: f64) -> Result<Sample> {
        self.angle = angle;
        let (c, d) = self.scaled_shift(angle);
        let operators = self.operators;
        operators.combine(c, d, &mut self.values);
        self.cholesky.factor(
            "the body operator c A + d B (is the body clamped or otherwise held?)",
            &self.values,
            &mut self.factor,
            &mut self.memory,
        )?;
        let lower = self.cholesky.trailing_factor(&self.factor);
        let (others, interior) = (self.ports.others.len(), self.ports.interior());
        let mut condensed = Mat::zeros(lower.nrows(), others);
        for (g, (load, group)) in self.loads.iter().zip(&mut self.eliminated).enumerate() {
            self.cholesky.reorder(load, group);
            self.cholesky.eliminate_rows(&self.factor, group);
            get_columns(&group[interior..], condensed.as_mut(), g * WIDTH);
        }
        solve_lower_triangular_in_place(lower.as_ref(), condensed.as_mut(), Par::Seq);
        let mut inside = Mat::zeros(others, others);
        for (i, a) in self.eliminated.iter().enumerate() {
            for (j, b) in self.eliminated.iter().enumerate() {
                let (a, b) = (&a[..interior], &b[..interior]);
                products(a, b, inside.as_mut(), (i * WIDTH, j * WIDTH));
            }
        }
        Ok(Sample {
            lower,
            condensed,
            inside,
        })
    }

    /// The ports of the body.
    pub fn ports(&self) -> &'a PortMatrix {
        self.ports
    }

    /// What B is divided by, 1/s.
    pub fn reference_rate(&self) -> f64 {
        self.reference_rate
    }

    /// sigma, s.
    pub fn sigma(&self) -> f64 {
        self.sigma
    }

    /// The angle of the last sample.
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// Values of the operator at `angle`.
    pub fn operator(&self, angle: f64) -> Vec<f64> {
        let (c, d) = self.scaled_shift(angle);
        let mut values = vec![0.0; self.operators.row_idx.len()];
        self.operators.combine(c, d, &mut values);
        values
    }

    /// Values of A, with those of sigma B.
    pub fn viscosity(&self) -> Vec<f64> {
        let both = self.operators.a.iter().zip(&self.operators.b);
        both.map(|(a, b)| a + self.sigma * b).collect()
    }

    /// An operator with the given values times the columns of `x` (by dofs).
    pub fn apply(&mut self, operator: &[f64], x: MatRef<f64>) -> Mat<f64> {
        let mut out = Mat::zeros(x.nrows(), x.ncols());
        for j in (0..x.ncols()).step_by(WIDTH) {
            set_columns(&mut self.by_dofs, x, j);
            self.operators
                .apply_rows(operator, &self.by_dofs, &mut self.rows);
            get_columns(&self.rows, out.as_mut(), j);
        }
        out
    }

    /// Whether the body has memory: fields then hold its branches too.
    pub fn has_memory(&self) -> bool {
        !self.operators.memory.is_empty()
    }

    /// Rows of a field with the branches of the memory.
    pub fn field_len(&self) -> usize {
        self.ports.rows * (1 + self.operators.memory.len())
    }

    /// `A_ext x` (with sigma `B_ext x` added) for the columns of `x`; `viscosity` has the values of A (with those of sigma B).
    pub fn viscous_images(&mut self, viscosity: &[f64], x: MatRef<f64>) -> Mat<f64> {
        let (n, operators) = (self.ports.rows, self.operators);
        let mut out = Mat::zeros(x.nrows(), x.ncols());
        let own = self.apply(viscosity, x.subrows(0, n));
        out.as_mut().subrows_mut(0, n).copy_from(own);
        for (j, branch) in operators.memory.iter().enumerate() {
            let at = (1 + j) * n;
            let image = self.apply(&branch.c, x.subrows(at, n));
            let to = out.as_mut().subrows_mut(at, n);
            zip!(to, &image).for_each(|unzip!(to, image)| *to = branch.tau * image);
            if self.sigma > 0.0 {
                let lag = x.subrows(0, n) - x.subrows(at, n);
                let force = Scale(self.sigma) * self.apply(&branch.c, lag.as_ref());
                let mut own = out.as_mut().subrows_mut(0, n);
                own += &force;
                let mut to = out.as_mut().subrows_mut(at, n);
                to -= &force;
            }
        }
        out
    }

    /// `B_ext x` divided by the reference rate, for the columns of `x`; `elasticity` has the values of B by that rate.
    pub fn elastic_images(&mut self, elasticity: &[f64], x: MatRef<f64>) -> Mat<f64> {
        let (n, operators) = (self.ports.rows, self.operators);
        let own = x.subrows(0, n);
        let mut out = Mat::zeros(x.nrows(), x.ncols());
        let image = self.apply(elasticity, own);
        out.as_mut().subrows_mut(0, n).copy_from(image);
        for (j, branch) in operators.memory.iter().enumerate() {
            let at = (1 + j) * n;
            let lag = own - x.subrows(at, n);
            let force = Scale(1.0 / self.reference_rate) * self.apply(&branch.c, lag.as_ref());
            let mut to = out.as_mut().subrows_mut(0, n);
            to += &force;
            let to = out.as_mut().subrows_mut(at, n);
            zip!(to, &force).for_each(|unzip!(to, force)| *to = -force);
        }
        out
    }

    /// `x . B_ext y` divided by the reference rate, for all columns of `x` with themselves; `elasticity` has the values of B by
    /// that rate.
    pub fn elastic_gram(&mut self, elasticity: &[f64], x: MatRef<f64>) -> Mat<f64> {
        let (n, operators) = (self.ports.rows, self.operators);
        let own = x.subrows(0, n);
        let mut gram = own.transpose() * self.apply(elasticity, own);
        for (j, branch) in operators.memory.iter().enumerate() {
            let lag = own - x.subrows((1 + j) * n, n);
            let image = self.apply(&branch.c, lag.as_ref());
            gram += Scale(1.0 / self.reference_rate) * (lag.transpose() * image);
        }
        gram
    }

    /// What `A_ext x` does to the body once the branches are eliminated at the angle of the last sample: n x columns. `image` is
    /// `A_ext x`.
    pub fn eliminated_image(&mut self, image: MatRef<f64>) -> Mat<f64> {
        let n = self.ports.rows;
        let (c, d) = self.scaled_shift(self.angle);
        let mut out = image.subrows(0, n).to_owned();
        for (j, branch) in self.operators.memory.iter().enumerate() {
            let weight = d / (c * branch.tau + d);
            out += Scale(weight) * image.subrows((1 + j) * n, n);
        }
        out
    }

    /// The field with its branches of a response `u` at the angle of the last sample to `A_ext x`, or to forces on the body alone.
    pub fn with_branches(&self, u: Mat<f64>, x: Option<MatRef<f64>>) -> Mat<f64> {
        if !self.has_memory() {
            return u;
        }
        let n = self.ports.rows;
        let (c, d) = self.scaled_shift(self.angle);
        let mut out = Mat::zeros(self.field_len(), u.ncols());
        for (j, branch) in self.operators.memory.iter().enumerate() {
            let tau = branch.tau;
            let scale = c * tau + d;
            let mut to = out.as_mut().subrows_mut((1 + j) * n, n);
            zip!(to.rb_mut(), &u).for_each(|unzip!(to, u)| *to = d * u / scale);
            if let Some(x) = x {
                let from = x.subrows((1 + j) * n, n);
                zip!(to.rb_mut(), from).for_each(|unzip!(to, x)| *to += tau * x / scale);
                if self.sigma > 0.0 {
                    let lag = x.subrows(0, n) - from;
                    zip!(to, &lag).for_each(|unzip!(to, lag)| *to -= self.sigma * lag / scale);
                }
            }
        }
        out.as_mut().subrows_mut(0, n).copy_from(u);
        out
    }

    /// `(c, d)` of A and B at an angle.
    fn scaled_shift(&self, angle: f64) -> (f64, f64) {
        let (c, d) = shift(angle);
        (c, d / self.reference_rate + self.sigma * c)
    }

    /// Solves with the operator of the last sample, in place, for all columns of `forces` (by dofs).
    pub fn respond(&mut self, lower: &Mat<f64>, mut forces: MatMut<f64>) {
        let interior = self.ports.interior();
        for j in (0..forces.ncols()).step_by(WIDTH) {
            set_columns(&mut self.by_dofs, forces.as_ref(), j);
            self.cholesky.reorder(&self.by_dofs, &mut self.rows);
            self.cholesky.eliminate_rows(&self.factor, &mut self.rows);
            let mut on_contact = Mat::zeros(lower.nrows(), WIDTH);
            get_columns(&self.rows[interior..], on_contact.as_mut(), 0);
            solve_lower_triangular_in_place(lower.as_ref(), on_contact.as_mut(), Par::Seq);
            let upper = lower.transpose();
            solve_upper_triangular_in_place(upper, on_contact.as_mut(), Par::Seq);
            set_columns(&mut self.rows[interior..], on_contact.as_ref(), 0);
            self.cholesky
                .substitute_back_rows(&self.factor, &mut self.rows);
            self.cholesky.restore(&self.rows, &mut self.by_dofs);
            get_columns(&self.by_dofs, forces.rb_mut(), j);
        }
    }

    /// What the responses to `forces` (by dofs) at the angle of the last `sample` show at the ports: ports x forces.
    pub fn observe_responses(&mut self, sample: &Sample, forces: MatRef<f64>) -> Mat<f64> {
        let (contact, interior) = (self.ports.contact_len, self.ports.interior());
        let mut seen = Mat::zeros(self.ports.len(), forces.ncols());
        for from in (0..forces.ncols()).step_by(WIDTH) {
            set_columns(&mut self.by_dofs, forces, from);
            let rows = &mut self.rows;
            self.cholesky.reorder(&self.by_dofs, rows);
            self.cholesky.eliminate_rows(&self.factor, rows);
            for (i, group) in self.eliminated.iter().enumerate() {
                let (a, b) = (&group[..interior], &rows[..interior]);
                products(a, b, seen.as_mut(), (contact + i * WIDTH, from));
            }
            get_columns(
                &rows[interior..],
                seen.as_mut().subrows_mut(0, contact),
                from,
            );
        }
        let (on_contact, others) = seen.as_mut().split_at_row_mut(contact);
        let mut on_contact = on_contact;
        solve_lower_triangular_in_place(sample.lower.as_ref(), on_contact.rb_mut(), Par::Seq);
        let mut others = others;
        others += sample.condensed.transpose() * &on_contact;
        let upper = sample.lower.transpose();
        solve_upper_triangular_in_place(upper, on_contact, Par::Seq);
        seen
    }
}

impl Sampler<'_> {
    /// Derivative of the transfer matrix by the angle at the last `sample`: `-P^T M^-1 M' M^-1 P`, ports x ports, block by block.
    pub fn derivative(&mut self, sample: &Sample) -> Mat<f64> {
        let (c, d) = shift(self.angle);
        let along = (-d, c / self.reference_rate - self.sigma * d);
        let mut slope = vec![0.0; self.operators.row_idx.len()];
        self.operators
            .combine_slope(self.scaled_shift(self.angle), along, &mut slope);
        let m = self.ports.len();
        let mut derivative = Mat::zeros(m, m);
        for from in (0..m).step_by(BLOCK) {
            let mut columns = self.ports.columns(from..m.min(from + BLOCK));
            self.respond(&sample.lower, columns.as_mut());
            let images = self.apply(&slope, columns.as_ref());
            let seen = self.observe_responses(sample, images.as_ref());
            let to = derivative.as_mut().subcols_mut(from, seen.ncols());
            zip!(to, &seen).for_each(|unzip!(to, seen)| *to = -seen);
        }
        Scale(0.5) * (&derivative + derivative.transpose())
    }

    /// Multiplications of such a derivative.
    pub fn derivative_work(&self) -> f64 {
        4.0 * self.ports.len() as f64 * (self.factor.len() + self.operators.row_idx.len()) as f64
    }
}

/// Writes the columns from `from` on into the lanes of `rows`; lanes without a column become 0.
fn set_columns(rows: &mut [[f64; WIDTH]], columns: MatRef<f64>, from: usize) {
    rows.fill([0.0; WIDTH]);
    for (lane, j) in (from..columns.ncols().min(from + WIDTH)).enumerate() {
        for (row, value) in rows.iter_mut().zip(columns.col(j).iter()) {
            row[lane] = *value;
        }
    }
}

/// Reads the columns from `from` on from the lanes of `rows`.
fn get_columns(rows: &[[f64; WIDTH]], mut columns: MatMut<f64>, from: usize) {
    for (lane, j) in (from..columns.ncols().min(from + WIDTH)).enumerate() {
        for (value, row) in columns.rb_mut().col_mut(j).iter_mut().zip(rows) {
            *value = row[lane];
        }
    }
}

/// Products of the columns in the lanes of `a` with those of `b`, into the block of `out` at `(i, j)` as far as it reaches.
fn products(a: &[[f64; WIDTH]], b: &[[f64; WIDTH]], mut out: MatMut<f64>, (i, j): (usize, usize)) {
    let (lanes, columns) = (WIDTH.min(out.nrows() - i), WIDTH.min(out.ncols() - j));
    for lane in 0..lanes {
        // sums of sums of PIECE rows: rounding grows with their lengths
        let mut sums = [0.0; WIDTH];
        for (a, b) in a.chunks(PIECE).zip(b.chunks(PIECE)) {
            let mut piece = [0.0; WIDTH];
            for (a, b) in a.iter().zip(b) {
                for (sum, b) in piece.iter_mut().zip(b) {
                    *sum += a[lane] * b;
                }
            }
            sums.iter_mut().zip(piece).for_each(|(s, p)| *s += p);
        }
        for (column, sum) in sums.iter().enumerate().take(columns) {
            out[(i + lane, j + column)] = *sum;
        }
    }
}
