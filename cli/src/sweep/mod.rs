//! `stickslip sweep`: many runs of one scene, on the cores of this machine, in one table.
//!
//! ```text
//! axes -> plan (which runs) -> study (which model each needs) -> pool (threads) -> journal (as they come) -> table (in order)
//! ```

mod axis;
mod journal;
mod plan;
mod pool;
mod record;
mod study;
mod table;

pub use axis::{Axis, Course, Range};
pub use journal::path_of as journal_of;
pub use plan::{Plan, Sampling, numbers};
pub use pool::Row;
pub use study::Study;

use crate::arguments::SweepOptions;
use crate::console;
use crate::failure::Failure;
use crate::source;
use crate::standard;
use journal::Journal;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;
use stickslip::Error;
use stickslip::message::escaped;

/// What of a sweep is not allowed.
fn refuse(path: &str, found: &str, allowed: &str) -> Error {
    Error::Scene {
        source_name: "sweep".to_owned(),
        path: path.to_owned(),
        found: found.to_owned(),
        allowed: allowed.to_owned(),
    }
}

/// Takes the runs of a study on `workers` threads (of none given, as many as there are processors) and returns their rows in the
/// order of the plan. With `table` a journal is kept beside that file, from which a sweep that was ended goes on when it
/// `is_resumed`. `observe` is told the runs done and their number, and may end the sweep.
///
/// # Errors
/// [`Failure::File`] for the journal; [`Failure::Library`] with [`Error::Cancelled`] for a sweep that was ended.
pub fn take(
    study: &Study,
    workers: Option<usize>,
    table: Option<&Path>,
    is_resumed: bool,
    observe: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Vec<Row>, Failure> {
    let runs = study.plan.points.len();
    let mut rows: Vec<Option<Row>> = vec![None; runs];
    let mut journal = None;
    if let Some(table) = table {
        let (opened, known) = Journal::open(table, study, is_resumed)?;
        for (run, row) in known {
            rows[run] = Some(row);
        }
        journal = Some(opened);
    }
    let todo: Vec<usize> = (0..runs).filter(|run| rows[*run].is_none()).collect();
    let mut done = runs - todo.len();
    let mut failure = None;
    let mut flow = observe(done, runs);
    if flow.is_continue() && !todo.is_empty() {
        let processors = || std::thread::available_parallelism().map_or(1, usize::from);
        let workers = workers.unwrap_or_else(processors);
        pool::work(study, todo, workers, &mut |run, row| {
            if let Some(Err(error)) = journal.as_mut().map(|journal| journal.add(run, &row)) {
                failure = Some(error);
                return ControlFlow::Break(());
            }
            rows[run] = Some(row);
            done += 1;
            flow = observe(done, runs);
            flow
        });
    }
    if let Some(failure) = failure {
        return Err(failure);
    }
    let taken: Option<Vec<Row>> = rows.into_iter().collect();
    taken.ok_or_else(|| Failure::Library {
        source_name: study.source_name().to_owned(),
        error: Box::new(Error::Cancelled { phase: "sweep" }),
    })
}

/// Writes the table (CSV, or NPZ where the name ends so) and removes the journal beside it.
///
/// # Errors
/// [`Failure::File`].
pub fn write(path: &Path, study: &Study, rows: &[Row]) -> Result<(), Failure> {
    table::write(path, study, rows)?;
    match std::fs::remove_file(journal_of(path)) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(Failure::writing(&journal_of(path))(&error))
        }
        _ => Ok(()),
    }
}

/// The command.
pub fn run(options: &SweepOptions) -> Result<(), Failure> {
    let output = &options.output;
    if !table::is_known(output) {
        return Err(Failure::Option(
            "--output ends in .csv or .npz (Parquet is written by stickslip.sweep of the Python package)",
        ));
    }
    let name = options.choice.name();
    let failed = Failure::of(name);
    let scene = source::scene(&options.choice, &[])?;
    let axes = options.vary.iter().map(|text| Axis::parse(text));
    let axes: Vec<_> = axes.collect::<stickslip::Result<_>>().map_err(&failed)?;
    let sampling = Sampling::of(&options.sampling).map_err(&failed)?;
    let plan = Plan::new(&axes, sampling, options.runs, options.seed).map_err(&failed)?;
    let files = Box::new(source::files(&options.choice));
    let study = Study::new(&scene, name, files, plan, &options.record).map_err(&failed)?;
    let bar = console::bar(study.plan.points.len() as u64, &escaped(&scene.name));
    let is_file = !standard::is_meant(output);
    let start = Instant::now();
    let table = is_file.then_some(output.as_path());
    let mut before = None;
    let rows = take(
        &study,
        options.workers,
        table,
        options.resume,
        &mut |done, _| {
            before.get_or_insert(done);
            bar.set_position(done as u64);
            ControlFlow::Continue(())
        },
    )?;
    bar.finish_and_clear();
    match is_file {
        true => write(output, &study, &rows)?,
        false => table::write(output, &study, &rows)?,
    }
    let (taken, seconds) = (
        rows.len() - before.unwrap_or(0),
        start.elapsed().as_secs_f64(),
    );
    let place = match is_file {
        true => output.display().to_string(),
        false => "standard output".to_owned(),
    };
    let text = format!(
        "{place}: {} runs, {taken} of them taken now in {seconds:.2} s ({:.0} a second)",
        rows.len(),
        taken as f64 / seconds.max(1e-9)
    );
    console::say_beside(Some(output), &escaped(&text))?;
    let mut failures = rows.iter().enumerate();
    let mut failures = failures
        .by_ref()
        .filter_map(|(run, row)| Some((run, row.error.as_ref()?)));
    let Some((run, why)) = failures.next() else {
        return Ok(());
    };
    Err(Failure::Runs {
        source_name: name.to_owned(),
        failed: 1 + failures.count(),
        of: rows.len(),
        first: format!("run {run}: {why}"),
    })
}
