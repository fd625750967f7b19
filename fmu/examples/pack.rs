//! Packs FMUs: `pack SCENE OUTPUT [2|3] [scalar]`, where SCENE is a file or the name of an embedded example.

use stickslip_fmu::{FmiVersion, Options, package};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, output, rest @ ..] = arguments.as_slice() else {
        return Err("usage: pack SCENE OUTPUT [2|3] [scalar]".into());
    };
    let text = match stickslip::scene::example(scene) {
        Some(text) => text.to_owned(),
        None => std::fs::read_to_string(scene)?,
    };
    let version = match rest.first().map(String::as_str) {
        Some("2") => FmiVersion::Fmi2,
        _ => FmiVersion::Fmi3,
    };
    let is_scalar = rest.iter().any(|word| word == "scalar");
    let options = Options {
        version,
        is_scalar,
        source_name: scene.clone(),
        ..Options::default()
    };
    let packed = package(&text, &options)?;
    std::fs::write(output, &packed.bytes)?;
    let glibc = packed.glibc.as_deref().unwrap_or("unknown");
    println!(
        "{output}: {} bytes, library {}, glibc {glibc}",
        packed.bytes.len(),
        packed.library.display()
    );
    Ok(())
}
