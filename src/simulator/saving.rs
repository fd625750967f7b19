//! Saving and restoring the state of a simulator.

use super::Simulator;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::state::State;
use std::sync::Arc;

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

    /// Makes a saved state the current one; allocates nothing, but where it has other numbers of a free material, which it brings
    /// with it. There is no step to take derivatives of afterwards.
    ///
    /// # Errors
    /// [`crate::Error::Fingerprint`] for the state of another model.
    pub fn restore(&mut self, from: &State) -> Result<()> {
        let model = self.model_of_state(from)?;
        self.state.copy_from(from)?;
        model.into_iter().for_each(|model| self.put_model(model));
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
        let of_state = self.model_of_state(&self.trial)?;
        let model = of_state.as_ref().unwrap_or(&self.model);
        self.trial.check_plausible(model)?;
        if let Some(what) = self.workspace.finite.fault(model, &self.trial) {
            return Err(Error::Bytes {
                what: format!("saved state: {what} is not finite"),
            });
        }
        std::mem::swap(&mut self.state, &mut self.trial);
        of_state.into_iter().for_each(|model| self.put_model(model));
        self.last_step = None;
        Ok(())
    }

    /// The model that a state has been made with, where it is of the same modes and another one than the present one.
    fn model_of_state(&self, state: &State) -> Result<Option<Arc<Model>>> {
        let is_other = state.fingerprint != self.state.fingerprint;
        // numbers that no initialization has taken up wait in the state
        if is_other || state.is_initialized == 0 {
            return Ok(None);
        }
        self.model_of(&state.material)
    }
}
