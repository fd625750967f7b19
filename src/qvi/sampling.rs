//! Points at which inequalities are tried out: a fixed sequence, so that results repeat.

use nalgebra::DVector;

/// The generator SplitMix64 of Steele, Lea and Flood (OOPSLA 2014).
pub struct Sampler(u64);

impl Sampler {
    pub fn new(seed: u64) -> Sampler {
        Sampler(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let share = (self.next() >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * share
    }

    /// A vector with components of one size between 1e-3 and 1e3, every other one sparse.
    pub fn vector(&mut self, n: usize) -> DVector<f64> {
        let size = 10.0_f64.powf(self.between(-3.0, 3.0));
        let is_sparse = self.next().is_multiple_of(2);
        let kept = (self.next() % n.max(1) as u64) as usize;
        DVector::from_fn(n, |i, _| {
            let value = size * self.between(-1.0, 1.0);
            if is_sparse && i != kept { 0.0 } else { value }
        })
    }

    /// Two points, near or far from each other.
    pub fn pair(&mut self, n: usize) -> [DVector<f64>; 2] {
        let u = self.vector(n);
        let v = &u + self.vector(n);
        [u, v]
    }
}
