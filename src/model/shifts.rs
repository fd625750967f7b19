//! Where the transfer matrix is sampled, decided before any factorization from the interval of relaxation rates alone.
//!
//! Every entry of the transfer matrix is `int dmu(r) / (c + d r)`, `c = cos phi`, `d = sin phi`, over the rates that the
//! material allows. The `S = 2 K + 1` angles are Chebyshev-Lobatto points of the quarter turn. The odd ones are the shifts of
//! the Galerkin projection; the even ones, among them the two ends, test it. All of them together give the derivative by the
//! angle at the shifts: with `S` poles inside the interval of rates,
//!
//! ```text
//! h(phi) prod_l (c + d r_l) = sum_j q_j prod_{k != j} sin(phi - phi_k) / sin(phi_j - phi_k)
//! ```
//!
//! interpolates `h` with an error that falls geometrically in `S` (rational interpolation with prescribed poles; the
//! narrower the interval, the faster: about 20 times per angle for the paper's material, twice that order for the projection).

use faer::{Col, Mat, Side};
use std::f64::consts::FRAC_PI_4;

/// Most shifts that are tried before a tolerance is given up.
const MOST_SHIFTS: usize = 16;
/// Share of the tolerance that the projection of the model spectrum may use.
const SHARE: f64 = 0.5;
/// Rates of the model spectrum.
const MODEL_RATES: usize = 48;

/// Angles of the samples, and how they are used.
pub struct Shifts {
    /// Angles, ascending, `2 K + 1` of them from 0 to a quarter turn; the odd ones are the shifts.
    pub angles: Vec<f64>,
    /// Weights of the derivative by the angle at shift i (row) from the samples (column).
    derivative: Vec<Vec<f64>>,
}

/// `(c, d)` of an angle; exact at the two ends.
pub fn shift(angle: f64) -> (f64, f64) {
    if angle == 2.0 * FRAC_PI_4 {
        (0.0, 1.0)
    } else {
        (angle.cos(), angle.sin())
    }
}

impl Shifts {
    /// The fewest shifts that reduce a body with rates in `interval` (relative to the reference rate) to `tolerance`, as far
    /// as the model spectrum of [`projection_error`] tells; `None` when there would be too many.
    pub fn for_tolerance(interval: [f64; 2], tolerance: f64) -> Option<Shifts> {
        (1..=MOST_SHIFTS)
            .find(|&count| projection_error(interval, &lobatto(count)) <= SHARE * tolerance)
            .map(|count| Shifts::new(interval, count))
    }

    /// `count` shifts.
    pub fn new(interval: [f64; 2], count: usize) -> Shifts {
        let angles = lobatto(count);
        let poles = spread(interval, angles.len());
        let derivative = (0..count)
            .map(|i| derivative_weights(&angles, &poles, 2 * i + 1))
            .collect();
        Shifts { angles, derivative }
    }

    /// One more shift.
    pub fn refined(&self, interval: [f64; 2]) -> Option<Shifts> {
        let count = self.count() + 1;
        (count <= MOST_SHIFTS).then(|| Shifts::new(interval, count))
    }

    /// Number of shifts.
    pub fn count(&self) -> usize {
        self.derivative.len()
    }

    /// Index of shift `i` among the angles.
    pub fn at(&self, i: usize) -> usize {
        2 * i + 1
    }

    /// Indices of the angles that test the projection.
    pub fn tests(&self) -> impl Iterator<Item = usize> {
        (0..self.angles.len()).step_by(2)
    }

    /// Derivative by the angle at shift `i` of what was sampled at the angles.
    pub fn derivative(&self, i: usize, samples: &[Mat<f64>]) -> Mat<f64> {
        let mut sum = Mat::zeros(samples[0].nrows(), samples[0].ncols());
        for (weight, sample) in self.derivative[i].iter().zip(samples) {
            for j in 0..sum.ncols() {
                for (to, from) in sum.col_mut(j).iter_mut().zip(sample.col(j).iter()) {
                    *to += weight * from;
                }
            }
        }
        sum
    }
}

/// Chebyshev-Lobatto angles of the quarter turn for `count` shifts.
fn lobatto(count: usize) -> Vec<f64> {
    let last = 2 * count;
    (0..=last)
        .map(|k| match k {
            0 => 0.0,
            k if k == last => 2.0 * FRAC_PI_4,
            k => FRAC_PI_4 * (1.0 - (2.0 * FRAC_PI_4 * k as f64 / count as f64).cos()),
        })
        .collect()
}

/// Chebyshev points of an interval on the logarithmic scale.
fn spread([low, high]: [f64; 2], count: usize) -> Vec<f64> {
    let at = |k: usize| 0.5 * (1.0 - (4.0 * FRAC_PI_4 * (k as f64 + 0.5) / count as f64).cos());
    (0..count).map(|k| low * (high / low).powf(at(k))).collect()
}

