//! Figures 5 and 6: tangential stress and velocity on the contact at t = 1 for three pairs of friction coefficients.

use super::example::{self, Finished};
use crate::contact_table::write_columns;
use crate::failure::Failure;
use crate::pictures::{Axis, BLUE, Colour, Curves, GREEN, Mark, Panel, RED, Series, Sheet};
use std::path::Path;

/// The pairs (a, b) of the paper, the slip-weakening one first.
const PAIRS: [(f64, f64, Colour, Mark); 3] = [
    (0.003, 0.001, BLUE, Mark::Beads),
    (0.003, 0.003, RED, Mark::Line),
    (0.001, 0.001, GREEN, Mark::Line),
];

/// A run with its coefficients.
pub struct Law {
    a: f64,
    b: f64,
    colour: Colour,
    mark: Mark,
    pub finished: Finished,
}

impl Law {
    /// Values at the contact nodes at t = 1 against x.
    fn series(&self, values: fn(&crate::course::Frame) -> &[f64]) -> Series {
        let contact = self.finished.compilation.model.contact();
        let last = self.finished.frames.last();
        let values = last.map_or(&[][..], values);
        Series {
            name: format!("a = {}, b = {} Pa", self.a, self.b),
            colour: self.colour,
            mark: self.mark,
            points: contact
                .points
                .iter()
                .zip(values)
                .map(|(p, v)| (p[0], *v))
                .collect(),
        }
    }
}

pub fn run() -> Result<Vec<Law>, Failure> {
    PAIRS
        .into_iter()
        .map(|(a, b, colour, mark)| {
            let scene = example::scene(&[
                ("contact.friction.a", a.to_string()),
                ("contact.friction.b", b.to_string()),
            ])?;
            Ok(Law {
                a,
                b,
                colour,
                mark,
                finished: example::finish(&scene)?,
            })
        })
        .collect()
}

/// Figure 5.
pub fn stress(laws: &[Law]) -> Curves {
    Curves {
        heading: "Tangential stress on the body at t = 1 s".to_owned(),
        x: Axis::new("x", "m").between(0.0, 1.0),
        y: Axis::new("tangential stress", "Pa"),
        series: laws
            .iter()
            .map(|l| l.series(|f| &f.tangential_stress))
            .collect(),
    }
}

/// Figure 6.
pub fn velocity(laws: &[Law]) -> Curves {
    Curves {
        heading: "Tangential velocity at t = 1 s".to_owned(),
        x: Axis::new("x", "m").between(0.0, 1.0),
        y: Axis::new("tangential velocity", "m/s"),
        series: laws.iter().map(|l| l.series(|f| &f.slip_rate)).collect(),
    }
}

/// Writes both figures and their data.
pub fn draw(out: &Path, laws: &[Law]) -> Result<(), Failure> {
    let (stress, velocity) = (stress(laws), velocity(laws));
    let columns: Vec<&Series> = stress.series.iter().chain(&velocity.series).collect();
    let rows = (0..columns[0].points.len()).map(|i| {
        let values = columns.iter().map(|s| s.points[i].1);
        [columns[0].points[i].0].into_iter().chain(values).collect()
    });
    write_columns(
        &out.join("figures5and6.csv"),
        &[
            "x",
            "stress_a003_b001",
            "stress_a003_b003",
            "stress_a001_b001",
            "velocity_a003_b001",
            "velocity_a003_b003",
            "velocity_a001_b001",
        ],
        rows,
    )?;
    Sheet {
        title: "Figures 5 and 6: contact at t = 1 s, h = k = 1/32".to_owned(),
        width: 1240,
        height: 540,
        rows: vec![(1.0, vec![Panel::Curves(stress), Panel::Curves(velocity)])],
    }
    .save(out, "figures5and6")
}
