//! The table of a sweep: a row for every run, in the order of the plan. CSV, or NPZ with an array for every column.

use super::pool::Row;
use super::study::Study;
use crate::contact_table::shortest;
use crate::failure::Failure;
use crate::npz::{self, Array};
use crate::standard;
use std::path::Path;

/// Name of the column with what went wrong.
pub const ERROR: &str = "error";
/// Name of the column with the number of the run, from 0.
pub const RUN: &str = "run";

/// Whether a table of this name can be written here.
pub fn is_known(path: &Path) -> bool {
    standard::is_meant(path) || path.extension().is_some_and(|e| e == "csv" || e == "npz")
}

/// Writes a table, by the ending of its name.
///
/// # Errors
/// [`Failure::File`].
pub fn write(path: &Path, study: &Study, rows: &[Row]) -> Result<(), Failure> {
    match path.extension() {
        Some(ending) if ending == "npz" => write_npz(path, study, rows),
        _ => write_csv(path, study, rows),
    }
}

fn write_csv(path: &Path, study: &Study, rows: &[Row]) -> Result<(), Failure> {
    let failed = Failure::writing(path);
    let mut writer = csv::Writer::from_writer(standard::create(path)?);
    let columns = study.record.columns();
    let header = [RUN]
        .into_iter()
        .chain(study.plan.paths.iter().map(String::as_str));
    let header = header
        .chain(columns.iter().map(String::as_str))
        .chain([ERROR]);
    writer.write_record(header).map_err(|e| failed(&e))?;
    for (run, (point, row)) in study.plan.points.iter().zip(rows).enumerate() {
        let values = row.values.iter().copied().map(shortest);
        let line = [run.to_string()].into_iter().chain(point.iter().cloned());
        let error = row.error.clone().unwrap_or_default();
        writer
            .write_record(line.chain(values).chain([error]))
            .map_err(|e| failed(&e))?;
    }
    writer.flush().map_err(|e| failed(&e))
}

fn write_npz(path: &Path, study: &Study, rows: &[Row]) -> Result<(), Failure> {
    let runs: Vec<f64> = (0..rows.len()).map(|run| run as f64).collect();
    let errors: Vec<String> = rows
        .iter()
        .map(|r| r.error.clone().unwrap_or_default())
        .collect();
    let axes: Vec<_> = (0..study.plan.paths.len())
        .map(|axis| study.axis(axis))
        .collect();
    let columns = study.record.columns();
    let values: Vec<Vec<f64>> = (0..columns.len())
        .map(|column| rows.iter().map(|row| row.values[column]).collect())
        .collect();
    let shape = || vec![rows.len()];
    let mut arrays = vec![(RUN.to_owned(), Array::Numbers(&runs, shape()))];
    for (path, axis) in study.plan.paths.iter().zip(&axes) {
        let array = match axis {
            Ok(numbers) => Array::Numbers(numbers, shape()),
            Err(texts) => Array::Texts(texts),
        };
        arrays.push((path.clone(), array));
    }
    for (name, values) in columns.iter().zip(&values) {
        arrays.push((name.clone(), Array::Numbers(values, shape())));
    }
    arrays.push((ERROR.to_owned(), Array::Texts(&errors)));
    npz::write(path, &arrays)
}
