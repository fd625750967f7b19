//! Axes: a range of values, its ticks, and the place of a value on the sheet.

use super::canvas::{Anchor, Canvas, Frame, SMALL, TEXT};
use super::colours::{BLACK, GRID};
use plotters::prelude::DrawingBackend;

/// Room left of and below the plotted area for ticks and labels.
const LEFT_ROOM: f64 = 78.0;
const BOTTOM_ROOM: f64 = 50.0;
/// Room above it for the heading.
const HEADING_ROOM: f64 = 26.0;
/// Colours show values that differ by less than this part of the largest as one: what differs is the end of a relaxation, or rounding.
const SAME_COLOUR: f64 = 1e-6;
/// Decimals of a tick at most.
const DECIMALS: i32 = 12;

/// One axis: what it shows, its unit, and how.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Name of the quantity.
    pub name: String,
    /// Unit; empty for a number.
    pub unit: String,
    pub is_log: bool,
    /// Range to show; otherwise that of the data with a margin.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    pub fn new(name: &str, unit: &str) -> Axis {
        Axis {
            name: name.to_owned(),
            unit: unit.to_owned(),
            is_log: false,
            range: None,
        }
    }

    pub fn log(name: &str, unit: &str) -> Axis {
        Axis {
            is_log: true,
            ..Axis::new(name, unit)
        }
    }

    pub fn between(mut self, low: f64, high: f64) -> Axis {
        self.range = Some((low, high));
        self
    }

    /// The axis from the least to the greatest value, for colours.
    pub(super) fn fit_exactly(&self, values: impl Iterator<Item = f64> + Clone) -> Fitted {
        let low = values.clone().fold(f64::INFINITY, f64::min);
        let high = values.clone().fold(f64::NEG_INFINITY, f64::max);
        let is_uniform = low >= high || high - low < SAME_COLOUR * low.abs().max(high.abs());
        match self.range {
            None if is_uniform && low.is_finite() => self.fit([low].into_iter()),
            None if !is_uniform => self.clone().between(low, high).fit(values),
            _ => self.fit(values),
        }
    }

    /// The axis fitted to data, with a margin.
    pub(super) fn fit(&self, values: impl Iterator<Item = f64>) -> Fitted {
        let usable = values.filter(|v| v.is_finite() && !(self.is_log && *v <= 0.0));
        let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
        let (low, high) = match self.range {
            Some(range) => range,
            // nothing to show; a decade, because zero is infinitely far away on a logarithmic axis
            None if low > high => (0.1, 1.0),
            None if self.is_log => (low / 1.25, high * 1.25),
            None if low == high => (
                low - 0.5 * low.abs().max(1e-12),
                high + 0.5 * high.abs().max(1e-12),
            ),
            None => (low - 0.05 * (high - low), high + 0.05 * (high - low)),
        };
        let largest = low.abs().max(high.abs());
        let exponent = if self.is_log || (1e-2..1e4).contains(&largest) {
            0
        } else {
            3 * (largest.log10() / 3.0).floor() as i32
        };
        Fitted {
            low,
            high,
            is_log: self.is_log,
            exponent,
            label: label(&self.name, &self.unit, exponent),
        }
    }
}

/// `name (10^exponent unit)`.
fn label(name: &str, unit: &str, exponent: i32) -> String {
    let factor = if exponent == 0 {
        String::new()
    } else {
        power_of_ten(exponent)
    };
    match (factor.as_str(), unit) {
        ("", "") => name.to_owned(),
        (factor, unit) => format!("{name} ({})", format!("{factor} {unit}").trim()),
    }
}

fn power_of_ten(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = exponent.abs().to_string();
    let raised = digits
        .chars()
        .filter_map(|c| c.to_digit(10))
        .map(|d| DIGITS[d as usize]);
    let sign = if exponent < 0 { "⁻" } else { "" };
    format!("10{sign}{}", raised.collect::<String>())
}

/// An axis with its range.
pub(super) struct Fitted {
    pub low: f64,
    pub high: f64,
    is_log: bool,
    exponent: i32,
    pub label: String,
}

impl Fitted {
    /// Place of a value between the ends, 0 to 1.
    pub fn place(&self, value: f64) -> f64 {
        if self.is_log {
            (value.max(f64::MIN_POSITIVE) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// Ticks and their texts.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        if self.is_log {
            return self.log_ticks();
        }
        let unit = 10f64.powi(self.exponent);
        let (low, high) = (self.low / unit, self.high / unit);
        let rough = (high - low) / 7.5;
        let magnitude = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 2.5, 5.0, 10.0]
            .into_iter()
            .map(|s| s * magnitude)
            .find(|s| *s >= rough)
            .unwrap_or(rough);
        // digits the step needs: 0.25 needs two, 0.2 one
        let mut decimals = 0;
        while decimals < DECIMALS && {
            let shifted = step * 10f64.powi(decimals);
            (shifted - shifted.round()).abs() > 1e-6
        } {
            decimals += 1;
        }
        let (first, last) = (
            (low / step - 1e-6).ceil() as i64,
            (high / step + 1e-6).floor() as i64,
        );
        (first..=last)
            .map(|i| {
                let value = i as f64 * step;
                let text = format!("{value:.*}", decimals as usize);
                (value * unit, text.replace('-', "−"))
            })
            .collect()
    }

