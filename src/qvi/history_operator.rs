//! History operators (2.9),
//!
//! ```text
//! S v(t) = R(t) ( int_0^t q(t, s) iota(v(s)) ds + a )
//! ```
//!
//! with iota the identity in the paper. Another Lipschitz map of v, `|v_tau|` for the accumulated slip, gives a history operator all
//! the same. At the points of a quadrature, `S_n = R(t_n) (h_n + w_nn q(t_n, t_n) iota(v_n))` with h_n from the past.

use super::kernel::{Kernel, Own, Past};
use super::{Quadrature, SolveError, Space};
use nalgebra::{DMatrix, DVector};

/// A map of vectors.
pub type MapOfVectors = Box<dyn Fn(&DVector<f64>) -> DVector<f64>>;

/// iota: what of v is integrated.
pub enum Integrand {
    /// v itself.
    Identity,
    /// A map of v with values of this dimension, Lipschitz with constant `lipschitz`.
    Map {
        dimension: usize,
        lipschitz: f64,
        of: MapOfVectors,
    },
}

impl Integrand {
    pub(super) fn of(&self, v: &DVector<f64>) -> DVector<f64> {
        match self {
            Integrand::Identity => v.clone(),
            Integrand::Map { of, .. } => of(v),
        }
    }

    pub(super) fn lipschitz(&self) -> f64 {
        match self {
            Integrand::Identity => 1.0,
            Integrand::Map { lipschitz, .. } => *lipschitz,
        }
    }
}

/// S.
pub struct HistoryOperator {
    pub kernel: Kernel,
    pub integrand: Integrand,
    /// R(t); the identity where it is `None`.
    pub factor: Option<Box<dyn Fn(f64) -> DMatrix<f64>>>,
    /// a, of the dimension of the integrand.
    pub start: DVector<f64>,
    /// A quadrature of its own; that of the run where it is `None`.
    pub rule: Option<Quadrature>,
}

impl HistoryOperator {
    /// `int_0^t q(t, s) v(s) ds + a`.
    pub fn new(kernel: Kernel, start: DVector<f64>) -> HistoryOperator {
        HistoryOperator {
            kernel,
            integrand: Integrand::Identity,
            factor: None,
            start,
            rule: None,
        }
    }

    /// R(t) before it.
    pub fn with_factor(self, factor: impl Fn(f64) -> DMatrix<f64> + 'static) -> HistoryOperator {
        HistoryOperator {
            factor: Some(Box::new(factor)),
            ..self
        }
    }

    /// The dimension of the integrand on vectors of this dimension.
    pub fn dimension(&self, of_v: usize) -> usize {
        match &self.integrand {
            Integrand::Identity => of_v,
            Integrand::Map { dimension, .. } => *dimension,
        }
    }

    /// `sup |R| |q|` over points of `[0, T]`: c1, times the constant of the integrand.
    pub fn largest(&self, space: &Space, end: f64, samples: usize) -> f64 {
        let at = |i: usize| end * i as f64 / samples.max(1) as f64;
        let dimension = self.dimension(space.dimension());
        let (mut r, mut q): (f64, f64) = (if self.factor.is_some() { 0.0 } else { 1.0 }, 0.0);
        for i in 0..=samples {
            if let Some(factor) = &self.factor {
                r = r.max(Own::Matrix(factor(at(i))).norm(space));
            }
            for j in 0..=i {
                q = q.max(self.kernel.value(dimension, at(i), at(j)).norm(space));
            }
        }
        r * q * self.integrand.lipschitz()
    }
}

/// S along a run: the sums over the past.
pub(super) struct Course<'a> {
    of: &'a HistoryOperator,
    past: Box<dyn Past>,
    /// `h_n = a + sum over the past` of the next point.
    pub known: DVector<f64>,
    /// `w_nn q(t_n, t_n)` of the next point.
    pub own: Own,
    /// R at the next point.
    factor: Option<DMatrix<f64>>,
}

impl<'a> Course<'a> {
    pub fn new(
        of: &'a HistoryOperator,
        of_v: usize,
        rule: &Quadrature,
        k: f64,
    ) -> Result<Course<'a>, SolveError> {
        let dimension = of.dimension(of_v);
        SolveError::check_shape(
            "components of the start of a history",
            dimension,
            of.start.len(),
        )?;
        Ok(Course {
            of,
            past: of
                .kernel
                .past(dimension, of.rule.as_ref().unwrap_or(rule), k)?,
            known: of.start.clone(),
            own: Own::Number(0.0),
            factor: None,
        })
    }

    /// Goes to the next point, at the instant `t`.
    pub fn prepare(&mut self, t: f64) {
        self.past.sum(&mut self.known);
        self.known += &self.of.start;
        self.own = self.past.own();
        self.factor = self.of.factor.as_ref().map(|factor| factor(t));
    }

    /// `R (h + own iota(v))`; without v only what is known.
    pub fn value(&self, v: Option<&DVector<f64>>) -> DVector<f64> {
        let mut inner = self.known.clone();
        if let Some(v) = v
            && !self.own.is_zero()
        {
            let z = self.of.integrand.of(v);
            self.own.add_to(1.0, z.as_slice(), inner.as_mut_slice());
        }
        match &self.factor {
            None => inner,
            Some(factor) => factor * inner,
        }
    }

    /// `R w_nn q(t_n, t_n)`, the derivative of the value by v where the integrand is the identity.
    pub fn implicit(&self) -> Own {
        match (&self.factor, &self.own) {
            (None, own) => own.clone(),
            (Some(factor), Own::Number(own)) => Own::Matrix(factor * *own),
            (Some(factor), Own::Matrix(own)) => Own::Matrix(factor * own),
        }
    }

    /// Largest weight of v at the next point, `|R| |w_nn q|` times the constant of the integrand.
    pub fn own_size(&self, space: &Space) -> f64 {
        self.implicit().norm(space) * self.of.integrand.lipschitz()
    }

    pub fn is_identity(&self) -> bool {
        matches!(self.of.integrand, Integrand::Identity)
    }

    /// Takes the value at the point.
    pub fn push(&mut self, v: &DVector<f64>) {
        let z = self.of.integrand.of(v);
        self.past.push(&z);
    }

    pub fn numbers(&self) -> usize {
        self.past.numbers()
    }

    pub fn products(&self) -> usize {
        self.past.products()
    }
}
