//! The time-discrete scheme: at every point `t_n = n k` an inequality for u_n, (3.4) with the trapezoid, (3.26) with the rectangle.
//!
//! At `n = 0` it is solved as well, with `S_0 = R(0) a`: a start that does not satisfy it costs the second order.
//!
//! [`Solver::Lambda`] is the fixed point of the proof of Theorem 3.1: `Lambda eta` solves the inequality with `S_n` of
//! `(u_0, ..., u_n-1, eta)` and `j(eta, .)` frozen. It contracts by `(alpha c1 w_nn + beta) / m`, `w_nn = k/2` for the trapezoid, and
//! diverges beyond although the step may have exactly one solution. [`Solver::Direct`] takes the linear part of phi in the new value
//! into the operator, `M = A + sum_i B_i R w_nn q(t_n, t_n)`, and iterates the coefficients of the parts only.

use super::elliptic::{Condensed, contract};
use super::functional::Linear;
use super::history_operator::Course;
use super::kernel::Own;
use super::prox::Nonsmooth;
use super::settings::{Iterations, Settings, Solver};
use super::space::{largest_singular_value, smallest_symmetric_eigenvalue};
use super::{Inequality, Matrix, Quadrature, SolveError};
use nalgebra::{DMatrix, DVector};

/// Changes below so many times the tolerance are rounding rather than contraction.
const MEASURABLE: f64 = 1e5;

/// A run along the points.
pub struct Evolution<'a> {
    of: &'a Inequality,
    settings: Settings,
    k: f64,
    /// Points that are solved.
    points: usize,
    courses: Vec<Course<'a>>,
    u: DVector<f64>,
    values: Vec<DVector<f64>>,
    iterations: Iterations,
    condensed: Option<(Vec<Own>, Condensed)>,
}

