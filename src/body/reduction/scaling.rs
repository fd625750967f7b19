//! Ports made comparable in energy: unit forces at them store about as much at the middle sample.
//!
//! With the trailing factor of the middle sample, `S_mid = L_mid L_mid^T`, contact forces are counted in `T = L_mid^-T` and
//! other ports in the root t of their own response, divided by a weight. A sample in these units is a product, so that it is
//! symmetric, positive and as sharp as its factor, without any inverse:
//!
//! ```text
//! Z = L^-1 L_mid,   q_j = L^-1 r_j / t_j,   H = [Z q]^T [Z q] + diag(0, y_j . y_k / (t_j t_k))
//! ```

use super::transfer::Sample;
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, Mat, MatMut, MatRef, Par};

use crate::linalg::mirror_lower;

/// The units of the ports.
pub struct Scaling {
    /// Trailing factor of the middle sample.
    lower: Mat<f64>,
    /// Roots of the own responses of the ports that follow the contact (1 for a port that does nothing), divided by their
    /// weights.
    others: Vec<f64>,
}

/// Iterations of the subspace method that finds the smoothest contact forces; they only have to be smooth.
const SUBSPACE_ITERATIONS: usize = 8;

/// A sample in the units of the ports.
pub struct ScaledSample {
    /// Transfer matrix, m x m, exactly symmetric.
    pub h: Mat<f64>,
    /// Factor of its contact block `Z^T Z`, lower triangular.
    pub z: Mat<f64>,
}

impl Scaling {
    /// The units in which `middle` is near the identity, and the response of the port that follows the contact as the j-th
    /// is `weights[j]` squared.
    pub fn new(middle: &Sample, weights: &[f64]) -> Scaling {
        let own = |j: usize| {
            let condensed = middle.condensed.col(j);
            condensed.squared_norm_l2() + middle.inside[(j, j)]
        };
        let scale = |own: f64| if own > 0.0 { own.sqrt() } else { 1.0 };
        Scaling {
            lower: middle.lower.clone(),
            others: (0..weights.len())
                .map(|j| scale(own(j)) / weights[j])
                .collect(),
        }
    }

    /// Contact dofs.
    pub fn contact_len(&self) -> usize {
        self.lower.nrows()
    }

    /// A sample in these units.
    pub fn apply(&self, sample: &Sample) -> ScaledSample {
        let contact = self.contact_len();
        let m = contact + self.others.len();
        let mut stacked = Mat::<f64>::zeros(contact, m);
        let mut z = stacked.as_mut().subcols_mut(0, contact);
        z.copy_from(&self.lower);
        solve_lower_triangular_in_place(sample.lower.as_ref(), z, Par::Seq);
        for (j, scale) in self.others.iter().enumerate() {
            let column = stacked.col_mut(contact + j).iter_mut();
            for (to, from) in column.zip(sample.condensed.col(j).iter()) {
                *to = from / scale;
            }
        }
        let mut h = Mat::<f64>::zeros(m, m);
        gram(h.as_mut(), stacked.as_ref());
        for (j, tj) in self.others.iter().enumerate() {
            for (i, ti) in self.others.iter().enumerate().skip(j) {
                h[(contact + i, contact + j)] += sample.inside[(i, j)] / (ti * tj);
            }
        }
        mirror_lower(h.as_mut());
        ScaledSample {
            h,
            z: stacked.get(.., ..contact).to_owned(),
        }
    }

    /// Up to `count` orthonormal directions (contact x count) of scaled contact forces that move the contact most for their
    /// energy: the smoothest ones.
    pub fn smooth_directions(&self, count: usize) -> Mat<f64> {
        let contact = self.contact_len();
        let count = count.min(contact);
        // no symmetry of a mesh is orthogonal to this start
        let mut directions = Mat::from_fn(contact, count, |i, j| {
            ((i + 1) as f64 * (j + 1) as f64).sin()
        });
        for _ in 0..SUBSPACE_ITERATIONS {
            // the compliance in scaled units: L^-1 L^-T
            solve_upper_triangular_in_place(self.lower.transpose(), directions.as_mut(), Par::Seq);
            solve_lower_triangular_in_place(self.lower.as_ref(), directions.as_mut(), Par::Seq);
            directions = directions.qr().compute_thin_Q();
        }
        directions
    }

    /// Velocities at the scaled ports (ports x columns), from those at the ports.
    pub fn apply_to_velocities(&self, velocities: &Mat<f64>) -> Mat<f64> {
        let contact = self.contact_len();
        let mut out = velocities.clone();
        let on_contact = self.lower.transpose() * velocities.get(..contact, ..);
        out.as_mut().subrows_mut(0, contact).copy_from(&on_contact);
        for (i, scale) in self.others.iter().enumerate() {
            let row = out.row_mut(contact + i);
            row.iter_mut().for_each(|v| *v /= scale);
        }
        out
    }

    /// A symmetric matrix of velocities by forces (ports x ports) in these units.
    pub fn apply_to_matrix(&self, matrix: &Mat<f64>) -> Mat<f64> {
        let half = self.apply_to_velocities(matrix);
        self.apply_to_velocities(&half.transpose().to_owned())
    }

    /// Contact forces (N) of scaled ones, contact x columns.
    pub fn contact_forces(&self, scaled: &Mat<f64>) -> Mat<f64> {
        &self.lower * scaled
    }

    /// Scaled contact velocities of modes (states x contact).
    pub fn contact_velocities(&self, velocities: &Mat<f64>) -> Mat<f64> {
        velocities * &self.lower
    }

    /// Port velocities of modes (states x ports) back from scaled ports.
    pub fn unapply(&self, ports: &Mat<f64>) -> Mat<f64> {
        let contact = self.contact_len();
        let mut forces = ports.get(.., ..contact).transpose().to_owned();
        solve_upper_triangular_in_place(self.lower.transpose(), forces.as_mut(), Par::Seq);
        let mut out = ports.clone();
        out.as_mut()
            .subcols_mut(0, contact)
            .copy_from(forces.transpose());
        for (i, scale) in self.others.iter().enumerate() {
            let column = out.col_mut(contact + i);
            column.iter_mut().for_each(|v| *v *= scale);
        }
        out
    }

    /// Forces at the ports from forces at the scaled ports, in place.
    pub fn apply_to_forces(&self, mut forces: MatMut<f64>) {
        let contact = self.contact_len();
        let mut on_contact = Mat::<f64>::zeros(contact, forces.ncols());
        matmul(
            on_contact.as_mut(),
            BlockStructure::Rectangular,
            Accum::Replace,
            self.lower.as_ref(),
            BlockStructure::TriangularLower,
            forces.as_ref().subrows(0, contact),
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
        forces
            .as_mut()
            .subrows_mut(0, contact)
            .copy_from(&on_contact);
        for (i, scale) in self.others.iter().enumerate() {
            let row = forces.as_mut().row_mut(contact + i);
            row.iter_mut().for_each(|v| *v /= scale);
        }
    }
}

/// Lower triangle of `a^T a`.
fn gram(to: MatMut<f64>, a: MatRef<f64>) {
    matmul(
        to,
        BlockStructure::TriangularLower,
        Accum::Replace,
        a.transpose(),
        BlockStructure::Rectangular,
        a,
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
}
