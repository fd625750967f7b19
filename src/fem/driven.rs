//! How the motion of driven parts enters the equations of the free components.
//!
//! The displacement of a body whose parts move by given amounts `d` is split, `u = u~ + L d`: `L` is the static shape of a unit of
//! each motion with the contact free, `L = -B_ff^-1 B_fd` on the free components and the motion itself on the driven ones. Then
//! B drops out, and a motion enters as a column like a load, whose intensity is its velocity `v = d'`:
//!
//! ```text
//! A u~' + B u~ + E Lambda = F f + G v,   G = -(A_ff L + A_fd)
//! ```
//!
//! `G` vanishes where the motions move the body as a whole. Forces of the motions, their share of the energies and what loads and
//! probes see of them follow from `G` and a few small matrices. Nothing else of the body is needed.

use super::cell::Cell;
use super::dofs::DofMap;
use super::forms::Forms;
use super::held::motions;
use super::operators::OperatorPair;
use crate::error::Result;
use crate::linalg::SparseCholesky;
use crate::mesh::Mesh;
use crate::scene::Scene;
use faer::ColMut;
use nalgebra::Vector3;

/// Share of the diagonal of A below which an entry of `G` is rounding.
const ROUNDING: f64 = 1e-11;

/// How the motions of driven parts enter.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drives {
    /// Names of the inputs.
    pub names: Vec<String>,
    /// `G`: per motion the free components (ascending) and values, N s/m; empty where the motion moves the body as a whole.
    pub columns: Vec<Vec<(usize, f64)>>,
    /// Contact velocities by a unit velocity of a motion, at fixed `u~`: per motion one value per contact component.
    pub on_contact: Vec<Vec<f64>>,
    /// What loads see: per motion one value per load.
    pub on_loads: Vec<Vec<f64>>,
    /// What probes see: per motion one value per probe and axis.
    pub on_probes: Vec<Vec<f64>>,
    /// `[L; I]^T A [L; I]` and `[L; I]^T B [L; I]`, motions by motions, row by row.
    pub viscosity: Vec<f64>,
    pub elasticity: Vec<f64>,
    /// Fields `L` on the free components.
    pub shapes: Vec<Vec<f64>>,
    /// The motions at all nodes of driven parts: node and displacement by a unit.
    pub fields: Vec<Vec<(u32, [f64; 3])>>,
}

/// Nodal shares of loads and rows of probes on all nodes, held ones too: per load or row pairs of node and vector.
pub(super) type NodalRows = Vec<Vec<(u32, Vector3<f64>)>>;

