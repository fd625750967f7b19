//! What the full and the condensed model share: the sparse operators, their symbolic factor, loads and outputs.
//!
//! A state is the displacement u and, for every branch of the memory, the strain of its dashpot as a field q_j. A stage eliminates
//! them:
//!
//! ```text
//! M = A + theta k B + sum_j tau_j theta k / (tau_j + theta k) C_j
//! M w = F f - B p - sum_j tau_j / (tau_j + theta k) C_j (p - p_j) - E Lambda
//! q_j' = (p - p_j + theta k w) / (tau_j + theta k)
//! ```

use crate::body::nonlinear::{Nonlinear, VISCOUS};
use crate::body::{Scratch, Stage};
use crate::bytes::{LARGEST, Reader, Writer, is_usable};
use crate::error::Result;
use crate::fem::{Body, BranchOperator, OperatorPair, StrainNorm};
use crate::linalg::{DenseCholesky, SparseCholesky};
use crate::scene::Scene;
use faer::Mat;

/// Right-hand sides solved together when the contact compliance is built.
pub const BLOCK: usize = 32;

/// A sparse row or column: pairs of free dof and value.
pub type SparseVector = Vec<(usize, f64)>;

/// The whole mesh.
pub struct Field {
    pub operators: OperatorPair,
    pub cholesky: SparseCholesky,
    /// Entries of the strain norm, where it is no combination of the operators.
    pub strain: Option<Vec<f64>>,
    /// The cells whose laws are not linear, where there are any.
    pub nonlinear: Option<Nonlinear>,
    pub contact_len: usize,
    /// Columns of forces: loads, then driven parts.
    pub loads: Vec<SparseVector>,
    /// Rows of the outputs that follow the loads: the probes.
    pub probes: Vec<SparseVector>,
}

impl Field {
    /// # Errors
    /// Those of [`SparseCholesky::new`] and [`Nonlinear::new`].
    pub fn new(scene: &Scene, body: &Body) -> Result<Field> {
        let operators = body.operators.clone();
        let cholesky = SparseCholesky::new(
            &operators.col_ptr,
            &operators.row_idx,
            &body.interior_places(),
        )?;
        Ok(Field {
            cholesky,
            strain: match &body.strain {
                StrainNorm::Combination(..) => None,
                StrainNorm::Assembled(values) => Some(values.clone()),
            },
            nonlinear: Nonlinear::new(scene, body)?,
            contact_len: body.contact_len(),
            loads: body.force_columns().cloned().collect(),
            probes: body
                .probes
                .iter()
                .flat_map(|p| p.rows.iter().cloned())
                .collect(),
            operators,
        })
    }

    /// Free dofs.
    pub fn len(&self) -> usize {
        self.operators.n
    }

    /// Length of a state.
    pub fn states(&self) -> usize {
        self.len() * (1 + self.operators.memory.len())
    }

