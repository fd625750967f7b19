//! Whether a solution is one, written without the crate: balance, friction law, normal condition.

use crate::cases::{Case, Found, product};
use stickslip::contact::SlipPath;
use stickslip::contact::pressed::NormalCondition;

/// What a solution violates at most: imbalance as a share of the largest force, the laws as a share of the largest force and
/// the largest gap or velocity. Not a number counts as infinite.
pub fn violation(case: &Case, found: &Found) -> f64 {
    let Found {
        velocity,
        force,
        reaction,
    } = found;
    let body = product(&case.s, velocity);
    let largest = |x: &[f64]| x.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let scale = largest(&case.r)
        .max(largest(&body))
        .max(largest(force))
        .max(f64::MIN_POSITIVE);
    let fastest = largest(velocity).max(f64::MIN_POSITIVE);
    let c = case.components;
    let mut worst: f64 = 0.0;
    let mut see = |value: f64| {
        worst = worst.max(if value.is_nan() {
            f64::INFINITY
        } else {
            value.abs()
        })
    };
    for i in 0..force.len() {
        let f = if i % (c + 1) == c {
            -force[i]
        } else {
            force[i]
        };
        see((body[i] + f - case.r[i]) / scale);
        see((case.r[i] - body[i] - reaction[i]) / scale);
    }
    for node in 0..case.nodes() {
        let at = node * (c + 1);
        let (v, lam) = (&velocity[at..at + c], &force[at..at + c]);
        let (v_n, p) = (velocity[at + c], force[at + c]);
        let length = |x: &[f64]| {
            x.iter()
                .map(|x| (x / fastest.max(scale)).powi(2))
                .sum::<f64>()
                .sqrt()
                * fastest.max(scale)
        };
        let length = |x: &[f64]| if x.len() == 1 { x[0].abs() } else { length(x) };
        if case.gap_base[node] == f64::INFINITY {
            see(largest(lam) / scale);
            see(p / scale);
            continue;
        }
        // the condition
        let gap = case.gap_base[node] + case.gap_rate * v_n;
        let gaps = case.gap_base[node].abs() + case.gap_rate * fastest;
        match case.condition {
            NormalCondition::Bilateral => see(gap / gaps),
            NormalCondition::Unilateral => {
                see((-gap).max(0.0) / gaps);
                see((-p).max(0.0) / scale);
                see((gap / gaps).min(p / scale));
            }
            NormalCondition::Compliance { exponent } => {
                let law = |gap: f64| {
                    let depth = (-gap).max(0.0);
                    case.stiffness[node] * depth.powf(exponent - 1.0) * depth
                };
                // the gap is known to rounding only
                let margin = 4.0 * f64::EPSILON * gaps;
                see((law(gap + margin) - p).max(0.0) / scale);
                see((p - law(gap - margin)).max(0.0) / scale);
            }
        }
        // the law
        let rate = length(v);
        let slip = SlipPath {
            base: case.slip_base[node],
            per_rate: case.theta_k,
        };
        let [mu, _] = case.friction.coefficient.at(rate, slip);
        let [pressure, _] = case.friction.pressure.at(p);
        let bound = mu * pressure;
        if rate == 0.0 {
            see((length(lam) - bound).max(0.0) / scale);
        } else {
            for (lam, v) in lam.iter().zip(v) {
                see((lam - bound * (v / rate)) / scale);
            }
        }
    }
    worst
}
