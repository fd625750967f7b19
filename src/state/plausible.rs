//! What a state that was read from bytes must satisfy before anything computes with it. The checksum finds damage, not what
//! another program has written.

use super::{MEANINGS, State};
use crate::bytes::Reader;
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
            "its phase is none",
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
        ensure(
            self.history.iter().all(|v| v.is_finite()),
            "a number of its past is not finite",
        )?;
        let magnitudes = [
            &self.accumulated_slip,
            &self.second.accumulated_slip,
            &self.report,
            &self.control,
        ];
        ensure(
            magnitudes.into_iter().flatten().all(|v| *v >= 0.0),
            "a magnitude or count is negative",
        )?;
        let components = model.contact().components;
        for points in [&self.linearisation, &self.second.linearisation] {
            ensure(
                linearisation::is_plausible(points, components),
                "a point of linearisation is none",
            )?;
        }
        for (i, value) in self.coefficients.iter().enumerate() {
            if i < model.law().coefficient_names().len() {
                let checked = model.law().check_coefficient(i, *value);
                checked.map_err(|e| Reader::refusal(format!("saved state: {e}")))?;
            }
        }
        if self.is_initialized == 0 {
            ensure(
                self.steps == 0 && self.moving().flatten().all(|v| *v == 0.0),
                "it has moved before its initialization",
            )?;
        }
        Ok(())
    }
}