impl Drives {
    /// # Errors
    /// [`crate::Error::NotPositiveDefinite`] when the body is not held with its contact free.
    pub(super) fn new(
        scene: &Scene,
        mesh: &Mesh,
        dofs: &DofMap,
        forms: &Forms,
        (operators, pins): (&OperatorPair, &[usize]),
        places: &[[f64; 3]],
        (loads, probes): (&NodalRows, &NodalRows),
    ) -> Result<Drives> {
        let mut drives = Drives::default();
        let motions = motions(scene)?;
        if motions.is_empty() {
            return Ok(drives);
        }
        let cholesky = SparseCholesky::new(&operators.col_ptr, &operators.row_idx, places)?;
        let (mut factor, mut memory) = (vec![0.0; cholesky.len()], cholesky.scratch(1));
        let what = "the elasticity with the contact free (is the body clamped or driven so that it is held?)";
        // of the shapes that differ by a motion that contact holds, the one that vanishes at the pins
        let mut elasticity = operators.b.clone();
        for pin in pins {
            elasticity[operators.col_ptr[dofs.contact_start() + pin]] *= 2.0;
        }
        cholesky.factor(what, &elasticity, &mut factor, &mut memory)?;
        // whole fields [L; I], and A and B times them
        let mut whole: Vec<Vec<Vector3<f64>>> = Vec::new();
        let mut images: Vec<[Vec<Vector3<f64>>; 2]> = Vec::new();
        for motion in &motions {
            let mut field = vec![Vector3::zeros(); mesh.nodes.len()];
            let mut given = Vec::new();
            for &node in mesh.faces(motion.part, &motion.path)?.flatten() {
                let by = motion.at(mesh.nodes[node as usize]);
                field[node as usize] = by;
                given.push((node, by.into()));
            }
            given.sort_by_key(|(node, _)| *node);
            given.dedup_by_key(|(node, _)| *node);
            let [_, forces] = apply(mesh, forms, &field);
            let mut shape = project(mesh, dofs, &forces);
            shape.iter_mut().for_each(|value| *value = -*value);
            cholesky.solve(
                &factor,
                ColMut::from_slice_mut(&mut shape).as_mat_mut(),
                &mut memory,
            );
            for node in 0..mesh.nodes.len() as u32 {
                field[node as usize] += Vector3::from(dofs.vector(node, &shape));
            }
            let both = apply(mesh, forms, &field);
            let column = project(mesh, dofs, &both[0]);
            let size = |dof: usize| operators.a[operators.col_ptr[dof]] * largest(&field);
            drives.columns.push(
                column
                    .iter()
                    .enumerate()
                    .filter(|(dof, value)| value.abs() > ROUNDING * size(*dof))
                    .map(|(dof, value)| (dof, -value))
                    .collect(),
            );
            drives.names.push(motion.name.to_owned());
            drives
                .on_contact
                .push(shape[dofs.contact_start()..].to_vec());
            let seen = |rows: &NodalRows| -> Vec<f64> {
                let of = |row: &Vec<(u32, Vector3<f64>)>| {
                    row.iter().map(|(n, v)| v.dot(&field[*n as usize])).sum()
                };
                rows.iter().map(of).collect()
            };
            drives.on_loads.push(seen(loads));
            drives.on_probes.push(seen(probes));
            drives.shapes.push(shape);
            drives.fields.push(given);
            whole.push(field);
            images.push(both);
        }
        // a motion of the body as a whole leaves rounding, which would count as a force
        let most = |diagonal: &[f64]| {
            let entries = operators.col_ptr[..operators.n].iter();
            entries.fold(0.0_f64, |most, at| most.max(diagonal[*at]))
        };
        let (of_a, of_b) = (most(&operators.a), most(&operators.b));
        let length = |field: &[Vector3<f64>]| -> f64 {
            let squares = field.iter().map(|v| v.norm_squared());
            squares.sum::<f64>().sqrt()
        };
        for row in &whole {
            for ([a, b], column) in images.iter().zip(&whole) {
                let product = |image: &[Vector3<f64>], size: f64| -> f64 {
                    let sum: f64 = row.iter().zip(image).map(|(x, y)| x.dot(y)).sum();
                    let rounding = ROUNDING * size * length(row) * length(column);
                    if sum.abs() > rounding { sum } else { 0.0 }
                };
                drives.viscosity.push(product(a, of_a));
                drives.elasticity.push(product(b, of_b));
            }
        }
        Ok(drives)
    }

    /// Number of motions.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Whether nothing is driven.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// The columns that are not zero, in the order of the motions.
    pub fn force_columns(&self) -> impl Iterator<Item = &Vec<(usize, f64)>> {
        self.columns.iter().filter(|column| !column.is_empty())
    }
}

fn largest(field: &[Vector3<f64>]) -> f64 {
    field.iter().fold(0.0, |most, v| v.amax().max(most))
}

/// Forces of A and B at all nodes (global axes; a follower's are those of its leader) for vectors at all nodes.
fn apply(mesh: &Mesh, forms: &Forms, field: &[Vector3<f64>]) -> [Vec<Vector3<f64>>; 2] {
    let mut sums = [
        vec![Vector3::zeros(); field.len()],
        vec![Vector3::zeros(); field.len()],
    ];
    for (cell, nodes) in mesh.cells().enumerate() {
        if nodes.iter().all(|n| field[*n as usize] == Vector3::zeros()) {
            continue;
        }
        let shapes = Cell::new(mesh, nodes);
        let forms = forms.of(cell);
        for (a, row) in nodes.iter().enumerate() {
            for (b, column) in nodes.iter().enumerate() {
                let blocks = shapes.blocks(a, b, &forms);
                for (sum, block) in sums.iter_mut().zip(blocks) {
                    sum[mesh.leader[*row as usize] as usize] += block * field[*column as usize];
                }
            }
        }
    }
    sums
}

/// Components of nodal forces along the free directions.
fn project(mesh: &Mesh, dofs: &DofMap, forces: &[Vector3<f64>]) -> Vec<f64> {
    let mut out = vec![0.0; dofs.len()];
    for (node, leader) in mesh.leader.iter().enumerate() {
        if *leader as usize != node {
            continue;
        }
        for (dof, axis) in dofs.range(*leader).zip(dofs.frame(*leader)) {
            out[dof] += Vector3::from(*axis).dot(&forces[node]);
        }
    }
    out
}
