//! Where the transfer matrix is sampled, decided before any factorization from the interval of relaxation rates alone.
//!
//! Every entry of the transfer matrix is `int dmu(r) / (c + d r)`, `c = cos phi`, `d = sin phi`, over the rates that the
//! material allows. Of Zolotarev's points (see `zolotarev`) the odd ones, his zeros, are the shifts of the Galerkin projection;
//! the even ones, among them the two ends, are where its error is largest, and test it. The derivative by the angle at the
//! shifts comes from all S samples; where it asks for more, a few stand beyond the two ends, where `c A + d B` is still positive
//! (differences of samples on one side only would magnify their rounding errors). With S poles inside the interval of rates,
//!
//! ```text
//! h(phi) prod_l (c + d r_l) = sum_j q_j prod_{k != j} sin(phi - phi_k) / sin(phi_j - phi_k)
//! ```
//!
//! interpolates `h` with an error that falls geometrically in `S` (rational interpolation with prescribed poles; the
//! narrower the interval, the faster: about 20 times per angle for the paper's material, twice that order for the projection).
//! For rates decades apart it is no better than 1e-7, and derivatives are computed instead (`transfer`), where that is allowed.

use super::zolotarev::{angle_of, modulus, slowest, spread, zolotarev_angles};
use faer::{Col, Mat, Side};
use std::f64::consts::FRAC_PI_2;

/// Most shifts that are tried before a tolerance is given up.
const MOST_SHIFTS: usize = 16;
/// How many times the tolerance the projection of the model spectrum may be wrong by: contacts are reduced 20 to 50 times better
/// than that one port, which excites all rates alike.
const SHARE: f64 = 8.0;
/// Share of the tolerance that the derivatives may be wrong by: the weakest responses that a reduction keeps are a hundredth of
/// the tolerance (loads are asked for more), and their derivatives have to be right to a tenth.
const DERIVATIVE_SHARE: f64 = 1e-3;
/// Derivatives are not asked for below this: rounding of the samples.
const DERIVATIVE_FLOOR: f64 = 1e-14;
/// Most samples beyond each end.
const MOST_OUTER: usize = 3;
/// Place of the outermost one between the end and the rates, on a logarithmic scale.
const OUTERMOST: f64 = 0.22;
/// Modulus that is taken for rates that are all equal.
const NARROWEST: f64 = 0.05;
/// Rates of the model spectrum.
const MODEL_RATES: usize = 48;

/// Where the derivatives at the shifts come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derivatives {
    /// The samples.
    Sampled,
    /// The samples where they are accurate enough, else responses of the body to all ports at the shifts.
    Computed,
}

/// Angles of the samples, and how they are used.
pub struct Shifts {
    /// Angles, ascending, from 0 to a quarter turn and a little beyond.
    pub angles: Vec<f64>,
    /// Indices of the angles that are shifts.
    pub shifts: Vec<usize>,
    /// Indices of the angles that test the projection: the first one is the instantaneous response, the last one the long-time one.
    pub tests: Vec<usize>,
    /// Weights of the derivative by the angle at shift i (row) from the samples (column); `None` where derivatives are computed.
    derivative: Option<Vec<Vec<f64>>>,
    /// Largest error of a derivative, relative to the response of one rate.
    pub derivative_error: f64,
}

/// `(c, d)` of an angle; exact at the two ends.
pub fn shift(angle: f64) -> (f64, f64) {
    if angle == FRAC_PI_2 {
        (0.0, 1.0)
    } else {
        (angle.cos(), angle.sin())
    }
}

impl Shifts {
    /// The fewest shifts that reduce a body with rates in `interval` (relative to the reference rate) to `tolerance`, as far
    /// as the model spectrum of [`projection_error`] tells; `None` when there would be too many.
    pub fn for_tolerance(
        interval: [f64; 2],
        tolerance: f64,
        derivatives: Derivatives,
    ) -> Option<Shifts> {
        (1..=MOST_SHIFTS)
            .find(|&count| {
                projection_error(interval, &zolotarev_angles(interval, count)) <= SHARE * tolerance
            })
            .map(|count| Shifts::new(interval, count, tolerance, derivatives))
    }

