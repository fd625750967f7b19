//! Responses that are kept as fields of the body: those to the loads and to the smoothest contact forces.
//!
//! Samples of the transfer matrix distinguish two responses only when their difference has more energy than the rounding of the
//! samples. Rounding is largest for motions of the whole body, and what a further shift adds to the response to a load is
//! below it. Friction reacts to it all the same: late in a run loads and stresses nearly balance, and the error of the slip
//! rate is proportional to the missing amplitude, not to its energy. There are few such forces. So their responses
//! `(M^-1 A)^j M^-1 f`, M the operator of the middle sample, are computed as fields, and each is made orthonormal in A to
//! the ones before it.
//!
//! Let `A Q_1 = M Q T` for all fields Q but the last responses, `Q = [Q_1 Q_2]`, with `M = c A + d B`. Their products with the
//! responses to the ports at a shift `K = alpha M + beta A` then need substitutions for the few fields of Q_2 alone:
//!
//! ```text
//! alpha P^T K^-1 A Q_1 + beta P^T K^-1 A Q T = P^T Q T
//! ```

use super::basis::Basis;
use super::shifts::shift;
use super::transfer::{Sample, Sampler};
use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, Scale};
use std::f64::consts::FRAC_PI_2;

/// Share of the tolerance that the energy of what is missed of a response to contact forces may have.
const SHARE: f64 = 0.5;
/// Most responses to a force.
const MOST: usize = 12;
/// Most loads whose responses are kept: a field is as long as the body.
const MOST_LOADS: usize = 6;

/// How many responses to a force are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Depth {
    /// To a load, and to a smooth contact force.
    loads: usize,
    smooth: usize,
    /// Whether these fields alone represent the response of the body to the forces to the tolerance, at every shift.
    pub holds_all: bool,
}

impl Depth {
    /// For a body with rates in the interval. What loads do to the contact is asked for to a smaller error, by the factor
    /// `emphasis`: that error is the mean of what is missed of a load and, by truncation, of the contact forces, which is allowed
    /// the share `truncation` of the tolerance.
    pub fn new(
        [slowest, fastest]: [f64; 2],
        tolerance: f64,
        emphasis: f64,
        truncation: f64,
    ) -> Depth {
        let root = (fastest / slowest).sqrt();
        // what a response leaves of the error of those before it
        let left = (root - 1.0) / (root + 1.0);
        let depth = |missed: f64| (0.5 * (missed * tolerance).ln() / left.ln()).ceil();
        let smooth = depth(SHARE);
        let loads = depth(SHARE.min(1.0 / (truncation * emphasis * emphasis)));
        let allowed = |depth: f64| depth.clamp(1.0, MOST as f64) as usize;
        Depth {
            loads: allowed(loads),
            smooth: allowed(smooth),
            holds_all: loads <= MOST as f64,
        }
    }
}

/// How many of the loads have their responses kept: all of them, or none.
pub fn held_loads(loads: usize) -> usize {
    if loads <= MOST_LOADS { loads } else { 0 }
}

/// Orthonormal fields.
pub struct Fields {
    /// The fields Q, by dofs, with the branches of the memory: field length x k.
    pub fields: Mat<f64>,
    /// B, divided by the reference rate, on the fields: k x k.
    pub elasticity: Mat<f64>,
    /// What the fields show at the ports: ports x k.
    pub seen: Mat<f64>,
    /// Angle of the operator M.
    angle: f64,
    /// T: k x first.
    recurrence: Mat<f64>,
    /// Which fields are those of Q_1, in the order of the columns of T, and of Q_2.
    first: Vec<usize>,
    last: Vec<usize>,
    /// A Q_2: field length x last.
    last_images: Mat<f64>,
}

