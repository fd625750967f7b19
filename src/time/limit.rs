//! A bound on the work of a communication step: its friction iterations, shared evenly among the problems that are left in it.
//!
//! Everything else that a step does is known before it begins. A problem that is not solved within its share ends at the best
//! iterate, and what it does not need is left to the others.

use crate::model::Model;

/// Friction iterations that are left to a communication step. Without a limit, and outside steps, there is none.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct WorkLimit {
    left: Option<u64>,
    problems: u64,
}

impl WorkLimit {
    /// For a communication step of so many internal steps.
    pub fn of_step(model: &Model, internal_steps: u64) -> WorkLimit {
        let tableau = model.tableau();
        let ends = usize::from(!tableau.ends_with_stage());
        let stages = (tableau.stages().len() + ends) as u64;
        // the second solution takes steps of half the size
        let solutions = if model.has_error_estimate() { 3 } else { 1 };
        WorkLimit {
            left: model.work_limit(),
            problems: solutions * stages * internal_steps,
        }
    }

    /// The step has so many problems more: those of a jump.
    pub fn expect(&mut self, problems: u64) {
        self.problems += problems;
    }

    pub fn is_given(&self) -> bool {
        self.left.is_some()
    }

    /// Iterations that the next problem may take, `most` without a limit.
    pub fn share(&self, most: usize) -> usize {
        let Some(left) = self.left else {
            return most;
        };
        let share = left.div_ceil(self.problems.max(1));
        usize::try_from(share).map_or(most, |share| most.min(share))
    }

    /// A problem has taken so many.
    pub fn spend(&mut self, iterations: usize) {
        if let Some(left) = &mut self.left {
            *left = left.saturating_sub(iterations as u64);
        }
        self.problems = self.problems.saturating_sub(1);
    }
}

#[cfg(test)]
mod tests {
    use super::WorkLimit;

    #[test]
    fn shares_never_exceed_the_limit() {
        for (limit, problems) in [(1, 5), (7, 3), (100, 8), (0, 2)] {
            let mut work = WorkLimit {
                left: Some(limit),
                problems,
            };
            let mut taken = 0;
            // more problems than were told of too
            for _ in 0..problems + 2 {
                let share = work.share(50);
                work.spend(share);
                taken += share as u64;
            }
            assert_eq!(taken, limit);
        }
    }

    #[test]
    fn what_one_does_not_need_is_left_to_the_others() {
        let mut work = WorkLimit {
            left: Some(12),
            problems: 4,
        };
        assert_eq!(work.share(200), 3);
        work.spend(0);
        assert_eq!(work.share(200), 4);
        assert_eq!(WorkLimit::default().share(200), 200);
    }
}
