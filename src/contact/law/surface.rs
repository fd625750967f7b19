//! A table over slip rate and accumulated slip: linear along both between its points, constant outside.
//!
//! Along a stage the slip is `base + per_rate * rate`, so the value is a piecewise quadratic function of the rate, with a new
//! piece where rate or slip crosses a point. Simpson's rule is exact on each; a potential takes the longer the more are crossed.

use crate::contact::evaluation::{Evaluation, SlipPath};

/// Points and values; one row of values per rate, one value per slip in it.
#[derive(Debug, Clone, Copy)]
pub struct Surface<'a> {
    pub rates: &'a [f64],
    pub slips: &'a [f64],
    pub values: &'a [f64],
}

/// Where a coordinate lies between points.
#[derive(Debug, Clone, Copy)]
struct Cell {
    /// The point before, or the first, and the one after it, which is the same outside the points.
    ends: [usize; 2],
    /// Share of the way between them.
    share: f64,
    /// Their distance; infinite outside.
    length: f64,
}

impl Cell {
    /// At a point it is the one beyond.
    fn of(points: &[f64], x: f64) -> Cell {
        let beyond = points.partition_point(|point| *point <= x);
        if beyond == 0 || beyond == points.len() {
            let end = beyond.saturating_sub(1);
            return Cell {
                ends: [end, end],
                share: 0.0,
                length: f64::INFINITY,
            };
        }
        let length = points[beyond] - points[beyond - 1];
        Cell {
            ends: [beyond - 1, beyond],
            share: (x - points[beyond - 1]) / length,
            length,
        }
    }
}

fn mix([a, b]: [f64; 2], share: f64) -> f64 {
    // never outside its ends
    (1.0 - share) * a + share * b
}

impl Surface<'_> {
    fn corners(&self, rate: Cell, slip: Cell) -> [[f64; 2]; 2] {
        let columns = self.slips.len();
        rate.ends
            .map(|row| slip.ends.map(|column| self.values[row * columns + column]))
    }

    fn value(&self, rate: f64, slip: f64) -> f64 {
        let (rate, slip) = (Cell::of(self.rates, rate), Cell::of(self.slips, slip));
        mix(
            self.corners(rate, slip).map(|row| mix(row, slip.share)),
            rate.share,
        )
    }

    /// Value and its derivatives by rate and by slip; beyond a point where they jump.
    pub fn derivatives(&self, rate: f64, slip: f64) -> [f64; 3] {
        let (rate, slip) = (Cell::of(self.rates, rate), Cell::of(self.slips, slip));
        let corners = self.corners(rate, slip);
        let along = corners.map(|row| mix(row, slip.share));
        let rises = corners.map(|row| (row[1] - row[0]) / slip.length);
        [
            mix(along, rate.share),
            (along[1] - along[0]) / rate.length,
            mix(rises, rate.share),
        ]
    }

    pub fn along(&self, path: SlipPath, rate: f64) -> Evaluation {
        let [bound, by_rate, by_slip] = self.derivatives(rate, path.base + path.per_rate * rate);
        Evaluation {
            bound,
            slope: by_rate + path.per_rate * by_slip,
            potential: self.potential(path, rate),
        }
    }

    fn potential(&self, path: SlipPath, rate: f64) -> f64 {
        let slip = |rate: f64| path.base + path.per_rate * rate;
        let at = |rate: f64| self.value(rate, slip(rate));
        let mut next_rate = self.rates.partition_point(|point| *point <= 0.0);
        let mut next_slip = self.slips.partition_point(|point| *point <= path.base);
        let (mut from, mut value, mut sum) = (0.0, at(0.0), 0.0);
        while from < rate {
            let crossing = match self.slips.get(next_slip) {
                Some(point) if path.per_rate > 0.0 => (point - path.base) / path.per_rate,
                _ => f64::INFINITY,
            };
            let point = self.rates.get(next_rate).copied().unwrap_or(f64::INFINITY);
            let to = rate.min(point).min(crossing).max(from);
            let (middle, end) = (at(0.5 * (from + to)), at(to));
            sum += (to - from) * ((value + 4.0 * middle + end) / 6.0);
            next_rate += usize::from(point <= to);
            next_slip += usize::from(crossing <= to);
            (from, value) = (to, end);
        }
        sum
    }

    /// The steepest fall along a stage whose slip grows by `per_rate` times the rate, anywhere on the surface: the derivative
    /// by the rate depends on the slip alone within a cell, and the other way round, so it is at a corner of a cell.
    pub fn steepest_fall(&self, per_rate: f64) -> f64 {
        let columns = self.slips.len();
        let value = |row: usize, column: usize| self.values[row * columns + column];
        // by the rate from a row on, at a column; nothing outside
        let by_rate = |row: Option<usize>, column: usize| match row {
            Some(row) if row + 1 < self.rates.len() => {
                (value(row + 1, column) - value(row, column))
                    / (self.rates[row + 1] - self.rates[row])
            }
            _ => 0.0,
        };
        let by_slip = |column: Option<usize>, row: usize| match column {
            Some(column) if column + 1 < columns => {
                (value(row, column + 1) - value(row, column))
                    / (self.slips[column + 1] - self.slips[column])
            }
            _ => 0.0,
        };
        let mut steepest = 0.0_f64;
        for row in 0..self.rates.len() {
            for column in 0..columns {
                for rows in [row.checked_sub(1), Some(row)] {
                    for columns in [column.checked_sub(1), Some(column)] {
                        let rise = by_rate(rows, column) + per_rate * by_slip(columns, row);
                        steepest = steepest.max(-rise);
                    }
                }
            }
        }
        steepest
    }
}
