//! The field of the body from a state, on demand: for pictures and files, never in a step.

use super::port_matrix::PortMatrix;
use super::shifts::shift;
use crate::body::reduction::Synthesis;
use crate::error::Result;
use crate::fem::Body;
use crate::linalg::SparseCholesky;
use faer::{ColMut, ColRef, Mat};

impl Synthesis {
    /// Modal coordinates.
    pub fn states(&self) -> usize {
        self.forces.ncols()
    }

    /// Nodal field of modal coordinates `q`: `sum_i (c_i A + d_i B)^-1 P y_i`, `y_i` the port forces of shift i.
    ///
    /// # Errors
    /// [`crate::Error::NotPositiveDefinite`]; not for a body that could be reduced.
    pub fn field(&self, body: &Body, cholesky: &SparseCholesky, q: &[f64]) -> Result<Vec<f64>> {
        let ports = PortMatrix::new(body);
        let (n, m) = (body.len(), ports.len());
        let operators = &body.operators;
        let mut values = vec![0.0; operators.row_idx.len()];
        let mut factor = vec![0.0; cholesky.len()];
        let mut memory = cholesky.scratch(1);
        let mut field = vec![0.0; n];
        let mut part = vec![0.0; n];
        let forces = &self.forces * faer::ColRef::from_slice(q);
        let of_fields = &self.fields * (&self.of_fields * faer::ColRef::from_slice(q));
        field
            .iter_mut()
            .zip(of_fields.iter())
            .for_each(|(f, o)| *f += o);
        for (i, angle) in self.angles.iter().enumerate() {
            let (c, d) = shift(*angle);
            operators.combine(c, d / self.reference_rate + self.sigma * c, &mut values);
            cholesky.factor("the body operator", &values, &mut factor, &mut memory)?;
            let y: Vec<f64> = (0..m).map(|p| forces[i * m + p]).collect();
            ports.expand(&y, &mut part);
            let rhs = ColMut::from_slice_mut(&mut part).as_mat_mut();
            cholesky.solve(&factor, rhs, &mut memory);
            field.iter_mut().zip(&part).for_each(|(f, p)| *f += p);
        }
        Ok(field)
    }

    /// `V^T K V` for the fields V of all modes and the symmetric matrix K with these entries on the pattern of the operators. It
    /// holds twice as many numbers as the fields of all modes have.
    ///
    /// # Errors
    /// Those of [`Synthesis::field`].
    pub fn gram(&self, body: &Body, cholesky: &SparseCholesky, values: &[f64]) -> Result<Mat<f64>> {
        let ports = PortMatrix::new(body);
        let (n, m) = (body.len(), ports.len());
        let operators = &body.operators;
        let mut entries = vec![0.0; operators.row_idx.len()];
        let mut factor = vec![0.0; cholesky.len()];
        let mut memory = cholesky.scratch(1);
        let mut fields = &self.fields * &self.of_fields;
        let mut column = vec![0.0; n];
        for (i, angle) in self.angles.iter().enumerate() {
            let (c, d) = shift(*angle);
            operators.combine(c, d / self.reference_rate + self.sigma * c, &mut entries);
            cholesky.factor("the body operator", &entries, &mut factor, &mut memory)?;
            for (mut field, forces) in fields.col_iter_mut().zip(self.forces.col_iter()) {
                let y: Vec<f64> = forces.subrows(i * m, m).iter().copied().collect();
                ports.expand(&y, &mut column);
                let rhs = ColMut::from_slice_mut(&mut column).as_mat_mut();
                cholesky.solve(&factor, rhs, &mut memory);
                field += ColRef::from_slice(&column);
            }
        }
        let mut images = Mat::zeros(n, fields.ncols());
        for (field, mut image) in fields.col_iter().zip(images.col_iter_mut()) {
            let field: Vec<f64> = field.iter().copied().collect();
            operators.apply(values, &field, &mut column);
            image.copy_from(ColRef::from_slice(&column));
        }
        Ok(fields.transpose() * images)
    }
}
