//! A panel of curves, with its legend above the plotted area.

use super::axes::{Axis, Plane};
use super::canvas::{Anchor, Canvas, Frame, SMALL};
use super::colours::Colour;
use plotters::prelude::DrawingBackend;

/// Height of a row of the legend.
const LEGEND_ROW: f64 = 21.0;
const SAMPLE: f64 = 26.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mark {
    Line,
    Dashed,
    /// A line with a dot at every value.
    Beads,
    /// A dot at every value.
    Dots,
    /// The name below and left of every value, this far left, and not in the legend.
    Name(f64),
}

#[derive(Debug, Clone)]
pub struct Series {
    /// Name in the legend; empty for none.
    pub name: String,
    pub colour: Colour,
    pub mark: Mark,
    pub points: Vec<(f64, f64)>,
}

pub struct Curves {
    pub heading: String,
    pub x: Axis,
    pub y: Axis,
    pub series: Vec<Series>,
}

impl Curves {
    pub(super) fn draw<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        panel: Frame,
    ) -> Result<(), String> {
        let values = || self.series.iter().flat_map(|s| &s.points);
        let x = self.x.fit(values().map(|p| p.0));
        let y = self.y.fit(values().map(|p| p.1));
        let legend = self.legend(canvas, panel);
        let rows = legend.last().map_or(0, |entry| entry.row + 1);
        let plane = Plane::new(panel, x, y, rows as f64 * LEGEND_ROW, 0.0);
        plane.grid(canvas)?;
        for series in &self.series {
            series.draw(canvas, &plane)?;
        }
        plane.axes(canvas, &self.heading, panel)?;
        let top = plane.frame.top - rows as f64 * LEGEND_ROW;
        for entry in legend {
            let (x, y) = (entry.x, top + (entry.row as f64 + 0.35) * LEGEND_ROW);
            entry.series.sample(canvas, x, y)?;
            let at = (x + SAMPLE + 6.0, y);
            canvas.text(&entry.series.name, at, Anchor::Left, SMALL)?;
        }
        Ok(())
    }

    /// Places of the names, as many in a row as fit.
    fn legend<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, panel: Frame) -> Vec<Entry<'_>> {
        let start = panel.left + 78.0;
        let (mut x, mut row) = (start, 0);
        let mut entries = Vec::new();
        let has_entry = |s: &&Series| !s.name.is_empty() && !matches!(s.mark, Mark::Name(_));
        for series in self.series.iter().filter(has_entry) {
            let width = SAMPLE + 24.0 + canvas.text_width(&series.name, SMALL);
            if x > start && x + width > panel.right {
                (x, row) = (start, row + 1);
            }
            entries.push(Entry { series, x, row });
            x += width;
        }
        entries
    }
}

struct Entry<'a> {
    series: &'a Series,
    x: f64,
    row: usize,
}

impl Series {
    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, plane: &Plane) -> Result<(), String> {
        let visible = |p: &&(f64, f64)| p.0.is_finite() && p.1.is_finite() && plane.shows(p.0, p.1);
        // a curve that leaves the ranges is interrupted, not cut off at the frame
        for piece in self.points.split(|p| !visible(&p)) {
            let points: Vec<_> = piece.iter().map(|p| plane.at(p.0, p.1)).collect();
            self.stroke(canvas, &points)?;
        }
        Ok(())
    }

    fn stroke<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        points: &[(f64, f64)],
    ) -> Result<(), String> {
        match self.mark {
            Mark::Line | Mark::Beads if points.len() > 1 => {
                canvas.line(points, self.colour, 2.0)?
            }
            Mark::Dashed => canvas.dashes(points, self.colour, 1.6)?,
            _ => {}
        }
        for point in points {
            match self.mark {
                Mark::Beads | Mark::Dots => canvas.dot(*point, 3.2, self.colour)?,
                Mark::Name(left) => {
                    let beside = (point.0 - left, point.1 + 6.0);
                    canvas.heading(&self.name, beside, Anchor::Right)?;
                }
                Mark::Line | Mark::Dashed => {}
            }
        }
        Ok(())
    }

    /// What the legend shows of it.
    fn sample<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        x: f64,
        y: f64,
    ) -> Result<(), String> {
        let (from, to) = ((x, y), (x + SAMPLE, y));
        match self.mark {
            Mark::Line => canvas.line(&[from, to], self.colour, 2.0),
            Mark::Dashed => canvas.dashes(&[from, to], self.colour, 1.6),
            Mark::Dots => canvas.dot((x + 0.5 * SAMPLE, y), 3.2, self.colour),
            Mark::Name(_) => Ok(()),
            Mark::Beads => {
                canvas.line(&[from, to], self.colour, 2.0)?;
                canvas.dot((x + 0.5 * SAMPLE, y), 3.2, self.colour)
            }
        }
    }
}
