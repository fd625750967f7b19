//! Packs an FMU: shared library, compiled model and scene, description, documentation, reference results.

use crate::component::{MODEL_FILE, SCENE_FILE};
use crate::description::{
    FmiVersion, MODEL_IDENTIFIER, model_description, start_values, terminals,
};
use crate::documentation::{LibraryNotes, page};
use crate::reference_run::{ReferenceRun, reference_run};
use crate::variables::Variables;
use crate::xml::Xml;
use std::fmt;
use std::io::{Cursor, Write};
use std::ops::ControlFlow;
use std::path::{Component, Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use stickslip::{Compilation, Files, Scene};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

const REFERENCE_IN: &str = "reference_in.csv";
const REFERENCE_OUT: &str = "reference_out.csv";
/// Where both versions of FMI have the licence of an FMU, and of what is in it.
const LICENSES: &str = "documentation/licenses";
const LICENSE: &str = include_str!("../../LICENSE");
const THIRD_PARTY_NOTICES: &str = include_str!("../../THIRD-PARTY-NOTICES.txt");
/// Variable of the environment with the time (s since 1970) that a reproducible package is dated with.
const EPOCH: &str = "SOURCE_DATE_EPOCH";

/// How an FMU is packed.
#[derive(Debug, Clone)]
pub struct Options {
    /// Version of FMI. Default: FMI 3.
    pub version: FmiVersion,
    /// FMI 3 with one variable per array element, for importers without arrays. Default: false.
    pub is_scalar: bool,
    /// The shared library; default: [`find_library`].
    pub library: Option<PathBuf>,
    /// What errors call the scene. Default: `scene`.
    pub source_name: String,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            version: FmiVersion::Fmi3,
            is_scalar: false,
            library: None,
            source_name: "scene".to_owned(),
        }
    }
}

/// A packed FMU.
#[derive(Debug, Clone)]
pub struct Packed {
    /// The zip file.
    pub bytes: Vec<u8>,
    /// The shared library that is in it.
    pub library: PathBuf,
    /// Newest glibc version that the library asks for.
    pub glibc: Option<String>,
}

/// Why there is no FMU.
#[derive(Debug)]
pub enum PackageError {
    /// The scene is refused, or does not run.
    Scene(stickslip::Error),
    /// There is no shared library; the places that were searched.
    NoLibrary(Vec<PathBuf>),
    /// The shared library is a build for tests, which panics on request.
    TestLibrary(PathBuf),
    /// `SOURCE_DATE_EPOCH` is set, but not to a number of seconds.
    Date(String),
    /// A file cannot be read, or the archive not be written.
    Io(PathBuf, std::io::Error),
}

impl fmt::Display for PackageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PackageError::Scene(error) => error.fmt(f),
            PackageError::NoLibrary(places) => {
                let places: Vec<_> = places.iter().map(|p| p.display().to_string()).collect();
                write!(
                    f,
                    "no FMU library at {} (cargo build --release -p stickslip-fmu makes it)",
                    places.join(", ")
                )
            }
            PackageError::TestLibrary(path) => write!(
                f,
                "{} was built for tests, with the feature panic-injection (cargo build --release makes the library to pack)",
                path.display()
            ),
            PackageError::Date(found) => write!(
                f,
                "{EPOCH}: found {found:?}, expected a number of seconds since 1970"
            ),
            PackageError::Io(path, error) => write!(f, "{}: {error}", path.display()),
        }
    }
}

impl std::error::Error for PackageError {}

impl From<stickslip::Error> for PackageError {
    fn from(error: stickslip::Error) -> PackageError {
        PackageError::Scene(error)
    }
}

/// File name of the shared library.
fn library_name() -> String {
    format!(
        "{}{MODEL_IDENTIFIER}{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    )
}

/// Folders of the library in an FMU, FMI 2 and FMI 3.
fn platform(version: FmiVersion) -> &'static str {
    match (
        version,
        cfg!(target_os = "macos"),
        cfg!(windows),
        cfg!(target_arch = "aarch64"),
    ) {
        (FmiVersion::Fmi2, true, ..) => "darwin64",
        (FmiVersion::Fmi2, _, true, _) => "win64",
        (FmiVersion::Fmi2, ..) => "linux64",
        (FmiVersion::Fmi3, true, _, true) => "aarch64-darwin",
        (FmiVersion::Fmi3, true, ..) => "x86_64-darwin",
        (FmiVersion::Fmi3, _, true, _) => "x86_64-windows",
        (FmiVersion::Fmi3, _, _, true) => "aarch64-linux",
        (FmiVersion::Fmi3, ..) => "x86_64-linux",
    }
}