    fn log_ticks(&self) -> Vec<(f64, String)> {
        let (first, last) = (
            self.low.log10().floor() as i32,
            self.high.log10().ceil() as i32,
        );
        let decades = (self.high / self.low).log10();
        let mantissas: &[f64] = if decades < 2.5 {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        (first..=last)
            .flat_map(|e| mantissas.iter().map(move |m| (*m, e)))
            .map(|(m, e)| {
                let text = if m == 1.0 {
                    power_of_ten(e)
                } else {
                    format!("{m}·{}", power_of_ten(e))
                };
                (m * 10f64.powi(e), text)
            })
            .filter(|(value, _)| (self.low * 0.999..=self.high * 1.001).contains(value))
            .collect()
    }
}

/// The plotted area of a panel, with both axes.
pub(super) struct Plane {
    pub frame: Frame,
    pub x: Fitted,
    pub y: Fitted,
}

impl Plane {
    /// Leaves room for ticks, labels, the heading, and `above` and `right` for what the panel adds.
    pub fn new(panel: Frame, x: Fitted, y: Fitted, above: f64, right: f64) -> Plane {
        let frame = Frame {
            left: panel.left + LEFT_ROOM,
            top: panel.top + HEADING_ROOM + above,
            right: panel.right - 16.0 - right,
            bottom: panel.bottom - BOTTOM_ROOM,
        };
        Plane { frame, x, y }
    }

    pub fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (
            self.frame.left + self.x.place(x) * self.frame.width(),
            self.frame.bottom - self.y.place(y) * self.frame.height(),
        )
    }

    /// Whether a point lies within the ranges.
    pub fn shows(&self, x: f64, y: f64) -> bool {
        let within = |place: f64| (-1e-9..=1.0 + 1e-9).contains(&place);
        within(self.x.place(x)) && within(self.y.place(y))
    }

    pub fn grid<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Result<(), String> {
        let Frame {
            left,
            top,
            right,
            bottom,
        } = self.frame;
        for (value, _) in self.x.ticks() {
            let (x, _) = self.at(value, self.y.low);
            canvas.line(&[(x, top), (x, bottom)], GRID, 1.0)?;
        }
        for (value, _) in self.y.ticks() {
            let (_, y) = self.at(self.x.low, value);
            canvas.line(&[(left, y), (right, y)], GRID, 1.0)?;
        }
        Ok(())
    }

    /// Outline, ticks, labels and the heading.
    pub fn axes<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        heading: &str,
        panel: Frame,
    ) -> Result<(), String> {
        let Frame { left, bottom, .. } = self.frame;
        canvas.outline(self.frame, BLACK, 1.0)?;
        for (value, text) in self.x.ticks() {
            let (x, _) = self.at(value, self.y.low);
            canvas.line(&[(x, bottom), (x, bottom + 5.0)], BLACK, 1.0)?;
            canvas.text(&text, (x, bottom + 8.0), Anchor::Below, SMALL)?;
        }
        for (value, text) in self.y.ticks() {
            let (_, y) = self.at(self.x.low, value);
            canvas.line(&[(left - 5.0, y), (left, y)], BLACK, 1.0)?;
            canvas.text(&text, (left - 8.0, y), Anchor::Right, SMALL)?;
        }
        let (cx, cy) = self.frame.centre();
        canvas.text(&self.x.label, (cx, bottom + 38.0), Anchor::Centre, TEXT)?;
        canvas.text(
            &self.y.label,
            (panel.left + 12.0, cy),
            Anchor::Upwards,
            TEXT,
        )?;
        canvas.heading(heading, (left, panel.top + 11.0), Anchor::Left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_without_data_has_few_ticks() {
        for axis in [Axis::new("a", "m"), Axis::log("a", "m")] {
            let ticks = axis
                .fit([0.0, f64::NAN].into_iter().filter(|v| *v > 0.0))
                .ticks();
            assert!((2..=12).contains(&ticks.len()), "{ticks:?}");
            assert!(ticks.iter().all(|(value, _)| (0.1..=1.0).contains(value)));
        }
    }

    /// Values that lie close together on a large one have ticks that can be told apart, and rounding is not drawn as a pattern.
    #[test]
    fn ticks_tell_apart_what_they_mark() {
        for spread in [1.0, 1e-3, 3e-6, 1e-9, 0.0] {
            let values = [100e-6, 100e-6 * (1.0 + spread)];
            let ticks = Axis::new("u", "m").fit_exactly(values.into_iter()).ticks();
            let mut texts: Vec<_> = ticks.iter().map(|(_, text)| text).collect();
            texts.dedup();
            assert!(
                texts.len() == ticks.len() && texts.len() > 2,
                "{spread}: {ticks:?}"
            );
            let covered = ticks[ticks.len() - 1].0 - ticks[0].0;
            assert!(
                spread > SAME_COLOUR || covered > 50e-6,
                "{spread}: {ticks:?}"
            );
        }
    }
}
