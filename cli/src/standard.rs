//! Standard input and output instead of files: `-`.

use crate::failure::Failure;
use std::fs::File;
use std::io::{BufWriter, ErrorKind, Read, Write};
use std::path::Path;

/// What messages call standard input.
pub const INPUT: &str = "standard input";

/// Whether a name of a file means standard input or output; a file of that name is `./-`.
pub fn is_meant(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// All of standard input.
pub fn read() -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    std::io::stdin().lock().read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A file to write, made with the folders it lies in, or standard output.
pub fn create(path: &Path) -> Result<Box<dyn Write>, Failure> {
    if is_meant(path) {
        return Ok(Box::new(BufWriter::new(Output)));
    }
    let failed = Failure::writing(path);
    if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|e| failed(&e))?;
    }
    Ok(Box::new(File::create(path).map_err(|e| failed(&e))?))
}

/// Standard output. When the reader closes its end, what follows is discarded and the command finishes its work.
struct Output;

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match std::io::stdout().write(bytes) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(bytes.len()),
            other => other,
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match std::io::stdout().flush() {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            other => other,
        }
    }
}