/// The shared library: of those in `portable/`, beside the executable and in its `deps/` the one built last, because cargo
/// may renew only one of them; the portable build wins a tie.
///
/// # Errors
/// [`PackageError::NoLibrary`].
pub fn find_library() -> Result<PathBuf, PackageError> {
    let executable =
        std::env::current_exe().map_err(|e| PackageError::Io("the executable".into(), e))?;
    // an executable of a test or an example lies one folder deeper
    let folders = executable.ancestors().skip(1).take(2);
    let places: Vec<PathBuf> = folders
        .flat_map(|folder| ["deps", "", "portable"].map(|p| folder.join(p).join(library_name())))
        .collect();
    let built = |path: &PathBuf| std::fs::metadata(path).and_then(|m| m.modified()).ok();
    let found = places.iter().filter_map(|path| Some((built(path)?, path)));
    match found.max_by_key(|(time, _)| *time) {
        Some((_, path)) => Ok(path.clone()),
        None => Err(PackageError::NoLibrary(places)),
    }
}

/// Newest `GLIBC_x.y` among the versions that a library names.
pub fn newest_glibc(library: &[u8]) -> Option<String> {
    let mark = b"GLIBC_";
    let versions = library
        .windows(mark.len())
        .enumerate()
        .filter(|(_, w)| w == mark)
        .filter_map(|(at, _)| {
            let text: Vec<u8> = library[at + mark.len()..]
                .iter()
                .copied()
                .take_while(|b| b.is_ascii_digit() || *b == b'.')
                .collect();
            let text = String::from_utf8(text).ok()?;
            let numbers: Option<Vec<u32>> = text.split('.').map(|n| n.parse().ok()).collect();
            Some((numbers?, text))
        });
    versions.max().map(|(_, text)| text)
}

/// Whether a library was built with the feature `panic-injection`, which is for tests only: its message is in it.
fn is_test_library(library: &[u8]) -> bool {
    // put together here, so that a library does not contain the text because it contains the packager
    let mark = ["panic-injection", "stickslip_fmu built with "];
    let mark = format!("{}{}", mark[1], mark[0]);
    library.windows(mark.len()).any(|w| w == mark.as_bytes())
}

/// Packs the FMU of a scene text with the files that it names. It contains: the shared library, the compiled model, the scene and its
/// files (in `resources/`), the
/// model description, for FMI 3 the terminals, a documentation page, the licences, and the results of the scene's own run. The
/// same scene and library give the same bytes where `SOURCE_DATE_EPOCH` says what date to write.
///
/// # Errors
/// [`PackageError`].
pub fn package(
    scene_text: &str,
    files: &dyn Files,
    options: &Options,
) -> Result<Packed, PackageError> {
    let scene = Scene::from_json(scene_text, &options.source_name)?;
    let compilation = Compilation::with(&scene, files, &mut |_| ControlFlow::Continue(()))?;
    let model = &compilation.model;
    let text = compilation.scene.to_json();
    let library = options.library.clone().map_or_else(find_library, Ok)?;
    let binary = std::fs::read(&library).map_err(|e| PackageError::Io(library.clone(), e))?;
    if is_test_library(&binary) {
        return Err(PackageError::TestLibrary(library));
    }
    let glibc = newest_glibc(&binary);
    let (version, is_scalar) = (options.version, options.is_scalar);

    let date = iso_time(date_of_packing()?);
    let description = model_description(model, &compilation.scene, version, is_scalar, &date)?;
    let run = reference_run(&compilation.scene, model)?;
    let notes = LibraryNotes {
        glibc: glibc.clone(),
    };
    let start = start_values(model, &Variables::new(model))?;
    let documentation = page(&compilation, &start, version, is_scalar, &notes);
    let mut members: Vec<(String, Vec<u8>)> = vec![
        ("modelDescription.xml".into(), description.into()),
        (
            format!("binaries/{}/{}", platform(version), binary_name()),
            binary,
        ),
        (format!("resources/{SCENE_FILE}"), text.into()),
        (format!("resources/{MODEL_FILE}"), model.to_bytes()),
        ("documentation/index.html".into(), documentation.into()),
        (format!("{LICENSES}/license.txt"), LICENSE.into()),
        (
            format!("{LICENSES}/THIRD-PARTY-NOTICES.txt"),
            THIRD_PARTY_NOTICES.into(),
        ),
    ];
    if version == FmiVersion::Fmi3 {
        let name = "terminalsAndIcons/terminalsAndIcons.xml";
        members.push((name.into(), terminals(model, is_scalar).into()));
    }
    members.extend(scene_files(model));
    members.extend(reference_files(run));
    let bytes = archive(&members).map_err(|e| PackageError::Io("the archive".into(), e.into()))?;
    Ok(Packed {
        bytes,
        library,
        glibc,
    })
}

