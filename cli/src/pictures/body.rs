//! A panel of the deformed body, coloured by its displacement, with forces as arrows.

use super::axes::Axis;
use super::canvas::{Anchor, Canvas, Frame, SMALL};
use super::colours::{BLACK, GREY, RED, sequential};
use super::map::colour_bar;
use super::shape::{Place, Shape};
use plotters::prelude::DrawingBackend;

const HEADING_ROOM: f64 = 26.0;
const SCALE_ROOM: f64 = 96.0;
/// Room around the body, and the length of the longest arrow.
const MARGIN: f64 = 18.0;
const LONGEST: f64 = 46.0;

/// A plane body.
pub struct BodyView {
    pub heading: String,
    pub shape: Shape,
    /// Lines around the body before the deformation.
    pub outline: Vec<Vec<Place>>,
    /// Amount at the nodes, shown by colour.
    pub amount: Vec<f64>,
    pub scale: Axis,
    /// Lines along the contact as it is now.
    pub contact: Vec<Vec<Place>>,
    /// Points and forces; arrows end at the point, with one length per force.
    pub forces: Vec<((f64, f64), (f64, f64))>,
    /// What the arrows are, where there are any.
    pub arrows: Option<String>,
}

impl BodyView {
    pub(super) fn draw<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        panel: Frame,
    ) -> Result<(), String> {
        let all = || self.shape.nodes.iter().chain(self.outline.iter().flatten());
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
        let nodes = &self.shape.nodes;
        for triangle in &self.shape.triangles {
            let corners: Vec<_> = triangle.iter().map(|&n| at(nodes[n])).collect();
            let mean = triangle.iter().map(|&n| self.amount[n]).sum::<f64>() / 3.0;
            canvas.polygon(&corners, sequential(colours.place(mean)))?;
        }
        for outline in &self.shape.outlines {
            let line: Vec<_> = outline.iter().map(|p| at(*p)).collect();
            canvas.line(&line, (245, 245, 245), 0.35)?;
        }
        for outline in &self.outline {
            let line: Vec<_> = outline.iter().map(|p| at(*p)).collect();
            canvas.dashes(&line, GREY, 1.2)?;
        }
        self.draw_forces(canvas, &at)?;
        let (x, y) = (panel.left + MARGIN, panel.top + 11.0);
        canvas.heading(&self.heading, (x, y), Anchor::Left)?;
        let y = panel.top + HEADING_ROOM + 6.0;
        let mut next = x;
        if let Some(arrows) = &self.arrows {
            canvas.arrow((x, y), (x + 26.0, y), RED)?;
            canvas.text(arrows, (x + 32.0, y), Anchor::Left, SMALL)?;
            next += 60.0 + canvas.text_width(arrows, SMALL);
        }
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
        for line in self.contact.iter().filter(|line| line.len() > 1) {
            let foot: Vec<_> = line.iter().map(|point| at(*point)).collect();
            canvas.line(&foot, BLACK, 1.0)?;
        }
        Ok(())
    }
}
