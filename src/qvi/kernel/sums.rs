//! Kernels that are sums of terms with one vector each: however long the past is, a step costs the same.

use super::{Own, Past};
use crate::qvi::{Quadrature, SolveError};
use nalgebra::DVector;

/// The next point of a quadrature.
pub(super) struct Point {
    pub rule: Quadrature,
    /// Step, s.
    pub k: f64,
    /// Its number; the first is 0.
    pub n: usize,
}

impl Point {
    pub fn time(&self) -> f64 {
        self.n as f64 * self.k
    }

    /// The weight of this point in all later sums.
    pub fn settled(&self) -> f64 {
        self.rule.settled(self.k, self.n).unwrap_or(f64::NAN)
    }
}

/// A term of a kernel.
pub(super) trait Term: Sized {
    /// Adds its share of the sum over the past at the next point, from the vector of the term.
    fn add(&self, at: &Point, sum: &[f64], out: &mut [f64]);

    /// `w_nn q(t_n, t_n)` of all terms, on vectors of this length.
    fn own(terms: &[Self], dimension: usize, at: &Point) -> Own;

    /// Takes z at the next point into the vector of the term.
    fn push(&self, at: &Point, z: &[f64], sum: &mut [f64]);
}

/// The past of such a kernel.
pub(super) struct Sums<T> {
    terms: Vec<T>,
    next: Point,
    dimension: usize,
    /// The vectors of the terms.
    sums: Vec<f64>,
    products: usize,
}

impl<T: Term> Sums<T> {
    /// No past yet.
    ///
    /// # Errors
    /// [`SolveError::Rule`] for a rule whose weights change from row to row.
    pub fn new(
        terms: Vec<T>,
        dimension: usize,
        rule: Quadrature,
        k: f64,
    ) -> Result<Sums<T>, SolveError> {
        if rule.settled(k, 0).is_none() {
            return Err(SolveError::Rule {
                rule: rule.name(),
                why: "its weights change with the row, which takes the whole history: give the kernel as a function",
            });
        }
        Ok(Sums {
            sums: vec![0.0; terms.len() * dimension],
            terms,
            next: Point { rule, k, n: 0 },
            dimension,
            products: 0,
        })
    }
}

impl<T: Term> Past for Sums<T> {
    fn sum(&mut self, out: &mut DVector<f64>) {
        out.fill(0.0);
        for (term, sum) in self.terms.iter().zip(self.sums.chunks(self.dimension)) {
            term.add(&self.next, sum, out.as_mut_slice());
        }
        self.products += self.terms.len();
    }

    fn own(&self) -> Own {
        T::own(&self.terms, self.dimension, &self.next)
    }

    fn push(&mut self, z: &DVector<f64>) {
        for (term, sum) in self.terms.iter().zip(self.sums.chunks_mut(self.dimension)) {
            term.push(&self.next, z.as_slice(), sum);
        }
        self.next.n += 1;
        self.products += self.terms.len();
    }

    fn numbers(&self) -> usize {
        self.sums.len()
    }

    fn products(&self) -> usize {
        self.products
    }
}
