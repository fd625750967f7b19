//! The reduced model: the relaxation rates that the ports see. A step needs no mesh and no sparse matrix.
//!
//! In modal coordinates `A = I` and `B = diag(rates)`, so a stage is `w_j = (F_j f - rate_j p_j) / (1 + theta_k rate_j)`
//! and the contact compliance is `P diag(1 / (1 + theta_k rate)) P^T`, whatever the step size. A body with memory is the same, in
//! modes of its pencil with all branches.

use crate::body::{BodyModel, ModalMatrices, Scratch, Stage};
use crate::bytes::{Reader, Writer};
use crate::error::Result;
use crate::linalg::{StoredMatrix, modal, multiply, multiply_transposed};
use crate::scene::Precision;
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, Mat, MatMut, MatRef, Par};

pub struct Reduced {
    /// Relaxation rates, 1/s, ascending.
    pub rates: Vec<f64>,
    /// Contact velocities of every mode: states x contact length.
    pub contact: StoredMatrix,
    /// Loads, then probes, of every mode: states x outputs.
    pub outputs: Mat<f64>,
    /// How many of the outputs are loads.
    pub loads: usize,
    /// Where a material has no dashpot, the time sigma, s: the modes are those of `A + sigma B` and B then, so that A is
    /// `diag(1 - sigma rate)`. Else 0.
    pub sigma: f64,
    /// The strain norm (states x states), where the friction solver measures in it and it is no combination of A and B.
    pub strain: Option<Mat<f64>>,
}

impl BodyModel for Reduced {
    fn states(&self) -> usize {
        self.rates.len()
    }

    fn contact_len(&self) -> usize {
        self.contact.ncols()
    }

    fn factor_len(&self) -> usize {
        self.rates.len()
    }

    fn scratch(&self) -> Scratch {
        let (m, r) = (self.contact_len(), self.states());
        Scratch {
            work: vec![0.0; r],
            ..Scratch::of_modes(m, r)
        }
    }

    fn factor(&self, theta_k: f64, stage: &mut Stage, scratch: &mut Scratch) -> Result<()> {
        for (d, rate) in stage.factor.iter_mut().zip(&self.rates) {
            *d = 1.0 / (1.0 + (theta_k - self.sigma) * rate);
        }
        scratch.condense(&self.contact, stage)
    }

    fn predict(&self, stage: &Stage, p: &[f64], f: &[f64], r: &mut [f64], scratch: &mut Scratch) {
        let loads = self.outputs.as_ref().subcols(0, self.loads);
        multiply(loads, f, &mut scratch.free);
        modal::free_motion(&mut scratch.free, &self.rates, p, &stage.factor);
        self.contact
            .multiply_transposed(&scratch.free, &mut scratch.contact);
        multiply(stage.s.as_ref(), &scratch.contact, r);
    }

    fn correct(
        &self,
        stage: &Stage,
        _contact_velocity: &[f64],
        contact_force: &[f64],
        w: &mut [f64],
        scratch: &mut Scratch,
    ) {
        self.contact.multiply(contact_force, w);
        modal::corrected_motion(w, &scratch.free, &stage.factor);
    }

    fn products(&self, x: &[f64]) -> (f64, f64) {
        let (whole, elastic) = modal::squares(x, &self.rates);
        if self.sigma == 0.0 {
            return (whole, elastic);
        }
        // what is left of the difference may be rounding
        ((whole - self.sigma * elastic).max(0.0), elastic)
    }

    fn strain_square(&self, x: &[f64]) -> f64 {
        let Some(strain) = &self.strain else {
            return f64::NAN;
        };
        let of_column = |column: faer::ColRef<f64>| -> f64 {
            column.iter().zip(x).map(|(value, x)| value * x).sum()
        };
        strain
            .col_iter()
            .zip(x)
            .map(|(column, x)| of_column(column) * x)
            .sum()
    }

    fn cancelled_norm(&self, scratch: &Scratch) -> f64 {
        self.products(&scratch.free).1.sqrt()
    }

