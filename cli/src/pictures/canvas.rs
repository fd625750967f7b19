//! The few strokes all panels are made of, in units of the sheet.

use super::colours::{BLACK, Colour};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::sync::OnceLock;

/// Name under which the embedded font is known; an SVG viewer takes its own font of that kind.
const FONT: &str = "sans-serif";
pub const TEXT: f64 = 15.0;
pub const SMALL: f64 = 13.5;
const TITLE: f64 = 19.0;

/// A rectangle of the sheet.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Frame {
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub fn centre(&self) -> (f64, f64) {
        (
            0.5 * (self.left + self.right),
            0.5 * (self.top + self.bottom),
        )
    }
}

/// Where a text stands relative to its point.
#[derive(Debug, Clone, Copy)]
pub enum Anchor {
    Left,
    Centre,
    Right,
    /// Centred below the point.
    Below,
    /// Centred, read from below.
    Upwards,
}

pub struct Canvas<'a, DB: DrawingBackend> {
    area: &'a DrawingArea<DB, Shift>,
    scale: f64,
}

/// Registers the embedded font, once.
fn register_font() -> Result<(), String> {
    static OUTCOME: OnceLock<Result<(), String>> = OnceLock::new();
    OUTCOME
        .get_or_init(|| {
            use plotters::style::{FontStyle, register_font};
            let refused = |_| "the embedded font is unusable".to_owned();
            register_font(FONT, FontStyle::Normal, dejavu::sans::regular()).map_err(refused)?;
            register_font(FONT, FontStyle::Bold, dejavu::sans::bold()).map_err(refused)
        })
        .clone()
}

impl<'a, DB: DrawingBackend> Canvas<'a, DB> {
    /// A canvas whose unit is `scale` pixels of `area`.
    pub fn new(area: &'a DrawingArea<DB, Shift>, scale: f64) -> Result<Self, String> {
        register_font()?;
        Ok(Canvas { area, scale })
    }

    fn pixel(&self, (x, y): (f64, f64)) -> (i32, i32) {
        (
            (x * self.scale).round() as i32,
            (y * self.scale).round() as i32,
        )
    }

    fn style(&self, colour: Colour, width: f64) -> ShapeStyle {
        ShapeStyle {
            color: RGBColor(colour.0, colour.1, colour.2).to_rgba(),
            filled: false,
            stroke_width: (width * self.scale).round().max(1.0) as u32,
        }
    }

    fn fill(&self, colour: Colour) -> ShapeStyle {
        self.style(colour, 1.0).filled()
    }

    pub fn line(&self, points: &[(f64, f64)], colour: Colour, width: f64) -> Result<(), String> {
        let points: Vec<_> = points.iter().map(|p| self.pixel(*p)).collect();
        self.area
            .draw(&PathElement::new(points, self.style(colour, width)))
            .map_err(|e| e.to_string())
    }

    /// A line of dashes and gaps of equal length.
    pub fn dashes(&self, points: &[(f64, f64)], colour: Colour, width: f64) -> Result<(), String> {
        const DASH: f64 = 6.0;
        let (mut left, mut is_drawn) = (DASH, true);
        for pair in points.windows(2) {
            let (mut at, to) = (pair[0], pair[1]);
            loop {
                let rest = (to.0 - at.0).hypot(to.1 - at.1);
                let stride = rest.min(left);
                if rest <= 0.0 {
                    break;
                }
                let share = stride / rest;
                let next = (at.0 + share * (to.0 - at.0), at.1 + share * (to.1 - at.1));
                if is_drawn {
                    self.line(&[at, next], colour, width)?;
                }
                left -= stride;
                if left <= 0.0 {
                    (left, is_drawn) = (DASH, !is_drawn);
                }
                at = next;
                if stride >= rest {
                    break;
                }
            }
        }
        Ok(())
    }

