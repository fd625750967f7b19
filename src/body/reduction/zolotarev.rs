//! The points of Zolotarev's third problem, for an interval of relaxation rates.
//!
//! Positive shifts `s = c / d` on one side and rates on the other are its two sets: with `x = (s - 1) / (s + 1)` (rates relative
//! to their geometric mean, the slowest one q) they are `[-1, 1]` and what lies beyond `1 / kappa`, `kappa = (1 - q) / (1 + q)`.
//! Points stand at `x = sn(u, kappa)`, even in u over the quarter periods.
//!
//! Beckermann and Townsend, SIAM Review 61 (2019); `sn` by descending Landen transformations.

use std::f64::consts::FRAC_PI_2;

/// Zolotarev's zeros (odd) and the extremes between them (even) for `count` zeros, ascending from 0 to a quarter turn.
pub fn zolotarev_angles(interval: [f64; 2], count: usize) -> Vec<f64> {
    let last = 2 * count;
    (0..=last)
        .map(|i| match i {
            0 => 0.0,
            i if i == last => FRAC_PI_2,
            i => angle_of(sine_amplitude(
                slowest(interval),
                1.0 - i as f64 / count as f64,
            )),
        })
        .collect()
}

/// Angle of `x = (s - 1) / (s + 1)`, `s = c / d`.
pub fn angle_of(x: f64) -> f64 {
    (1.0 - x).atan2(1.0 + x)
}

/// `count` rates of the interval: Zolotarev's poles.
pub fn spread(interval: [f64; 2], count: usize) -> Vec<f64> {
    let slowest = slowest(interval);
    let kappa = modulus(slowest);
    let mean = (interval[0] * interval[1]).sqrt();
    (0..count)
        .map(|i| {
            let t = (2 * i + 1) as f64 / count as f64 - 1.0;
            let x = kappa * sine_amplitude(slowest, t);
            mean * (1.0 + x) / (1.0 - x)
        })
        .collect()
}

/// Slowest rate relative to the geometric mean.
pub fn slowest([low, high]: [f64; 2]) -> f64 {
    (low / high).sqrt()
}

pub fn modulus(slowest: f64) -> f64 {
    (1.0 - slowest) / (1.0 + slowest)
}

/// `sn(t K, kappa)` with the quarter period K and the modulus of [`modulus`], for t in [-1, 1].
fn sine_amplitude(slowest: f64, t: f64) -> f64 {
    // the complementary modulus, free of cancellation
    let (mut a, mut b) = (1.0_f64, 2.0 * slowest.sqrt() / (1.0 + slowest));
    let mut ratios = Vec::new();
    while (a - b).abs() > f64::EPSILON * a && ratios.len() < 40 {
        let half_gap = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        ratios.push(half_gap / a);
    }
    let mut phase = 2.0_f64.powi(ratios.len() as i32) * FRAC_PI_2 * t;
    for ratio in ratios.iter().rev() {
        phase = 0.5 * (phase + (ratio * phase.sin()).asin());
    }
    phase.sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz and Stegun, Table 17.1 and 16.5.2: `sn(K / 2) = (1 + k')^(-1/2)`, `sn(K) = 1`.
    #[test]
    fn the_sine_amplitude_has_its_half_period_value() {
        for slowest in [1.0, 0.7, 0.1, 1e-4] {
            let complementary = 2.0 * f64::sqrt(slowest) / (1.0 + slowest);
            let half = 1.0 / (1.0 + complementary).sqrt();
            assert!((sine_amplitude(slowest, 0.5) - half).abs() < 1e-14);
            assert!((sine_amplitude(slowest, 1.0) - 1.0).abs() < 1e-14);
            assert_eq!(sine_amplitude(slowest, 0.0), 0.0);
        }
    }

    #[test]
    fn poles_are_rates_of_the_interval() {
        for interval in [[0.7268, 1.3758], [1.0, 1.0], [1e-3, 1e3]] {
            let poles = spread(interval, 9);
            let inside =
                |r: &f64| *r >= interval[0] * (1.0 - 1e-12) && *r <= interval[1] * (1.0 + 1e-12);
            assert!(poles.iter().all(inside), "{poles:?}");
        }
    }
}
