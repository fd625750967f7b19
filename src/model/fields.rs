//! Responses that are kept as fields of the body: those to the loads and to the smoothest contact forces.
//!
//! Samples of the transfer matrix tell responses apart only as far as their energy is above the rounding of the samples. That
//! is largest where the whole body moves, and what a further shift adds to the response to a load is below it. Friction sees it
//! all the same: late in a run loads and stresses nearly balance, and errors in time go with the amplitude that is missed,
//! not with its energy. There are few of these forces, so their responses `(M^-1 A)^j M^-1 f`, M the operator of the middle
//! sample, are computed as fields, each made orthonormal in A to those before it as soon as it is there.
//!
//! With the fields Q, `M^-1 A Q = Q T + Z`, where Z has columns for the last responses alone, and the operator of a
//! shift `K = alpha M + beta A`, their products with the responses to the ports need few substitutions:
//!
//! ```text
//! P^T K^-1 A Q = (P^T Q T + alpha P^T K^-1 M Z) (alpha + beta T)^-1
//! ```

use super::shifts::shift;
use super::transfer::{Sample, Sampler};
use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, Scale};
use std::f64::consts::FRAC_PI_2;
use std::ops::SubAssign;

/// A response is dropped when this share of it is all that the others do not hold.
const DEPENDENT: f64 = 1e-11;
/// Share of the tolerance that the energy of what is missed of a response may have.
const SHARE: f64 = 0.5;
/// Most responses to a force.
const MOST: usize = 12;

/// How many responses to a force hold what it does to a body with rates in the interval, and whether they hold all of it.
pub fn depth([slowest, fastest]: [f64; 2], tolerance: f64) -> (usize, bool) {
    let root = (fastest / slowest).sqrt();
    // what a response leaves of the error of those before it
    let left = (root - 1.0) / (root + 1.0);
    let depth = 0.5 * (SHARE * tolerance).ln() / left.ln();
    (
        depth.ceil().clamp(1.0, MOST as f64) as usize,
        depth <= MOST as f64,
    )
}

/// Orthonormal fields.
pub struct Fields {
    /// The fields Q, by dofs: n x k.
    pub fields: Mat<f64>,
    /// B, divided by the reference rate, on the fields: k x k.
    pub elasticity: Mat<f64>,
    /// What the fields show at the ports: ports x k.
    pub seen: Mat<f64>,
    /// Angle of the operator M.
    angle: f64,
    /// T: k x k.
    recurrence: Mat<f64>,
    /// M Z without its columns that are 0: n x last.
    rest: Mat<f64>,
}

