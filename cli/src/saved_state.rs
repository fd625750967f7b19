//! States in files: what a long run goes on from.

use crate::failure::Failure;
use crate::standard;
use std::io::Write;
use std::path::Path;
use stickslip::Simulator;

/// Brings a simulator to the state in a file.
///
/// # Errors
/// [`Failure::File`] for a file that cannot be read, or holds no state of this model.
pub fn load(path: &Path, simulator: &mut Simulator) -> Result<(), Failure> {
    let failed = |why: &dyn std::fmt::Display| Failure::File {
        path: path.to_owned(),
        doing: "go on from",
        why: why.to_string(),
    };
    let bytes = std::fs::read(path).map_err(|e| failed(&e))?;
    simulator.restore_bytes(&bytes).map_err(|e| failed(&e))?;
    match simulator.is_initialized() {
        true => Ok(()),
        false => Err(failed(&"it is the state before a run")),
    }
}

/// Writes the state of a simulator. A file that is there is replaced at once: whenever the machine goes down, one of the two is whole.
///
/// # Errors
/// [`Failure::File`].
pub fn save(path: &Path, simulator: &Simulator) -> Result<(), Failure> {
    let failed = Failure::writing(path);
    let mut beside = path.as_os_str().to_owned();
    beside.push(".new");
    let beside = Path::new(&beside);
    let mut file = standard::create(beside)?;
    let written = file.write_all(&simulator.to_bytes());
    written
        .and_then(|()| file.flush())
        .map_err(|e| failed(&e))?;
    drop(file);
    std::fs::rename(beside, path).map_err(|e| failed(&e))
}
