//! The cells of a file as they stand there: of one element, with nodes that exist and one region each.

use super::block::Block;
use super::contents::Contents;
use super::fault::{Fault, Outcome};
use super::names::Names;
use super::types::entity_name;
use crate::element::Element;
use crate::mesh::MAX_NODES;
use std::collections::BTreeSet;

/// Cells as they stand in the file: places of nodes in its list.
pub(super) struct Found {
    pub nodes: Vec<u32>,
    pub regions: Vec<u32>,
    /// Number of the element, for messages.
    pub tags: Vec<u64>,
}

/// The one element of the cells: those of the highest dimension.
pub(super) fn element_of(contents: &Contents) -> Outcome<&'static Element> {
    let solid = |d: usize| {
        contents
            .blocks
            .iter()
            .filter(move |b| b.of.dimension == d && !b.tags.is_empty())
    };
    let dimension = if solid(3).next().is_some() { 3 } else { 2 };
    let mut blocks = solid(dimension);
    let Some(first) = blocks.next() else {
        let has_points = contents.blocks.iter().any(|b| !b.tags.is_empty());
        let found = match has_points {
            true => "$Elements: no triangles and no tetrahedra, only elements of lower dimension",
            false => "$Elements: no elements",
        };
        let allowed = "cells of a body: where a file has physical groups, Gmsh writes only what is in one, so give the surface (2D) \
                       or the volume (3D) a physical group";
        return Err(Fault::new(found, allowed));
    };
    let refuse = |block: &Block, also: &str| {
        let found = format!(
            "$Elements: element {} on {} {} is a {} (type {}){also}",
            block.tags[0],
            entity_name(dimension),
            block.entity,
            block.of.name,
            block.of.number
        );
        let allowed = "triangles or tetrahedra of first or second order, all of one type";
        Err(Fault::new(found, allowed))
    };
    let Some(element) = first.of.cell() else {
        return refuse(first, "");
    };
    match blocks.find(|block| block.of != first.of) {
        Some(other) => refuse(
            other,
            &format!(", beside the {} {}", first.of.name, first.tags[0]),
        ),
        None => Ok(element),
    }
}

/// Numbers of the nodes with their places in the file, ascending.
pub(super) fn sorted_tags(contents: &Contents) -> Outcome<Vec<(u64, u32)>> {
    if contents.nodes.len() > MAX_NODES as usize {
        let found = format!("$Nodes: {} nodes", contents.nodes.len());
        return Err(Fault::new(found, format!("at most {MAX_NODES}")));
    }
    let mut tags: Vec<(u64, u32)> = contents
        .nodes
        .iter()
        .map(|(tag, _)| *tag)
        .zip(0..)
        .collect();
    tags.sort_unstable();
    match tags.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => {
            let found = format!("$Nodes: node {} a second time", pair[0].0);
            Err(Fault::new(found, "each node once"))
        }
        None => Ok(tags),
    }
}

/// The cells of a file with their regions, and the names of these.
pub(super) fn collect(
    contents: &Contents,
    names: &Names,
    element: &'static Element,
    by_tag: &[(u64, u32)],
) -> Outcome<(Found, Vec<String>)> {
    let dimension = element.dimension;
    let blocks = || {
        contents
            .blocks
            .iter()
            .filter(|b| b.of.dimension == dimension)
    };
    let mut of_blocks = Vec::new();
    for block in blocks() {
        of_blocks.push(names.region(block, contents)?);
    }
    let regions: Vec<String> = BTreeSet::from_iter(&of_blocks)
        .into_iter()
        .cloned()
        .collect();
    let mut found = Found {
        nodes: Vec::new(),
        regions: Vec::new(),
        tags: Vec::new(),
    };
    for (block, region) in blocks().zip(&of_blocks) {
        let region = regions.binary_search(region).unwrap_or(0) as u32;
        for (tag, nodes) in block
            .tags
            .iter()
            .zip(block.nodes.chunks_exact(block.of.nodes))
        {
            for i in 0..element.nodes {
                let node = nodes[block.of.place(i)];
                let Ok(at) = by_tag.binary_search_by_key(&node, |(tag, _)| *tag) else {
                    let found = format!("$Elements: element {tag} has the node {node}");
                    return Err(Fault::new(found, "nodes that stand in $Nodes"));
                };
                found.nodes.push(by_tag[at].1);
            }
            found.regions.push(region);
            found.tags.push(*tag);
        }
    }
    if found.tags.len() > u32::MAX as usize {
        let found = format!("$Elements: {} cells", found.tags.len());
        return Err(Fault::new(found, "cells that can be numbered with 32 bits"));
    }
    Ok((found, regions))
}
