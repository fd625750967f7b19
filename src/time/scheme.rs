//! Quadratures of the history `u(t) = u_0 + int_0^t w`, written as diagonally implicit Runge-Kutta tableaux.
//!
//! One step of size k goes through at most two stages. Stage `i` solves the inequality at `t + c_i k` with
//!
//! ```text
//! u_i = p_i + theta_i k w_i,   p_i = u_n + k sum_{j < i} a_ij w_j     (w_0 is the velocity at the start of the step)
//! ```
//!
//! and the last stage is the new instant, but for the midpoint rule, whose one stage has the means over the step. Everything else that is integrated in time (contact slip, accumulated slip,
//! conjugate displacements) follows the same formula.
//!
//! | scheme | theta | order | stability |
//! |---|---|---|---|
//! | trapezoid (3.2)-(3.4) | 1/2 | 2 | A-stable, rings at large k |
//! | midpoint | 1/2 | 2 | A-stable, rings at large k |
//! | rectangle (3.26) | 0 | 1 | k < 2 / fastest relaxation rate |
//! | backward Euler | 1 | 1 | L-stable |
//! | TR-BDF2 | 1 - sqrt(2)/2 | 2 | L-stable |
//!
//! The tableau of TR-BDF2 with gamma = 2 - sqrt(2) is that of Hosea and Shampine, Appl. Numer. Math. 20 (1996).

use crate::scene::Scheme;
use std::f64::consts::FRAC_1_SQRT_2;

/// Most stages of a scheme.
pub const MAX_STAGES: usize = 2;

/// One implicit stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// Instant within the step, as a fraction c of it.
    pub instant: f64,
    /// Weights a_ij of the velocity at the start of the step and of the earlier stages.
    pub explicit: [f64; MAX_STAGES],
    /// Implicit weight theta.
    pub theta: f64,
}

/// A time scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tableau {
    stages: [Stage; MAX_STAGES],
    count: usize,
    order: u32,
    /// Weight of the last stage in the whole step; those of the others are its explicit ones.
    last_weight: f64,
}

impl Tableau {
    /// The tableau of a scheme.
    pub fn of(scheme: Scheme) -> Tableau {
        let single = |explicit: f64, theta: f64, order: u32| Tableau {
            stages: [Stage {
                instant: 1.0,
                explicit: [explicit, 0.0],
                theta,
            }; MAX_STAGES],
            count: 1,
            order,
            last_weight: theta,
        };
        match scheme {
            // scenes say what it stands for
            Scheme::Auto | Scheme::Trapezoid => single(0.5, 0.5, 2),
            Scheme::Rectangle => single(1.0, 0.0, 1),
            Scheme::BackwardEuler => single(0.0, 1.0, 1),
            Scheme::Midpoint => {
                let stage = Stage {
                    instant: 0.5,
                    explicit: [0.0; MAX_STAGES],
                    theta: 0.5,
                };
                Tableau {
                    stages: [stage; MAX_STAGES],
                    count: 1,
                    order: 2,
                    last_weight: 1.0,
                }
            }
            Scheme::TrBdf2 => {
                let theta = 1.0 - FRAC_1_SQRT_2;
                let outer = 0.5 * FRAC_1_SQRT_2;
                Tableau {
                    stages: [
                        Stage {
                            instant: 2.0 * theta,
                            explicit: [theta, 0.0],
                            theta,
                        },
                        Stage {
                            instant: 1.0,
                            explicit: [outer, outer],
                            theta,
                        },
                    ],
                    count: 2,
                    order: 2,
                    last_weight: theta,
                }
            }
        }
    }

    /// The stages in order; the last one is the new instant.
    pub fn stages(&self) -> &[Stage] {
        &self.stages[..self.count]
    }

    /// Weight b_j of the start of the step (j = 0) and of stage j in the whole step; they sum to one.
    pub fn weight(&self, j: usize) -> f64 {
        let last = &self.stages[self.count - 1];
        if j == self.count {
            self.last_weight
        } else {
            last.explicit[j]
        }
    }

    /// Whether the last stage is the new instant; otherwise it has the means over the step.
    pub fn ends_with_stage(&self) -> bool {
        self.stages[self.count - 1].instant == 1.0
    }

    /// Order of the error in time, from a consistent start.
    pub fn order(&self) -> u32 {
        self.order
    }

    /// Implicit weight of all stages.
    pub fn theta(&self) -> f64 {
        self.stages[0].theta
    }

    /// Whether the velocity at the start of a step enters the step.
    pub fn uses_start_velocity(&self) -> bool {
        self.stages[0].explicit[0] != 0.0
    }

    /// Largest stable step of an explicit scheme for the fastest relaxation rate (1/s); `None` when every step is stable.
    pub fn stability_limit(&self, fastest_rate: f64) -> Option<f64> {
        (self.theta() == 0.0).then(|| 2.0 / fastest_rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_consistent_and_second_order_where_claimed() {
        for scheme in [
            Scheme::Trapezoid,
            Scheme::Rectangle,
            Scheme::Midpoint,
            Scheme::BackwardEuler,
            Scheme::TrBdf2,
        ] {
            let tableau = Tableau::of(scheme);
            let count = tableau.stages().len();
            let instants: Vec<f64> = std::iter::once(0.0)
                .chain(tableau.stages().iter().map(|s| s.instant))
                .collect();
            let sum: f64 = (0..=count).map(|j| tableau.weight(j)).sum();
            assert!((sum - 1.0).abs() < 1e-15);
            let first_moment: f64 = (0..=count).map(|j| tableau.weight(j) * instants[j]).sum();
            let is_second = (first_moment - 0.5).abs() < 1e-15;
            assert_eq!(tableau.order(), if is_second { 2 } else { 1 }, "{scheme:?}");
            for stage in tableau.stages() {
                let row: f64 = stage.explicit.iter().sum::<f64>() + stage.theta;
                assert!((row - stage.instant).abs() < 1e-15);
                assert_eq!(stage.theta, tableau.theta());
            }
        }
    }
}
