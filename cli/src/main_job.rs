//! The main job: the paper's example with default settings, through the interface a master uses.

use crate::console;
use crate::contact_table::ContactTable;
use crate::failure::Failure;
use crate::fmu;
use crate::paper::{self, example};
use crate::run_pictures;
use std::path::{Path, PathBuf};
use stickslip::{NoFiles, Scene};
use stickslip_fmu::Options;

/// Where everything goes.
const OUT: &str = "out";

/// Does it; `library` is the FMU library that is packed, or else the one beside the executable.
pub fn run(library: Option<PathBuf>) -> Result<(), Failure> {
    let out = Path::new(OUT);
    let scene = example::scene(&[])?;
    let finished = example::finish(&scene)?;
    let model = &finished.compilation.model;
    let contact = model.contact();
    let mut table = ContactTable::create(&out.join("kazmi2014.csv"), contact, model.ports())?;
    for frame in &finished.frames {
        table.add(contact, frame)?;
    }
    table.finish()?;
    run_pictures::draw(out, &scene, contact, &finished.frames)?;
    console::say(&paper::figures(out)?)?;
    console::say(&format!("\nwritten to {OUT}/"))?;
    console::say(&fmu_of(&scene, out, library)?)
}

/// Packs the example and says how to load it. A command that was copied away from its libraries has none to pack: the rest
/// of the job stands, and the line says why there is no FMU.
fn fmu_of(scene: &Scene, out: &Path, library: Option<PathBuf>) -> Result<String, Failure> {
    let options = Options {
        source_name: example::NAME.to_owned(),
        library,
        ..Options::default()
    };
    let packed = match fmu::pack(scene, &NoFiles, options) {
        Ok(packed) => packed,
        Err(failure @ Failure::Package { .. }) => return Ok(format!("no FMU: {failure}")),
        Err(failure) => return Err(failure),
    };
    let path = out.join(format!("{}.fmu", example::NAME));
    fmu::write(&path, &packed)?;
    let path = path.display();
    Ok(format!(
        "FMU (FMI 3.0, {}): {path}\n  python3 -m venv .venv && .venv/bin/pip install 'fmpy[plot]==0.3.32'\n  \
         .venv/bin/python -c \"import fmpy; r = fmpy.simulate_fmu('{path}', output=['contact.slip_rate', \
         'contact.stick_fraction']); print(r['contact.stick_fraction'])\"",
        fmu::library_of(&packed)
    ))
}