    /// The same, where no derivative is asked for.
    pub fn without_derivatives(interval: [f64; 2], tolerance: f64) -> Option<Shifts> {
        Shifts::for_tolerance(interval, tolerance, Derivatives::Computed)
            .map(|shifts| Shifts::with_outer_samples(interval, shifts.count(), 0))
    }

    /// `count` shifts, with samples beyond the ends until the derivatives are accurate enough for `tolerance`, or until there
    /// are as many as allowed and derivatives are computed, or as good as they get.
    pub fn new(
        interval: [f64; 2],
        count: usize,
        tolerance: f64,
        derivatives: Derivatives,
    ) -> Shifts {
        let needed = (DERIVATIVE_SHARE * tolerance).max(DERIVATIVE_FLOOR);
        let mut extra = 0;
        loop {
            let shifts = Shifts::with_outer_samples(interval, count, extra);
            if shifts.derivative_error <= needed {
                return shifts;
            }
            if extra == MOST_OUTER {
                return match derivatives {
                    Derivatives::Sampled => shifts,
                    Derivatives::Computed => Shifts {
                        derivative: None,
                        derivative_error: 0.0,
                        ..Shifts::with_outer_samples(interval, count, 0)
                    },
                };
            }
            extra += 1;
        }
    }

    /// Whether derivatives are computed.
    pub fn computes_derivatives(&self) -> bool {
        self.derivative.is_none()
    }

    /// `count` shifts, and `extra` samples beyond each end.
    fn with_outer_samples(interval: [f64; 2], count: usize, extra: usize) -> Shifts {
        let kappa = modulus(slowest(interval));
        // between the end (1) and the rates (1 / kappa)
        let outer = |j: usize| {
            kappa
                .max(NARROWEST)
                .powf(-OUTERMOST * j as f64 / extra as f64)
        };
        let mut angles: Vec<f64> = (1..=extra).rev().map(|j| angle_of(outer(j))).collect();
        let ends_at = angles.len();
        angles.extend(zolotarev_angles(interval, count));
        angles.extend((1..=extra).map(|j| angle_of(-outer(j))));
        let shifts: Vec<usize> = (0..count).map(|i| ends_at + 2 * i + 1).collect();
        let tests: Vec<usize> = (0..=count).map(|i| ends_at + 2 * i).collect();
        let poles = spread(interval, angles.len());
        let derivative: Vec<_> = shifts
            .iter()
            .map(|&at| derivative_weights(&angles, &poles, at))
            .collect();
        let derivative_error = derivative_error(interval, &angles, &shifts, &derivative);
        Shifts {
            angles,
            shifts,
            tests,
            derivative: Some(derivative),
            derivative_error,
        }
    }

    /// One more shift.
    pub fn refined(
        &self,
        interval: [f64; 2],
        tolerance: f64,
        derivatives: Derivatives,
    ) -> Option<Shifts> {
        let count = self.count() + 1;
        (count <= MOST_SHIFTS).then(|| Shifts::new(interval, count, tolerance, derivatives))
    }

    /// Number of shifts.
    pub fn count(&self) -> usize {
        self.shifts.len()
    }

    /// Angle of shift `i`.
    pub fn angle(&self, i: usize) -> f64 {
        self.angles[self.shifts[i]]
    }

    /// The shifts as `s = c / d` in 1/s, descending.
    pub fn rates(&self, reference_rate: f64) -> Vec<f64> {
        let angles = (0..self.count()).map(|i| self.angle(i));
        angles.map(|angle| reference_rate / angle.tan()).collect()
    }

