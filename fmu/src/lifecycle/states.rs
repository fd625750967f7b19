//! Saved states: handles, and bytes that another process continues from.

use super::{Call, Instance};
use crate::fault::{Fault, Outcome};
use crate::saved::Saved;
use std::sync::Arc;
use stickslip::Simulator;

impl Instance {
    /// Saves the state, into `handle` when that is one of this instance; the handle of the saved state.
    pub fn save(&mut self, handle: Option<u64>) -> Outcome<u64> {
        self.permit(Call::States)?;
        if let Some(handle) = handle {
            let at = self.find(handle)?;
            let saved = &mut self.saved[at].1;
            if !Arc::ptr_eq(&saved.component, &self.component) {
                saved.component = Arc::clone(&self.component);
                saved.state = self.simulator.new_state();
            }
            self.simulator.save(&mut saved.state)?;
            saved.phase = self.phase;
            saved.start_time = self.start_time;
            saved.parameters.copy_from_slice(&self.parameters);
            saved.stop_time = self.stop_time;
            return Ok(handle);
        }
        let saved = Saved {
            component: Arc::clone(&self.component),
            state: self.simulator.state().clone(),
            phase: self.phase,
            start_time: self.start_time,
            parameters: self.parameters.clone(),
            stop_time: self.stop_time,
        };
        Ok(self.keep(saved))
    }

    /// Handles are numbers, never addresses, and are not used twice: a freed or foreign one is not mistaken for another.
    fn keep(&mut self, saved: Saved) -> u64 {
        self.saves += 1;
        let handle = (self.serial << 32) | self.saves;
        self.saved.push((handle, saved));
        handle
    }

    fn find(&self, handle: u64) -> Outcome<usize> {
        let unknown = || {
            Fault::error(
                "this is no saved state of this instance: freed, or saved by another instance",
            )
        };
        self.saved
            .iter()
            .position(|(h, _)| *h == handle)
            .ok_or_else(unknown)
    }

    pub fn restore(&mut self, handle: u64) -> Outcome {
        self.permit(Call::States)?;
        let at = self.find(handle)?;
        let saved = &self.saved[at].1;
        if !Arc::ptr_eq(&saved.component, &self.component) {
            self.simulator = Simulator::new(Arc::clone(&saved.component.model));
            self.component = Arc::clone(&saved.component);
        }
        self.simulator.restore(&saved.state)?;
        self.phase = saved.phase;
        self.start_time = saved.start_time;
        self.parameters.copy_from_slice(&saved.parameters);
        self.stop_time = saved.stop_time;
        self.are_values_fresh = false;
        Ok(())
    }

    pub fn free_saved(&mut self, handle: u64) -> Outcome {
        let at = self.find(handle)?;
        self.saved.swap_remove(at);
        Ok(())
    }

    pub fn serialized_len(&self, handle: u64) -> Outcome<usize> {
        self.permit(Call::States)?;
        Ok(self.saved[self.find(handle)?].1.byte_len())
    }

    pub fn serialize(&self, handle: u64, out: &mut [u8]) -> Outcome {
        self.permit(Call::States)?;
        let bytes = self.saved[self.find(handle)?].1.to_bytes();
        match out.get_mut(..bytes.len()) {
            Some(out) => out.copy_from_slice(&bytes),
            None => {
                let (needed, found) = (bytes.len(), out.len());
                return Err(Fault::error(format!(
                    "the state needs {needed} bytes, the buffer has {found}"
                )));
            }
        }
        Ok(())
    }

    pub fn deserialize(&mut self, bytes: &[u8]) -> Outcome<u64> {
        self.permit(Call::States)?;
        let count = self.parameters.len();
        let saved = Saved::from_bytes(bytes, count, |parameters| self.component_of(parameters))?;
        Ok(self.keep(saved))
    }
}
