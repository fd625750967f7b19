//! How much memory a scene takes, before it is taken.
//!
//! Estimates are sums of the large arrays: mesh, operators, sparse factor, matrices of contact order, recorded past. They are
//! made from the scene alone before there is a mesh, and again with the true sizes of mesh and factor. A scene beyond
//! `fidelity.memory_limit`, or beyond what the machine gives, is refused with the estimate.

use crate::element::{self, Element};
use crate::error::{Error, Result};
use crate::fem::Body;
use crate::mesh::{Extent, Mesh};
use crate::scene::{ModelKind, Scene};
use crate::state::history_row;

const NUMBER: f64 = 8.0;
/// Samples that a reduction holds, and shifts among them.
const SAMPLES: f64 = 13.0;
const SHIFTS: f64 = 4.0;
/// Fields that a reduction holds per force.
const FIELDS: f64 = 10.0;
/// Step sizes whose factors a simulator keeps.
const STEP_SIZES: f64 = 4.0;

/// Sizes of a body.
#[derive(Debug, Clone, Copy)]
pub struct Sizes {
    nodes: f64,
    cells: f64,
    dofs: f64,
    /// Entries of a lower triangle of the operators.
    entries: f64,
    /// Entries of a sparse factor.
    factor: f64,
    /// Contact components, and the other ports.
    contact: f64,
    others: f64,
    /// Branches of the memory of the materials.
    branches: f64,
    /// Entries that a stage keeps beside its factor: the tangents of laws that are not linear.
    tangent: f64,
}

impl Sizes {
    /// From the scene alone; refinement counts as far as its boxes are filled.
    pub fn of_scene(scene: &Scene) -> Option<Sizes> {
        let element = scene.element_table()?;
        let extent = scene.extent(element)?;
        Some(Sizes::new(scene, element, &extent))
    }

    /// Of a mesh from a file, before it gets midside nodes and there are matrices.
    pub fn of_file(scene: &Scene, mesh: &Mesh) -> Sizes {
        let kind = scene.element.unwrap_or(mesh.element.kind);
        let element = element::of(kind, mesh.dimension).unwrap_or(mesh.element);
        // midside nodes are three times as many as corners in the plane, seven times in space
        let growth = match element == mesh.element {
            true => 1,
            false => 1u128 << mesh.dimension,
        };
        let parts = scene.each_contact();
        let faces = parts.map(|contact| mesh.parts.get(&contact.part).map_or(0, Vec::len));
        let faces = faces.sum::<usize>() / mesh.element.face_nodes();
        let per_face =
            element.order.pow(mesh.dimension as u32 - 1) as f64 / (mesh.dimension - 1) as f64;
        let extent = Extent {
            nodes: growth * mesh.nodes.len() as u128,
            refined: 0.0,
            contact: faces as f64 * per_face,
        };
        Sizes::new(scene, element, &extent)
    }

    fn new(scene: &Scene, element: &Element, extent: &Extent) -> Sizes {
        let d = element.dimension as f64;
        let nodes = extent.nodes as f64 + extent.refined;
        let dofs = d * nodes;
        let separator = match element.dimension {
            // a separator is as long as the shorter side, and its dofs become a dense triangle
            2 => 7.75 * nodes * nodes.max(2.0).log2(),
            _ => 9.0 * nodes.powf(4.0 / 3.0),
        };
        Sizes {
            nodes,
            cells: 2.0 * nodes * (d - 1.0),
            dofs,
            entries: element.row_entries as f64 * dofs,
            factor: separator,
            contact: extent.contact * (d - 1.0 + f64::from(u8::from(scene.is_pressed()))),
            others: ports(scene, element.dimension),
            branches: branches(scene),
            tangent: match scene.is_nonlinear() {
                true => element.row_entries as f64 * dofs,
                false => 0.0,
            },
        }
    }

    /// Of an assembled body whose factors have `factor` entries.
    pub fn of_body(scene: &Scene, body: &Body, factor: usize) -> Sizes {
        Sizes {
            nodes: body.mesh.nodes.len() as f64,
            cells: body.mesh.cell_count() as f64,
            dofs: body.len() as f64,
            entries: body.operators.row_idx.len() as f64,
            factor: factor as f64,
            contact: body.contact_len() as f64,
            others: ports(scene, body.mesh.dimension),
            branches: body.operators.memory.len() as f64,
            tangent: match body.is_nonlinear {
                true => body.operators.row_idx.len() as f64,
                false => 0.0,
            },
        }
    }

    /// Mesh, operators and one factor, bytes: every model needs them.
    fn of_mesh(&self) -> f64 {
        let operators = (6.0 + self.branches) * self.entries;
        NUMBER * (8.0 * self.nodes + 4.0 * self.cells + operators + self.factor)
    }

