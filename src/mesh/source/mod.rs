//! Where meshes come from: one file per source, one line each in the list below.
//!
//! A source is what stands under `mesh` in a scene: plain data with its own rules. It answers at once what must be known before
//! memory is taken (dimension, names of parts and regions, sizes), and makes the mesh when asked. Everything else that the
//! scene needs to know, it asks the mesh.

mod bisection;
mod boxes;
mod criss_cross;
mod gmsh;
mod grid;
mod lines;
mod rectangle;
mod refinement;
mod regions;

pub use boxes::BoxMesh;
pub use gmsh::GmshMesh;
pub use grid::{Axis, Grid};
pub use rectangle::Rectangle;
#[cfg(test)]
pub(super) use rectangle::ungraded;
pub use refinement::Refinement;
pub use regions::{BODY, RegionBox};

use super::Mesh;
use crate::element::Element;
use crate::error::Result;
use crate::files::Files;
use crate::refusal::Verdict;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Mesh of the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum MeshSpec {
    Rectangle(Rectangle),
    Box(BoxMesh),
    Gmsh(GmshMesh),
}

impl MeshSpec {
    /// The source.
    pub(crate) fn source(&self) -> &dyn MeshSource {
        match self {
            MeshSpec::Rectangle(source) => source,
            MeshSpec::Box(source) => source,
            MeshSpec::Gmsh(source) => source,
        }
    }

    /// Space dimension, 2 or 3; `None` where only the file of the mesh says it.
    pub fn dimension(&self) -> Option<usize> {
        self.source().dimension()
    }

    /// The grid that the mesh is cut from; `None` for a mesh that comes from a file.
    pub fn grid(&self) -> Option<Grid<'_>> {
        self.source().grid()
    }

    /// Sizes with this element, before there is a mesh; `None` for a mesh that comes from a file.
    pub fn extent(&self, element: &Element, contact: &str) -> Option<Extent> {
        self.source().extent(element, contact)
    }

    /// The file that the mesh comes from; `None` for a mesh that is generated.
    pub fn file(&self) -> Option<&str> {
        self.source().file()
    }
}

/// A source of meshes.
pub(crate) trait MeshSource {
    /// Space dimension, 2 or 3; `None` where only the file says it.
    fn dimension(&self) -> Option<usize>;

    /// Refuses values that give no mesh, or one that cannot be numbered with 32 bits with this element.
    fn check(&self, element: &Element) -> Verdict;

    /// Names of the parts of the boundary; `None` where only the file says them.
    fn parts(&self) -> Option<Vec<&str>>;

    /// What is allowed instead of a part that the mesh will not have; `None` for one that it will, or may.
    fn part_fault(&self, part: &str) -> Option<String>;

    /// Names that regions may have; which of them have cells, the mesh knows. `None` where only the file says them.
    fn regions(&self) -> Option<Vec<&str>>;

    /// Sizes of the mesh with this element and of its part `contact`; `None` where only the file says them.
    fn extent(&self, element: &Element, contact: &str) -> Option<Extent>;

    /// The grid that the mesh is cut from, for what varies `mesh.cells` and `mesh.grading`; `None` where there is none.
    fn grid(&self) -> Option<Grid<'_>>;

    /// Name of the file that the mesh comes from.
    fn file(&self) -> Option<&str> {
        None
    }

    /// Makes the mesh, of linear cells unless a file has others; the values have been checked.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for what only the mesh shows: too many nodes, a region without cells, a cell in two regions; a
    /// file that cannot be read.
    fn mesh(&self, files: &dyn Files) -> Result<Mesh>;
}

/// Sizes of a mesh before there is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Nodes before refinement, those joined by periodicity counted twice.
    pub nodes: u128,
    /// Nodes that refinement adds, about.
    pub refined: f64,
    /// Nodes on the contact part, about.
    pub contact: f64,
}
