//! The work-precision picture: error against cost, with the Pareto front and its settings.

use super::point::{Group, Point, front, milestones};
use crate::failure::Failure;
use crate::pictures::{
    Axis, BLACK, BLUE, BROWN, Colour, Curves, GREEN, GREY, Mark, Notes, ORANGE, PURPLE, Panel, RED,
    SKY, Series, Sheet,
};
use std::path::Path;
use stickslip::tradeoff::{MARGIN, Quantity, Reference};

/// Quantities drawn.
const DRAWN: [Quantity; 2] = [Quantity::SlipRate, Quantity::Displacement];

/// Draws `tradeoff.png` and `tradeoff.svg` into a folder.
pub fn draw(
    folder: &Path,
    name: &str,
    points: &[Point],
    reference: &Reference,
) -> Result<(), Failure> {
    let failed = Failure::writing(folder);
    std::fs::create_dir_all(folder).map_err(|e| failed(&e))?;
    let panels = DRAWN.map(|quantity| {
        let limit = reference.uncertainty(quantity).map(|u| MARGIN * u);
        Panel::Curves(curves(points, quantity, limit))
    });
    let notes = DRAWN.map(|quantity| notes(points, quantity));
    let longest = notes.iter().map(|n| n.lines.len()).max();
    let room = Notes::height(longest.unwrap_or(0));
    Sheet {
        title: format!("{name}: error against cost"),
        width: 1300,
        height: 620 + room as u32,
        rows: vec![
            (560.0, panels.into()),
            (room, notes.map(Panel::Notes).into()),
        ],
    }
    .save(folder, "tradeoff")
}

fn has_figures(points: &[Point], quantity: Quantity) -> bool {
    points.iter().any(|p| p.figure(&[quantity]).is_some())
}

fn colour(group: Group) -> Colour {
    match group {
        Group::AsGiven => BLACK,
        Group::Cells => BROWN,
        Group::Mesh => SKY,
        Group::Step => ORANGE,
        Group::Scheme => PURPLE,
        Group::Tolerance => GREEN,
        Group::Model => GREY,
        Group::Joint => BLUE,
    }
}

fn curves(points: &[Point], quantity: Quantity, limit: Option<f64>) -> Curves {
    // bounds where the reference is too poor for any figure
    let has_figures = has_figures(points, quantity);
    let place = |p: &Point| match has_figures {
        true => Some((p.cost(), p.figure(&[quantity])?)),
        false => p.verdict.of(quantity).map(|m| (p.cost(), m.bound())),
    };
    let front = front(points, &[quantity]);
    let mut series = Vec::new();
    if has_figures {
        series.push(Series {
            name: "Pareto front".to_owned(),
            colour: GREY,
            mark: Mark::Dashed,
            points: front.iter().filter_map(|p| place(p)).collect(),
        });
    }
    let (least, most) = points
        .iter()
        .filter_map(place)
        .fold((f64::INFINITY, 0.0_f64), |(l, m), p| {
            (l.min(p.0), m.max(p.0))
        });
    if let Some(limit) = limit.filter(|l| has_figures && l.is_finite() && least < most) {
        series.push(Series {
            name: "limit of the reference".to_owned(),
            colour: RED,
            mark: Mark::Dashed,
            points: vec![(least, limit), (most, limit)],
        });
    }
    let x = Axis::log("computing time per second of the scene", "s");
    let x = match least < most {
        // room for the names of the cheapest points
        true => x.between(0.4 * least, 1.4 * most),
        false => x,
    };
    // the scene itself last, so that it is on top
    for group in Group::ALL.into_iter().rev() {
        let of = || points.iter().filter(|p| p.group == group);
        let places: Vec<_> = of().filter_map(place).collect();
        // the panels have the same legends
        if of().count() > 0 {
            series.push(Series {
                name: group.name().to_owned(),
                colour: colour(group),
                mark: Mark::Dots,
                points: places,
            });
        }
    }
    // left of a falling front there is nothing
    let named = milestones(points, quantity);
    let names = named.iter().zip(letters()).map(|(point, letter)| Series {
        name: letter,
        colour: BLACK,
        mark: Mark::Name(8.0),
        points: place(point).into_iter().collect(),
    });
    series.extend(names);
    Curves {
        heading: match has_figures {
            true => format!("Error in {}", quantity.name()),
            false => format!("Bound of the error in {}", quantity.name()),
        },
        x,
        y: Axis::log("relative error", ""),
        series,
    }
}

fn notes(points: &[Point], quantity: Quantity) -> Notes {
    let named = milestones(points, quantity);
    let lines = named.iter().zip(letters()).filter_map(|(point, letter)| {
        let error = point.figure(&[quantity])?;
        Some(format!("{letter}  {error:.1e}: {}", point.label()))
    });
    let unknown = points
        .iter()
        .filter(|p| p.verdict.of(quantity).is_some() && p.figure(&[quantity]).is_none());
    let unknown = match unknown.count() {
        0 => None,
        _ if !has_figures(points, quantity) => {
            Some("no setting is so far off that the reference is ten times as accurate".to_owned())
        }
        n => Some(format!(
            "{n} settings at the limit of the reference are not drawn"
        )),
    };
    let tolerances =
        "joint settings: friction to 1e-4, reduced to 1e-4 or the next tolerance that will do";
    Notes {
        lines: lines
            .chain(unknown)
            .chain([tolerances.to_owned()])
            .collect(),
    }
}

/// Names of the points of a front: A, B, ..., then numbers.
fn letters() -> impl Iterator<Item = String> {
    let letters = ('A'..='Z').map(String::from);
    letters.chain((27..).map(|n: u32| n.to_string()))
}
