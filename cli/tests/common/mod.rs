//! Runs the command in a folder of its own.

#![allow(dead_code)]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

pub struct Shell {
    pub folder: TempDir,
}

/// What a command left behind.
pub struct Outcome {
    pub status: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Outcome {
    fn of(output: Output) -> Outcome {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Outcome {
            status: output.status.code().expect("ended by a signal"),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }
}

impl Shell {
    pub fn new() -> Shell {
        Shell {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
        command
            .args(arguments)
            .current_dir(self.folder.path())
            .stdin(Stdio::null());
        command
    }

    pub fn run(&self, arguments: &[&str]) -> Outcome {
        Outcome::of(self.command(arguments).output().unwrap())
    }

    /// Runs a command that reads `input`.
    pub fn feed(&self, arguments: &[&str], input: &[u8]) -> Outcome {
        let mut command = self.command(arguments);
        let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = piped.stderr(Stdio::piped()).spawn().unwrap();
        let mut stdin = child.stdin.take().unwrap();
        std::io::Write::write_all(&mut stdin, input).unwrap();
        drop(stdin);
        Outcome::of(child.wait_with_output().unwrap())
    }

    /// Runs what must succeed without a remark and returns what it printed.
    pub fn succeed(&self, arguments: &[&str]) -> String {
        let outcome = self.run(arguments);
        assert_eq!(outcome.status, 0, "{arguments:?}: {}", outcome.stderr);
        assert_eq!(outcome.stderr, "", "{arguments:?}");
        outcome.stdout
    }

    /// Runs what must fail with one line on stderr, and returns that line.
    pub fn fail(&self, arguments: &[&str]) -> String {
        let outcome = self.run(arguments);
        assert_eq!(outcome.status, 1, "{arguments:?}: {}", outcome.stdout);
        assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
        outcome.stderr
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.folder.path().join(name), text).unwrap();
    }

    pub fn has(&self, name: &str) -> bool {
        std::fs::metadata(self.folder.path().join(name)).is_ok_and(|m| m.len() > 0)
    }

    pub fn table(&self, name: &str) -> CsvTable {
        CsvTable::read(&self.folder.path().join(name))
    }
}

/// A CSV file of numbers.
pub struct CsvTable {
    pub header: Vec<String>,
    pub columns: BTreeMap<String, Vec<f64>>,
    pub rows: usize,
}

impl CsvTable {
    fn read(path: &Path) -> CsvTable {
        let mut reader = csv::Reader::from_path(path).unwrap();
        let header: Vec<String> = reader.headers().unwrap().iter().map(Into::into).collect();
        let mut columns: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        let mut rows = 0;
        for record in reader.records() {
            rows += 1;
            for (name, text) in header.iter().zip(record.unwrap().iter()) {
                let column = columns.entry(name.clone()).or_default();
                column.push(text.parse().unwrap());
            }
        }
        CsvTable {
            header,
            columns,
            rows,
        }
    }

    /// Values of a column in the rows at `time`.
    pub fn at(&self, time: f64, name: &str) -> Vec<f64> {
        let times = &self.columns["time"];
        let rows = (0..self.rows).filter(|&i| (times[i] - time).abs() < 1e-9);
        rows.map(|i| self.columns[name][i]).collect()
    }
}
