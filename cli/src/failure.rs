//! Why the command fails: one line on stderr; the exit status is then 1 (2 is for mistakes in the use of the command).

use std::fmt;
use std::path::{Path, PathBuf};
use stickslip::message::{cut, escaped};
use stickslip_fmu::PackageError;

#[derive(Debug)]
pub enum Failure {
    /// The library refused; the source is the scene's file or name.
    Library {
        source_name: String,
        error: Box<stickslip::Error>,
    },
    /// A file cannot be read or written.
    File {
        path: PathBuf,
        doing: &'static str,
        why: String,
    },
    /// There is no FMU of the scene.
    Package {
        source_name: String,
        error: Box<PackageError>,
    },
    /// Runs of a sweep that failed; the table says which.
    Runs {
        source_name: String,
        failed: usize,
        of: usize,
        first: String,
    },
    /// An option that another one rules out.
    Option(&'static str),
    /// An abstract inequality was not solved.
    Inequality(stickslip::qvi::SolveError),
    /// Neither a file nor an embedded example.
    NoScene { name: String },
    /// Standard output is not writable, other than by being closed.
    Output(std::io::Error),
}

impl Failure {
    /// For a file that cannot be written.
    pub fn writing(path: &Path) -> impl Fn(&dyn fmt::Display) -> Failure {
        let path = path.to_owned();
        move |why| Failure::File {
            path: path.clone(),
            doing: "write",
            why: why.to_string(),
        }
    }

    /// An error of the library about the scene called `source_name`.
    pub fn of(source_name: &str) -> impl Fn(stickslip::Error) -> Failure {
        let source_name = source_name.to_owned();
        move |error| Failure::Library {
            source_name: source_name.clone(),
            error: Box::new(error),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Failure::Library { source_name, error } => match error.as_ref() {
                // the library calls a mesh's scene "scene"
                stickslip::Error::Scene {
                    path,
                    found,
                    allowed,
                    ..
                } => format!("{source_name}: at {path}: found {found}; allowed: {allowed}"),
                error => format!("{source_name}: {error}"),
            },
            Failure::File { path, doing, why } => {
                format!("{}: cannot {doing}: {why}", path.display())
            }
            Failure::Package { source_name, error } => format!("{source_name}: {error}"),
            Failure::Runs {
                source_name,
                failed,
                of,
                first,
            } => format!("{source_name}: {failed} of {of} runs failed; {first}"),
            Failure::Inequality(error) => error.to_string(),
            Failure::Option(why) => (*why).to_owned(),
            Failure::NoScene { name } => {
                let names: Vec<_> = stickslip::scene::example_names().collect();
                format!(
                    "{}: neither a file nor an embedded example ({})",
                    cut(name),
                    names.join(", ")
                )
            }
            Failure::Output(error) => format!("standard output: {error}"),
        };
        // one line, whatever a file name or a text in the scene contains
        f.write_str(&escaped(&text))
    }
}
