//! Kernels q(t - s) in O(N log^2 N): contributions of aligned dyadic blocks of the past to the next block of the same length, by
//! fast Fourier transforms (Hairer, Lubich, Schlichte, SIAM J. Sci. Stat. Comput. 6 (1985) 532-541).
//!
//! A pair of points `j < n` meets in exactly one pair of neighbouring aligned blocks of equal length: when m points are known, the
//! block of the `2^p` last ones is added to the next `2^p` points, `2^p` the largest power of two that divides m. Pairs within
//! a block of [`SHORTEST`] points are added one by one.

use super::fourier::{Complex, transform};
use super::{Own, Past};
use crate::qvi::Quadrature;
use nalgebra::DVector;
use std::sync::Arc;

/// Length up to which sums are direct.
const SHORTEST: usize = 32;

pub(super) struct Convolution {
    q: Arc<dyn Fn(f64) -> f64>,
    rule: Quadrature,
    k: f64,
    /// `w_j z_j` at all points, component by component a row.
    past: Vec<Vec<f64>>,
    /// What blocks have added to each point so far.
    future: Vec<Vec<f64>>,
    /// Values of the kernel at lags 0, k, 2k, ...
    values: Vec<f64>,
    /// Transforms of the kernel for blocks of the lengths `SHORTEST 2^i`.
    transforms: Vec<Vec<Complex>>,
    n: usize,
    products: usize,
}

impl Convolution {
    pub fn new(
        q: Arc<dyn Fn(f64) -> f64>,
        dimension: usize,
        rule: Quadrature,
        k: f64,
    ) -> Convolution {
        Convolution {
            q,
            rule,
            k,
            past: vec![Vec::new(); dimension],
            future: vec![Vec::new(); dimension],
            values: Vec::new(),
            transforms: Vec::new(),
            n: 0,
            products: 0,
        }
    }

    fn extend_values(&mut self, count: usize) {
        for lag in self.values.len()..count {
            self.values.push((self.q)(lag as f64 * self.k));
        }
    }

    /// Adds the last `length` points to the next ones.
    fn add_block(&mut self, length: usize) {
        let size = 2 * length;
        self.extend_values(size);
        let level = (length / SHORTEST).ilog2() as usize;
        while self.transforms.len() <= level {
            let size = 2 * (SHORTEST << self.transforms.len());
            let mut kernel: Vec<Complex> = self.values[..size]
                .iter()
                .map(|value| [*value, 0.0])
                .collect();
            transform(&mut kernel, false);
            self.transforms.push(kernel);
        }
        let kernel = &self.transforms[level];
        let mut block = vec![[0.0; 2]; size];
        for (past, future) in self.past.iter().zip(&mut self.future) {
            block.fill([0.0; 2]);
            for (to, z) in block.iter_mut().zip(&past[self.n - length..]) {
                to[0] = *z;
            }
            transform(&mut block, false);
            for (to, [re, im]) in block.iter_mut().zip(kernel) {
                *to = [to[0] * re - to[1] * im, to[0] * im + to[1] * re];
            }
            transform(&mut block, true);
            if future.len() < self.n + length {
                future.resize(self.n + length, 0.0);
            }
            // the first half is mixed with what wraps around, the second is the sum
            for (to, value) in future[self.n..].iter_mut().zip(&block[length..]) {
                *to += value[0];
            }
        }
        self.products += 3 * size * size.ilog2() as usize / 2;
    }
}

impl Past for Convolution {
    fn sum(&mut self, out: &mut DVector<f64>) {
        let n = self.n;
        let first = n / SHORTEST * SHORTEST;
        self.extend_values(SHORTEST);
        for ((out, past), future) in out.iter_mut().zip(&self.past).zip(&self.future) {
            let direct = (first..n).map(|j| self.values[n - j] * past[j]);
            *out = future.get(n).copied().unwrap_or(0.0) + direct.sum::<f64>();
        }
        self.products += n - first;
    }

    fn own(&self) -> Own {
        Own::Number(self.rule.weight(self.k, self.n, self.n) * (self.q)(0.0))
    }

    fn push(&mut self, z: &DVector<f64>) {
        let settled = self.rule.settled(self.k, self.n).unwrap_or(f64::NAN);
        for (past, z) in self.past.iter_mut().zip(z.iter()) {
            past.push(settled * z);
        }
        self.n += 1;
        let length = 1 << self.n.trailing_zeros();
        if length >= SHORTEST {
            self.add_block(length);
        }
    }

    fn numbers(&self) -> usize {
        let transforms: usize = self.transforms.iter().map(|t| 2 * t.len()).sum();
        let rows = self.past.iter().chain(&self.future);
        rows.map(Vec::len).sum::<usize>() + self.values.len() + transforms
    }

    fn products(&self) -> usize {
        self.products
    }
}