    /// What a reduction adds, bytes.
    fn of_reduction(&self) -> f64 {
        let ports = self.contact + self.others;
        let states = self.dofs * (1.0 + self.branches);
        let fields = 2.0 * FIELDS * (3.0 + self.others.min(6.0)) * states;
        let gram = (SHIFTS * ports).powi(2);
        NUMBER * (2.0 * SAMPLES * ports.powi(2) + 4.0 * gram + fields)
    }

    /// What the full or condensed model adds, with one simulator, bytes.
    fn of_whole(&self) -> f64 {
        let stage = self.factor + self.tangent + self.contact.powi(2);
        NUMBER
            * ((3.0 + self.branches) * self.entries
                + STEP_SIZES * stage
                + 6.0 * self.contact.powi(2)
                + 20.0 * self.dofs * (1.0 + self.branches))
    }

    /// The recorded past of one simulator, which holds three states, bytes.
    fn of_past(&self, scene: &Scene) -> f64 {
        let row = history_row(self.contact as usize) as f64;
        3.0 * NUMBER * f64::from(scene.history.capacity) * row
    }

    /// Refuses a scene whose model of the least memory goes beyond the limit.
    ///
    /// # Errors
    /// [`Error::Scene`] at `history.capacity`, `mesh.cells` or `mesh.file`.
    pub fn check(&self, scene: &Scene) -> Result<()> {
        let past = self.of_past(scene);
        let added = match scene.fidelity.model {
            ModelKind::Full | ModelKind::Condensed => self.of_whole(),
            ModelKind::Reduced => self.of_reduction(),
            ModelKind::Auto => self.of_whole().min(self.of_reduction()),
        };
        let body = self.of_mesh() + added;
        if past > body {
            let found = format!(
                "{} with {} contact components",
                scene.history.capacity, self.contact
            );
            ensure(scene, "history.capacity", found, past + body)
        } else {
            let nodes = format!("{:.0} nodes", self.nodes);
            match scene.mesh.grid() {
                Some(grid) => {
                    let found = format!("{:?}, {nodes}", grid.cells);
                    ensure(scene, "mesh.cells", found, past + body)
                }
                None => ensure(scene, "mesh.file", nodes, past + body),
            }
        }
    }

    /// Refuses a reduction beyond the limit.
    ///
    /// # Errors
    /// [`Error::Scene`] at `fidelity.model`.
    pub fn check_reduction(&self, scene: &Scene) -> Result<()> {
        let found = format!("a reduced model of {} contact components", self.contact);
        let needed = self.of_mesh() + self.of_reduction() + self.of_past(scene);
        ensure(scene, "fidelity.model", found, needed)
    }
}

fn ports(scene: &Scene, dimension: usize) -> f64 {
    (scene.inputs().count() + scene.probes.len() * dimension) as f64
}

/// Relaxation times that no other branch of the scene has.
fn branches(scene: &Scene) -> f64 {
    let materials = scene.materials().into_iter();
    let times = materials.flat_map(|m| m.operators.branches());
    let times: std::collections::BTreeSet<u64> = times.map(|(tau, _)| tau.to_bits()).collect();
    times.len() as f64
}

fn ensure(scene: &Scene, path: &str, found: String, needed: f64) -> Result<()> {
    let limit = scene.fidelity.memory_limit();
    let refuse = |allowed: String| {
        Err(Error::Scene {
            source_name: scene.name.clone(),
            path: path.to_owned(),
            found: format!("{found}, which takes about {}", gigabytes(needed)),
            allowed,
        })
    };
    if needed.is_nan() || needed > limit {
        return refuse(format!(
            "what takes at most {} (fidelity.memory_limit)",
            gigabytes(limit)
        ));
    }
    if !is_available(needed as usize) {
        return refuse("what this machine has memory for".to_owned());
    }
    Ok(())
}

fn gigabytes(bytes: f64) -> String {
    format!("{:.3} GB", 1e-9 * bytes)
}

/// Refuses what takes more memory than the machine gives now.
///
/// # Errors
/// [`Error::Body`].
pub(crate) fn ensure_available(what: &str, bytes: usize) -> Result<()> {
    if is_available(bytes) {
        return Ok(());
    }
    let needed = gigabytes(bytes as f64);
    Err(Error::Body {
        what: format!("{what} takes about {needed}, more than this machine has memory for"),
    })
}

/// Whether the machine would give this much memory now; none is taken.
fn is_available(bytes: usize) -> bool {
    Vec::<u8>::new().try_reserve_exact(bytes).is_ok()
}
