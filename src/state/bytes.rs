//! Bytes of a saved state: a frame (see `crate::bytes`) of the counters and then the values.

use super::layout::Blocks;
use super::{COUNTERS, State, history_row};
use crate::bytes::{Frame, HEADER, OVERHEAD, Reader};
use crate::error::Result;
use crate::model::Model;

const FRAME: Frame = Frame {
    magic: *b"SLIPSTAT",
    format: 7,
    what: "saved state",
};

impl State {
    /// Length of [`State::to_bytes`].
    pub fn byte_len(&self) -> usize {
        OVERHEAD + 8 * (COUNTERS + self.len())
    }

    /// The same of the states of a model, without the memory of its recorded past.
    pub(crate) fn byte_len_of(model: &Model) -> usize {
        let past = model
            .history_capacity()
            .saturating_mul(history_row(model.contact().len()));
        State::without_history(model)
            .byte_len()
            .saturating_add(past.saturating_mul(8))
    }

    /// Versioned, checksummed bytes; they fit every simulator of a model with the same fingerprint.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = vec![0; self.byte_len()];
        self.write_bytes(&mut bytes);
        bytes
    }

    /// Time of a state in bytes, s, without its model. Whoever restores the state checks the rest of it.
    ///
    /// # Errors
    /// [`crate::Error::Bytes`] for bytes that are not a state of this format, or damaged.
    pub fn time_of(bytes: &[u8]) -> Result<f64> {
        let (_, payload) = FRAME.open(bytes)?;
        Reader::new(payload).word().map(f64::from_bits)
    }

    /// Writes the bytes of [`State::to_bytes`] without allocating; `out` has [`State::byte_len`] bytes.
    pub(crate) fn write_bytes(&self, out: &mut [u8]) {
        let values = self
            .blocks()
            .flat_map(|(_, block)| block)
            .map(|v| v.to_bits());
        let words = self.counters().into_iter().chain(values);
        for (to, word) in out[HEADER..].chunks_exact_mut(8).zip(words) {
            to.copy_from_slice(&word.to_le_bytes());
        }
        FRAME.seal(self.fingerprint, out);
    }

    /// Reads bytes into this state. It is then to be checked, [`State::check_plausible`], and spoilt after an error.
    ///
    /// # Errors
    /// [`crate::Error::Bytes`] for bytes that are not a state of this format, truncated or damaged;
    /// [`crate::Error::Fingerprint`] for the state of another model.
    pub(crate) fn read_bytes(&mut self, bytes: &[u8]) -> Result<()> {
        let (fingerprint, payload) = FRAME.open(bytes)?;
        self.check_fingerprint(fingerprint)?;
        if bytes.len() != self.byte_len() {
            return Err(Reader::refusal(format!(
                "saved state: expected {} bytes, found {}",
                self.byte_len(),
                bytes.len()
            )));
        }
        let mut reader = Reader::new(payload);
        let mut counters = [0; COUNTERS];
        for counter in &mut counters {
            *counter = reader.word()?;
        }
        self.set_counters(counters);
        for value in self.blocks_mut().flat_map(|(_, block)| block) {
            *value = reader.float()?;
        }
        Ok(())
    }
}