/// The files that the scene names, beside it: whoever unpacks the FMU has a scene that compiles. The model carries them too, so that
/// the FMU does not depend on them; a name that leads out of the folder stays in the model alone.
fn scene_files(model: &stickslip::Model) -> Vec<(String, Vec<u8>)> {
    let is_inside = |name: &str| {
        let is_plain = |part: Component| matches!(part, Component::Normal(_));
        !name.contains('\\') && Path::new(name).components().all(is_plain)
    };
    let files = model.files().0.iter();
    files
        .filter(|(name, _)| is_inside(name) && ![SCENE_FILE, MODEL_FILE].contains(&name.as_str()))
        .map(|(name, bytes)| (format!("resources/{name}"), bytes.to_vec()))
        .collect()
}

/// FMI names the file after the model identifier, without the prefix `lib`.
fn binary_name() -> String {
    format!("{MODEL_IDENTIFIER}{}", std::env::consts::DLL_SUFFIX)
}

fn reference_files(run: ReferenceRun) -> Vec<(String, Vec<u8>)> {
    let folder = "extra/org.fmi-standard.fmi-ls-ref";
    let mut xml = Xml::new();
    xml.open(
        "fmiReferences",
        &[
            ("xmlns:fmi-ls", "http://fmi-standard.org/fmi-ls-manifest"),
            ("fmi-ls:fmi-ls-name", "org.fmi-standard.fmi-ls-ref"),
            ("fmi-ls:fmi-ls-version", "1.0.0-alpha.1"),
            (
                "fmi-ls:fmi-ls-description",
                "Input and output of the default experiment.",
            ),
        ],
    );
    let stimuli = format!(
        "Input of the default experiment up to {:?} s, communication step {:?} s: a row is set before the step that {} there.",
        run.until,
        run.step,
        if run.is_set_at_end { "ends" } else { "begins" }
    );
    for (source, role, description) in [
        (REFERENCE_IN, "stimulus", stimuli.as_str()),
        (REFERENCE_OUT, "result", "Output of the default experiment"),
    ] {
        xml.empty(
            "Related",
            &[
                ("type", "text/csv"),
                ("source", source),
                ("role", role),
                ("description", description),
            ],
        );
    }
    let file = |name: &str, text: String| (format!("{folder}/{name}"), text.into_bytes());
    vec![
        file("fmi-ls-manifest.xml", xml.finish()),
        file(REFERENCE_IN, run.inputs),
        file(REFERENCE_OUT, run.outputs),
    ]
}

/// A zip file that every importer reads: deflate, no data descriptors.
fn archive(files: &[(String, Vec<u8>)]) -> zip::result::ZipResult<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        let mode = if Path::new(name).starts_with("binaries") {
            0o755
        } else {
            0o644
        };
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(zip::DateTime::default())
            .unix_permissions(mode);
        zip.start_file(name.as_str(), options)?;
        zip.write_all(bytes)?;
    }
    Ok(zip.finish()?.into_inner())
}

/// The date that the model description states.
///
/// # Errors
/// [`PackageError::Date`].
fn date_of_packing() -> Result<SystemTime, PackageError> {
    let Some(text) = std::env::var_os(EPOCH) else {
        return Ok(SystemTime::now());
    };
    let text = text.to_string_lossy();
    let seconds = text.parse().ok().map(Duration::from_secs);
    seconds
        .and_then(|seconds| UNIX_EPOCH.checked_add(seconds))
        .ok_or_else(|| PackageError::Date(text.into_owned()))
}

/// ISO 8601 in UTC, to the second.
fn iso_time(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    // days since 0000-03-01 in eras of 400 years (Hinnant, days_from_civil)
    let z = days + 719_468;
    let (era, doe) = (z / 146_097, z % 146_097);
    let yoe = (doe - doe / 1460 + doe / 36_524 - doe / 146_096) / 365;
    let doy = doe - (365 * yoe + yoe / 4 - yoe / 100);
    let mp = (5 * doy + 2) / 153;
    let (day, month) = (
        doy - (153 * mp + 2) / 5 + 1,
        if mp < 10 { mp + 3 } else { mp - 9 },
    );
    let year = yoe + 400 * era + u64::from(month <= 2);
    format!(
        "{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}Z",
        rest / 3600,
        rest / 60 % 60,
        rest % 60
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_civil() {
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
        ] {
            assert_eq!(iso_time(UNIX_EPOCH + Duration::from_secs(seconds)), text);
        }
    }

    #[test]
    fn the_newest_version_is_found() {
        let bytes = b"..GLIBC_2.9\0GLIBC_2.14\0GLIBC_PRIVATE\0GLIBC_2.2.5";
        assert_eq!(newest_glibc(bytes).as_deref(), Some("2.14"));
    }
}
