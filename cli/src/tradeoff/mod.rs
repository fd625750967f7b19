//! `stickslip tradeoff`: speed against accuracy, measured.
//!
//! The library compares runs and counts their work (`stickslip::tradeoff`); here are the clocks, the choice of settings,
//! the budget, and what is told of them.

mod advice;
mod clock;
mod estimate;
mod file;
mod markdown;
mod picture;
mod plan;
mod point;
mod survey;
mod table;

use crate::arguments::TradeoffOptions;
use crate::console;
use crate::failure::Failure;
use crate::source;
use clock::Budget;
use stickslip::simulator::course::Points;
use stickslip::tradeoff::{Reference, Study};
use survey::{Refined, Survey};

/// Share of the budget that the reference may use before there is anything else.
const SHARE_OF_REFERENCE: f64 = 0.5;

pub fn run(options: &TradeoffOptions) -> Result<(), Failure> {
    let name = options.choice.name();
    let scene = source::scene(&options.choice, &[])?;
    let place = match &options.markdown {
        Some(path) => Some(markdown::Place::find(path, &scene.name)?),
        None => None,
    };
    let budget = match options.work {
        Some(work) => Budget::of_work(work),
        None => Budget::of_seconds(options.budget),
    };
    Points::checked(&scene).map_err(Failure::of(name))?;
    let mut study = Study::new(&scene).map_err(Failure::of(name))?;

    let (reference, found) = measure(&mut study, &budget).map_err(Failure::of(name))?;

    if let Some(path) = &options.csv {
        file::write(path, study.scene(), &found.points)?;
    }
    if let Some(folder) = &options.plots {
        picture::draw(folder, &scene.name, &found.points, &reference)?;
    }
    if let Some(place) = place {
        place.write(&markdown::text(&command(), &found.points, &reference))?;
    }
    let say = |text: &str| console::say_beside(options.csv.as_deref(), text);
    say(&table::reference(&scene.name, &reference))?;
    say(&format!("\n{}", table::settings(&found.points)))?;
    let sentences = advice::sentences(&advice::SUBJECTS, (&found.points, &reference), "");
    say(&format!("\n{}", sentences.join("\n")))?;
    say(&format!("\n{}", table::left_out(&found, &budget)))
}

/// What was called, as one line.
fn command() -> String {
    let arguments = std::env::args_os().skip(1);
    let words = arguments.map(|word| point::quoted(&word.to_string_lossy()));
    format!("stickslip {}", words.collect::<Vec<_>>().join(" "))
}

/// The reference first, then the settings, then what is left of the budget for the reference.
fn measure(study: &mut Study, budget: &Budget) -> stickslip::Result<(Reference, Survey)> {
    let mut refined = Refined::new(study)?;
    refined.refine(study, budget, SHARE_OF_REFERENCE)?;
    let mut found = survey::settings(study, &refined.reference, budget)?;
    if refined.refine(study, budget, 1.0)? {
        found.judge(&refined.reference)?;
    }
    Ok((refined.reference, found))
}
