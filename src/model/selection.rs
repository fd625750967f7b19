//! The note of a model on how its setting was picked for `fidelity.target_error`. The study that picks stands above the model.

use crate::bytes::{Reader, Writer};
use crate::error::Result;

/// Numbers that say how well a setting does: an error and an uncertainty for each of four quantities.
const ERRORS: usize = 8;

/// What was picked for a target, and how well it meets it.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// Relative error asked for.
    pub target: f64,
    /// Errors of the setting that was picked, as numbers; [`crate::tradeoff::Verdict`] reads them.
    pub(crate) errors: Vec<f64>,
    /// Paths and values of the scene that it replaces.
    pub changes: Vec<(String, String)>,
    /// Settings measured.
    pub tried: usize,
}

impl Selection {
    /// Writes what [`Selection::read`] reads.
    pub(crate) fn write(selection: Option<&Selection>, out: &mut Writer) {
        out.word(u64::from(selection.is_some()));
        let Some(selection) = selection else { return };
        out.float(selection.target);
        out.floats(&selection.errors);
        out.word(selection.tried as u64);
        out.word(selection.changes.len() as u64);
        for (path, value) in &selection.changes {
            out.text(path);
            out.text(value);
        }
    }

    /// # Errors
    /// [`crate::Error::Bytes`].
    pub(crate) fn read(from: &mut Reader) -> Result<Option<Selection>> {
        match from.word()? {
            0 => return Ok(None),
            1 => {}
            other => return Err(Reader::refusal(format!("selection of kind {other}"))),
        }
        let target = from.float()?;
        let errors = from.floats()?;
        if errors.len() != ERRORS {
            return Err(Reader::refusal("the errors of the setting that was picked"));
        }
        let tried = from.size()?;
        let count = from.word()?;
        let mut change = || Ok((from.text()?.to_owned(), from.text()?.to_owned()));
        Ok(Some(Selection {
            target,
            errors,
            changes: (0..count).map(|_| change()).collect::<Result<_>>()?,
            tried,
        }))
    }
}
