//! Plane stress of a material with rates: a plate whose faces are free.
//!
//! Without stress across the plate, the strain across it follows the trace of the plane with a relaxation of its own,
//!
//! ```text
//! (a1 + a2) e' + (b1 + b2) e = -(a1 tr' + b1 tr)
//! ```
//!
//! with `A eps = a1 tr(eps) I + a2 eps` and B alike. Eliminated, it leaves laws of the plane and one branch of memory on the trace; none
//! where A and B are proportional.

use super::form::Form;

/// Share of the elasticity below which the branch is rounding.
const ROUNDING: f64 = 1e-14;

/// What the plane has of a plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plate {
    pub viscosity: Form,
    pub elasticity: Form,
    /// Relaxation time (s) and form (Pa) of the branch.
    pub branch: Option<(f64, Form)>,
}

/// The plate of a body with these coefficients of the trace and of the strain, for viscosity and elasticity.
pub(super) fn plate([a1, a2]: [f64; 2], [b1, b2]: [f64; 2]) -> Plate {
    let (a, b) = (a1 + a2, b1 + b2);
    let on_trace = ((a1 * b2 - a2 * b1) / a).powi(2) / b;
    let form = |lambda, two_mu| Form::Isotropic { lambda, two_mu };
    Plate {
        viscosity: form(a1 * a2 / a, a2),
        elasticity: form(b1 * b2 / b, b2),
        branch: (on_trace > ROUNDING * b).then(|| (a / b, form(on_trace, 0.0))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: [f64; 2] = [0.05, 0.1];
    const B: [f64; 2] = [2.0, 0.7];

    /// The trace of the stress in the plane by the strain across the plate, and by the branch, for a trace that grows and stops; both
    /// equations by the same small steps.
    #[test]
    fn the_branch_is_the_strain_across_the_plate() {
        let Plate {
            viscosity,
            elasticity,
            branch,
        } = plate(A, B);
        let (tau, spring) = branch.expect("a branch");
        let k = 1e-4;
        let (mut across, mut lag, mut trace, mut worst) = (0.0, 0.0, 0.0_f64, 0.0_f64);
        let mut largest: f64 = 0.0;
        for n in 0..5000 {
            let rate = if n < 1500 { 1.0 } else { 0.0 };
            let middle = trace + 0.5 * k * rate;
            // trapezoidal steps of both
            let weight = (A[0] + A[1]) + 0.5 * k * (B[0] + B[1]);
            let right = -(A[0] * rate + B[0] * middle) - (B[0] + B[1]) * across;
            let across_rate = right / weight;
            let across_middle = across + 0.5 * k * across_rate;
            // s' = rate - s / tau for the strain of the spring
            let lag_rate = (rate - lag / tau) / (1.0 + 0.5 * k / tau);
            let lag_middle = lag + 0.5 * k * lag_rate;
            // per unit of the identity, the shares of the strain itself are the same in both
            let shared = A[0] * (rate + across_rate) + B[0] * (middle + across_middle);
            let on_trace = |form: &Form| match form {
                Form::Isotropic { lambda, .. } => *lambda,
                Form::Matrix(_) => f64::NAN,
            };
            let found = on_trace(&viscosity) * rate
                + on_trace(&elasticity) * middle
                + on_trace(&spring) * lag_middle;
            worst = worst.max((found - shared).abs());
            largest = largest.max(shared.abs());
            across += k * across_rate;
            lag += k * lag_rate;
            trace += k * rate;
        }
        assert!(worst < 1e-11 * largest, "{worst:e} of {largest}");
    }

    #[test]
    fn proportional_laws_have_no_branch() {
        let found = plate(A, A.map(|a| 7.0 * a));
        assert_eq!(found.branch, None);
        assert!(plate(A, B).branch.is_some());
    }
}
