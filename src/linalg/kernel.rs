//! Matrix-vector products for the small matrices of a step, where the dispatch of a general product costs more than the
//! product. Plain loops, compiled for the vector instructions that the machine has.

use faer::MatRef;
use pulp::Arch;

/// Columns added together, so that the result is read and written once for all of them.
const COLUMNS: usize = 4;
/// Partial sums of a dot product: independent, so that they fill the vector units.
const LANES: usize = 8;

/// `y = a x`, `a` column-major.
pub fn multiply(a: MatRef<f64>, x: &[f64], y: &mut [f64]) {
    assert_eq!((a.nrows(), a.ncols()), (y.len(), x.len()));
    y.fill(0.0);
    Arch::new().dispatch(
        #[inline(always)]
        || {
            let mut j = 0;
            while j + COLUMNS <= x.len() {
                let [x0, x1, x2, x3] = [x[j], x[j + 1], x[j + 2], x[j + 3]];
                // sticking nodes make whole blocks of zeros
                if x0 != 0.0 || x1 != 0.0 || x2 != 0.0 || x3 != 0.0 {
                    let [a0, a1, a2, a3] = [
                        column(a, j),
                        column(a, j + 1),
                        column(a, j + 2),
                        column(a, j + 3),
                    ];
                    for ((((y, a0), a1), a2), a3) in y.iter_mut().zip(a0).zip(a1).zip(a2).zip(a3) {
                        *y += (a0 * x0 + a1 * x1) + (a2 * x2 + a3 * x3);
                    }
                }
                j += COLUMNS;
            }
            for (j, x) in x.iter().enumerate().skip(j) {
                for (y, a) in y.iter_mut().zip(column(a, j)) {
                    *y += a * x;
                }
            }
        },
    );
}

/// `y = a^T x`, `a` column-major.
pub fn multiply_transposed(a: MatRef<f64>, x: &[f64], y: &mut [f64]) {
    assert_eq!((a.nrows(), a.ncols()), (x.len(), y.len()));
    Arch::new().dispatch(
        #[inline(always)]
        || {
            for (j, y) in y.iter_mut().enumerate() {
                *y = dot(column(a, j), x);
            }
        },
    );
}

/// `a . b`, over the shorter of the two.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (a_blocks, a_rest) = a.as_chunks::<LANES>();
    let (b_blocks, b_rest) = b.as_chunks::<LANES>();
    for (a, b) in a_blocks.iter().zip(b_blocks) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// A column as a slice. All matrices of this crate are column-major; the product of another would be a programming error.
#[inline(always)]
pub fn column<'a>(a: MatRef<'a, f64>, j: usize) -> &'a [f64] {
    match a.col(j).try_as_col_major() {
        Some(column) => column.as_slice(),
        None => unreachable!("matrices are column-major"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;

    #[test]
    fn products_agree_with_the_library() {
        for (n, m) in [(1, 1), (3, 9), (17, 8), (32, 133), (40, 5)] {
            let a = Mat::from_fn(n, m, |i, j| ((3 * i + 7 * j) % 13) as f64 - 6.0);
            let x: Vec<f64> = (0..m)
                .map(|j| if j % 5 < 3 { 0.0 } else { j as f64 })
                .collect();
            let z: Vec<f64> = (0..n).map(|i| 1.0 / (1.0 + i as f64)).collect();
            let (mut y, mut t) = (vec![0.0; n], vec![0.0; m]);
            multiply(a.as_ref(), &x, &mut y);
            multiply_transposed(a.as_ref(), &z, &mut t);
            let (ey, et) = (
                &a * faer::ColRef::from_slice(&x),
                a.transpose() * faer::ColRef::from_slice(&z),
            );
            for i in 0..n {
                assert!((y[i] - ey[i]).abs() < 1e-12 * (1.0 + ey[i].abs()));
            }
            for j in 0..m {
                assert!((t[j] - et[j]).abs() < 1e-12 * (1.0 + et[j].abs()));
            }
        }
    }
}
