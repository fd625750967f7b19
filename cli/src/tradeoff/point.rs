//! A setting that was measured.

use std::time::Duration;
use stickslip::tradeoff::{Measured, Quantity, Sample, Setting, Verdict};

/// What a setting varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    AsGiven,
    Cells,
    Mesh,
    Step,
    Scheme,
    Tolerance,
    Model,
    Joint,
}

impl Group {
    pub const ALL: [Group; 8] = [
        Group::AsGiven,
        Group::Cells,
        Group::Mesh,
        Group::Step,
        Group::Scheme,
        Group::Tolerance,
        Group::Model,
        Group::Joint,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Group::AsGiven => "as given",
            Group::Cells => "cells",
            Group::Mesh => "grading, element",
            Group::Step => "steps",
            Group::Scheme => "scheme",
            Group::Tolerance => "tolerance, precision",
            Group::Model => "model",
            Group::Joint => "joint",
        }
    }
}

/// Errors, cost and size of one setting.
pub struct Point {
    pub group: Group,
    /// What it changes of the scene.
    pub setting: Setting,
    /// The run, to be judged again when the reference is refined.
    pub sample: Sample,
    pub verdict: Verdict,
    /// Fastest compilation.
    pub setup: Duration,
    /// Fastest run, steps alone.
    pub stepping: Duration,
    pub states: usize,
    pub contact_nodes: usize,
    pub model_bytes: usize,
    pub state_bytes: usize,
}

impl Point {
    /// Seconds per internal step.
    pub fn per_step(&self) -> f64 {
        self.stepping.as_secs_f64() / self.steps()
    }

    /// Seconds per second of the scene.
    pub fn cost(&self) -> f64 {
        self.stepping.as_secs_f64() / self.sample.trajectory.until
    }

    pub fn iterations_per_step(&self) -> f64 {
        self.sample.trajectory.work.iterations as f64 / self.steps()
    }

    fn steps(&self) -> f64 {
        self.sample.trajectory.work.steps.max(1) as f64
    }

    /// The worst of these errors; `None` when one of them is at the limit of the reference or there is none.
    pub fn figure(&self, quantities: &[Quantity]) -> Option<f64> {
        let measured: Vec<Measured> = quantities
            .iter()
            .filter_map(|q| self.verdict.of(*q))
            .collect();
        let figures: Option<Vec<f64>> = measured.iter().map(Measured::figure).collect();
        figures?.into_iter().reduce(f64::max)
    }

    /// What the worst of these errors does not exceed.
    pub fn bound(&self, quantities: &[Quantity]) -> f64 {
        let measured = quantities.iter().filter_map(|q| self.verdict.of(*q));
        measured.map(|m| m.bound()).fold(0.0, f64::max)
    }

    /// The changes in few words; of joint settings without the tolerances, which are far below their errors.
    pub fn label(&self) -> String {
        let word = |(path, value): &(String, String)| {
            let list = value.trim_matches(['[', ']']);
            Some(match path.as_str() {
                "mesh.cells" => format!("cells {}", list.replace(',', " x ")),
                "mesh.grading" => format!("grading {}", list.replace(',', ", ")),
                "time.step" => format!("step {value}"),
                "time.tolerance" if value == "null" => "equal steps".to_owned(),
                "time.tolerance" => format!("steps chosen to {value}"),
                "time.error_estimate" if value == "true" => "error estimate".to_owned(),
                "time.error_estimate" => return None,
                "fidelity.tolerance" | "fidelity.friction_tolerance"
                    if self.group == Group::Joint =>
                {
                    return None;
                }
                "fidelity.tolerance" => format!("reduced to {value}"),
                "fidelity.friction_tolerance" => format!("friction to {value}"),
                "fidelity.precision" => format!("{value} precision"),
                // names of elements, schemes and models speak for themselves
                _ => value.replace('_', " "),
            })
        };
        match self.setting.changes() {
            [] => "as given".to_owned(),
            changes => changes
                .iter()
                .filter_map(word)
                .collect::<Vec<_>>()
                .join("; "),
        }
    }

    /// The changes as a user passes them.
    pub fn arguments(&self) -> String {
        let argument = |(path, value): &(String, String)| {
            format!("--set {}", quoted(&format!("{path}={value}")))
        };
        match self.setting.changes() {
            [] => "the scene as it is".to_owned(),
            changes => changes.iter().map(argument).collect::<Vec<_>>().join(" "),
        }
    }
}

/// A word of a command line, quoted where a shell would read more into it.
pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._=-/".contains(c);
    match word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{word}'"),
    }
}

/// An error that is not smaller by this factor is not worth a higher cost, which clocks tell no better.
const WORTHWHILE: f64 = 0.95;

/// Error relative to the one before below which a point of the front is worth a name.
const REMARKABLE: f64 = 0.7;

/// The points of the front that are well apart in error.
pub fn milestones(points: &[Point], quantity: Quantity) -> Vec<&Point> {
    let mut last = f64::INFINITY;
    let mut found = front(points, &[quantity]);
    found.retain(|p| {
        let error = p.figure(&[quantity]).unwrap_or(f64::INFINITY);
        let is_remarkable = error < REMARKABLE * last;
        if is_remarkable {
            last = error;
        }
        is_remarkable
    });
    found
}

/// Points that no other one beats in both cost and error, cheapest first; those without a figure are not among them.
pub fn front<'a>(points: &'a [Point], quantities: &[Quantity]) -> Vec<&'a Point> {
    let mut known: Vec<(f64, &Point)> = points
        .iter()
        .filter_map(|p| Some((p.figure(quantities)?, p)))
        .collect();
    known.sort_by(|a, b| a.1.cost().total_cmp(&b.1.cost()).then(a.0.total_cmp(&b.0)));
    let mut is_worthwhile = worthwhile();
    known.retain(|(error, _)| is_worthwhile(*error));
    known.into_iter().map(|(_, point)| point).collect()
}

/// Whether an error, asked for by ascending cost, is worth its cost. What is not worth it does not count: many small gains add
/// up to one that is.
fn worthwhile() -> impl FnMut(f64) -> bool {
    let mut least = f64::INFINITY;
    move |error| {
        let is_worthwhile = error < WORTHWHILE * least;
        if is_worthwhile {
            least = error;
        }
        is_worthwhile
    }
}

#[cfg(test)]
mod tests {
    use super::worthwhile;

    #[test]
    fn small_gains_add_up() {
        let kept = [1.0, 0.97, 0.94, 0.92, 0.5, 0.6].map(worthwhile());
        assert_eq!(kept, [true, false, true, false, true, false]);
    }
}
