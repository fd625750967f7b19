//! The memory of a body: one operator per relaxation time, over all regions that have it.

use super::dofs::DofMap;
use super::driven::Drives;
use super::forms::Forms;
use super::operators::{BranchOperator, OperatorPair};
use crate::error::Result;
use crate::mesh::Mesh;
use crate::message::cut;
use crate::refusal::scene_error;
use crate::scene::Scene;

/// The operators of all branches, ascending in their relaxation times.
pub(super) fn branch_operators(mesh: &Mesh, dofs: &DofMap, forms: &Forms) -> Vec<BranchOperator> {
    let mut operators = Vec::new();
    // an assembly makes two
    for times in forms.times().chunks(2) {
        let pair = OperatorPair::from_elements(mesh, dofs, &forms.of_branches(times));
        let values = [pair.a, pair.b].into_iter();
        let branches = times.iter().zip(values);
        operators.extend(branches.map(|(&tau, c)| BranchOperator { tau, c }));
    }
    operators
}

/// The memory of what a driven part strains is not followed, nor what of it depends on a material that stays free: a motion must
/// move such a body as a whole.
///
/// # Errors
/// [`crate::Error::Scene`] that names the motion.
pub(super) fn refuse_strained_memory(scene: &Scene, drives: &Drives, forms: &Forms) -> Result<()> {
    // a motion of the whole body stores nothing
    let stores = |i: &usize| drives.elasticity[i * drives.len() + i] != 0.0;
    let Some(at) = (0..drives.len())
        .find(stores)
        .filter(|_| forms.have_memory() || scene.fidelity.free_material)
    else {
        return Ok(());
    };
    let name = &drives.names[at];
    let mut parts = scene.driven.iter();
    let part = parts.position(|driven| driven.directions.contains_key(name));
    let path = format!(
        "driven[{}].directions.{}",
        part.unwrap_or_default(),
        cut(name)
    );
    let (of, without) = match forms.have_memory() {
        true => ("with memory", "materials without memory"),
        false => ("whose material stays free", "no fidelity.free_material"),
    };
    let allowed = format!(
        "a motion of the whole body (nothing else clamped or driven against it), or {without}"
    );
    Err(scene_error(
        &path,
        format!("a motion that strains a body {of}"),
        allowed,
    ))
}
