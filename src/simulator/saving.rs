//! Saving and restoring the state of a simulator.

use super::Simulator;
use crate::error::{Error, Result};
use crate::state::State;

impl Simulator {
    /// A state of this model to save into; holds the state before initialization.
    pub fn new_state(&self) -> State {
        State::new(&self.model)
    }

    /// Copies the state into `to`, a state of the same model; allocates nothing.
    ///
    /// # Errors
    /// [`crate::Error::Fingerprint`] for the state of another model.
    pub fn save(&self, to: &mut State) -> Result<()> {
        to.copy_from(&self.state)
    }

    /// Makes a saved state the current one; allocates nothing. There is no step to take derivatives of afterwards.
    ///
    /// # Errors
    /// [`crate::Error::Fingerprint`] for the state of another model.
    pub fn restore(&mut self, from: &State) -> Result<()> {
        self.state.copy_from(from)?;
        self.last_step = None;
        Ok(())
    }

    /// The state as versioned, checksummed bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.state.to_bytes()
    }

    /// Continues from the bytes of a state of the same model; on failure the state stays. There is no step to take
    /// derivatives of afterwards.
    ///
    /// # Errors
    /// [`Error::Bytes`], also for a state that no simulation leaves behind (numbers that are not finite, counters out of
    /// range); [`Error::Fingerprint`].
    pub fn restore_bytes(&mut self, bytes: &[u8]) -> Result<()> {
        self.trial.read_bytes(bytes)?;
        self.trial.check_plausible(&self.model)?;
        if let Some(what) = self.workspace.finite.fault(&self.model, &self.trial) {
            return Err(Error::Bytes {
                what: format!("saved state: {what} is not finite"),
            });
        }
        std::mem::swap(&mut self.state, &mut self.trial);
        self.last_step = None;
        Ok(())
    }
}
