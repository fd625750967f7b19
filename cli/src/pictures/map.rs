//! A panel of coloured cells: an amount over two coordinates, grey where the contact sticks, white where it is open.

use super::axes::{Axis, Plane};
use super::canvas::{Anchor, Canvas, Frame, SMALL, TEXT};
use super::colours::{BLACK, STICK, WHITE, sequential};
use plotters::prelude::DrawingBackend;

/// Room right of the plotted area for the colour scale.
const SCALE_ROOM: f64 = 104.0;
const LEGEND_ROW: f64 = 22.0;

/// What a cell shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell {
    Amount(f64),
    Stick,
    Open,
    /// There is no contact.
    Nothing,
}

impl Cell {
    pub fn amount(self) -> Option<f64> {
        match self {
            Cell::Amount(amount) => Some(amount),
            Cell::Stick | Cell::Open | Cell::Nothing => None,
        }
    }
}

/// Cells `x_edges[i]..x_edges[i + 1]` by `y_edges[j]..y_edges[j + 1]`, in `values[j][i]`.
pub struct Map {
    pub heading: String,
    pub x: Axis,
    pub y: Axis,
    pub x_edges: Vec<f64>,
    pub y_edges: Vec<f64>,
    pub values: Vec<Vec<Cell>>,
    /// What the colours mean.
    pub scale: Axis,
}

impl Map {
    pub(super) fn draw<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        panel: Frame,
    ) -> Result<(), String> {
        let ends = |edges: &[f64]| match edges {
            [first, .., last] => (*first, *last),
            _ => (0.0, 1.0),
        };
        let fit = |axis: &Axis, edges: &[f64]| {
            let (low, high) = ends(edges);
            axis.clone().between(low, high).fit(std::iter::empty())
        };
        let (x, y) = (fit(&self.x, &self.x_edges), fit(&self.y, &self.y_edges));
        let plane = Plane::new(panel, x, y, LEGEND_ROW, SCALE_ROOM);
        canvas.rectangle(plane.frame, STICK)?;
        let amounts = self.values.iter().flatten().filter_map(|c| c.amount());
        let colours = self.scale.fit_exactly(amounts);
        for (j, row) in self.values.iter().enumerate() {
            for (i, shown) in row.iter().enumerate() {
                let colour = match shown {
                    Cell::Amount(amount) => sequential(colours.place(*amount)),
                    Cell::Open | Cell::Nothing => WHITE,
                    // the ground
                    Cell::Stick => continue,
                };
                let (left, bottom) = plane.at(self.x_edges[i], self.y_edges[j]);
                let (right, top) = plane.at(self.x_edges[i + 1], self.y_edges[j + 1]);
                let cell = Frame {
                    left,
                    top,
                    right,
                    bottom,
                };
                canvas.rectangle(cell, colour)?;
            }
        }
        plane.axes(canvas, &self.heading, panel)?;
        let top = plane.frame.top - 0.6 * LEGEND_ROW;
        let has_open = self.values.iter().flatten().any(|c| *c == Cell::Open);
        let open = has_open.then_some(("open", WHITE));
        for (i, (word, colour)) in [("stick", STICK)].into_iter().chain(open).enumerate() {
            let left = plane.frame.left + 90.0 * i as f64;
            let patch = Frame {
                left,
                top: top - 7.0,
                right: left + 26.0,
                bottom: top + 7.0,
            };
            canvas.rectangle(patch, colour)?;
            canvas.outline(patch, BLACK, 1.0)?;
            canvas.text(word, (patch.right + 6.0, top), Anchor::Left, SMALL)?;
        }
        let bar = Frame {
            left: plane.frame.right + 18.0,
            right: plane.frame.right + 36.0,
            ..plane.frame
        };
        colour_bar(canvas, bar, &colours)
    }
}

/// The scale of colours, its ticks and label.
pub(super) fn colour_bar<DB: DrawingBackend>(
    canvas: &Canvas<DB>,
    bar: Frame,
    colours: &super::axes::Fitted,
) -> Result<(), String> {
    const BANDS: usize = 96;
    let band = bar.height() / BANDS as f64;
    for i in 0..BANDS {
        let bottom = bar.bottom - i as f64 * band;
        let frame = Frame { bottom, ..bar };
        canvas.rectangle(frame, sequential((i as f64 + 0.5) / BANDS as f64))?;
    }
    canvas.outline(bar, BLACK, 1.0)?;
    for (value, text) in colours.ticks() {
        let y = bar.bottom - colours.place(value) * bar.height();
        canvas.line(&[(bar.right, y), (bar.right + 4.0, y)], BLACK, 1.0)?;
        canvas.text(&text, (bar.right + 7.0, y), Anchor::Left, SMALL)?;
    }
    let (_, cy) = bar.centre();
    canvas.text(
        &colours.label,
        (bar.right + 56.0, cy),
        Anchor::Upwards,
        TEXT,
    )
}
