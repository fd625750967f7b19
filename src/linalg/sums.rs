//! Sums of the vectors of a step, one pass each.

use super::lanes;
use pulp::{Arch, Simd, WithSimd};

/// `to += factor * from`, of equal length.
pub fn add_scaled(to: &mut [f64], factor: f64, from: &[f64]) {
    assert_eq!(to.len(), from.len());
    Arch::new().dispatch(Addition { to, factor, from });
}

struct Addition<'a> {
    to: &'a mut [f64],
    factor: f64,
    from: &'a [f64],
}

impl WithSimd for Addition<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        lanes::add_scaled(simd, self.to, self.factor, self.from);
    }
}

#[cfg(test)]
mod tests {
    use super::add_scaled;

    #[test]
    fn sums_of_any_length() {
        for n in 0..20 {
            let mut to: Vec<f64> = (0..n).map(f64::from).collect();
            let from = vec![2.0; to.len()];
            add_scaled(&mut to, 0.5, &from);
            let expected: Vec<f64> = (0..n).map(|i| f64::from(i) + 1.0).collect();
            assert_eq!(to, expected);
        }
    }
}