    pub fn polygon(&self, points: &[(f64, f64)], colour: Colour) -> Result<(), String> {
        let points: Vec<_> = points.iter().map(|p| self.pixel(*p)).collect();
        self.area
            .draw(&Polygon::new(points, self.fill(colour)))
            .map_err(|e| e.to_string())
    }

    pub fn rectangle(&self, frame: Frame, colour: Colour) -> Result<(), String> {
        let corners = [
            self.pixel((frame.left, frame.top)),
            self.pixel((frame.right, frame.bottom)),
        ];
        self.area
            .draw(&Rectangle::new(corners, self.fill(colour)))
            .map_err(|e| e.to_string())
    }

    pub fn outline(&self, frame: Frame, colour: Colour, width: f64) -> Result<(), String> {
        let Frame {
            left,
            top,
            right,
            bottom,
        } = frame;
        let corners = [
            (left, top),
            (right, top),
            (right, bottom),
            (left, bottom),
            (left, top),
        ];
        self.line(&corners, colour, width)
    }

    pub fn dot(&self, at: (f64, f64), radius: f64, colour: Colour) -> Result<(), String> {
        let radius = (radius * self.scale).round() as i32;
        self.area
            .draw(&Circle::new(self.pixel(at), radius, self.fill(colour)))
            .map_err(|e| e.to_string())
    }

    /// A line with a head at its end.
    pub fn arrow(&self, from: (f64, f64), to: (f64, f64), colour: Colour) -> Result<(), String> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy);
        if length < 0.5 {
            return Ok(());
        }
        let head = (0.45 * length).min(6.0) / length;
        let base = (to.0 - head * dx, to.1 - head * dy);
        let (sx, sy) = (-0.4 * head * dy, 0.4 * head * dx);
        self.line(&[from, base], colour, 1.4)?;
        let corners = [to, (base.0 + sx, base.1 + sy), (base.0 - sx, base.1 - sy)];
        self.polygon(&corners, colour)
    }

    pub fn text(
        &self,
        text: &str,
        at: (f64, f64),
        anchor: Anchor,
        size: f64,
    ) -> Result<(), String> {
        self.write(text, at, anchor, size, FontStyle::Normal)
    }

    pub fn heading(&self, text: &str, at: (f64, f64), anchor: Anchor) -> Result<(), String> {
        self.write(text, at, anchor, TEXT, FontStyle::Bold)
    }

    pub fn title(&self, text: &str, x: f64, y: f64) -> Result<(), String> {
        self.write(text, (x, y), Anchor::Centre, TITLE, FontStyle::Bold)
    }

    fn write(
        &self,
        text: &str,
        at: (f64, f64),
        anchor: Anchor,
        size: f64,
        style: FontStyle,
    ) -> Result<(), String> {
        let (h, v, turn) = match anchor {
            Anchor::Left => (HPos::Left, VPos::Center, FontTransform::None),
            Anchor::Centre => (HPos::Center, VPos::Center, FontTransform::None),
            Anchor::Right => (HPos::Right, VPos::Center, FontTransform::None),
            Anchor::Below => (HPos::Center, VPos::Top, FontTransform::None),
            Anchor::Upwards => (HPos::Center, VPos::Center, FontTransform::Rotate270),
        };
        let font = FontDesc::new(FontFamily::SansSerif, size * self.scale, style).transform(turn);
        let style = font
            .color(&RGBColor(BLACK.0, BLACK.1, BLACK.2))
            .pos(Pos::new(h, v));
        self.area
            .draw_text(text, &style, self.pixel(at))
            .map_err(|e| e.to_string())
    }

    /// Width of a text.
    pub fn text_width(&self, text: &str, size: f64) -> f64 {
        let font = FontDesc::new(FontFamily::SansSerif, size * self.scale, FontStyle::Normal);
        let wide = font.box_size(text).map_or(0, |(width, _)| width);
        f64::from(wide) / self.scale
    }
}
