//! A panel of lines of text.

use super::canvas::{Anchor, Canvas, Frame, SMALL};
use plotters::prelude::DrawingBackend;

const LINE: f64 = 20.0;
const MARGIN: f64 = 24.0;

pub struct Notes {
    pub lines: Vec<String>,
}

impl Notes {
    /// Height of a panel of so many lines.
    pub fn height(lines: usize) -> f64 {
        LINE * (lines as f64 + 0.5)
    }

    pub(super) fn draw<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        panel: Frame,
    ) -> Result<(), String> {
        for (i, line) in self.lines.iter().enumerate() {
            let at = (panel.left + MARGIN, panel.top + (i as f64 + 0.5) * LINE);
            canvas.text(line, at, Anchor::Left, SMALL)?;
        }
        Ok(())
    }
}
