//! What the full and the condensed model share: the sparse operators, their symbolic factor, loads and outputs.

use crate::error::Result;
use crate::fem::{Body, OperatorPair};
use crate::linalg::{DenseCholesky, SparseCholesky};
use crate::model::body_model::{Scratch, Stage};

/// Right-hand sides solved together when the contact compliance is built.
pub const BLOCK: usize = 32;

/// A sparse row or column: pairs of free dof and value.
pub type SparseVector = Vec<(usize, f64)>;

/// The whole mesh.
pub struct Field {
    pub operators: OperatorPair,
    pub cholesky: SparseCholesky,
    pub contact_len: usize,
    /// Load columns F.
    pub loads: Vec<SparseVector>,
    /// Rows of the outputs that follow the loads: the probes.
    pub probes: Vec<SparseVector>,
}

impl Field {
    /// # Errors
    /// Those of [`SparseCholesky::new`].
    pub fn new(body: &Body) -> Result<Field> {
        let operators = body.operators.clone();
        let cholesky =
            SparseCholesky::new(&operators.col_ptr, &operators.row_idx, body.contact_len())?;
        Ok(Field {
            cholesky,
            contact_len: body.contact_len(),
            loads: body.loads.iter().map(|l| l.entries.clone()).collect(),
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

    /// Factors `A + theta_k B` into `stage.factor`.
    ///
    /// # Errors
    /// [`crate::Error::NotPositiveDefinite`] when the body is not held.
    pub fn factor(&self, theta_k: f64, stage: &mut Stage, scratch: &mut Scratch) -> Result<()> {
        self.operators.combine(1.0, theta_k, &mut scratch.matrix);
        self.cholesky.factor(
            "the stage operator A + theta k B (is the body clamped or otherwise held?)",
            (&self.operators.col_ptr, &self.operators.row_idx),
            &scratch.matrix,
            &mut stage.factor,
            &mut scratch.memory,
        )
    }

    /// `out = F f - B p`.
    pub fn load(&self, p: &[f64], f: &[f64], out: &mut [f64]) {
        self.operators.apply(&self.operators.b, p, out);
        out.iter_mut().for_each(|v| *v = -*v);
        for (column, intensity) in self.loads.iter().zip(f) {
            for &(dof, value) in column {
                out[dof] += value * intensity;
            }
        }
    }

    pub fn outputs(&self, x: &[f64], out: &mut [f64]) {
        for (out, row) in out.iter_mut().zip(self.loads.iter().chain(&self.probes)) {
            *out = row.iter().map(|&(dof, value)| value * x[dof]).sum();
        }
    }

    pub fn scratch(&self) -> Scratch {
        let n = self.len();
        Scratch {
            free: vec![0.0; n],
            work: vec![0.0; n],
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
        word * (3 * self.operators.row_idx.len() + self.len() + vectors)
    }
}