impl<'a> Evolution<'a> {
    /// A run with steps of size k; nothing is solved yet: the first [`Evolution::advance`] gives u at the time 0.
    ///
    /// # Errors
    /// [`SolveError::Value`] for a step that is not positive, and what does not fit ([`Inequality::check`], kernels and quadratures).
    pub fn new(
        of: &'a Inequality,
        rule: &Quadrature,
        k: f64,
        settings: Settings,
    ) -> Result<Evolution<'a>, SolveError> {
        of.check()?;
        if !(k > 0.0 && k.is_finite()) {
            return Err(SolveError::Value {
                what: "size of a step".to_owned(),
                found: k,
                allowed: "a positive number",
            });
        }
        let n = of.dimension();
        if let Some(start) = &settings.start {
            SolveError::check_shape("components of u_0", n, start.len())?;
        }
        if let Quadrature::Weights(weights) = rule {
            // those of the first rows; later rows are the user's word
            for (row, j) in (0..4).flat_map(|row| (0..=row).map(move |j| (row, j))) {
                let found = weights.weight(k, row, j);
                if found < 0.0 || found.is_nan() {
                    return Err(SolveError::Value {
                        what: format!("weight {j} in row {row} of a quadrature"),
                        found,
                        allowed: "a number >= 0",
                    });
                }
            }
        }
        let courses = of.histories.iter().map(|s| Course::new(s, n, rule, k));
        Ok(Evolution {
            of,
            settings,
            k,
            points: 0,
            courses: courses.collect::<Result<_, _>>()?,
            u: DVector::zeros(n),
            values: Vec::new(),
            iterations: Iterations::default(),
            condensed: None,
        })
    }

    /// Solves the next point and returns u there.
    ///
    /// # Errors
    /// [`SolveError`]; the run then stands where it stood.
    pub fn advance(&mut self) -> Result<&DVector<f64>, SolveError> {
        self.prepare();
        let u = match (&self.settings.start, self.points) {
            (Some(start), 0) => start.clone(),
            _ => self.solve_from(self.u.clone())?,
        };
        self.values = self.values_at(&u);
        for course in &mut self.courses {
            course.push(&u);
        }
        self.u = u;
        self.points += 1;
        Ok(&self.u)
    }

    /// Solutions of the next point that the direct solver finds from several starts, without advancing: from the given ones, from
    /// rest, from coefficients that vanish. Those that differ by less than `difference` in the largest component are one.
    /// More than one are possible where `beta >= m` only.
    pub fn solutions(&mut self, starts: &[DVector<f64>], difference: f64) -> Vec<DVector<f64>> {
        self.prepare();
        let kept = (self.settings.solver, self.iterations);
        self.settings.solver = Solver::Direct;
        let zero = vec![0.0; self.of.parts.len()];
        let mut all = starts.to_vec();
        all.push(DVector::zeros(self.of.dimension()));
        let free = self.map(&self.u.clone(), Some(&zero));
        all.extend(free);
        let mut found: Vec<DVector<f64>> = Vec::new();
        for start in all {
            if let Ok(u) = self.solve_from(start)
                && found.iter().all(|v| (v - &u).amax() > difference)
            {
                found.push(u);
            }
        }
        (self.settings.solver, self.iterations) = kept;
        found
    }

    /// The time of the last point, and u there.
    pub fn u(&self) -> &DVector<f64> {
        &self.u
    }

    /// Values of the history operators at the last point.
    pub fn histories(&self) -> &[DVector<f64>] {
        &self.values
    }

    /// Time of the last point.
    pub fn time(&self) -> f64 {
        self.points.saturating_sub(1) as f64 * self.k
    }

    pub fn iterations(&self) -> &Iterations {
        &self.iterations
    }

    /// Numbers that the sums over the past keep: constant in time for exponential sums and separable kernels.
    pub fn numbers_kept(&self) -> usize {
        self.courses.iter().map(Course::numbers).sum()
    }

    /// Products with values of kernels that the sums over the past have taken.
    pub fn kernel_products(&self) -> usize {
        self.courses.iter().map(Course::products).sum()
    }

    fn next_time(&self) -> f64 {
        self.points as f64 * self.k
    }

    fn prepare(&mut self) {
        let t = self.next_time();
        for course in &mut self.courses {
            course.prepare(t);
        }
        let sizes = self.courses.iter().map(|c| c.own_size(&self.of.space));
        let own = sizes.fold(self.iterations.own_weight, f64::max);
        self.iterations.own_weight = own;
    }

    fn values_at(&self, u: &DVector<f64>) -> Vec<DVector<f64>> {
        self.courses.iter().map(|c| c.value(Some(u))).collect()
    }

    /// The fixed point of the map of a step.
    fn solve_from(&mut self, mut eta: DVector<f64>) -> Result<DVector<f64>, SolveError> {
        let (step, time) = (self.points, self.next_time());
        let tolerance = self.settings.tolerance;
        let mut last: Option<f64> = None;
        let mut contraction: f64 = 0.0;
        let mut change = f64::INFINITY;
        for iteration in 1..=self.settings.most_iterations {
            let next = self.map(&eta, None)?;
            let difference = &next - &eta;
            change = difference.amax();
            let size = self.of.space.norm(&difference);
            let scale = next.amax().max(1.0);
            if let Some(last) = last
                && change > MEASURABLE * tolerance * scale
            {
                contraction = contraction.max(size / last);
            }
            last = Some(size);
            eta = next;
            if change <= tolerance * scale {
                let all = &mut self.iterations;
                all.last = iteration;
                all.total += iteration;
                all.most = all.most.max(iteration);
                all.contraction = all.contraction.max(contraction);
                return Ok(eta);
            }
            if !change.is_finite() || change > 1e12 {
                return Err(SolveError::Diverged {
                    step,
                    time,
                    iterations: iteration,
                    contraction,
                });
            }
        }
        Err(SolveError::NotConverged {
            step,
            time,
            iterations: self.settings.most_iterations,
            change,
            contraction,
        })
    }

    /// `Lambda eta`, or the same with the linear part solved for; with given coefficients instead of those at eta.
    fn map(
        &mut self,
        eta: &DVector<f64>,
        given: Option<&[f64]>,
    ) -> Result<DVector<f64>, SolveError> {
        let of = self.of;
        let n = of.dimension();
        let is_direct = self.settings.solver == Solver::Direct;
        // the new value enters the linear part through the operator
        let is_implicit: Vec<bool> = (0..self.courses.len())
            .map(|i| {
                let course = &self.courses[i];
                is_direct
                    && course.is_identity()
                    && !course.own.is_zero()
                    && matches!(of.phi.linear(i), Linear::Matrix(_))
            })
            .collect();
        let values = self.values_at(eta);
        let mut force = DVector::zeros(n);
        let mut coefficients = vec![0.0; of.parts.len()];
        of.phi.freeze(&values, &mut force, &mut coefficients);
        if is_implicit.contains(&true) {
            let known: Vec<_> = (0..self.courses.len())
                .map(|i| {
                    let v = if is_implicit[i] { None } else { Some(eta) };
                    self.courses[i].value(v)
                })
                .collect();
            force.fill(0.0);
            of.phi
                .freeze(&known, &mut force, &mut vec![0.0; of.parts.len()]);
        }
        let arguments: Vec<_> = std::iter::once(eta.clone()).chain(values).collect();
        of.j.freeze(&arguments, &mut force, &mut coefficients);
        if let Some(given) = given {
            coefficients.copy_from_slice(given);
        }
        if let Some(found) = coefficients.iter().find(|c| **c < 0.0 || c.is_nan()) {
            return Err(SolveError::Value {
                what: "a coefficient of phi or j".to_owned(),
                found: *found,
                allowed: "a number >= 0",
            });
        }
        let r = (of.load)(self.next_time()) - force;
        let nonsmooth = Nonsmooth {
            parts: &of.parts,
            set: &*of.set,
        };
        let tolerance = 0.1 * self.settings.tolerance;
        let implicit: Vec<(&Matrix, Own)> = (0..self.courses.len())
            .filter(|i| is_implicit[*i])
            .filter_map(|i| match of.phi.linear(i) {
                Linear::Matrix(matrix) => Some((matrix, self.courses[i].implicit())),
                _ => None,
            })
            .collect();
        if let Some(a) = of.operator.matrix() {
            let key: Vec<Own> = implicit.iter().map(|(_, own)| own.clone()).collect();
            if self
                .condensed
                .as_ref()
                .is_some_and(|(kept, _)| *kept != key)
            {
                self.condensed = None;
            }
            let condensed = match &mut self.condensed {
                Some((_, condensed)) => condensed,
                slot @ None => {
                    let matrix = implicit
                        .iter()
                        .fold(a.clone(), |sum, (b, own)| add(&sum, b, own));
                    &mut slot.insert((key, Condensed::new(&matrix, nonsmooth)?)).1
                }
            };
            return condensed.solve(&r, &coefficients, nonsmooth, eta, tolerance);
        }
        let [m, l] = of.operator.constants().ok_or(SolveError::NoConstants)?;
        let [smallest, largest] = of.space.extremes();
        let mut constants = [m * smallest, l * largest];
        let history = implicit
            .iter()
            .fold(DMatrix::zeros(n, n), |sum, (b, own)| sum + product(b, own));
        if !implicit.is_empty() {
            constants[0] += smallest_symmetric_eigenvalue(&history);
            constants[1] += largest_singular_value(&history);
        }
        if constants[0] <= 0.0 || constants[0].is_nan() {
            return Err(SolveError::Singular);
        }
        let operator = |u: &DVector<f64>| match implicit.is_empty() {
            true => of.operator.apply(u),
            false => of.operator.apply(u) + &history * u,
        };
        contract(
            operator,
            constants,
            &r,
            &coefficients,
            nonsmooth,
            eta,
            tolerance,
        )
    }
}

/// `B own` as a matrix.
fn product(b: &Matrix, own: &Own) -> DMatrix<f64> {
    match own {
        Own::Number(own) => b.to_dense() * *own,
        Own::Matrix(own) => b.to_dense() * own,
    }
}

/// `sum + B own`.
fn add(sum: &Matrix, b: &Matrix, own: &Own) -> Matrix {
    match own {
        Own::Number(own) => sum.plus(*own, b),
        Own::Matrix(_) => Matrix::Dense(sum.to_dense() + product(b, own)),
    }
}