impl Fields {
    /// `depth` responses to each of the `forces` (n x count, by dofs), with the operator of the last `sample`.
    pub fn new(sampler: &mut Sampler, sample: &Sample, forces: Mat<f64>, depth: usize) -> Fields {
        let angle = sampler.angle();
        let operators = [0.0, FRAC_PI_2, angle].map(|angle| sampler.operator(angle));
        let [viscosity, elasticity, middle] = &operators;
        let (n, most) = (forces.nrows(), depth * forces.ncols());
        let mut basis = Basis {
            fields: Mat::with_capacity(n, most),
            images: Mat::with_capacity(n, most),
        };
        basis.fields.resize_with(n, 0, |_, _| 0.0);
        basis.images.resize_with(n, 0, |_, _| 0.0);
        let mut recurrence = Mat::<f64>::zeros(most, most);
        let mut latest = forces;
        for level in 0..=depth {
            // from A Q to M^-1 A Q, the columns of Q that are the latest
            sampler.respond(&sample.lower, latest.as_mut());
            let (to, responses) = (basis.fields.ncols(), latest.clone());
            if level < depth {
                basis.add(latest, |x| sampler.apply(viscosity, x));
                latest = basis.images.get(.., to..).to_owned();
            }
            if level > 0 {
                let shares = basis.images.transpose() * &responses;
                let from = to - responses.ncols();
                let mut block = recurrence.get_mut(..shares.nrows(), from..to);
                block.copy_from(shares);
            }
        }
        let Basis { fields, images } = basis;
        let (k, last) = (fields.ncols(), fields.ncols() - latest.ncols());
        let recurrence = recurrence.get(..k, ..k).to_owned();
        let of_last = &fields * recurrence.get(.., last..);
        let rest = images.get(.., last..) - sampler.apply(middle, of_last.as_ref());
        let stiff = fields.transpose() * sampler.apply(elasticity, fields.as_ref());
        Fields {
            elasticity: stiff,
            seen: sampler.ports().observe(fields.as_ref()),
            fields,
            angle,
            recurrence,
            rest,
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.fields.ncols()
    }

    /// What the responses to A times the fields show at the ports, at the angle of the last `sample`: ports x k.
    pub fn couple(&self, sampler: &mut Sampler, sample: &Sample) -> Mat<f64> {
        let ((c, d), (ci, di)) = (shift(self.angle), shift(sampler.angle()));
        let alpha = di / d;
        let beta = ci - c * alpha;
        let k = self.len();
        let mut sum = &self.seen * &self.recurrence;
        let of_rest = sampler.observe_responses(sample, self.rest.as_ref());
        let last = k - of_rest.ncols();
        let mut of_last = sum.as_mut().subcols_mut(last, k - last);
        of_last += Scale(alpha) * of_rest;
        let pair = Mat::from_fn(k, k, |i, j| {
            let same = if i == j { alpha } else { 0.0 };
            same + beta * self.recurrence[(i, j)]
        });
        let transposed = pair.transpose().partial_piv_lu().solve(sum.transpose());
        transposed.transpose().to_owned()
    }
}

/// Orthonormal fields, and A times them.
struct Basis {
    fields: Mat<f64>,
    images: Mat<f64>,
}

impl Basis {
    /// Adds what each of `block` has that the others have not, unless that is nothing.
    fn add(&mut self, mut block: Mat<f64>, viscosity: impl Fn(MatRef<f64>) -> Mat<f64>) {
        let mut held = vec![0.0; block.ncols()];
        // the second time for the rounding of the first
        for _ in 0..2 {
            let shares = self.images.transpose() * &block;
            block -= &self.fields * &shares;
            for (held, shares) in held.iter_mut().zip(shares.col_iter()) {
                *held += shares.squared_norm_l2();
            }
        }
        let mut images = viscosity(block.as_ref());
        let first = self.fields.ncols();
        for (j, held) in held.into_iter().enumerate() {
            let mut held = held;
            for _ in 0..2 {
                let (fields, known) = (self.fields.get(.., first..), self.images.get(.., first..));
                let shares = known.transpose() * block.col(j);
                block.col_mut(j).sub_assign(fields * &shares);
                images.col_mut(j).sub_assign(known * &shares);
                held += shares.squared_norm_l2();
            }
            let own = (block.col(j).transpose() * images.col(j)).max(0.0).sqrt();
            if own > DEPENDENT * held.sqrt() {
                let unit = Scale(1.0 / own);
                append(&mut self.fields, (block.col(j) * unit).as_mat());
                append(&mut self.images, (images.col(j) * unit).as_mat());
            }
        }
    }
}

/// Appends columns.
fn append(to: &mut Mat<f64>, columns: MatRef<f64>) {
    let from = to.ncols();
    let all = from + columns.ncols();
    to.resize_with(to.nrows(), all, |i, j| columns[(i, j - from)]);
}

#[cfg(test)]
mod tests {
    use super::super::port_matrix::PortMatrix;
    use super::*;
    use crate::fem::Body;
    use crate::linalg::SparseCholesky;
    use crate::mesh::Mesh;
    use crate::scene::{Scene, example};

    #[test]
    fn couplings_by_recurrence_are_those_by_substitution() {
        let cells = [("mesh.cells".to_string(), "[8, 4]".to_string())];
        let text = example("kazmi2014").unwrap();
        let scene = Scene::with_overrides(text, "kazmi2014", &cells).unwrap();
        let body = Body::assemble_on(&scene, Mesh::generate(&scene.mesh).unwrap()).unwrap();
        let operators = &body.operators;
        let (col_ptr, row_idx) = (&operators.col_ptr, &operators.row_idx);
        let cholesky = SparseCholesky::new(col_ptr, row_idx, &body.interior_places()).unwrap();
        let ports = PortMatrix::new(&body);
        let mut sampler = Sampler::new(&ports, operators, &cholesky, 10.0);
        let middle = sampler.sample(0.8).unwrap();
        let smooth = Mat::from_fn(ports.contact_len, 2, |i, j| ((i * (j + 1)) as f64).cos());
        let forces = ports.forces(1, &smooth);
        let fields = Fields::new(&mut sampler, &middle, forces, 6);
        assert_eq!(fields.len(), 18);

        let images = sampler.apply(&sampler.operator(0.0), fields.fields.as_ref());
        let gram = fields.fields.transpose() * &images;
        assert!((gram - Mat::<f64>::identity(18, 18)).norm_max() < 1e-12);
        for angle in [0.05, 0.8, 1.5] {
            let sample = sampler.sample(angle).unwrap();
            let expected = sampler.observe_responses(&sample, images.as_ref());
            let found = fields.couple(&mut sampler, &sample);
            assert!((found - &expected).norm_max() < 1e-11 * expected.norm_max());
        }
    }

    #[test]
    fn narrow_materials_need_few_fields_and_wide_ones_more_than_there_are() {
        assert_eq!(depth([0.7268, 1.3758], 1e-8), (6, true));
        assert_eq!(depth([0.01, 100.0], 1e-8), (MOST, false));
        assert_eq!(depth([1.0, 1.0], 1e-8), (1, true));
    }
}
