//! Sentences: the cheapest setting measured for an accuracy.

use super::point::Point;
use stickslip::tradeoff::{Quantity, Reference};

/// Accuracies that users ask for.
const TARGETS: [(f64, &str); 4] = [
    (0.1, "10 %"),
    (0.01, "1 %"),
    (0.001, "0.1 %"),
    (0.0001, "0.01 %"),
];
/// What they may ask it of.
pub const SUBJECTS: [Subject; 3] = [
    ("slip rate", &[Quantity::SlipRate]),
    ("tangential stress", &[Quantity::TangentialStress]),
    ("slip rate, stress, displacement and force", &Quantity::ALL),
];
/// A name, and the quantities of which the worst counts.
pub type Subject = (&'static str, &'static [Quantity]);

/// One sentence for every subject and accuracy that was reached, with the arguments between `quotes`, and one for the first
/// accuracy that was not.
pub fn sentences(
    subjects: &[Subject],
    (points, reference): (&[Point], &Reference),
    quotes: &str,
) -> Vec<String> {
    let mut lines = Vec::new();
    for (name, quantities) in subjects {
        let mut missed = None;
        for (target, percent) in TARGETS {
            match cheapest(points, target, quantities) {
                Some(point) => {
                    let error = match point.figure(quantities) {
                        Some(error) => format!("error {error:.1e}"),
                        None => format!("error below {:.1e}", point.bound(quantities)),
                    };
                    lines.push(format!(
                        "for {percent} in {name} use {quotes}{}{quotes} ({error}; {} per second of the scene)",
                        point.arguments(),
                        time(point.cost())
                    ));
                }
                None => missed = missed.or(Some(percent)),
            }
        }
        if let Some(percent) = missed {
            let left = quantities.iter().filter_map(|q| reference.uncertainty(*q));
            lines.push(format!(
                "no setting measured is sure to reach {percent} in {name}; the reference itself is known to {:.1e}",
                left.fold(0.0, f64::max)
            ));
        }
    }
    lines
}

fn cheapest<'a>(points: &'a [Point], target: f64, quantities: &[Quantity]) -> Option<&'a Point> {
    let has_any = |p: &&Point| quantities.iter().any(|q| p.verdict.of(*q).is_some());
    points
        .iter()
        .filter(|p| p.verdict.meets(target, quantities))
        .filter(has_any)
        .min_by(|a, b| a.cost().total_cmp(&b.cost()))
}

/// A duration in the unit that suits it.
pub fn time(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1e-3 => (1e6 * s, "us"),
        s if s < 1.0 => (1e3 * s, "ms"),
        s => (s, "s"),
    };
    let digits = (2.0 - value.log10().floor()).clamp(0.0, 2.0) as usize;
    format!("{value:.digits$} {unit}")
}
