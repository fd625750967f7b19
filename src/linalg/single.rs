//! Loops over columns stored in single precision, in double arithmetic: plain loops, which a compiler vectorizes for the
//! machine they are dispatched to.

use super::products::Entry;
use pulp::Simd;

/// Partial sums of a dot product.
const LANES: usize = 8;

impl Entry for f32 {
    #[inline(always)]
    fn add_columns<S: Simd, const N: usize>(_: S, a: [&[f32]; N], x: [f64; N], y: &mut [f64]) {
        let a = a.map(|a| &a[..y.len()]);
        for (k, y) in y.iter_mut().enumerate() {
            let mut sum = *y;
            for i in 0..N {
                sum += f64::from(a[i][k]) * x[i];
            }
            *y = sum;
        }
    }

    #[inline(always)]
    fn dots<S: Simd, const N: usize>(_: S, a: [&[f32]; N], x: &[f64]) -> [f64; N] {
        let mut sums = [[0.0; LANES]; N];
        let (x, x_rest) = x.as_chunks::<LANES>();
        let mut blocks: [&[[f32; LANES]]; N] = [&[]; N];
        let mut rests: [&[f32]; N] = [&[]; N];
        for i in 0..N {
            let (block, rest) = a[i].as_chunks::<LANES>();
            (blocks[i], rests[i]) = (&block[..x.len()], &rest[..x_rest.len()]);
        }
        for (k, x) in x.iter().enumerate() {
            for i in 0..N {
                for lane in 0..LANES {
                    sums[i][lane] += f64::from(blocks[i][k][lane]) * x[lane];
                }
            }
        }
        let mut out = [0.0; N];
        for i in 0..N {
            let rest: f64 = rests[i]
                .iter()
                .zip(x_rest)
                .map(|(a, x)| f64::from(*a) * x)
                .sum();
            out[i] = sums[i].iter().sum::<f64>() + rest;
        }
        out
    }

    #[inline(always)]
    fn widen<'a>(values: &'a [f32], buffer: &'a mut [f64]) -> &'a [f64] {
        for (to, value) in buffer.iter_mut().zip(values) {
            *to = f64::from(*value);
        }
        &buffer[..values.len()]
    }
}
