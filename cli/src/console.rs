//! What goes to the terminal: results on stdout, remarks on stderr, progress bars only where someone looks.

use crate::failure::Failure;
use crate::standard;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{ErrorKind, IsTerminal, Write};
use std::ops::ControlFlow;
use std::path::Path;
use stickslip::model::Progress;
use stickslip::{Compilation, Files, Scene};

/// Prints lines of results. A closed pipe is not an error: the output is discarded and the command finishes its work.
pub fn say(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::Output(error)),
        _ => Ok(()),
    }
}

/// Prints what is said beside a file of results: on standard error where the file is standard output.
pub fn say_beside(results: Option<&Path>, text: &str) -> Result<(), Failure> {
    if results.is_some_and(standard::is_meant) {
        let _ = writeln!(std::io::stderr().lock(), "{text}");
        return Ok(());
    }
    say(text)
}

/// Prints a remark or an error; where stderr is closed there is nobody to tell.
pub fn warn(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "stickslip: {text}");
}

/// A sign that work goes on, invisible unless stderr is a terminal.
pub fn spinner(what: &str) -> ProgressBar {
    let spinner = bar(0, what);
    if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} {elapsed}") {
        spinner.set_style(style);
    }
    spinner.enable_steady_tick(std::time::Duration::from_millis(200));
    spinner
}

/// Compiles a scene; where stderr is a terminal, with a bar of what is done.
pub fn compile(scene: &Scene, files: &dyn Files) -> stickslip::Result<Compilation> {
    let bar = bar(100, &scene.name);
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent} %") {
        bar.set_style(style);
    }
    let outcome = Compilation::with(scene, files, &mut |now: Progress| {
        bar.set_message(format!("compiling {}: {}", scene.name, now.phase.name()));
        bar.set_position((100.0 * now.fraction) as u64);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    outcome
}

/// A progress bar of `steps`, invisible unless stderr is a terminal.
pub fn bar(steps: u64, what: &str) -> ProgressBar {
    let target = if std::io::stderr().is_terminal() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(Some(steps), target)
        .with_style(style)
        .with_message(what.to_owned())
}
