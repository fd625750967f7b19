//! A panel of the deformed body, coloured by its displacement, with forces as arrows.

use super::axes::Axis;
use super::canvas::{Anchor, Canvas, Frame, SMALL};
use super::colours::{BLACK, GREY, RED, sequential};
use super::map::colour_bar;
use plotters::prelude::DrawingBackend;

const HEADING_ROOM: f64 = 26.0;
const SCALE_ROOM: f64 = 96.0;
/// Room around the body, and the length of the longest arrow.
const MARGIN: f64 = 18.0;
const LONGEST: f64 = 46.0;

/// A plane body.
pub struct BodyView {
    pub heading: String,
    /// Nodes where they are now, m.
    pub nodes: Vec<(f64, f64)>,
    /// The corners of the body before the deformation, closed.
    pub outline: Vec<(f64, f64)>,
    pub triangles: Vec<[usize; 3]>,
    /// Amount at the nodes, shown by colour.
    pub amount: Vec<f64>,
    pub scale: Axis,
    /// Points and forces; arrows end at the point, with one length per force.
    pub forces: Vec<((f64, f64), (f64, f64))>,
    /// What the arrows are.
    pub arrows: String,
}

impl BodyView {
    pub(super) fn draw<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        panel: Frame,
    ) -> Result<(), String> {
        let all = || self.nodes.iter().chain(&self.outline);
        let extent = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
                (l.min(v), h.max(v))
            })
        };
        let (left, right) = extent(&mut all().map(|p| p.0));
        let (low, high) = extent(&mut all().map(|p| p.1));
        let room = Frame {
            left: panel.left + MARGIN,
            top: panel.top + HEADING_ROOM + 22.0,
            right: panel.right - SCALE_ROOM - MARGIN,
            bottom: panel.bottom - LONGEST - MARGIN,
        };
        let unit = (room.width() / (right - left)).min(room.height() / (high - low));
        let shift = 0.5 * (room.width() - unit * (right - left));
        let at = |(x, y): (f64, f64)| {
            (
                room.left + shift + unit * (x - left),
                room.bottom - unit * (y - low),
            )
        };
        let colours = self.scale.fit_exactly(self.amount.iter().copied());
        for triangle in &self.triangles {
            let corners: Vec<_> = triangle.iter().map(|&n| at(self.nodes[n])).collect();
            let mean = triangle.iter().map(|&n| self.amount[n]).sum::<f64>() / 3.0;
            canvas.polygon(&corners, sequential(colours.place(mean)))?;
        }
        for triangle in &self.triangles {
            let mut corners: Vec<_> = triangle.iter().map(|&n| at(self.nodes[n])).collect();
            corners.push(corners[0]);
            canvas.line(&corners, (245, 245, 245), 0.35)?;
        }
        let outline: Vec<_> = self.outline.iter().map(|p| at(*p)).collect();
        canvas.dashes(&outline, GREY, 1.2)?;
        self.draw_forces(canvas, &at)?;
        let (x, y) = (panel.left + MARGIN, panel.top + 11.0);
        canvas.heading(&self.heading, (x, y), Anchor::Left)?;
        let y = panel.top + HEADING_ROOM + 6.0;
        canvas.arrow((x, y), (x + 26.0, y), RED)?;
        canvas.text(&self.arrows, (x + 32.0, y), Anchor::Left, SMALL)?;
        let next = x + 60.0 + canvas.text_width(&self.arrows, SMALL);
        canvas.dashes(&[(next, y), (next + 26.0, y)], GREY, 1.2)?;
        canvas.text("undeformed", (next + 32.0, y), Anchor::Left, SMALL)?;
        let bar = Frame {
            left: panel.right - SCALE_ROOM,
            right: panel.right - SCALE_ROOM + 18.0,
            top: room.top + 10.0,
            bottom: room.bottom,
        };
        colour_bar(canvas, bar, &colours)
    }

    fn draw_forces<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        at: &impl Fn((f64, f64)) -> (f64, f64),
    ) -> Result<(), String> {
        let lengths = self.forces.iter().map(|(_, f)| f.0.hypot(f.1));
        let largest = lengths.fold(f64::MIN_POSITIVE, f64::max);
        for (point, force) in &self.forces {
            let to = at(*point);
            let share = LONGEST / largest;
            let from = (to.0 - share * force.0, to.1 + share * force.1);
            canvas.arrow(from, to, RED)?;
        }
        let foot: Vec<_> = self.forces.iter().map(|(point, _)| at(*point)).collect();
        if foot.len() > 1 {
            canvas.line(&foot, BLACK, 1.0)?;
        }
        Ok(())
    }
}
