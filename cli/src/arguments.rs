//! The command line.

use crate::standard;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::{Path, PathBuf};

/// Frictional contact of a viscoelastic body, stepped through the interface a master uses.
///
/// Without a command it does the main job: steps the example of Kazmi et al. (2014) with default settings, prints the
/// results beside the paper's figures and writes data and pictures into `out`.
#[derive(Parser)]
#[command(name = "stickslip", version)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Subcommand)]
pub enum Command {
    /// Step a scene on its own signals; a load without a signal keeps its start value.
    Run(RunOptions),
    /// Validate a scene; print its ports, the certificate of uniqueness and the step to choose. Of a mesh file (.msh): its parts,
    /// regions, sizes and quality.
    Check(SceneChoice),
    /// Pack a scene as an FMU: the shared library, the compiled model, the description, a page, a reference run.
    Fmu(FmuOptions),
    /// Run a scene many times with other values, in parallel, into one table.
    Sweep(SweepOptions),
    /// Measure speed against accuracy: meshes, elements, steps, schemes, tolerances and models of a scene on its own signals,
    /// against a reference that is ten times as accurate.
    Tradeoff(TradeoffOptions),
    /// Print an embedded example, or without a name list them.
    Example { name: Option<String> },
    /// Print the JSON Schema of scenes.
    Schema,
    /// Solve the abstract inequalities P1 to P7, which have exact solutions, and print errors, orders and conditions.
    Qvi,
    /// Reproduce section 7 of Kazmi et al. (2014): Figures 3 to 7 and the reported numbers.
    Paper(PaperOptions),
}

#[derive(Args)]
pub struct SceneChoice {
    /// A scene file, the name of an embedded example (kazmi2014 is the paper's), or `-` for standard input.
    pub scene: String,
    /// Replace a value of the scene, e.g. `contact.friction.alpha=50` or `loads[0].start=1`; may be repeated.
    #[arg(long = "set", value_name = "PATH=VALUE", value_parser = parse_override)]
    pub overrides: Vec<(String, String)>,
    /// Take an explicit scheme beyond its stability limit all the same: `time.force=true` of the scene.
    #[arg(long)]
    pub force: bool,
}

impl SceneChoice {
    /// What messages call the scene.
    pub fn name(&self) -> &str {
        match standard::is_meant(Path::new(&self.scene)) {
            true => standard::INPUT,
            false => &self.scene,
        }
    }
}

#[derive(Args)]
pub struct RunOptions {
    #[command(flatten)]
    pub choice: SceneChoice,
    /// End of the run, s [default: run.until of the scene].
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub until: Option<f64>,
    /// Communication step, s [default: run.step of the scene, else time.step]; cut into internal steps no larger than time.step.
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    pub step: Option<f64>,
    /// Write one row per communication point and contact node; nodes are numbered from 0. `-` is standard output, and what is
    /// said of the run goes to standard error.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write the deformed body at every communication point (legacy VTK, with a .vtk.series index for ParaView); the files of
    /// an earlier run of the scene go.
    #[arg(long, value_name = "DIR")]
    pub vtk: Option<PathBuf>,
    /// Draw slip rate and stress along the contact, the stick-slip map and the energies (PNG and SVG).
    #[arg(long, value_name = "DIR")]
    pub plots: Option<PathBuf>,
    /// Write one row per communication point with all inputs and all outputs that are no arrays: forces, energies, solver.
    #[arg(long, value_name = "FILE")]
    pub ports: Option<PathBuf>,
    /// Write all inputs and outputs over time, and the contact nodes, for NumPy.
    #[arg(long, value_name = "FILE")]
    pub npz: Option<PathBuf>,
    /// Write what the closing table says, as JSON; `-` is standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Save the state at the end of the run, and with --checkpoint on the way.
    #[arg(long, value_name = "FILE")]
    pub save_state: Option<PathBuf>,
    /// Go on from a saved state of the same scene, bit for bit as the run would have gone on; its time is the first point.
    #[arg(long, value_name = "FILE")]
    pub load_state: Option<PathBuf>,
    /// Save the state every N communication points too.
    #[arg(long, value_name = "N", requires = "save_state", value_parser = clap::value_parser!(u64).range(1..))]
    pub checkpoint: Option<u64>,
}

