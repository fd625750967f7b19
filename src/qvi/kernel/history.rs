//! Any kernel: the whole history, summed in blocks of points.
//!
//! When a block of points begins, the contributions of all points before it to all points of the block are computed together, so
//! that a past value is read once for the whole block. Points of the block itself are added one by one. The work is O(N^2), the
//! memory O(N).

use super::{Kernel, Own, Past};
use crate::qvi::Quadrature;
use nalgebra::DVector;

/// Points of a block.
const BLOCK: usize = 32;

pub(super) struct History {
    kernel: Kernel,
    rule: Quadrature,
    k: f64,
    dimension: usize,
    /// z at all points.
    past: Vec<f64>,
    /// What the points before the block give to each of its points.
    block: Vec<f64>,
    products: usize,
}

impl History {
    pub fn new(kernel: Kernel, dimension: usize, rule: Quadrature, k: f64) -> History {
        History {
            kernel,
            rule,
            k,
            dimension,
            past: Vec::new(),
            block: vec![0.0; BLOCK * dimension],
            products: 0,
        }
    }

    fn n(&self) -> usize {
        self.past.len() / self.dimension
    }

    /// `w_nj q(t_n, t_j)`.
    fn value(&self, n: usize, j: usize) -> Own {
        let at = |point: usize| point as f64 * self.k;
        let weight = self.rule.weight(self.k, n, j);
        let value = self.kernel.value(self.dimension, at(n), at(j));
        value.scaled(weight)
    }
}

impl Past for History {
    fn sum(&mut self, out: &mut DVector<f64>) {
        let (n, d) = (self.n(), self.dimension);
        let first = n / BLOCK * BLOCK;
        if n == first {
            let mut block = std::mem::take(&mut self.block);
            block.fill(0.0);
            for j in 0..first {
                let z = &self.past[j * d..(j + 1) * d];
                for (i, to) in block.chunks_mut(d).enumerate() {
                    self.value(first + i, j).add_to(1.0, z, to);
                }
            }
            self.block = block;
            self.products += first * BLOCK;
        }
        out.as_mut_slice()
            .copy_from_slice(&self.block[(n - first) * d..(n - first + 1) * d]);
        for j in first..n {
            let z = &self.past[j * d..(j + 1) * d];
            self.value(n, j).add_to(1.0, z, out.as_mut_slice());
        }
        self.products += n - first;
    }

    fn own(&self) -> Own {
        self.value(self.n(), self.n())
    }

    fn push(&mut self, z: &DVector<f64>) {
        self.past.extend_from_slice(z.as_slice());
    }

    fn numbers(&self) -> usize {
        self.past.len() + self.block.len()
    }

    fn products(&self) -> usize {
        self.products
    }
}
