//! Meshes that Gmsh has written: MSH 4.1 and 2.2, text and binary, triangles or tetrahedra of first or second order.
//!
//! The crate `mshio` was looked at: it reads 4.1 alone, without `$PhysicalNames`, panics on what it does not know, and is no
//! longer maintained. So the sections that a body needs are read here (`contents`, `version4`, `version2`), and everything a
//! file may get wrong is checked (`found`, `cells`, `names`, `parts`). Memory is taken only as far as the file is long enough for what
//! it announces. Other sections are skipped: `$Periodic` says how Gmsh made the mesh, not that two sides move together.

mod block;
mod cells;
mod contents;
mod cursor;
mod fault;
mod found;
mod names;
mod parts;
mod types;
mod version2;
mod version4;

use super::{Extent, Grid, MeshSource};
use crate::element::Element;
use crate::error::Result;
use crate::files::Files;
use crate::mesh::Mesh;
use crate::message::{cut, number};
use crate::refusal::{Refusal, Verdict, ensure, json};
use cells::Cells;
use contents::Contents;
use fault::Outcome;
use names::Names;
use parts::Parts;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A mesh file of Gmsh: MSH 4.1 or 2.2, text or binary; triangles in the plane z = 0, or tetrahedra; first or second order.
/// Physical groups of the dimension of the body are regions, those of one dimension less parts. Second-order cells keep the midside
/// nodes of the file, so that their sides may be curved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GmshMesh {
    /// Name of the file, relative to the folder of the scene. The file travels inside FMUs and compiled models.
    pub file: String,
    /// What the coordinates of the file are multiplied with to be metres: 0.001 for a file in millimetres. Default: 1.
    #[serde(default = "metres")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: f64,
}

/// No scaling.
fn metres() -> f64 {
    1.0
}

impl MeshSource for GmshMesh {
    fn dimension(&self) -> Option<usize> {
        None
    }

    fn check(&self, _element: &Element) -> Verdict {
        ensure(!self.file.is_empty() && !self.file.contains('\0'), || {
            Refusal::new(
                "mesh.file",
                json(&self.file),
                "the name of a file beside the scene",
            )
        })?;
        ensure(self.scale.is_finite() && self.scale > 0.0, || {
            Refusal::new("mesh.scale", number(self.scale), "a finite number > 0")
        })
    }

    fn parts(&self) -> Option<Vec<&str>> {
        None
    }

    fn part_fault(&self, _part: &str) -> Option<String> {
        None
    }

    fn regions(&self) -> Option<Vec<&str>> {
        None
    }

    fn extent(&self, _element: &Element, _contact: &str) -> Option<Extent> {
        None
    }

    fn grid(&self) -> Option<Grid<'_>> {
        None
    }

    fn file(&self) -> Option<&str> {
        Some(&self.file)
    }

    fn mesh(&self, files: &dyn Files) -> Result<Mesh> {
        let bytes = files.read(&self.file).map_err(|why| {
            let found = format!("{:?}, which cannot be read: {why}", cut(&self.file));
            Refusal::new("mesh.file", found, "an MSH file of Gmsh").of("scene")
        })?;
        read(&bytes, self.scale).map_err(|fault| {
            let found = format!("{}: {}", cut(&self.file), fault.found);
            Refusal::new("mesh.file", found, fault.allowed).of("scene")
        })
    }
}

/// The mesh of a file.
fn read(bytes: &[u8], scale: f64) -> Outcome<Mesh> {
    let contents = Contents::read(bytes)?;
    let names = Names::new(&contents)?;
    let cells = Cells::new(&contents, &names, scale)?;
    let parts = Parts::new(&contents, &names, &cells)?;
    let count = cells.nodes.len() as u32;
    Ok(Mesh {
        dimension: cells.element.dimension,
        element: cells.element,
        nodes: cells.nodes,
        cell_nodes: cells.cell_nodes,
        regions: cells.regions,
        cell_regions: cells.cell_regions,
        parts: parts.faces,
        unusable: parts.unusable,
        leader: (0..count).collect(),
    })
}