    fn outputs(&self, x: &[f64], out: &mut [f64]) {
        multiply_transposed(self.outputs.as_ref(), x, out);
    }

    fn matrices(&self) -> Option<ModalMatrices> {
        let rows = |matrix: MatRef<f64>| -> Vec<f64> {
            let rows = matrix.row_iter();
            rows.flat_map(|row| row.iter().copied().collect::<Vec<_>>())
                .collect()
        };
        Some(ModalMatrices {
            rates: self.rates.clone(),
            contact: rows(self.contact.to_double().as_ref()),
            outputs: rows(self.outputs.as_ref()),
        })
    }

    fn stage_multiplications(&self) -> usize {
        // the contact ports forward and backward, the loads, S once
        let (r, contact) = (self.states(), self.contact_len());
        r * (2 * contact + self.loads) + contact * contact
    }

    fn bytes(&self) -> usize {
        let numbers = self.rates.len() * (1 + self.outputs.ncols());
        let strain = self.strain.as_ref().map_or(0, |m| m.nrows() * m.ncols());
        (numbers + strain) * std::mem::size_of::<f64>() + self.contact.bytes()
    }

    fn write(&self, out: &mut Writer) {
        out.floats(&self.rates);
        out.float(self.sigma);
        self.contact.write(out);
        out.matrix(self.outputs.as_ref());
        self.strain
            .iter()
            .for_each(|strain| out.matrix(strain.as_ref()));
    }
}

impl Reduced {
    /// Contact compliance of `x A + y B` (lower triangle).
    pub fn compliance(&self, x: f64, y: f64) -> Mat<f64> {
        let m = self.contact.ncols();
        let mut compliance = Mat::zeros(m, m);
        let ports = self.contact.to_double();
        let to = compliance.as_mut();
        add_response(
            to,
            1.0,
            ports.as_ref(),
            &self.rates,
            (x, y - self.sigma * x),
        );
        compliance
    }

    /// Reads what [`BodyModel::write`] wrote, for the given numbers of contact components, loads and outputs, with or without a
    /// strain norm.
    ///
    /// # Errors
    /// [`crate::Error::Bytes`].
    pub fn read(
        from: &mut Reader,
        contact: usize,
        loads: usize,
        outputs: usize,
        precision: Precision,
        has_strain: bool,
    ) -> Result<Reduced> {
        let rates = from.finite()?;
        // fewer modes than contact components leave some of them without any motion
        if !rates.iter().all(|rate| *rate > 0.0) || rates.len() < contact {
            return Err(Reader::refusal(format!(
                "{} relaxation rates of {contact} contact components",
                rates.len()
            )));
        }
        let sigma = from.float()?;
        let fastest = rates.iter().copied().fold(0.0, f64::max);
        if !(sigma >= 0.0 && sigma * fastest <= 1.0 + 1e-9) {
            return Err(Reader::refusal(
                "a reduced model whose viscosity is negative",
            ));
        }
        let is_single = precision == Precision::Single;
        Ok(Reduced {
            contact: StoredMatrix::read(from, is_single, (rates.len(), contact))?,
            outputs: from.matrix(rates.len(), outputs)?,
            strain: match has_strain {
                true => Some(from.matrix(rates.len(), rates.len())?),
                false => None,
            },
            loads,
            sigma,
            rates,
        })
    }
}

/// Adds `weight ports^T diag(1 / (c + d rate)) ports` to the lower triangle of `to`.
pub fn add_response(
    to: MatMut<f64>,
    weight: f64,
    ports: MatRef<f64>,
    rates: &[f64],
    (c, d): (f64, f64),
) {
    let mut weighted = ports.to_owned();
    for j in 0..ports.ncols() {
        for (value, rate) in weighted.col_mut(j).iter_mut().zip(rates) {
            *value /= c + d * rate;
        }
    }
    matmul(
        to,
        BlockStructure::TriangularLower,
        Accum::Add,
        ports.transpose(),
        BlockStructure::Rectangular,
        weighted.as_ref(),
        BlockStructure::Rectangular,
        weight,
        Par::Seq,
    );
}