    /// Derivative by the angle at shift `i` of what was sampled at the angles; 0 where derivatives are computed.
    pub fn derivative(&self, i: usize, samples: &[Mat<f64>]) -> Mat<f64> {
        let mut sum = Mat::zeros(samples[0].nrows(), samples[0].ncols());
        let weights = self.derivative.as_ref().map(|weights| &weights[i]);
        for (weight, sample) in weights.into_iter().flatten().zip(samples) {
            for j in 0..sum.ncols() {
                for (to, from) in sum.col_mut(j).iter_mut().zip(sample.col(j).iter()) {
                    *to += weight * from;
                }
            }
        }
        sum
    }
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

/// Largest error of the derivatives of the responses `1 / (c + d r)` of rates of the interval, relative to the response.
fn derivative_error(
    interval: [f64; 2],
    angles: &[f64],
    shifts: &[usize],
    weights: &[Vec<f64>],
) -> f64 {
    let response = |angle: f64, rate: f64| {
        let (c, d) = shift(angle);
        1.0 / (c + d * rate)
    };
    let mut worst: f64 = 0.0;
    for rate in spread(interval, MODEL_RATES) {
        for (&at, weights) in shifts.iter().zip(weights) {
            let (c, d) = shift(angles[at]);
            let h = response(angles[at], rate);
            let sum: f64 = angles
                .iter()
                .zip(weights)
                .map(|(&angle, weight)| weight * response(angle, rate))
                .sum();
            worst = worst.max((sum - h * h * (d - rate * c)).abs() / h);
        }
    }
    worst
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
        let count = |interval, tolerance| {
            let found = Shifts::for_tolerance(interval, tolerance, Derivatives::Sampled);
            found.map(|s| s.count())
        };
        assert_eq!(count(INTERVAL, 1e-4), Some(2));
        assert_eq!(count(INTERVAL, 1e-6), Some(3));
        assert_eq!(count(INTERVAL, 1e-9), Some(4));
        assert_eq!(count([1.0, 1.0], 1e-12), Some(1));
        assert!(count([0.01, 100.0], 1e-9) > Some(6));
        assert_eq!(count([1e-9, 1e9], 1e-12), None);
    }

    #[test]
    fn outer_samples_sharpen_the_derivatives() {
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-9] {
            let shifts = Shifts::for_tolerance(INTERVAL, tolerance, Derivatives::Computed).unwrap();
            assert!(!shifts.computes_derivatives());
            assert!(shifts.angles.is_sorted());
            let plain = Shifts::with_outer_samples(INTERVAL, shifts.count(), 0);
            assert!(shifts.angles.len() > plain.angles.len());
            assert!(shifts.derivative_error < 0.1 * plain.derivative_error);
            assert_eq!(shifts.angles[shifts.tests[0]], 0.0);
            assert_eq!(shifts.angles[*shifts.tests.last().unwrap()], FRAC_PI_2);
            // the operators of all samples are positive
            for angle in &shifts.angles {
                assert!(INTERVAL.iter().all(|r| angle.cos() + angle.sin() * r > 0.3));
            }
        }
    }

    /// Of rates three decades apart they are not, and are computed where that is allowed.
    #[test]
    fn derivatives_of_rates_far_apart_are_computed() {
        let wide = [0.04, 25.0];
        let of = |derivatives| Shifts::for_tolerance(wide, 1e-8, derivatives).unwrap();
        let (sampled, computed) = (of(Derivatives::Sampled), of(Derivatives::Computed));
        assert!(sampled.derivative_error > 1e-8 && !sampled.computes_derivatives());
        assert!(computed.derivative_error == 0.0 && computed.computes_derivatives());
        assert_eq!(sampled.count(), computed.count());
    }

    #[test]
    fn derivatives_of_responses_are_as_sharp_as_the_projection() {
        for (count, allowed) in [(2, 1e-5), (3, 5e-8), (4, 2e-10), (5, 2e-12)] {
            let shifts = Shifts::with_outer_samples(INTERVAL, count, 0);
            assert!(shifts.derivative_error < allowed);
            for rate in [0.73, 0.9, 1.0, 1.2, 1.37] {
                let samples: Vec<_> = shifts
                    .angles
                    .iter()
                    .map(|angle| {
                        Mat::from_fn(1, 1, |_, _| 1.0 / (angle.cos() + rate * angle.sin()))
                    })
                    .collect();
                for i in 0..count {
                    let angle = shifts.angle(i);
                    let h = samples[shifts.shifts[i]][(0, 0)];
                    let exact = h * h * (angle.sin() - rate * angle.cos());
                    let error = (shifts.derivative(i, &samples)[(0, 0)] - exact).abs();
                    assert!(error < allowed, "{count} shifts, rate {rate}: {error:e}");
                }
            }
        }
    }
}
