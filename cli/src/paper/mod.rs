//! Section 7 of K. Kazmi, M. Barboteu, W. Han, M. Sofonea, ESAIM: M2AN 48 (2014) 919-942, again: Figures 3 to 7 and the
//! numbers reported with them.

mod convergence;
mod deformed;
pub mod example;
mod iterates;
mod laws;
mod overview;
mod record;

use crate::arguments::PaperOptions;
use crate::console;
use crate::failure::Failure;
use std::path::Path;

/// `stickslip paper`: everything.
pub fn run(options: &PaperOptions) -> Result<(), Failure> {
    let out = &options.out;
    console::say(&figures(out)?)?;
    let reference = if options.quick { 64 } else { 256 };
    let errors = convergence::both_starts(reference)?;
    convergence::draw(out, &errors, reference)?;
    console::say(&format!("\n{}", convergence::table(&errors, reference)))?;
    console::say(&format!("\nwritten to {}", out.display()))
}

/// The figures that take seconds, 3, 5, 6 and 7, and the table beside the paper's numbers.
pub fn figures(out: &Path) -> Result<String, Failure> {
    let failed = Failure::writing(out);
    std::fs::create_dir_all(out).map_err(|e| failed(&e))?;
    let laws = laws::run()?;
    laws::draw(out, &laws)?;
    let body = deformed::Deformed::of(&laws[0].finished)?;
    body.draw(out)?;
    overview::draw(out, &laws, &body)?;
    iterates::draw(out)?;
    record::table(&laws[0].finished)
}