    /// The fields of the branches of the memory in a state, or in what follows its displacement.
    fn branches<'a>(
        &'a self,
        fields: &'a [f64],
    ) -> impl Iterator<Item = (&'a BranchOperator, &'a [f64])> {
        let fields = fields.chunks_exact(self.len());
        self.operators.memory.iter().zip(fields)
    }

    /// Factors `A + theta_k B`, with the tangent of the stage, into `stage.factor`.
    ///
    /// # Errors
    /// [`crate::Error::NotPositiveDefinite`] when the body is not held.
    pub fn factor(&self, theta_k: f64, stage: &mut Stage, scratch: &mut Scratch) -> Result<()> {
        self.combine(theta_k, stage, scratch);
        self.cholesky.factor(
            "the stage operator A + theta k B (is the body clamped or otherwise held?)",
            &scratch.matrix,
            &mut stage.factor,
            &mut scratch.memory,
        )
    }

    /// `out = F f - B p`, with what the memory adds; `lags` become `p - p_j`.
    pub fn load(&self, stage: &Stage, p: &[f64], f: &[f64], out: &mut [f64], lags: &mut [f64]) {
        let (own, fields) = p.split_at(self.len());
        self.operators.apply(&self.operators.b, own, out);
        let implicit = stage.implicit();
        let lags = lags.chunks_exact_mut(self.len());
        for ((branch, field), lag) in self.branches(fields).zip(lags) {
            for ((lag, p), q) in lag.iter_mut().zip(own).zip(field) {
                *lag = p - q;
            }
            let weight = branch.lag_weight(1.0, implicit);
            self.operators.add_product(weight, &branch.c, lag, out);
        }
        out.iter_mut().for_each(|v| *v = -*v);
        for (column, intensity) in self.loads.iter().zip(f) {
            for &(dof, value) in column {
                out[dof] += value * intensity;
            }
        }
    }

    /// The rates of the branches' fields from the velocity of the body and the explicit lags.
    pub fn correct_branches(&self, stage: &Stage, w: &[f64], lags: &[f64], out: &mut [f64]) {
        let implicit = stage.implicit();
        let out = out.chunks_exact_mut(self.len());
        for ((branch, lag), out) in self.branches(lags).zip(out) {
            let scale = branch.tau + implicit;
            for ((out, lag), w) in out.iter_mut().zip(lag).zip(w) {
                *out = (lag + implicit * w) / scale;
            }
        }
    }

    /// `(x.A x, x.B x)` of a state, with the memory: for velocities what is dissipated, for displacements twice what is stored.
    pub fn products(&self, x: &[f64]) -> (f64, f64) {
        let (own, fields) = x.split_at(self.len());
        let operators = &self.operators;
        let (mut a, mut b) = operators.product(own, own);
        for (branch, field) in self.branches(fields) {
            a += branch.tau * operators.square(&branch.c, field);
            b += operators.square_of_difference(&branch.c, own, field);
        }
        (a, b)
    }

    /// `u.(B + sum C_j) u` of a displacement of the body alone.
    pub fn glassy_square(&self, u: &[f64]) -> f64 {
        let springs = self.operators.memory.iter();
        let springs = springs.map(|branch| self.operators.square(&branch.c, u));
        self.operators.product(u, u).1 + springs.sum::<f64>()
    }

    /// The entries of M into `scratch.matrix`.
    fn combine(&self, theta_k: f64, stage: &Stage, scratch: &mut Scratch) {
        self.operators.combine(1.0, theta_k, &mut scratch.matrix);
        for (entry, tangent) in scratch.matrix.iter_mut().zip(&stage.tangent) {
            *entry += tangent;
        }
    }

    /// `y = M x`.
    pub fn apply_stage(&self, stage: &Stage, x: &[f64], y: &mut [f64], scratch: &mut Scratch) {
        self.combine(stage.theta_k.unwrap_or_default(), stage, scratch);
        self.operators.apply(&scratch.matrix, x, y);
    }

    /// Length of the tangents of a stage.
    pub fn tangent_len(&self) -> usize {
        let entries = self.operators.row_idx.len();
        self.nonlinear.as_ref().map_or(0, |_| entries)
    }

    /// `A x` or `B x`.
    pub fn apply(&self, which: usize, x: &[f64], y: &mut [f64]) {
        let values = match which {
            VISCOUS => &self.operators.a,
            _ => &self.operators.b,
        };
        self.operators.apply(values, x, y);
    }

    /// The square of the strain norm, where it is assembled.
    pub fn strain_square(&self, x: &[f64]) -> f64 {
        let values = self.strain.as_deref();
        values.map_or(f64::NAN, |values| {
            self.operators.square(values, &x[..self.len()])
        })
    }

    pub fn outputs(&self, x: &[f64], out: &mut [f64]) {
        for (out, row) in out.iter_mut().zip(self.loads.iter().chain(&self.probes)) {
            *out = row.iter().map(|&(dof, value)| value * x[dof]).sum();
        }
    }

    /// Multiplications of `B p` and of the branches: the lower triangle serves both halves.
    pub fn applications(&self) -> usize {
        2 * self.operators.row_idx.len() * (1 + self.operators.memory.len())
    }

    pub fn scratch(&self) -> Scratch {
        let n = self.len();
        let bent = |length: usize| self.nonlinear.as_ref().map_or(0, |_| length);
        Scratch {
            excess: vec![0.0; bent(n)],
            fields: [vec![0.0; bent(n)], vec![0.0; bent(n)]],
            square: Mat::zeros(bent(self.contact_len), bent(self.contact_len)),
            columns: Mat::new(),
            free: vec![0.0; n],
            work: vec![0.0; n],
            lags: vec![0.0; self.states() - n],
            contact: vec![0.0; self.contact_len],
            matrix: vec![0.0; self.operators.row_idx.len()],
            dense: DenseCholesky::new(self.contact_len),
            memory: self.cholesky.scratch(BLOCK),
        }
    }

    pub fn bytes(&self) -> usize {
        let word = std::mem::size_of::<f64>();
        let vectors: usize = self
            .loads
            .iter()
            .chain(&self.probes)
            .map(|v| 2 * v.len())
            .sum();
        let strain = self.strain.as_ref().map_or(0, Vec::len);
        let nonlinear = self.nonlinear.as_ref().map_or(0, Nonlinear::bytes);
        let branches = self.operators.memory.len();
        word * ((3 + branches) * self.operators.row_idx.len() + strain + self.len() + vectors)
            + nonlinear
    }

    pub fn write(&self, out: &mut Writer) {
        let operators = &self.operators;
        out.indices(&operators.col_ptr);
        out.indices(&operators.row_idx);
        out.indices(self.cholesky.order());
        out.floats(&operators.a);
        out.floats(&operators.b);
        out.word(operators.memory.len() as u64);
        for branch in &operators.memory {
            out.float(branch.tau);
            out.floats(&branch.c);
        }
        self.strain.iter().for_each(|values| out.floats(values));
        self.nonlinear.iter().for_each(|cells| cells.write(out));
        for vector in self.loads.iter().chain(&self.probes) {
            out.word(vector.len() as u64);
            for &(dof, value) in vector {
                out.word(dof as u64);
                out.float(value);
            }
        }
    }

    /// Reads what [`Field::write`] wrote, for a scene and the given numbers of free dofs, contact components, loads and outputs, with or
    /// without a strain norm.
    ///
    /// # Errors
    /// [`crate::Error::Bytes`].
    pub fn read(
        from: &mut Reader,
        scene: &Scene,
        n: usize,
        contact_len: usize,
        loads: usize,
        outputs: usize,
        has_strain: bool,
    ) -> Result<Field> {
        let col_ptr = from.indices(usize::MAX)?;
        let row_idx = from.indices(n)?;
        let order = from.indices(n)?;
        let (a, b) = (from.finite()?, from.finite()?);
        let mut memory = Vec::new();
        for _ in 0..from.size()? {
            let (tau, c) = (from.float()?, from.finite()?);
            memory.push(BranchOperator { tau, c });
        }
        let strain = match has_strain {
            true => Some(from.finite()?),
            false => None,
        };
        let entries = row_idx.len();
        let is_lower_triangle = col_ptr.len() == n.saturating_add(1)
            && col_ptr[0] == 0
            && col_ptr[n] == entries
            && col_ptr.windows(2).enumerate().all(|(column, ends)| {
                // ascending rows that begin with the diagonal
                row_idx.get(ends[0]..ends[1]).is_some_and(|rows| {
                    rows.first() == Some(&column) && rows.windows(2).all(|r| r[0] < r[1])
                })
            });
        let is_complete = a.len() == entries
            && b.len() == entries
            && strain.as_ref().is_none_or(|values| values.len() == entries);
        if !is_lower_triangle || !is_complete || contact_len > n {
            return Err(Reader::refusal("the pattern of the operators is not one"));
        }
        let diagonal = || col_ptr[..n].iter().copied();
        // A may be nothing where there is no dashpot
        if !diagonal().all(|at| a[at] >= 0.0 && b[at] * LARGEST >= 1.0) {
            return Err(Reader::refusal(
                "the diagonal of an operator is not positive",
            ));
        }
        // ascending times of forms that are not negative
        let is_possible = |branch: &BranchOperator| {
            is_usable(branch.tau)
                && branch.tau * LARGEST >= 1.0
                && branch.c.len() == entries
                && diagonal().all(|at| branch.c[at] >= 0.0)
        };
        let is_ascending = memory.windows(2).all(|pair| pair[0].tau < pair[1].tau);
        if !(is_ascending && memory.iter().all(is_possible)) {
            return Err(Reader::refusal("the memory of the body is not one"));
        }
        let nonlinear = Nonlinear::read(from, scene, &col_ptr, &row_idx)?;
        let mut sparse = || -> Result<SparseVector> {
            let count = from.size()?;
            let mut vector = SparseVector::new();
            for _ in 0..count {
                let (dof, value) = (from.size()?, from.float()?);
                if dof >= n || !is_usable(value) {
                    return Err(Reader::refusal(format!("{value} at dof {dof} of {n}")));
                }
                vector.push((dof, value));
            }
            Ok(vector)
        };
        let mut vectors = (0..outputs).map(|_| sparse()).collect::<Result<Vec<_>>>()?;
        let probes = vectors.split_off(loads);
        Ok(Field {
            cholesky: SparseCholesky::with_order(&col_ptr, &row_idx, order, contact_len)?,
            strain,
            nonlinear,
            contact_len,
            loads: vectors,
            probes,
            operators: OperatorPair {
                n,
                col_ptr,
                row_idx,
                a,
                b,
                memory,
            },
        })
    }
}

/// Adds a force that may be absent.
pub fn add(to: &mut [f64], force: &[f64]) {
    for (to, force) in to.iter_mut().zip(force) {
        *to += force;
    }
}