impl Fields {
    /// Responses to each of the `forces` (n x count, by dofs; the first ones are `loads`), with the operator of the last `sample`.
    pub fn new(
        sampler: &mut Sampler,
        sample: &Sample,
        (forces, loads): (Mat<f64>, usize),
        depth: Depth,
    ) -> Fields {
        let angle = sampler.angle();
        let (viscosity, elasticity) = (sampler.viscosity(), sampler.operator(FRAC_PI_2));
        let levels = depth.loads.max(depth.smooth);
        let most = levels * forces.ncols();
        let mut basis = Basis::new(sampler.field_len(), most);
        let mut recurrence = Mat::<f64>::zeros(most, most);
        let mut first = Vec::new();
        // the fields that are responded to next, and whether they come from a load
        let mut current: Vec<usize> = Vec::new();
        let mut is_load: Vec<bool> = (0..forces.ncols()).map(|j| j < loads).collect();
        let mut latest = forces;
        let mut of: Option<Mat<f64>> = None;
        for level in 1..=levels {
            sampler.respond(&sample.lower, latest.as_mut());
            latest = sampler.with_branches(latest, of.as_ref().map(Mat::as_ref));
            let from = basis.len();
            let kept = basis.add(latest.clone(), |x| sampler.viscous_images(&viscosity, x));
            let shares = basis.images().transpose() * latest.get(.., ..current.len());
            let to = first.len()..first.len() + current.len();
            let mut block = recurrence.get_mut(..shares.nrows(), to);
            block.copy_from(shares);
            first.append(&mut current);
            let goes_on = |is_load: bool| level < if is_load { depth.loads } else { depth.smooth };
            let kept = kept.into_iter().map(|j| is_load[j]).enumerate();
            (current, is_load) = kept
                .filter(|&(_, is_load)| goes_on(is_load))
                .map(|(i, is_load)| (from + i, is_load))
                .unzip();
            latest = sampler.eliminated_image(columns(basis.images(), &current).as_ref());
            if sampler.has_memory() {
                of = Some(columns(basis.fields(), &current));
            }
        }
        let last: Vec<usize> = (0..basis.len()).filter(|j| !first.contains(j)).collect();
        let last_images = columns(basis.images(), &last);
        let recurrence = recurrence.get(..basis.len(), ..first.len()).to_owned();
        let fields = basis.into_fields();
        let stiff = sampler.elastic_gram(&elasticity, fields.as_ref());
        Fields {
            elasticity: stiff,
            seen: sampler.ports().observe(fields.as_ref()),
            fields,
            angle,
            recurrence,
            first,
            last,
            last_images,
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
        let of_last = sampler.eliminated_image(self.last_images.as_ref());
        let of_last = sampler.observe_responses(sample, of_last.as_ref());
        let (first, last) = (&self.first, &self.last);
        let others = Mat::from_fn(last.len(), first.len(), |i, j| {
            self.recurrence[(last[i], j)]
        });
        let known = &self.seen * &self.recurrence - Scale(beta) * (&of_last * others);
        let pair = Mat::from_fn(first.len(), first.len(), |i, j| {
            let same = if i == j { alpha } else { 0.0 };
            same + beta * self.recurrence[(first[j], i)]
        });
        let of_first = pair.partial_piv_lu().solve(known.transpose());
        let mut all = Mat::zeros(of_last.nrows(), self.len());
        for (i, &field) in first.iter().enumerate() {
            all.col_mut(field).copy_from(of_first.row(i).transpose());
        }
        for (j, &field) in last.iter().enumerate() {
            all.col_mut(field).copy_from(of_last.col(j));
        }
        all
    }
}

/// Some columns of a matrix.
fn columns(of: MatRef<f64>, chosen: &[usize]) -> Mat<f64> {
    let mut out = Mat::zeros(of.nrows(), chosen.len());
    for (j, &column) in chosen.iter().enumerate() {
        out.col_mut(j).copy_from(of.col(column));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::reduction::port_matrix::PortMatrix;
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
        let mut sampler = Sampler::new(&ports, operators, &cholesky, (10.0, 0.0));
        let middle = sampler.sample(0.8).unwrap();
        let smooth = Mat::from_fn(ports.contact_len, 2, |i, j| ((i * (j + 1)) as f64).cos());
        let forces = ports.forces(1, &smooth);
        let depth = Depth::new([0.7268, 1.3758], 1e-8, 1000.0, 0.1);
        let fields = Fields::new(&mut sampler, &middle, (forces, 1), depth);
        assert_eq!(fields.len(), 9 + 2 * 6);

        let images = sampler.apply(&sampler.operator(0.0), fields.fields.as_ref());
        let gram = fields.fields.transpose() * &images;
        assert!((gram - Mat::<f64>::identity(21, 21)).norm_max() < 1e-12);
        for angle in [0.05, 0.8, 1.5] {
            let sample = sampler.sample(angle).unwrap();
            let expected = sampler.observe_responses(&sample, images.as_ref());
            let found = fields.couple(&mut sampler, &sample);
            assert!((found - &expected).norm_max() < 1e-11 * expected.norm_max());
        }
    }

    #[test]
    fn narrow_materials_need_few_fields_and_wide_ones_more_than_there_are() {
        let depth = |interval, emphasis| {
            let Depth {
                loads,
                smooth,
                holds_all,
            } = Depth::new(interval, 1e-8, emphasis, 0.1);
            (loads, smooth, holds_all)
        };
        assert_eq!(depth([0.7268, 1.3758], 1.0), (6, 6, true));
        assert_eq!(depth([0.7268, 1.3758], 1000.0), (9, 6, true));
        assert_eq!(depth([0.01, 100.0], 1.0), (MOST, MOST, false));
        assert_eq!(depth([1.0, 1.0], 1000.0), (1, 1, true));
    }
}
