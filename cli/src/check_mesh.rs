//! `stickslip check part.msh`: what a mesh file offers to a scene, and how good its cells are.

use crate::arguments::SceneChoice;
use crate::closing::{figure, trimmed, two_columns};
use crate::console;
use crate::failure::Failure;
use crate::source;
use comfy_table::{Table, presets};
use std::fs::File;
use std::io::Read;
use std::path::Path;
use stickslip::mesh::{GmshMesh, Mesh, MeshSpec, Quality};
use stickslip::message::cut;

/// First bytes of a mesh file.
const MARK: &[u8] = b"$MeshFormat";

/// Whether the command line names a mesh file and no scene.
pub fn is_meant(choice: &SceneChoice) -> bool {
    let path = Path::new(&choice.scene);
    let has_ending = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("msh"));
    let mut first = [0; MARK.len()];
    let mut read = || {
        File::open(path)
            .and_then(|mut file| file.read_exact(&mut first))
            .is_ok()
    };
    has_ending || (path.is_file() && read() && first == MARK)
}

/// Prints parts, regions, sizes and quality; of `--set` it takes `mesh.scale`.
pub fn check(choice: &SceneChoice) -> Result<(), Failure> {
    let path = Path::new(&choice.scene);
    let mut spec = GmshMesh {
        file: path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned(),
        scale: 1.0,
    };
    for (key, value) in &choice.overrides {
        spec.scale = match (key.as_str(), value.parse()) {
            ("mesh.scale", Ok(scale)) => scale,
            _ => {
                return Err(Failure::Option(
                    "of a mesh file --set takes mesh.scale and a number",
                ));
            }
        };
    }
    if !path.is_file() {
        return Err(Failure::File {
            path: path.to_owned(),
            doing: "read",
            why: "there is no such file".to_owned(),
        });
    }
    let files = source::files(choice);
    let mesh = Mesh::read(&MeshSpec::Gmsh(spec), &files).map_err(Failure::of(choice.name()))?;
    let quality = mesh.quality();
    console::say(&two_columns(choice.name(), rows(&mesh, &quality)))?;
    console::say(&format!("\nregions\n{}", regions(&mesh, &quality)))?;
    console::say(&format!("\nparts\n{}", parts(&mesh, &quality)))?;
    match quality.least_jacobian > 0.0 {
        true => Ok(()),
        false => Err(Failure::File {
            path: path.to_owned(),
            doing: "use",
            why: "a cell is turned inside out by its bent sides".to_owned(),
        }),
    }
}

fn rows(mesh: &Mesh, quality: &Quality) -> Vec<(&'static str, String)> {
    let d = mesh.dimension;
    let list = |values: &[f64]| {
        values[..d]
            .iter()
            .map(|x| figure(*x, 6))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let mut rows = vec![
        (
            "mesh",
            format!(
                "{d}D, {} nodes, {} cells of {} (element \"{}\")",
                mesh.nodes.len(),
                mesh.cell_count(),
                mesh.element.name,
                mesh.element.kind.name()
            ),
        ),
        (
            "extent",
            format!(
                "({}) to ({}) m",
                list(&quality.bounds[0]),
                list(&quality.bounds[1])
            ),
        ),
        (
            "edges",
            format!(
                "{} to {} m",
                figure(quality.edges[0], 4),
                figure(quality.edges[1], 4)
            ),
        ),
        (
            "smallest angle",
            format!(
                "{} degrees {}, at ({})",
                figure(quality.smallest_angle, 3),
                if d == 2 {
                    "between sides"
                } else {
                    "between faces"
                },
                list(&quality.smallest_angle_at)
            ),
        ),
        (
            "worst aspect",
            format!(
                "{} (longest edge to shortest height; 1 is regular)",
                figure(quality.worst_aspect, 3)
            ),
        ),
    ];
    if mesh.element.order > 1 {
        let least = match quality.bent {
            0 => String::new(),
            _ => format!(
                "; least Jacobian {} of the largest in a cell",
                figure(quality.least_jacobian, 3)
            ),
        };
        rows.push((
            "bent cells",
            format!("{} of {}{least}", quality.bent, mesh.cell_count()),
        ));
    }
    if quality.pieces > 1 {
        let text = format!(
            "{}, which share no node: each needs a clamped part of its own",
            quality.pieces
        );
        rows.push(("pieces", text));
    }
    rows
}

fn table(header: [&str; 3]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(header);
    table
}

fn regions(mesh: &Mesh, quality: &Quality) -> String {
    let mut table = table([
        "name",
        "cells",
        if mesh.dimension == 2 {
            "area, m2"
        } else {
            "volume, m3"
        },
    ]);
    for region in &quality.regions {
        table.add_row([
            cut(&region.name),
            region.cells.to_string(),
            figure(region.measure, 6),
        ]);
    }
    trimmed(&table)
}

fn parts(mesh: &Mesh, quality: &Quality) -> String {
    let mut table = table([
        "name",
        "faces",
        if mesh.dimension == 2 {
            "length, m"
        } else {
            "area, m2"
        },
    ]);
    for part in &quality.parts {
        table.add_row([
            cut(&part.name),
            part.faces.to_string(),
            figure(part.measure, 6),
        ]);
    }
    for (name, why) in &mesh.unusable {
        table.add_row([cut(name), "-".to_owned(), format!("no part: {why}")]);
    }
    trimmed(&table)
}
