//! Parts of the boundary: the sides of cells that the elements of a physical group stand for.
//!
//! A group may hold what is no boundary, as the border between two regions. It is no part then, and the mesh keeps the reason
//! for whoever names it.

use super::cells::Cells;
use super::contents::Contents;
use super::fault::{Fault, Outcome};
use super::names::Names;
use super::types::entity_name;
use std::collections::{BTreeMap, BTreeSet};

/// Mark of the corner that a side of a triangle does not have.
const NONE: u32 = u32::MAX;

/// The sides of all cells, by their corners.
struct Sides {
    /// Corners ascending, cell, side of the cell.
    all: Vec<([u32; 3], u32, u8)>,
}

/// Parts, and why other groups are none.
pub(super) struct Parts {
    pub faces: BTreeMap<String, Vec<u32>>,
    pub unusable: BTreeMap<String, String>,
}

impl Parts {
    /// The parts of a file.
    pub fn new(contents: &Contents, names: &Names, cells: &Cells) -> Outcome<Parts> {
        let dimension = cells.element.dimension;
        let sides = Sides::new(cells)?;
        let mut found: BTreeMap<String, BTreeSet<(u32, u8)>> = BTreeMap::new();
        let mut unusable: BTreeMap<String, String> = BTreeMap::new();
        for block in contents
            .blocks
            .iter()
            .filter(|b| b.of.dimension + 1 == dimension)
        {
            if block.groups.is_empty() || block.tags.is_empty() {
                continue;
            }
            if !block.of.is_face_of(cells.element) {
                let found = format!(
                    "$Elements: element {} on {} {} is a {} (type {}), beside cells of {}",
                    block.tags[0],
                    entity_name(block.of.dimension),
                    block.entity,
                    block.of.name,
                    block.of.number,
                    cells.element.name
                );
                return Err(Fault::new(found, "sides of the cells"));
            }
            let groups: Vec<String> = block
                .groups
                .iter()
                .map(|g| names.of(block.of.dimension, *g))
                .collect();
            for (tag, nodes) in block
                .tags
                .iter()
                .zip(block.nodes.chunks_exact(block.of.nodes))
            {
                let place = match sides.find(cells, nodes) {
                    Ok(place) => place,
                    Err(why) => {
                        let reason = format!("element {tag} {why}");
                        for group in &groups {
                            unusable
                                .entry(group.clone())
                                .or_insert_with(|| reason.clone());
                        }
                        continue;
                    }
                };
                check_midsides(cells, place, *tag, nodes)?;
                for group in &groups {
                    found.entry(group.clone()).or_default().insert(place);
                }
            }
        }
        for name in names.listed(dimension - 1) {
            if !found.contains_key(name) {
                let reason = || "the file has no elements of it".to_owned();
                unusable.entry(name.clone()).or_insert_with(reason);
            }
        }
        found.retain(|name, _| !unusable.contains_key(name));
        let faces = found.into_iter().map(|(name, places)| {
            let nodes = places.into_iter().flat_map(|place| face(cells, place));
            (name, nodes.collect())
        });
        Ok(Parts {
            faces: faces.collect(),
            unusable,
        })
    }
}

impl Sides {
    /// # Errors
    /// More than two cells at one side.
    fn new(cells: &Cells) -> Outcome<Sides> {
        let element = cells.element;
        let mut all = Vec::with_capacity(element.faces.len() * cells.cell_regions.len());
        for (number, cell) in (0..).zip(cells.cell_nodes.chunks_exact(element.nodes)) {
            for (side, corners) in (0..).zip(element.faces) {
                let mut key = [NONE; 3];
                for (to, &corner) in key.iter_mut().zip(*corners) {
                    *to = cell[corner];
                }
                key.sort_unstable();
                all.push((key, number, side));
            }
        }
        all.sort_unstable();
        match all.windows(3).find(|three| three[0].0 == three[2].0) {
            None => Ok(Sides { all }),
            Some(three) => {
                let found = format!(
                    "$Elements: three cells share one side at {}",
                    cells.place(three[0].0[0])
                );
                Err(Fault::new(found, "cells that do not overlap"))
            }
        }
    }

    /// The one side of a cell that these nodes stand for, or why there is none.
    fn find(&self, cells: &Cells, nodes: &[u64]) -> Result<(u32, u8), String> {
        let mut key = [NONE; 3];
        for (to, tag) in key.iter_mut().zip(&nodes[..cells.element.dimension]) {
            *to = cells
                .number(*tag)
                .ok_or_else(|| format!("has the node {tag}, which no cell has"))?;
        }
        key.sort_unstable();
        let at = self.all.partition_point(|(other, ..)| *other < key);
        let mut same = self.all[at..]
            .iter()
            .take_while(|(other, ..)| *other == key);
        match (same.next(), same.next()) {
            (Some((_, cell, side)), None) => Ok((*cell, *side)),
            (Some(_), Some(_)) => Err("lies inside the body, between two cells".to_owned()),
            (None, _) => Err("is the side of no cell".to_owned()),
        }
    }
}

/// Nodes of a side: corners and midside nodes in the order of the element.
fn face(cells: &Cells, (cell, side): (u32, u8)) -> impl Iterator<Item = u32> {
    let element = cells.element;
    let start = cell as usize * element.nodes;
    let cell = &cells.cell_nodes[start..start + element.nodes];
    let corners = element.faces[side as usize];
    let middle = move |[i, j]: &[usize; 2]| {
        let ends = [corners[*i], corners[*j]];
        let is_between = |[p, q]: &[usize; 2]| [*p, *q] == ends || [*q, *p] == ends;
        let place = element.midsides.iter().position(is_between).unwrap_or(0);
        cell[element.corners() + place]
    };
    corners
        .iter()
        .map(|&corner| cell[corner])
        .chain(element.face_midsides.iter().map(middle))
}

/// A second-order side has the midside nodes of its cell.
fn check_midsides(cells: &Cells, place: (u32, u8), tag: u64, nodes: &[u64]) -> Outcome<()> {
    let corners = cells.element.dimension;
    let own: BTreeSet<u32> = face(cells, place).skip(corners).collect();
    for node in &nodes[corners..] {
        if cells
            .number(*node)
            .is_none_or(|number| !own.contains(&number))
        {
            let found = format!(
                "$Elements: element {tag} has the midside node {node}, the cell beside it another"
            );
            return Err(Fault::new(
                found,
                "sides that share the nodes of their cells",
            ));
        }
    }
    Ok(())
}
