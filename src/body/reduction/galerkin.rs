//! Galerkin projection of the body on a few fields and on the responses to its ports at a few shifts (see `responses`), the
//! latter from samples of the transfer matrix alone.
//!
//! Ports are comparable in energy (see `scaling`), so that contact forces of every wavelength count alike. The fields come
//! first. A Cholesky factorization with pivoting of the Gram matrix `X^T A X` then orders the responses by what each adds to
//! the fields and the responses before it: the first r of them are kept, made orthonormal in A by the factor, and the pair is
//! diagonalised: `A = I`, `B = diag(rates)`. Close to rounding, where responses of their own are hardly more than noise, the
//! singular vectors of the factor order combinations of them instead (those of the Gram matrix, at a multiple of the cost).

use super::responses::Responses;
use super::samples::Sampled;
use crate::error::Result;
use crate::linalg::{
    column, dot, mirror_lower, multiply, multiply_transposed, pivoted_cholesky, symmetric_eigen,
};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, Mat, Par};

/// Combinations whose share of the energy is below this are dependent to rounding.
const DEPENDENT: f64 = 1e-13;
/// Nor are combinations kept whose share is not this many times the error of the derivatives in the Gram matrix.
const SIGNAL: f64 = 3.0;
/// Iterations of the power method for the norm of a truncation error; it only has to find its magnitude.
const POWER_ITERATIONS: usize = 12;

/// The projected pair on the independent responses.
pub struct Projection {
    /// How many fields there are; they come first.
    fields: usize,
    /// Responses that are independent of them and of each other to rounding, strongest first: port, plus ports times shift.
    order: Vec<usize>,
    /// Shifts x ports.
    size: usize,
    /// Factor L of the Gram matrix of all of them.
    lower: Mat<f64>,
    /// Combinations of the orthonormal responses, when it is not themselves that are ordered: rank x rank.
    combinations: Option<Mat<f64>>,
    /// B on the orthonormal responses, or on their combinations, its lower triangle: rank x rank.
    elasticity: Mat<f64>,
    /// What the orthonormal responses show at the ports: rank x ports.
    seen: Mat<f64>,
    /// Instantaneous transfer matrix, scaled.
    instantaneous: Mat<f64>,
    /// Factors of the errors on the contact by the ports that follow it.
    emphasis: Vec<f64>,
}

/// The modes of a projection.
pub struct Modes {
    /// Rates relative to the reference rate, ascending, brought into the interval of the material: responses that hardly
    /// add anything carry the errors of the samples, magnified by as much as they are weak.
    pub rates: Vec<f64>,
    /// Largest effect on the scaled transfer matrix of bringing a rate into the interval, and that rate.
    pub outlier: (f64, f64),
    /// Scaled port velocities of every mode: states x ports.
    pub ports: Mat<f64>,
    /// Weights of the fields in a mode: fields x states.
    pub fields: Mat<f64>,
    /// Scaled port forces at every shift that make up the rest of a mode, the contact turned: (shifts x ports) x states.
    pub forces: Mat<f64>,
}

impl Projection {
    /// Projects on the fields and on the responses at the shifts. Responses to ports for which `is_held` is true are left out:
    /// the fields represent them. `emphasis` has a factor for each port after the contact: its errors on the contact count so
    /// much more.
    ///
    /// # Errors
    /// [`crate::Error::Body`] when the eigenvalues cannot be computed.
    pub fn new(
        sampled: &Sampled,
        is_held: impl Fn(usize) -> bool,
        emphasis: &[f64],
    ) -> Result<Projection> {
        let (shifts, fields) = (&sampled.shifts, &sampled.fields);
        let responses = Responses::new(sampled, is_held);
        let (m, k) = (sampled.transfer[0].nrows(), fields.len());
        let (mut a, b) = responses.products();
        // what the fields hold of the responses
        let held = Mat::from_fn(k, responses.len(), |f, at| responses.viscosity(f, at));
        matmul(
            a.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            held.transpose(),
            BlockStructure::Rectangular,
            held.as_ref(),
            BlockStructure::Rectangular,
            -1.0,
            Par::Seq,
        );
        // a response that the fields hold leaves rounding, of either sign
        for at in 0..a.nrows() {
            a[(at, at)] = a[(at, at)].max(0.0);
        }
        let weakest = DEPENDENT.max(SIGNAL * shifts.derivative_error);
        let (order, own) = pivoted_cholesky("the Gram matrix of the reduction", a, weakest)?;

        // the fields are orthonormal, and come first
        let rank = k + order.len();
        let response = |i: usize| i.checked_sub(k);
        let lower = Mat::from_fn(rank, rank, |i, j| match (response(i), response(j)) {
            (Some(i), Some(j)) => own[(i, j)],
            (Some(i), None) => held[(j, order[i])],
            (None, _) => f64::from(u8::from(i == j)),
        });
        let mut elasticity = Mat::from_fn(rank, rank, |i, j| match (response(i), response(j)) {
            (Some(i), Some(j)) => b[(order[i], order[j])],
            (Some(i), None) => responses.elasticity(j, order[i]),
            (None, Some(j)) => responses.elasticity(i, order[j]),
            (None, None) => fields.elasticity[(i, j)],
        });
        solve_lower_triangular_in_place(lower.as_ref(), elasticity.as_mut(), Par::Seq);
        let transposed = elasticity.as_mut().transpose_mut();
        solve_lower_triangular_in_place(lower.as_ref(), transposed, Par::Seq);
        let mut seen = Mat::from_fn(rank, m, |i, port| match response(i) {
            Some(i) => responses.seen(order[i], port),
            None => responses.seen_field(i, port),
        });
        sampled.turn.forth(seen.as_mut().transpose_mut());
        solve_lower_triangular_in_place(lower.as_ref(), seen.as_mut(), Par::Seq);
        let places = order.iter().map(|&at| responses.place(at));
        Ok(Projection {
            fields: k,
            order: places.map(|(shift, port)| shift * m + port).collect(),
            size: shifts.count() * m,
            lower,
            combinations: None,
            elasticity,
            seen,
            instantaneous: sampled.transfer[shifts.tests[0]].clone(),
            emphasis: emphasis.to_vec(),
        })
    }

