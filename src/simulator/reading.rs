//! What a simulator shows: its ports and the recorded past of its contact.

use super::Simulator;
use crate::error::{Error, Result};
use crate::ports::readout;
use crate::state::history_row;

/// One row of the recorded past of a contact node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Past<'a> {
    /// Time, s.
    pub time: f64,
    /// Slip rate, one value per tangential component, m/s.
    pub slip_rate: &'a [f64],
    /// Slip, m.
    pub slip: &'a [f64],
    /// Tangential stress on the body, Pa.
    pub tangential_stress: &'a [f64],
}

impl Simulator {
    /// Values of a port, by its reference, into `out` (of the port's length).
    ///
    /// # Errors
    /// [`Error::Unknown`], [`Error::Length`].
    pub fn get(&self, reference: u32, out: &mut [f64]) -> Result<()> {
        let port = self.model.ports().get(reference)?;
        if out.len() != port.len() {
            return Err(Error::Length {
                what: "values of the port",
                expected: port.len(),
                found: out.len(),
            });
        }
        readout::read(&self.model, &self.state, port, out);
        Ok(())
    }

    /// Values of a port, by its name.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    pub fn get_by_name(&self, name: &str) -> Result<Vec<f64>> {
        let port = self.model.ports().find(name)?;
        let mut out = vec![0.0; port.len()];
        readout::read(&self.model, &self.state, port, &mut out);
        Ok(out)
    }

    /// Number of values of all outputs together.
    pub fn output_len(&self) -> usize {
        self.model.ports().output_len()
    }

    /// All outputs one after the other, in the order of their references.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn get_outputs(&self, out: &mut [f64]) -> Result<()> {
        if out.len() != self.output_len() {
            return Err(Error::Length {
                what: "outputs",
                expected: self.output_len(),
                found: out.len(),
            });
        }
        let mut rest = out;
        for port in self.model.ports().outputs() {
            let (head, tail) = rest.split_at_mut(port.len());
            readout::read(&self.model, &self.state, port, head);
            rest = tail;
        }
        Ok(())
    }

    /// The recorded past of a contact node, oldest first: at most `history.capacity` internal steps.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a node beyond the last.
    pub fn slip_history(&self, node: usize) -> Result<impl Iterator<Item = Past<'_>>> {
        let contact = self.model.contact();
        if node >= contact.node_count() {
            return Err(Error::Unknown {
                what: "contact node",
                found: node.to_string(),
            });
        }
        let (c, m) = (contact.components, contact.len());
        let capacity = self.model.history_capacity() as u64;
        let kept = self.state.recorded.min(capacity);
        let row_len = history_row(m);
        let history = &self.state.history;
        Ok(
            (self.state.recorded - kept..self.state.recorded).map(move |i| {
                let at = (i % capacity) as usize * row_len;
                let row = &history[at..at + row_len];
                let part = |block: usize| &row[1 + block * m + node * c..][..c];
                Past {
                    time: row[0],
                    slip_rate: part(0),
                    slip: part(1),
                    tangential_stress: part(2),
                }
            }),
        )
    }
}
