//! What a step does in modal coordinates, where the operators of the body are diagonal: one pass over the modes each.

use super::lanes::visit;
use pulp::{Arch, Simd, WithSimd};

/// The free motion `(load - rates p) factor`, overwriting the load.
pub fn free_motion(load: &mut [f64], rates: &[f64], p: &[f64], factor: &[f64]) {
    Arch::new().dispatch(FreeMotion(load, rates, p, factor));
}

/// The velocity `free - response factor`, overwriting the response.
pub fn corrected_motion(response: &mut [f64], free: &[f64], factor: &[f64]) {
    Arch::new().dispatch(CorrectedMotion(response, free, factor));
}

/// `(x.x, x.diag(rates) x)`.
pub fn squares(x: &[f64], rates: &[f64]) -> (f64, f64) {
    Arch::new().dispatch(Squares(x, rates))
}

struct FreeMotion<'a>(&'a mut [f64], &'a [f64], &'a [f64], &'a [f64]);

impl WithSimd for FreeMotion<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let FreeMotion(load, rates, p, factor) = self;
        let modes = rates.iter().zip(p).zip(factor);
        for (load, ((rate, p), factor)) in load.iter_mut().zip(modes) {
            *load = (*load - rate * p) * factor;
        }
    }
}

struct CorrectedMotion<'a>(&'a mut [f64], &'a [f64], &'a [f64]);

impl WithSimd for CorrectedMotion<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let CorrectedMotion(response, free, factor) = self;
        for (response, (free, factor)) in response.iter_mut().zip(free.iter().zip(factor)) {
            *response = free - *response * factor;
        }
    }
}

struct Squares<'a>(&'a [f64], &'a [f64]);

impl WithSimd for Squares<'_> {
    type Output = (f64, f64);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> (f64, f64) {
        let (mut plain, mut weighted) = (simd.splat_f64s(0.0), simd.splat_f64s(0.0));
        visit(
            simd,
            [self.0, self.1],
            #[inline(always)]
            |[x, rate]| {
                let square = simd.mul_f64s(x, x);
                plain = simd.add_f64s(plain, square);
                weighted = simd.mul_add_e_f64s(rate, square, weighted);
            },
        );
        (simd.reduce_sum_f64s(plain), simd.reduce_sum_f64s(weighted))
    }
}

#[cfg(test)]
mod tests {
    use super::squares;

    #[test]
    fn squares_of_any_length() {
        for n in 0..20 {
            let x: Vec<f64> = (0..n).map(|i| f64::from(i) - 3.0).collect();
            let rates: Vec<f64> = (0..n).map(|i| 1.0 + f64::from(i)).collect();
            let (plain, weighted) = squares(&x, &rates);
            assert_eq!(plain, x.iter().map(|x| x * x).sum::<f64>());
            let terms = x.iter().zip(&rates).map(|(x, r)| r * x * x);
            assert_eq!(weighted, terms.sum::<f64>());
        }
    }
}
