//! Saved FMU states: everything that decides how an instance goes on, in memory and as bytes.
//!
//! Bytes (little endian): magic `SLIPFMUS`, format, phase, start time, stop time (infinite without one), the fixed parameters, the
//! length and bytes of the state of the simulator, and a checksum (XXH3, 64 bits) over everything before it. There is no
//! pointer in them: they may be read in another process.

use crate::component::Component;
use crate::fault::{Fault, Outcome};
use crate::phase::Phase;
use std::sync::Arc;
use stickslip::{Simulator, State};
use xxhash_rust::xxh3::xxh3_64;

const MAGIC: &[u8; 8] = b"SLIPFMUS";
const FORMAT: u64 = 3;
/// Words before the state, the parameters apart: magic, format, phase, start and stop time, length.
const HEADER: usize = 6;

/// A saved state.
pub struct Saved {
    pub component: Arc<Component>,
    pub state: State,
    pub phase: Phase,
    pub start_time: f64,
    /// Fixed parameters as set, compiled or not yet.
    pub parameters: Vec<f64>,
    pub stop_time: Option<f64>,
}

impl Saved {
    /// Length of [`Saved::to_bytes`].
    pub fn byte_len(&self) -> usize {
        8 * (HEADER + self.parameters.len() + 1) + self.state.byte_len()
    }

    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.byte_len());
        out.extend_from_slice(MAGIC);
        let stop = self.stop_time.unwrap_or(f64::INFINITY);
        let numbers = [
            FORMAT,
            self.phase as u64,
            self.start_time.to_bits(),
            stop.to_bits(),
        ];
        let values = self.parameters.iter().map(|v| v.to_bits());
        for word in numbers.into_iter().chain(values) {
            out.extend_from_slice(&word.to_le_bytes());
        }
        let state = self.state.to_bytes();
        out.extend_from_slice(&(state.len() as u64).to_le_bytes());
        out.extend_from_slice(&state);
        let checksum = xxh3_64(&out);
        out.extend_from_slice(&checksum.to_le_bytes());
        out
    }

    /// Reads [`Saved::to_bytes`] for an FMU with this number of fixed parameters; `component_of` gives its component for a set of
    /// them.
    pub fn from_bytes(
        bytes: &[u8],
        parameters: usize,
        component_of: impl FnOnce(&[f64]) -> Outcome<Arc<Component>>,
    ) -> Outcome<Saved> {
        let refuse = |what: &str| Err(Fault::error(format!("serialized FMU state: {what}")));
        let header = HEADER + parameters;
        if bytes.len() < 8 * (header + 1) || &bytes[..8] != MAGIC {
            return refuse("these bytes are not one, or are truncated");
        }
        let (body, checksum) = bytes.split_at(bytes.len() - 8);
        if xxh3_64(body).to_le_bytes() != checksum {
            return refuse("the checksum does not match: the bytes are truncated or damaged");
        }
        let word = |at: usize| {
            let mut word = [0; 8];
            word.copy_from_slice(&body[8 * at..8 * at + 8]);
            u64::from_le_bytes(word)
        };
        if word(1) != FORMAT {
            return refuse("of another version of this library");
        }
        let Some(phase) = Phase::from_number(word(2)) else {
            return refuse("unknown phase");
        };
        let float = |at: usize| f64::from_bits(word(at));
        let (start_time, stop_time) = (float(3), float(4));
        if !start_time.is_finite() || stop_time.is_nan() {
            return refuse("its start or stop time is not a number");
        }
        let parameters: Vec<f64> = (5..header - 1).map(float).collect();
        if word(header - 1) != (body.len() - 8 * header) as u64 {
            return refuse("of an FMU with other inputs");
        }
        let component = component_of(&parameters)?;
        let mut simulator = Simulator::new(Arc::clone(&component.model));
        simulator.restore_bytes(&body[8 * header..])?;
        let mut state = simulator.new_state();
        simulator.save(&mut state)?;
        Ok(Saved {
            component,
            state,
            phase,
            start_time,
            stop_time: stop_time.is_finite().then_some(stop_time),
            parameters,
        })
    }
}
