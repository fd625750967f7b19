//! Weighted Gram matrices of tall columns, as dot products of four columns with two at a time.

use super::double::tile;
use super::products::{Entry, column};
use faer::MatRef;
use pulp::{Arch, Simd, WithSimd};

/// Rows summed at a time, and columns that meanwhile stay in the first-level cache.
const PANEL: (usize, usize) = (256, 8);
/// Columns of the other factor.
const BLOCK: usize = 4;

/// Lower triangle of `ports^T diag(weights) ports`, into the columns of `out`.
pub fn weighted_gram<T: Entry>(ports: MatRef<T>, weights: &[f64], out: &mut [f64]) {
    let (r, m) = (ports.nrows(), ports.ncols());
    assert_eq!((r, m * m), (weights.len(), out.len()));
    Arch::new().dispatch(WeightedGram {
        ports,
        weights,
        out,
    });
}

struct WeightedGram<'a, T> {
    ports: MatRef<'a, T>,
    weights: &'a [f64],
    out: &'a mut [f64],
}

impl<T: Entry> WithSimd for WeightedGram<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let WeightedGram {
            ports,
            weights,
            out,
        } = self;
        let (r, m) = (ports.nrows(), ports.ncols());
        let mut scaled = [[0.0; PANEL.0]; PANEL.1];
        let mut buffers = [[0.0; PANEL.0]; BLOCK];
        out.fill(0.0);
        for from in (0..r).step_by(PANEL.0) {
            let rows = from..r.min(from + PANEL.0);
            // beyond the last column stands the last one again, and is left out
            let part = |j: usize| &column(ports, j.min(m - 1))[rows.clone()];
            for j in (0..m).step_by(PANEL.1) {
                for (q, scaled) in scaled.iter_mut().enumerate() {
                    let values = T::widen(part(j + q), &mut buffers[0]);
                    let values = values.iter().zip(&weights[rows.clone()]);
                    for (scaled, (value, weight)) in scaled.iter_mut().zip(values) {
                        *scaled = value * weight;
                    }
                }
                let last = m.min(j + PANEL.1);
                for i in (0..last).step_by(BLOCK) {
                    let [a, b, c, d] = &mut buffers;
                    let x = [
                        T::widen(part(i), a),
                        T::widen(part(i + 1), b),
                        T::widen(part(i + 2), c),
                        T::widen(part(i + 3), d),
                    ];
                    for q in (0..last - j).step_by(2) {
                        let y = [&scaled[q][..rows.len()], &scaled[q + 1][..rows.len()]];
                        let sums = tile(simd, x, y);
                        for (q, sums) in (j + q..last).zip(&sums) {
                            for (i, sum) in (i..=q).zip(sums) {
                                out[i * m + q] += sum;
                            }
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::weighted_gram;
    use faer::Mat;

    #[test]
    fn agrees_with_the_library() {
        for (r, m) in [(1, 1), (5, 3), (130, 32), (300, 9), (600, 70)] {
            let noise = |i, j| ((i * 7919 + j * 104_729) % 1009) as f64 / 1009.0 - 0.5;
            let ports = Mat::from_fn(r, m, noise);
            let weights: Vec<f64> = (0..r).map(|i| 1.0 / (1.0 + i as f64)).collect();
            let mut gram = vec![0.0; m * m];
            weighted_gram(ports.as_ref(), &weights, &mut gram);
            let scaled = Mat::from_fn(r, m, |i, j| weights[i] * ports[(i, j)]);
            let exact = ports.transpose() * scaled;
            for j in 0..m {
                for i in j..m {
                    assert!((gram[j * m + i] - exact[(i, j)]).abs() < 1e-13);
                }
            }
        }
    }
}