#[derive(Args)]
pub struct FmuOptions {
    #[command(flatten)]
    pub choice: SceneChoice,
    /// The FMU to write; missing folders are made. `-` is standard output.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Version of FMI (Co-Simulation).
    #[arg(long, value_enum, default_value = "3")]
    pub fmi: Fmi,
    /// FMI 3 with one variable per contact node instead of arrays, for importers that cannot read arrays.
    #[arg(long)]
    pub scalar: bool,
    /// The shared library to pack [default: the one built last beside this command, in deps/ or portable/].
    #[arg(long, value_name = "FILE")]
    pub library: Option<PathBuf>,
}

#[derive(Args)]
pub struct SweepOptions {
    #[command(flatten)]
    pub choice: SceneChoice,
    /// Vary a value of the scene: PATH=A:B:N (N numbers from A to B), PATH=A:B (to be sampled), either with `:log` at the end, or
    /// PATH=VALUE,VALUE,...; may be repeated.
    #[arg(long, value_name = "PATH=A:B:N", required = true)]
    pub vary: Vec<String>,
    /// How the runs are chosen: `grid`, `list` (all axes in step), `latin` (hypercube), `sobol`.
    #[arg(long, value_name = "HOW", default_value = "grid")]
    pub sampling: String,
    /// Number of samples of `latin` and `sobol`.
    #[arg(long, value_name = "N")]
    pub runs: Option<usize>,
    /// What samples are drawn with.
    #[arg(long, value_name = "NUMBER", default_value = "0")]
    pub seed: u32,
    /// Record a port: PORT (its end), PORT:min, PORT:max or PORT:mean over the run; may be repeated [default: the ends of all
    /// scalar outputs].
    #[arg(long, value_name = "PORT")]
    pub record: Vec<String>,
    /// The table to write, .csv or .npz; `-` is standard output.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Number of threads [default: one per processor]; the table does not depend on it.
    #[arg(long, value_name = "N", value_parser = parse_workers)]
    pub workers: Option<usize>,
    /// Go on with a sweep that was ended, from the rows in FILE.part.
    #[arg(long)]
    pub resume: bool,
}

#[derive(Args)]
pub struct TradeoffOptions {
    #[command(flatten)]
    pub choice: SceneChoice,
    /// Time to spend, s: half of it at most on the reference, then on the settings, cheapest first. The scene itself is
    /// always measured.
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = parse_budget)]
    pub budget: f64,
    /// Multiplications to spend, by estimate, instead of time: the same settings are measured on every machine.
    #[arg(long, value_name = "NUMBER", conflicts_with = "budget", value_parser = parse_budget)]
    pub work: Option<f64>,
    /// Write one row per setting measured; `-` is standard output.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Draw the errors against the cost of a run (PNG and SVG).
    #[arg(long, value_name = "DIR")]
    pub plots: Option<PathBuf>,
    /// Write a short table and the sentences as Markdown: between the lines `<!-- tradeoff NAME: begin -->` and
    /// `<!-- tradeoff NAME: end -->` of a file that has them (NAME is that of the scene), or into a new file.
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub enum Fmi {
    /// FMI 2.0
    #[value(name = "2")]
    Two,
    /// FMI 3.0
    #[value(name = "3")]
    Three,
}

#[derive(Args)]
pub struct PaperOptions {
    /// Folder for data and pictures.
    #[arg(long, value_name = "DIR", default_value = "out/paper")]
    pub out: PathBuf,
    /// Measure the errors against h = k = 1/64 instead of 1/256.
    #[arg(long)]
    pub quick: bool,
}

fn parse_budget(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds.is_finite() && seconds >= 0.0 => Ok(seconds),
        _ => Err("expected a number, 0 or more".to_owned()),
    }
}

fn parse_workers(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(workers) if (1..=4096).contains(&workers) => Ok(workers),
        _ => Err("expected a number of threads, 1 to 4096".to_owned()),
    }
}

fn parse_override(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((path, value)) if !path.is_empty() => Ok((path.to_owned(), value.to_owned())),
        _ => Err("expected PATH=VALUE, e.g. contact.friction.alpha=50".to_owned()),
    }
}
