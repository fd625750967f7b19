//! Names of physical groups: those of dimension d are regions, those of dimension d - 1 parts.

use super::block::Block;
use super::contents::Contents;
use super::fault::{Fault, Outcome};
use super::types::entity_name;
use crate::mesh::source::BODY;
use crate::message::cut;
use std::collections::{BTreeMap, BTreeSet};

/// Names of the groups of a file: that of `$PhysicalNames`, or else the number.
pub(super) struct Names<'a> {
    given: &'a BTreeMap<(usize, i64), String>,
}

impl<'a> Names<'a> {
    /// Refuses two groups of one dimension that are called alike.
    pub fn new(contents: &'a Contents) -> Outcome<Names<'a>> {
        let names = Names {
            given: &contents.names,
        };
        let in_use = contents.blocks.iter().flat_map(|block| {
            let dimension = block.of.dimension;
            block.groups.iter().map(move |group| (dimension, *group))
        });
        let groups: BTreeSet<(usize, i64)> = in_use.chain(contents.names.keys().copied()).collect();
        let mut known = BTreeMap::new();
        for (dimension, group) in groups {
            let name = names.of(dimension, group);
            if let Some(other) = known.insert((dimension, name.clone()), group) {
                let found = format!(
                    "$PhysicalNames: groups {other} and {group} of dimension {dimension} are both called {:?}",
                    cut(&name)
                );
                return Err(Fault::new(
                    found,
                    "a name that no other group of the dimension has",
                ));
            }
        }
        Ok(names)
    }

    /// Name of a group.
    pub fn of(&self, dimension: usize, group: i64) -> String {
        let given = self.given.get(&(dimension, group));
        given.cloned().unwrap_or_else(|| group.to_string())
    }

    /// Names of the groups of a dimension that `$PhysicalNames` lists.
    pub fn listed(&self, dimension: usize) -> impl Iterator<Item = &String> {
        let range = (dimension, i64::MIN)..=(dimension, i64::MAX);
        self.given.range(range).map(|(_, name)| name)
    }

    /// The region of a block of cells: its one group, or [`BODY`] where no cell of the file has one.
    pub fn region(&self, block: &Block, contents: &Contents) -> Outcome<String> {
        let dimension = block.of.dimension;
        let refuse = |found: String| {
            let place = format!("$Elements: {} {}", entity_name(dimension), block.entity);
            Err(Fault::new(
                format!("{place} {found}"),
                "cells in one physical group each, or no group at all",
            ))
        };
        match block.groups[..] {
            [group] => Ok(self.of(dimension, group)),
            [a, b, ..] => refuse(format!(
                "is in two physical groups, {:?} and {:?}",
                cut(&self.of(dimension, a)),
                cut(&self.of(dimension, b))
            )),
            [] => {
                let mut cells = contents
                    .blocks
                    .iter()
                    .filter(|b| b.of.dimension == dimension);
                match cells.find(|b| !b.groups.is_empty()) {
                    None => Ok(BODY.to_owned()),
                    Some(other) => refuse(format!(
                        "is in no physical group, while {} {} is in {:?}",
                        entity_name(dimension),
                        other.entity,
                        cut(&self.of(dimension, other.groups[0]))
                    )),
                }
            }
        }
    }
}
