//! What accepted steps note about themselves, for the log: told by the first step that it applies to and, once it applies no
//! longer, by the first step without it. The status of the steps stays OK.

use crate::fault::{OK, WARNING};
use crate::log::{Category, Log};
use stickslip::Simulator;

/// One kind of note.
struct Kind {
    applies: fn(&Simulator) -> bool,
    /// Follows "the step from time ... ".
    text: fn(&Simulator) -> String,
    /// The same of a step that is free of it.
    end: &'static str,
}

const KINDS: [Kind; 4] = [
    Kind {
        applies: |simulator| simulator.truncated_residual().is_some(),
        text: |simulator| {
            let residual = simulator.truncated_residual().unwrap_or_default();
            format!(
                "ended at fidelity.work_limit: the friction law holds to {residual:.1e} of the bound at a node, not to \
                 fidelity.friction_tolerance"
            )
        },
        end: "is solved within fidelity.work_limit again",
    },
    Kind {
        applies: |simulator| simulator.solutions().0 > 1.0,
        text: |simulator| {
            let (count, gap) = simulator.solutions();
            format!("has {count} solutions, their slip rates up to {gap:.1e} m/s apart")
        },
        end: "is unique again: the multiplicity test finds one solution",
    },
    Kind {
        applies: |simulator| simulator.residual_at_rounding().is_some(),
        text: |simulator| {
            let residual = simulator.residual_at_rounding().unwrap_or_default();
            format!(
                "holds the friction law to {residual:.1e} of the forces that meet at a node, as well as rounding allows, but \
                 not to fidelity.friction_tolerance"
            )
        },
        end: "holds the friction law to fidelity.friction_tolerance again",
    },
    Kind {
        applies: |simulator| simulator.lost_digits().is_some(),
        text: |simulator| {
            let lost = simulator.lost_digits().unwrap_or_default();
            format!(
                "leaves displacement and slip a relative error of {lost:.1e} by rounding: it is millions of relaxation times \
                 long and follows a jump of the loads"
            )
        },
        end: "loses no digits to a jump of the loads",
    },
];

/// The kinds that the log was told of and that have not ended.
#[derive(Debug, Clone, Copy, Default)]
pub struct Notes {
    told: [bool; KINDS.len()],
}

impl Notes {
    /// Tells what the last step of the simulator, which began at `time`, has changed. While warnings are off nothing counts as told.
    pub fn tell(&mut self, simulator: &Simulator, time: f64, log: &Log) {
        if !log.is_on(Category::Warning) {
            self.told = [false; KINDS.len()];
            return;
        }
        for (kind, told) in KINDS.iter().zip(&mut self.told) {
            let applies = (kind.applies)(simulator);
            if applies && !*told {
                let message = format!("the step from time {time} {}", (kind.text)(simulator));
                log.write(WARNING, Category::Warning, &message);
            } else if *told && !applies {
                let message = format!("the step from time {time} {}", kind.end);
                log.write(OK, Category::Warning, &message);
            }
            *told = applies;
        }
    }
}
