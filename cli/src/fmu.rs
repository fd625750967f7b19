//! Packs scenes as FMUs, and says what the file asks of the system it will run on.

use crate::arguments::{Fmi, FmuOptions};
use crate::console;
use crate::failure::Failure;
use crate::source;
use crate::standard;
use std::io::Write;
use std::path::{Path, PathBuf};
use stickslip::message::escaped;
use stickslip::{Files, Scene};
use stickslip_fmu::{FmiVersion, Options, PackageError, Packed, package};

/// `stickslip fmu`; `library` is packed where the options name none.
pub fn run(options: &FmuOptions, library: Option<PathBuf>) -> Result<(), Failure> {
    if options.scalar && options.fmi == Fmi::Two {
        return Err(Failure::Option(
            "--scalar is for --fmi 3: FMI 2 has no arrays",
        ));
    }
    let scene = source::scene(&options.choice, &[])?;
    let name = options.choice.name().to_owned();
    let packed = pack(
        &scene,
        &source::files(&options.choice),
        Options {
            version: match options.fmi {
                Fmi::Two => FmiVersion::Fmi2,
                Fmi::Three => FmiVersion::Fmi3,
            },
            is_scalar: options.scalar,
            library: options.library.clone().or(library),
            source_name: name,
        },
    )?;
    write(&options.output, &packed)?;
    let place = match standard::is_meant(&options.output) {
        true => "standard output".to_owned(),
        false => options.output.display().to_string(),
    };
    let version = match options.fmi {
        Fmi::Two => "2.0",
        Fmi::Three => "3.0",
    };
    let text = format!(
        "{place}: FMI {version}, {:.1} MB; {}",
        packed.bytes.len() as f64 / 1e6,
        library_of(&packed)
    );
    console::say_beside(Some(&options.output), &escaped(&text))
}

/// The FMU of a scene; `options.source_name` is what errors call the scene.
pub fn pack(scene: &Scene, files: &dyn Files, options: Options) -> Result<Packed, Failure> {
    package(&scene.to_json(), files, &options).map_err(|error| match error {
        PackageError::Scene(error) => Failure::of(&options.source_name)(error),
        error => Failure::Package {
            source_name: options.source_name.clone(),
            error: Box::new(error),
        },
    })
}

/// Writes the file, and the folders it lies in; `-` is standard output.
pub fn write(path: &Path, packed: &Packed) -> Result<(), Failure> {
    let failed = Failure::writing(path);
    let mut file = standard::create(path)?;
    let written = file.write_all(&packed.bytes);
    written.and_then(|()| file.flush()).map_err(|e| failed(&e))
}

/// Which library is in the FMU, and the oldest system that loads it.
pub fn library_of(packed: &Packed) -> String {
    let folder = packed.library.parent().and_then(Path::file_name);
    let kind = if folder.is_some_and(|f| f == "portable") {
        "portable"
    } else {
        "native"
    };
    let needs = match &packed.glibc {
        Some(version) => format!("needs glibc {version} or newer"),
        None => "names no glibc version".to_owned(),
    };
    format!("{kind} library {}, {needs}", packed.library.display())
}
