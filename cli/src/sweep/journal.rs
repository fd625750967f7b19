//! The journal of a sweep: a row for every run as it comes, so that a sweep that was ended goes on where it was.

use super::pool::Row;
use super::study::Study;
use crate::contact_table::shortest;
use crate::failure::Failure;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::xxh3_64;

/// The journal, open at its end.
pub struct Journal {
    path: PathBuf,
    file: File,
}

/// Where the journal of a table is.
pub fn path_of(table: &Path) -> PathBuf {
    let mut name = table.as_os_str().to_owned();
    name.push(".part");
    name.into()
}

/// What tells plans apart: the scene, the runs, what is recorded, the version.
fn head(study: &Study) -> String {
    let mut text = study.text().to_owned();
    for line in [&study.plan.paths, &study.record.columns()]
        .into_iter()
        .chain(&study.plan.points)
    {
        for word in line {
            text.push('\u{1f}');
            text.push_str(word);
        }
        text.push('\n');
    }
    format!(
        "# stickslip {} sweep {:016x}\n",
        env!("CARGO_PKG_VERSION"),
        xxh3_64(text.as_bytes())
    )
}

impl Journal {
    /// Opens the journal of a table, its folder made if need be, and returns the runs that it holds: none, unless `is_resumed`.
    ///
    /// # Errors
    /// [`Failure::File`], also for the journal of another sweep that would be gone on with.
    pub fn open(
        table: &Path,
        study: &Study,
        is_resumed: bool,
    ) -> Result<(Journal, Vec<(usize, Row)>), Failure> {
        let path = path_of(table);
        let failed = Failure::writing(&path);
        if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(|e| failed(&e))?;
        }
        let head = head(study);
        let text = match std::fs::read_to_string(&path) {
            Ok(text) if is_resumed => text,
            Err(error) if is_resumed && error.kind() != std::io::ErrorKind::NotFound => {
                return Err(failed(&error));
            }
            _ => String::new(),
        };
        // what was cut off in the middle of a line is taken again
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        if whole > 0 && !text.starts_with(&head) {
            return Err(failed(
                &"it is the journal of another sweep (scene, plan or record differ); without --resume it is written anew",
            ));
        }
        let mut rows = Vec::new();
        for (number, line) in text[..whole].lines().enumerate().skip(1) {
            let row = parse(line, study);
            let row = row.ok_or_else(|| failed(&format!("line {} is damaged", number + 1)))?;
            rows.push(row);
        }
        let mut options = OpenOptions::new();
        let mut file = options
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(|e| failed(&e))?;
        file.set_len(whole as u64).map_err(|e| failed(&e))?;
        std::io::Seek::seek(&mut file, std::io::SeekFrom::End(0)).map_err(|e| failed(&e))?;
        if whole == 0 {
            file.write_all(head.as_bytes()).map_err(|e| failed(&e))?;
        }
        drop(failed);
        Ok((Journal { path, file }, rows))
    }

    /// Adds a run.
    ///
    /// # Errors
    /// [`Failure::File`].
    pub fn add(&mut self, run: usize, row: &Row) -> Result<(), Failure> {
        let mut line = run.to_string();
        for value in &row.values {
            line.push(',');
            line.push_str(&shortest(*value));
        }
        line.push(',');
        // an error is one line
        line.push_str(row.error.as_deref().unwrap_or(""));
        line.push('\n');
        let written = self.file.write_all(line.as_bytes());
        written.map_err(|e| Failure::writing(&self.path)(&e))
    }
}

fn parse(line: &str, study: &Study) -> Option<(usize, Row)> {
    let columns = study.record.columns().len();
    let mut words = line.splitn(columns + 2, ',');
    let run = words.next()?.parse().ok()?;
    let values = words.by_ref().take(columns).map(|word| word.parse().ok());
    let values = values.collect::<Option<Vec<f64>>>()?;
    let error = words.next()?;
    let is_known = run < study.plan.points.len() && values.len() == columns;
    let error = (!error.is_empty()).then(|| error.to_owned());
    is_known.then_some((run, Row { values, error }))
}
