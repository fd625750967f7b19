//! Load columns and probe rows: how the inputs enter the equations and how the displacement is read at a point.
//!
//! A load of intensity p(t) puts the force `p(t) * column` on the free components; its work-conjugate displacement is
//! `column . u` (the mean displacement along the direction times `measure`). All integrals are exact but for those of bent cells and faces.

use super::cell::Cell;
use super::direction::direction;
use super::dofs::DofMap;
use super::driven::NodalRows;
use super::face::face_integrals;
use crate::element::MOST_NODES;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::refusal::scene_error;
use crate::scene::{Interpolation, LoadKind, Scene};
use nalgebra::Vector3;

/// Force of one load of unit intensity.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadColumn {
    /// Name of the input.
    pub name: String,
    /// Free component (ascending) and value: the integral of the shape function over the part (traction, m or m^2) or the
    /// body (body force, m^2 or m^3) times the unit direction.
    pub entries: Vec<(usize, f64)>,
    /// Length or area of the part, or area or volume of the body; parts that are clamped count.
    pub measure: f64,
    /// Intensity at the start: Pa, or N/m^3 for a body force.
    pub start: f64,
    /// Course of the input within a communication step.
    pub interpolation: Interpolation,
}

/// How the displacement at a point follows from the free components.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeRows {
    /// Name of the probe.
    pub name: String,
    /// The point, m; z = 0 in 2D.
    pub at: [f64; 3],
    /// For each global axis the free components (ascending) and their coefficients.
    pub rows: Vec<Vec<(usize, f64)>>,
}

/// The column of every load of the scene.
///
/// # Errors
/// [`crate::Error::Scene`] for a missing or unknown part or a direction without length.
pub(super) fn load_columns(
    scene: &Scene,
    mesh: &Mesh,
    dofs: &DofMap,
) -> Result<(Vec<LoadColumn>, NodalRows)> {
    let mut columns = Vec::with_capacity(scene.loads.len());
    let mut rows = NodalRows::new();
    for (i, load) in scene.loads.iter().enumerate() {
        let unit = direction(&load.direction, &format!("loads[{i}].direction"))?;
        let mut shares = vec![0.0; mesh.nodes.len()];
        match load.kind {
            LoadKind::Traction => {
                let path = format!("loads[{i}].part");
                let Some(part) = &load.part else {
                    let allowed = "the name of the part the traction acts on".to_string();
                    return Err(scene_error(&path, "nothing".to_string(), allowed));
                };
                for face in mesh.faces(part, &path)? {
                    for (node, share) in face_integrals(mesh, face) {
                        shares[node as usize] += share;
                    }
                }
            }
            LoadKind::BodyForce => {
                for cell in mesh.cells() {
                    let shapes = Cell::new(mesh, cell);
                    for (&node, share) in cell.iter().zip(shapes.integrals()) {
                        shares[node as usize] += share;
                    }
                }
            }
        }
        let mut entries = Vec::new();
        let mut row = Vec::new();
        for (node, &share) in shares.iter().enumerate() {
            if share != 0.0 {
                add_components(dofs, node as u32, unit * share, &mut entries);
                row.push((node as u32, unit * share));
            }
        }
        rows.push(row);
        columns.push(LoadColumn {
            name: load.name.clone(),
            entries: merged(entries),
            measure: shares.iter().sum(),
            start: load.start,
            interpolation: load.interpolation,
        });
    }
    Ok((columns, rows))
}

/// The rows of every probe of the scene.
///
/// # Errors
/// [`crate::Error::Scene`] for a point outside the body.
pub(super) fn probe_rows(
    scene: &Scene,
    mesh: &Mesh,
    dofs: &DofMap,
) -> Result<(Vec<ProbeRows>, NodalRows)> {
    let mut probes = Vec::with_capacity(scene.probes.len());
    let mut all = NodalRows::new();
    for (i, probe) in scene.probes.iter().enumerate() {
        let at = std::array::from_fn(|c| match c < mesh.dimension {
            true => probe.at.get(c).copied().unwrap_or(0.0),
            false => 0.0,
        });
        let Some((cell, values)) = locate(mesh, at) else {
            return Err(scene_error(
                &format!("probes[{i}].at"),
                format!("{:?}", probe.at),
                "a point of the body".to_string(),
            ));
        };
        let mut rows = Vec::with_capacity(mesh.dimension);
        for axis in 0..mesh.dimension {
            let mut entries = Vec::new();
            let mut row = Vec::new();
            for (&node, value) in mesh.cell(cell).iter().zip(values) {
                let mut along = Vector3::zeros();
                along[axis] = value;
                add_components(dofs, node, along, &mut entries);
                row.push((node, along));
            }
            rows.push(merged(entries));
            all.push(row);
        }
        probes.push(ProbeRows {
            name: probe.name.clone(),
            at,
            rows,
        });
    }
    Ok((probes, all))
}

/// The first cell that contains a point, and the values of its shape functions there.
fn locate(mesh: &Mesh, at: [f64; 3]) -> Option<(usize, [f64; MOST_NODES])> {
    // Points on the boundary may lie outside by rounding; relative to the size of the cell.
    const OUTSIDE: f64 = 1e-9;
    // Below this a barycentric coordinate is zero: a probe at a node reads that node alone.
    const NEGLIGIBLE: f64 = 1e-12;
    mesh.cells().enumerate().find_map(|(c, cell)| {
        let coordinates = Cell::new(mesh, cell).barycentric(mesh, cell, at)?;
        // Written so that a coordinate that is not a number lies nowhere.
        let is_inside = coordinates[..=mesh.dimension]
            .iter()
            .all(|&value| value >= -OUTSIDE);
        is_inside.then(|| {
            let kept = coordinates.map(|value| if value.abs() < NEGLIGIBLE { 0.0 } else { value });

            let mut values = [0.0; MOST_NODES];
            for (node, value) in values.iter_mut().take(cell.len()).enumerate() {
                *value = (mesh.element.shape)(node, &kept);
            }
            (c, values)
        })
    })
}

/// Appends the components of a vector at a node along its free directions, those that vanish left out.
fn add_components(dofs: &DofMap, node: u32, vector: Vector3<f64>, entries: &mut Vec<(usize, f64)>) {
    for (dof, axis) in dofs.range(node).zip(dofs.frame(node)) {
        let value = Vector3::from(*axis).dot(&vector);
        if value != 0.0 {
            entries.push((dof, value));
        }
    }
}

/// Sorts by component and adds entries of the same component (followers and leader).
fn merged(mut entries: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    // Stable: equal components are added in the order of the nodes, so that equal input gives equal bits.
    entries.sort_by_key(|(dof, _)| *dof);
    entries.dedup_by(|next, kept| {
        let is_same = next.0 == kept.0;
        if is_same {
            kept.1 += next.1;
        }
        is_same
    });
    entries
}
