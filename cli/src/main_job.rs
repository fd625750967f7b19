//! The main job: the paper's example with default settings, through the interface a master uses.

use crate::console;
use crate::contact_table::ContactTable;
use crate::failure::Failure;
use crate::paper::{self, example};
use crate::run_pictures;
use std::path::Path;

/// Where everything goes.
const OUT: &str = "out";

pub fn run() -> Result<(), Failure> {
    let out = Path::new(OUT);
    let scene = example::scene(&[])?;
    let finished = example::finish(&scene)?;
    let contact = finished.compilation.model.contact();
    let mut table = ContactTable::create(&out.join("kazmi2014.csv"), contact)?;
    for frame in &finished.frames {
        table.add(contact, frame)?;
    }
    table.finish()?;
    run_pictures::draw(out, &scene, contact, &finished.frames)?;
    console::say(&paper::figures(out)?)?;
    console::say(&format!("\nwritten to {OUT}/"))
}
