//! Sections of MSH 2.2: a list of nodes; elements one by one, each with its group and its entity. An element in two groups is
//! written twice.

use super::block::Block;
use super::cursor::{Cursor, Encoding};
use super::fault::Outcome;
use super::types::ElementType;
use std::collections::BTreeMap;

/// `$Nodes`.
pub(super) fn nodes(from: &mut Cursor) -> Outcome<Vec<(u64, [f64; 3])>> {
    let count = count(from, "the number of nodes")?;
    let count = from.checked(count, 4, 28, "nodes")?;
    let mut nodes = Vec::with_capacity(count);
    for _ in 0..count {
        let tag = tag(from, "the number of a node")?;
        let mut place = [0.0; 3];
        for coordinate in &mut place {
            *coordinate = from.double("a coordinate of a node")?;
        }
        nodes.push((tag, place));
    }
    Ok(nodes)
}

/// A count, which is text in files of both encodings.
fn count(from: &mut Cursor, what: &str) -> Outcome<u64> {
    let count = from.text_int(what)?;
    from.end_of_line();
    u64::try_from(count).map_err(|_| from.fault(count, what))
}

fn tag(from: &mut Cursor, what: &str) -> Outcome<u64> {
    let tag = from.int(what)?;
    u64::try_from(tag).map_err(|_| from.fault(tag, format!("{what}: a positive number")))
}

/// The blocks that elements go to.
#[derive(Default)]
struct Blocks {
    blocks: Vec<Block>,
    /// By type, group and entity.
    places: BTreeMap<(i64, i64, i64), usize>,
}

impl Blocks {
    fn of(&mut self, of: &'static ElementType, tags: &[i64]) -> &mut Block {
        let group = tags.first().map_or(0, |group| group.saturating_abs());
        let entity = tags.get(1).copied().unwrap_or(0);
        let next = self.blocks.len();
        let place = *self
            .places
            .entry((of.number, group, entity))
            .or_insert(next);
        if place == next {
            self.blocks.push(Block {
                of,
                entity,
                groups: if group == 0 { Vec::new() } else { vec![group] },
                tags: Vec::new(),
                nodes: Vec::new(),
            });
        }
        &mut self.blocks[place]
    }
}

/// `$Elements`.
pub(super) fn elements(from: &mut Cursor) -> Outcome<Vec<Block>> {
    let total = count(from, "the number of elements")?;
    let total = from.checked(total, 4, 8, "elements")? as u64;
    let mut blocks = Blocks::default();
    let mut found = 0;
    while found < total {
        // a text has the type, the number of tags behind the number of the element; a binary file once for several elements
        let (first, of, together, tags) = match from.encoding {
            Encoding::Text => {
                let number = tag(from, "the number of an element")?;
                let of = kind(from)?;
                (Some(number), of, 1, tag(from, "a number of tags")?)
            }
            Encoding::Binary { .. } => {
                let of = kind(from)?;
                let together = tag(from, "a number of elements")?;
                (None, of, together, tag(from, "a number of tags")?)
            }
        };
        let tags = from.checked(tags, 1, 4, "tags of an element")?;
        let numbers = 1 + tags + of.nodes;
        let together = from.checked(together, numbers - 1, 4 * numbers, "elements")? as u64;
        if together == 0 || together > total - found {
            let left = total - found;
            return Err(from.fault(
                format!("{together} elements together"),
                format!("1 to {left}"),
            ));
        }
        let mut values = vec![0; tags];
        for _ in 0..together {
            let number = match first {
                Some(number) => number,
                None => tag(from, "the number of an element")?,
            };
            for value in &mut values {
                *value = from.int("a tag of an element")?;
            }
            let block = blocks.of(of, &values);
            block.tags.push(number);
            for _ in 0..of.nodes {
                block.nodes.push(tag(from, "a node of an element")?);
            }
        }
        found += together;
    }
    Ok(blocks.blocks)
}

fn kind(from: &mut Cursor) -> Outcome<&'static ElementType> {
    let number = from.int("a type of elements")?;
    ElementType::of(number).ok_or_else(|| {
        let allowed = "types of lines, triangles and tetrahedra: 1, 2, 4, 8, 9, 11";
        from.fault(format!("an element of type {number}"), allowed)
    })
}