/// Weights of `h'(angles[i])` from the values of `h` at the angles, exact for combinations of `1 / (c + d pole)`.
fn derivative_weights(angles: &[f64], poles: &[f64], i: usize) -> Vec<f64> {
    let sine = |a: usize, b: usize| (angles[a] - angles[b]).sin();
    let others = |a: usize, b: usize| (0..angles.len()).filter(move |&k| k != a && k != b);
    let (c, d) = shift(angles[i]);
    // (log prod_l (c + d pole_l))' and the ratio of the products at angle j and here
    let slope: f64 = poles.iter().map(|p| (p * c - d) / (c + p * d)).sum();
    let ratio = |j: usize| -> f64 {
        let (cj, dj) = shift(angles[j]);
        poles.iter().map(|p| (cj + p * dj) / (c + p * d)).product()
    };
    (0..angles.len())
        .map(|j| {
            if j == i {
                let own: f64 = others(i, i)
                    .map(|k| (angles[i] - angles[k]).tan().recip())
                    .sum();
                own - slope
            } else {
                let numerator: f64 = others(i, j).map(|k| sine(i, k)).product();
                let denominator: f64 = others(j, j).map(|k| sine(j, k)).product();
                ratio(j) * numerator / denominator
            }
        })
        .collect()
}

/// Error of the projection on the shifts among `angles`, at the other angles, for one port that excites rates spread evenly
/// over the interval.
fn projection_error(interval: [f64; 2], angles: &[f64]) -> f64 {
    let rates = spread(interval, MODEL_RATES);
    let response = |angle: f64, rate: f64| {
        let (c, d) = shift(angle);
        1.0 / (c + d * rate)
    };
    let count = (angles.len() - 1) / 2;
    let snapshots = Mat::from_fn(MODEL_RATES, count, |r, i| {
        response(angles[2 * i + 1], rates[r])
    });
    let basis = snapshots.qr().compute_thin_Q();
    let scaled = Mat::from_fn(MODEL_RATES, count, |r, i| rates[r] * basis[(r, i)]);
    let Ok(eigen) = (basis.transpose() * &scaled).self_adjoint_eigen(Side::Lower) else {
        return f64::INFINITY;
    };
    let port = eigen.U().transpose() * (basis.transpose() * Col::<f64>::ones(MODEL_RATES));
    let reduced = |angle: f64| -> f64 {
        let rates = eigen.S().column_vector().iter();
        rates
            .zip(port.iter())
            .map(|(rate, p)| p * p * response(angle, *rate))
            .sum()
    };
    angles
        .iter()
        .step_by(2)
        .map(|&angle| {
            let exact: f64 = rates.iter().map(|rate| response(angle, *rate)).sum();
            (reduced(angle) / exact - 1.0).abs()
        })
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The paper's material, relative to the geometric mean.
    const INTERVAL: [f64; 2] = [0.7268, 1.3758];

    #[test]
    fn tighter_tolerances_and_wider_intervals_take_more_shifts() {
        let count =
            |interval, tolerance| Shifts::for_tolerance(interval, tolerance).map(|s| s.count());
        assert_eq!(count(INTERVAL, 1e-4), Some(2));
        assert_eq!(count(INTERVAL, 1e-6), Some(3));
        assert_eq!(count(INTERVAL, 1e-9), Some(4));
        assert_eq!(count([1.0, 1.0], 1e-12), Some(1));
        assert!(count([0.01, 100.0], 1e-9) > Some(6));
        assert_eq!(count([1e-9, 1e9], 1e-12), None);
    }

    #[test]
    fn derivatives_of_responses_are_as_sharp_as_the_projection() {
        for (count, allowed) in [(2, 1e-5), (3, 5e-8), (4, 2e-10), (5, 2e-12)] {
            let shifts = Shifts::new(INTERVAL, count);
            for rate in [0.73, 0.9, 1.0, 1.2, 1.37] {
                let samples: Vec<_> = shifts
                    .angles
                    .iter()
                    .map(|angle| {
                        Mat::from_fn(1, 1, |_, _| 1.0 / (angle.cos() + rate * angle.sin()))
                    })
                    .collect();
                for i in 0..count {
                    let angle = shifts.angles[shifts.at(i)];
                    let h = samples[shifts.at(i)][(0, 0)];
                    let exact = h * h * (angle.sin() - rate * angle.cos());
                    let error = (shifts.derivative(i, &samples)[(0, 0)] - exact).abs();
                    assert!(error < allowed, "{count} shifts, rate {rate}: {error:e}");
                }
            }
        }
    }
}
