//! Branches fitted to a measured curve: non-negative least squares on relaxation times that are spread over the logarithm. What is
//! not negative is passive, and makes the body's pencil positive.

use super::memory::MOST_BRANCHES;
use super::nnls::non_negative_least_squares;
use crate::refusal::Refusal;
use nalgebra::{DMatrix, DVector};

/// What was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curve {
    /// Storage and loss at an angular frequency, rad/s.
    Dynamic,
    /// A modulus at a time, s.
    Relaxation,
}

/// One measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Frequency or time.
    pub at: f64,
    /// What elasticity and viscosity contribute.
    pub known: [f64; 2],
    pub measured: [f64; 2],
}

/// A fitted curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Relaxation times (s, ascending) and moduli of the branches.
    pub terms: Vec<(f64, f64)>,
    /// Largest error, relative to the magnitude of what was measured.
    pub error: f64,
}

/// What a branch of modulus 1 contributes.
fn response(curve: Curve, at: f64, tau: f64) -> [f64; 2] {
    let x = at * tau;
    match curve {
        Curve::Dynamic if x > 1.0 => [1.0 / (1.0 + 1.0 / (x * x)), 1.0 / (x + 1.0 / x)],
        Curve::Dynamic => [x * x / (1.0 + x * x), x / (1.0 + x * x)],
        Curve::Relaxation => [(-at / tau).exp(), 0.0],
    }
}

/// Relaxation times between two, so many per decade.
pub fn spread([from, to]: [f64; 2], per_decade: f64) -> usize {
    let count = (per_decade * (to / from).log10()).ceil() + 1.0;
    count.clamp(1.0, MOST_BRANCHES as f64) as usize
}

/// What is said of numbers that are too far apart.
pub fn not_fitted(path: &str) -> Refusal {
    let found = "numbers that nothing can be fitted to";
    Refusal::new(path, found, "finite moduli of similar size")
}

/// Fits branches of `count` relaxation times between the given ones; `None` where numbers leave their range.
pub fn fit(curve: Curve, points: &[Point], [from, to]: [f64; 2], count: usize) -> Option<Fit> {
    let taus: Vec<f64> = (0..count)
        .map(|j| match count {
            1 => (from * to).sqrt(),
            _ => from * (to / from).powf(j as f64 / (count - 1) as f64),
        })
        .collect();
    let size = |point: &Point| point.measured[0].hypot(point.measured[1]);
    let sizes: Vec<f64> = points.iter().map(size).collect();
    if !sizes.iter().all(|size| size.is_finite() && *size > 0.0) {
        return None;
    }
    let rows = 2 * points.len();
    let a = DMatrix::from_fn(rows, count, |i, j| {
        response(curve, points[i / 2].at, taus[j])[i % 2] / sizes[i / 2]
    });
    let b = DVector::from_fn(rows, |i, _| {
        let point = &points[i / 2];
        (point.measured[i % 2] - point.known[i % 2]) / sizes[i / 2]
    });
    let moduli = non_negative_least_squares(&a, &b)?;
    let missed = &a * &moduli - b;
    let error = missed
        .as_slice()
        .chunks(2)
        .map(|m| m[0].hypot(m[1]))
        .fold(0.0, f64::max);
    let terms = taus.into_iter().zip(moduli.iter().copied());
    Some(Fit {
        terms: terms.filter(|(_, modulus)| *modulus > 0.0).collect(),
        error,
    })
}
