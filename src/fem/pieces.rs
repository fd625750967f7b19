//! Pieces of a body that share no node: each must be held.

use super::dofs::DofMap;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::message::cut;
use crate::refusal::scene_error;
use std::collections::BTreeSet;

/// Share of the size of a body up to which two nodes stand at the same place.
const SAME: f64 = 1e-9;

/// A piece of the mesh that no clamped or driven node holds can move freely: A is singular on it.
pub(super) fn refuse_loose_pieces(mesh: &Mesh, dofs: &DofMap) -> Result<()> {
    let pieces = mesh.pieces();
    let all = mesh.cell_nodes.iter().map(|node| pieces[*node as usize]);
    // whether a body in one piece is held, its matrices tell
    if all.clone().min() == all.max() {
        return Ok(());
    }
    let mut is_held = vec![false; pieces.len()];
    for &node in &mesh.cell_nodes {
        is_held[pieces[node as usize] as usize] |= dofs.is_held(node);
    }
    let is_loose = |cell: &&[u32]| !is_held[pieces[cell[0] as usize] as usize];
    let Some(cell) = mesh.cells().find(is_loose) else {
        return Ok(());
    };
    let piece = pieces[cell[0] as usize];
    let mut regions: Vec<&str> = Vec::new();
    let mut cells = 0;
    for (cell, region) in mesh.cells().zip(&mesh.cell_regions) {
        if pieces[cell[0] as usize] == piece {
            cells += 1;
            let region = mesh.regions[*region as usize].as_str();
            if !regions.contains(&region) {
                regions.push(region);
            }
        }
    }
    // nodes that stand at the same place but for the digits of a file
    let [low, high] = mesh.bounds();
    let size = (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max);
    let key = |node: u32| mesh.nodes[node as usize].map(|x| (x / (SAME * size)).round() as i64);
    let places = |is_own: bool| -> BTreeSet<[i64; 3]> {
        let nodes = mesh.cell_nodes.iter();
        let is_wanted = |node: &&u32| (pieces[**node as usize] == piece) == is_own;
        nodes.filter(is_wanted).map(|node| key(*node)).collect()
    };
    let touching = places(true).intersection(&places(false)).count();
    let found = format!(
        "parts that hold nothing of the {cells} cells of {} at {:?}, which share no node with the rest of the body{}",
        cut(&format!("{regions:?}")),
        &mesh.centroid(cell)[..mesh.dimension],
        match touching {
            0 => String::new(),
            n => format!(" although {n} of their nodes stand where it has one too"),
        }
    );
    let allowed = "a body that hangs together (in Gmsh: fragment or Coherence), or a clamped or driven part on every piece";
    Err(scene_error("clamped", found, allowed.to_owned()))
}
