//! Where forces on a body act and its velocities are seen: the columns of the matrix P.

use crate::fem::Body;
use faer::{Mat, MatRef};

/// The ports of a body: contact dofs, then loads and driven parts, then probes.
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
        let loads = body.force_columns().cloned();
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
    pub fn interior(&self) -> usize {
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

    /// Forces of the loads and the given contact forces (contact x count): n x columns, by dofs.
    pub fn forces(&self, loads: usize, on_contact: &Mat<f64>) -> Mat<f64> {
        let mut forces = Mat::zeros(self.rows, loads + on_contact.ncols());
        for (j, column) in self.others[..loads].iter().enumerate() {
            for &(dof, value) in column {
                forces[(dof, j)] += value;
            }
        }
        let mut rest = forces.get_mut(self.interior().., loads..);
        rest.copy_from(on_contact);
        forces
    }

    /// Some columns of P.
    pub fn columns(&self, range: std::ops::Range<usize>) -> Mat<f64> {
        let mut columns = Mat::zeros(self.rows, range.len());
        for (j, port) in range.enumerate() {
            match port.checked_sub(self.contact_len) {
                None => columns[(self.interior() + port, j)] = 1.0,
                Some(other) => {
                    for &(dof, value) in &self.others[other] {
                        columns[(dof, j)] += value;
                    }
                }
            }
        }
        columns
    }

    /// `P^T x`: ports x columns.
    pub fn observe(&self, x: MatRef<f64>) -> Mat<f64> {
        let (contact, interior) = (self.contact_len, self.interior());
        Mat::from_fn(self.len(), x.ncols(), |port, j| {
            match port.checked_sub(contact) {
                None => x[(interior + port, j)],
                Some(other) => {
                    let column = self.others[other].iter();
                    column.map(|&(dof, value)| value * x[(dof, j)]).sum()
                }
            }
        })
    }
}
