//! Linear least squares with unknowns that are not negative: the active set method of Lawson and Hanson, Solving Least Squares
//! Problems (1974), chapter 23. For the small problems of a fit, when a scene is compiled.

use nalgebra::{DMatrix, DVector};

/// Share of the largest gradient at the start below which a gradient is none.
const NONE: f64 = 1e-12;

/// The x >= 0 with the smallest `|a x - b|`; `None` for numbers that are not finite.
pub fn non_negative_least_squares(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let count = a.ncols();
    let mut x = DVector::zeros(count);
    let mut is_free = vec![false; count];
    // unknowns that rounding alone asks for, until something has changed
    let mut is_passed_over = vec![false; count];
    let gradient = |x: &DVector<f64>| a.tr_mul(&(b - a * x));
    let least = NONE * gradient(&x).amax();
    if !least.is_finite() {
        return None;
    }
    // every pass lowers the residual, so that no set comes twice; the bound is for rounding
    for _ in 0..10 * count {
        let slopes = gradient(&x);
        let held = (0..count).filter(|&j| !is_free[j] && !is_passed_over[j] && slopes[j] > least);
        let Some(steepest) = held.max_by(|&i, &j| slopes[i].total_cmp(&slopes[j])) else {
            break;
        };
        is_free[steepest] = true;
        let mut is_first = true;
        loop {
            let free: Vec<usize> = (0..count).filter(|&j| is_free[j]).collect();
            if free.is_empty() {
                break;
            }
            let target = solve(&a.select_columns(&free), b)?;
            let moves = || free.iter().copied().zip(target.iter().copied());
            if is_first && moves().any(|(j, to)| j == steepest && to <= 0.0) {
                (is_free[steepest], is_passed_over[steepest]) = (false, true);
                break;
            }
            is_first = false;
            // as far towards the solution on the free ones as all stay positive
            let falling = moves().filter(|(_, to)| *to <= 0.0);
            let first = falling
                .map(|(j, to)| (j, x[j] / (x[j] - to)))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let share = first.map_or(1.0, |(_, share)| share);
            for (j, to) in moves() {
                x[j] = (x[j] + share * (to - x[j])).max(0.0);
            }
            match first {
                Some((j, _)) => (x[j], is_free[j]) = (0.0, false),
                None => {
                    is_passed_over.fill(false);
                    break;
                }
            }
        }
    }
    Some(x)
}

/// Least squares without bounds.
fn solve(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let scales: Vec<f64> = a.column_iter().map(|column| column.norm()).collect();
    let scaled = DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] / scales[j]);
    let svd = scaled.svd(true, true);
    let mut x = svd.solve(b, f64::EPSILON * a.nrows() as f64).ok()?;
    x.iter_mut().zip(scales).for_each(|(x, scale)| *x /= scale);
    x.iter().all(|x| x.is_finite()).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(i: usize, j: usize) -> f64 {
        ((i * 7919 + j * 104_729 + 13) % 1009) as f64 / 1009.0 - 0.3
    }

    /// The conditions of Karush, Kuhn and Tucker, which have one solution.
    #[test]
    fn solutions_satisfy_the_conditions_of_a_minimum() {
        let mut held = 0;
        for (rows, columns) in [(6, 3), (20, 8), (30, 30)] {
            for shift in 0..5 {
                let a = DMatrix::from_fn(rows, columns, |i, j| noise(i + 31 * shift, j));
                let b = DVector::from_fn(rows, |i, _| noise(i, 77 + shift));
                let x = non_negative_least_squares(&a, &b).unwrap();
                let slopes = a.tr_mul(&(&b - &a * &x));
                for (x, slope) in x.iter().zip(slopes.iter()) {
                    assert!(*x >= 0.0 && *slope < 1e-9);
                    assert!(*x == 0.0 || slope.abs() < 1e-9, "{x} {slope}");
                    held += usize::from(*x == 0.0);
                }
            }
        }
        assert!(held > 20);
        let exact = DVector::from_vec(vec![0.0, 2.0, 0.5]);
        let a = DMatrix::from_fn(9, 3, noise);
        let found = non_negative_least_squares(&a, &(&a * &exact)).unwrap();
        assert!((found - exact).amax() < 1e-13);
    }
}
