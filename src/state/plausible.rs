//! What a state that was read from bytes must satisfy before anything computes with it. The checksum finds damage, not what
//! another program has written.

use super::layout::{Blocks, Kind};
use super::{MEANINGS, State, control};
use crate::bytes::Reader;
use crate::contact::pressed;
use crate::contact::solve::newton::linearisation;
use crate::error::Result;
use crate::model::Model;

/// Most internal steps that a state may have counted.
const MOST_STEPS: u64 = 1 << 53;

impl State {
    /// Refuses what no simulation of the model leaves behind: counters out of range or at odds with each other, numbers that
    /// are not finite, magnitudes below zero, coefficients that the law cannot have, motion before initialization.
    ///
    /// # Errors
    /// [`crate::Error::Bytes`] that says what is wrong.
    pub(crate) fn check_plausible(&self, model: &Model) -> Result<()> {
        let ensure = |holds: bool, what: &str| match holds {
            true => Ok(()),
            false => Err(Reader::refusal(format!("saved state: {what}"))),
        };
        ensure(self.time.is_finite(), "its time is not finite")?;
        ensure(
            self.is_initialized <= 1 && self.needs_settling <= self.is_initialized,
            "its phase is invalid",
        )?;
        ensure(
            self.meaning < MEANINGS.len() as u64,
            "unknown meaning of its inputs",
        )?;
        let is_recorded = self.is_initialized == 1 && model.history_capacity() > 0;
        let recorded = if is_recorded {
            self.steps.saturating_add(1)
        } else {
            0
        };
        ensure(
            self.steps < MOST_STEPS && self.recorded == recorded,
            "its numbers of steps and of recorded steps do not fit each other",
        )?;
        ensure(self.is_finite(), "a number is not finite")?;
        let components = model.contact().components;
        for (kind, block) in self.blocks() {
            match kind {
                Kind::Motion | Kind::Given => {}
                Kind::Magnitude | Kind::Account => ensure(
                    block.iter().all(|v| *v >= 0.0),
                    "a magnitude or count is negative",
                )?,
                Kind::Marks => ensure(
                    linearisation::is_plausible(block, components),
                    "a point of linearisation is invalid",
                )?,
                Kind::PressedMarks => ensure(
                    pressed::is_plausible(block, components),
                    "a point of linearisation is invalid",
                )?,
                Kind::Past => ensure(
                    block.iter().all(|v| v.is_finite()),
                    "a number of its past is not finite",
                )?,
            }
        }
        let of_second = self.second.iter().flat_map(|s| &s.friction_state);
        ensure(
            self.main
                .friction_state
                .iter()
                .chain(of_second)
                .all(|v| *v > 0.0),
            "a state of the friction law is not positive",
        )?;
        if self.is_initialized == 1 && model.tolerance().is_some() {
            // sizes grow from the proposed one by factors: from zero they never would
            let proposed = self.control[control::PROPOSED];
            ensure(
                proposed > 0.0 && proposed <= 2.0 * model.largest_step(),
                "its proposed step size is out of range",
            )?;
        }
        let checked = model.friction().check_values(&self.coefficients);
        checked.map_err(|e| Reader::refusal(format!("saved state: {e}")))?;
        if self.is_initialized == 0 {
            ensure(
                self.steps == 0 && self.is_at_rest(),
                "it has moved before its initialization",
            )?;
        }
        Ok(())
    }

    /// Whether everything that is zero before initialization is zero.
    fn is_at_rest(&self) -> bool {
        self.numbers()
            .filter(|(kind, _)| *kind != Kind::Given)
            .all(|(_, block)| block.iter().all(|v| *v == 0.0))
    }
}
