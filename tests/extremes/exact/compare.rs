//! A run against the solution in 96 digits.

use super::solve_exactly;
use crate::judge::{Judge, SAME, TOLERANCES};
use crate::run::run;

/// Relative error of the slip rate that the tolerances allow beyond which nothing is judged: the step is too near to where it
/// has several solutions.
const WORST_JUDGED: f64 = 1e-2;

impl Judge<'_> {
    /// Every internal step is seen, so that of several solutions of a step the one of the run is followed.
    pub(crate) fn solve_exactly(&mut self) {
        let (split, run_of_split);
        let (case, base) = if self.case.cuts == 1 {
            (self.case, self.base)
        } else {
            split = self.case.split();
            run_of_split = run(&split);
            (&split, &run_of_split)
        };
        let exact = match solve_exactly(case, base) {
            Ok(exact) => exact,
            Err(reason) => {
                self.exact = Err(reason);
                return;
            }
        };
        self.exact = Ok(());
        let (rate, stress) = base.scales();
        for (n, (exact, point)) in exact.iter().zip(&base.points).enumerate() {
            let steps = (1 + n) as f64;
            let allowed = |per_residual: f64, scale: f64| {
                TOLERANCES
                    * steps
                    * (case.friction_tolerance * per_residual + case.tolerance * scale)
                    + SAME * scale
            };
            let allowed_rate = allowed(exact.rate_per_residual, rate);
            if allowed_rate > WORST_JUDGED * rate {
                self.sensitive += 1;
                return;
            }
            for i in 0..point.rates.len() {
                let found = [
                    (
                        "exact slip rate",
                        point.rates[i],
                        exact.rates[i],
                        allowed_rate,
                        rate,
                    ),
                    (
                        "exact stress",
                        point.stress[i],
                        exact.stress[i],
                        allowed(exact.stress_per_residual[i], stress),
                        stress,
                    ),
                ];
                for (oracle, found, right, allowed, scale) in found {
                    // where all is zero
                    let scale = scale.max(f64::MIN_POSITIVE);
                    let detail = format!(
                        "point {n} component {i}: {found:e}, right {right:e}, largest {scale:e}, {}",
                        base.kind
                    );
                    self.find(
                        oracle,
                        (found - right).abs() / scale,
                        allowed / scale,
                        detail,
                    );
                }
            }
        }
    }
}