    /// Orders combinations of the responses by their energy from now on, instead of the responses themselves.
    ///
    /// # Errors
    /// [`crate::Error::Body`] when the eigenvalues cannot be computed.
    pub fn order_by_energy(&mut self) -> Result<()> {
        let gram = self.lower.transpose() * &self.lower;
        let (_, ascending) = symmetric_eigen("the Gram matrix of the reduction", gram.as_ref())?;
        let combinations = ascending.as_ref().reverse_cols().to_owned();
        mirror_lower(self.elasticity.as_mut());
        let half = &self.elasticity * &combinations;
        self.elasticity = combinations.transpose() * half;
        self.seen = combinations.transpose() * &self.seen;
        self.combinations = Some(combinations);
        Ok(())
    }

    /// Responses that are independent to rounding.
    pub fn rank(&self) -> usize {
        self.elasticity.nrows()
    }

    fn contact_len(&self) -> usize {
        self.seen.ncols() - self.emphasis.len()
    }

    /// The fewest responses whose instantaneous transfer matrix is right to `tolerance`.
    pub fn rank_for(&self, tolerance: f64) -> usize {
        let (mut low, mut high) = (self.fields.max(1), self.rank());
        while low < high {
            let middle = (low + high) / 2;
            if self.truncation_error(middle) <= tolerance {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        low
    }

    /// What the first `rank` responses miss of the instantaneous transfer matrix, as [`crate::body::reduction`] measures errors.
    fn truncation_error(&self, rank: usize) -> f64 {
        let seen = self.seen.get(..rank, ..);
        let contact = self.contact_len();
        let mut missed = vec![0.0; seen.ncols()];
        let mut worst = self.missed_on_contact(rank);
        for (j, emphasis) in (contact..seen.ncols()).zip(&self.emphasis) {
            multiply_transposed(seen, column(seen, j), &mut missed);
            for (missed, whole) in missed
                .iter_mut()
                .zip(column(self.instantaneous.as_ref(), j))
            {
                *missed = whole - *missed;
            }
            let own = |i: usize| self.instantaneous[(i, i)].max(f64::MIN_POSITIVE).sqrt();
            let on_contact = dot(&missed[..contact], &missed[..contact]).sqrt();
            worst = worst.max(emphasis * on_contact / own(j));
            for (i, missed) in missed.iter().enumerate().skip(contact) {
                worst = worst.max(missed.abs() / (own(i) * own(j)));
            }
        }
        worst
    }

    /// Norm of what the first `rank` responses miss of the contact compliance, which is never negative.
    fn missed_on_contact(&self, rank: usize) -> f64 {
        let contact = self.contact_len();
        let seen = self.seen.get(..rank, ..contact);
        let whole = self.instantaneous.get(..contact, ..contact);
        // no symmetry of a mesh is orthogonal to this start
        let mut v: Vec<f64> = (0..contact).map(|i| 1.0 + (i as f64 + 1.0).sin()).collect();
        let (mut modes, mut back, mut missed) =
            (vec![0.0; rank], vec![0.0; contact], vec![0.0; contact]);
        let mut norm = 0.0;
        for _ in 0..POWER_ITERATIONS {
            let length = dot(&v, &v).sqrt();
            v.iter_mut().for_each(|v| *v /= length);
            multiply(whole, &v, &mut missed);
            multiply(seen, &v, &mut modes);
            multiply_transposed(seen, &modes, &mut back);
            for ((v, missed), back) in v.iter_mut().zip(&missed).zip(&back) {
                *v = missed - back;
            }
            norm = dot(&v, &v).sqrt();
            if norm == 0.0 {
                break;
            }
        }
        norm
    }

    /// The modes on the first `rank` responses; their rates are those of a body with rates in `interval`.
    ///
    /// # Errors
    /// [`Error::Body`] when the eigenvalues cannot be computed.
    pub fn modes(&self, rank: usize, [low, high]: [f64; 2]) -> Result<Modes> {
        let pair = self.elasticity.get(..rank, ..rank);
        let (mut rates, rotation) = symmetric_eigen("the reduced elasticity", pair)?;
        let ports = rotation.transpose() * self.seen.get(..rank, ..);
        let mut outlier = (0.0, 0.0);
        for (j, rate) in rates.iter_mut().enumerate() {
            let inside = rate.clamp(low, high);
            if inside != *rate {
                let share = ports.row(j).squared_norm_l2();
                let effect = share * (*rate - inside).abs() / high;
                if effect > outlier.0 {
                    outlier = (effect, *rate);
                }
                *rate = inside;
            }
        }
        let mut modes = match &self.combinations {
            Some(combinations) => combinations.get(.., ..rank) * rotation,
            None => rotation,
        };
        let lower = self.lower.get(..modes.nrows(), ..modes.nrows());
        solve_upper_triangular_in_place(lower.transpose(), modes.as_mut(), Par::Seq);
        let mut forces = Mat::zeros(self.size, rank);
        let (of_fields, responses) = modes.split_at_row(self.fields);
        for (i, at) in self.order[..responses.nrows()].iter().enumerate() {
            forces.row_mut(*at).copy_from(responses.row(i));
        }
        Ok(Modes {
            rates,
            outlier,
            ports,
            fields: of_fields.to_owned(),
            forces,
        })
    }
}
