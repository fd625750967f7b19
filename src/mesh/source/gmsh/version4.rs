//! Sections of MSH 4.1: entities with their groups, nodes and elements in blocks by entity.

use super::block::Block;
use super::cursor::Cursor;
use super::fault::Outcome;
use super::types::ElementType;
use std::collections::BTreeMap;

/// Physical groups of the geometric entities, by dimension and number.
#[derive(Debug, Default)]
pub(super) struct Entities {
    groups: BTreeMap<(usize, i64), Vec<i64>>,
    is_known: bool,
}

impl Entities {
    /// `$Entities`.
    pub fn read(&mut self, from: &mut Cursor) -> Outcome<()> {
        self.read_all(from, false)
    }

    /// `$PartitionedEntities`: the pieces of the entities, which have groups of their own.
    pub fn read_parts(&mut self, from: &mut Cursor) -> Outcome<()> {
        from.size("the number of partitions")?;
        let ghosts = from.size("the number of ghost entities")?;
        let ghosts = from.checked(ghosts, 2, 8, "ghost entities")?;
        for _ in 0..ghosts {
            from.int("a ghost entity")?;
            from.int("the partition of a ghost entity")?;
        }
        self.read_all(from, true)
    }

    fn read_all(&mut self, from: &mut Cursor, is_partitioned: bool) -> Outcome<()> {
        self.is_known = true;
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = from.size("the number of entities")?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            let coordinates = if dimension == 0 { 3 } else { 6 };
            let numbers = 2 + coordinates;
            let bytes = 4 + 8 * coordinates + from.size_bytes();
            let count = from.checked(count, numbers, bytes, "entities")?;
            for _ in 0..count {
                let entity = from.int("the number of an entity")?;
                if is_partitioned {
                    from.int("the dimension of a parent")?;
                    from.int("the number of a parent")?;
                    skip_list(from, "partitions of an entity")?;
                }
                for _ in 0..coordinates {
                    from.double("the extent of an entity")?;
                }
                let mut groups = list(from, "groups of an entity")?;
                groups.iter_mut().for_each(|g| *g = g.saturating_abs());
                groups.sort_unstable();
                groups.dedup();
                if dimension > 0 {
                    skip_list(from, "borders of an entity")?;
                }
                self.groups.insert((dimension, entity), groups);
            }
        }
        Ok(())
    }
}

fn list(from: &mut Cursor, what: &str) -> Outcome<Vec<i64>> {
    let count = from.size(what)?;
    let count = from.checked(count, 1, 4, what)?;
    (0..count).map(|_| from.int(what)).collect()
}

fn skip_list(from: &mut Cursor, what: &str) -> Outcome<()> {
    let count = from.size(what)?;
    let count = from.checked(count, 1, 4, what)?;
    for _ in 0..count {
        from.int(what)?;
    }
    Ok(())
}

/// Total of the blocks that follow: number of blocks, number of things in them.
fn head(from: &mut Cursor, what: &str) -> Outcome<(u64, u64)> {
    let blocks = from.size("the number of blocks")?;
    let total = from.size(what)?;
    from.size("the smallest number in use")?;
    from.size("the largest number in use")?;
    Ok((blocks, total))
}

/// `$Nodes`.
pub(super) fn nodes(from: &mut Cursor) -> Outcome<Vec<(u64, [f64; 3])>> {
    let (blocks, total) = head(from, "the number of nodes")?;
    let each = 24 + from.size_bytes();
    let total = from.checked(total, 4, each, "nodes")?;
    let mut nodes: Vec<(u64, [f64; 3])> = Vec::with_capacity(total);
    for _ in 0..blocks {
        let dimension = from.int("the dimension of an entity")?;
        from.int("the number of an entity")?;
        let is_parametric = from.int("0, or 1 for nodes with parameters")?;
        let count = from.size("the number of nodes in a block")?;
        let count = from.checked(count, 4, each, "nodes in a block")?;
        if nodes.len() + count > total {
            let found = format!("more nodes in the blocks than the {total} of the section");
            return Err(from.fault(found, "as many nodes as the section says"));
        }
        let first = nodes.len();
        for _ in 0..count {
            nodes.push((from.size("the number of a node")?, [0.0; 3]));
        }
        let parameters = match (is_parametric, dimension) {
            (0, 0..=3) => 0,
            (1, 0..=3) => dimension,
            _ => {
                let found =
                    format!("a block with dimension {dimension} and parameters {is_parametric}");
                return Err(from.fault(found, "a dimension up to 3, parameters 0 or 1"));
            }
        };
        for (_, place) in &mut nodes[first..] {
            for coordinate in place {
                *coordinate = from.double("a coordinate of a node")?;
            }
            for _ in 0..parameters {
                from.double("a parameter of a node")?;
            }
        }
    }
    if nodes.len() != total {
        let found = format!("{} nodes in the blocks", nodes.len());
        return Err(from.fault(found, format!("{total}, as the section says")));
    }
    Ok(nodes)
}

/// `$Elements`.
pub(super) fn elements(from: &mut Cursor, entities: &Entities) -> Outcome<Vec<Block>> {
    let (count, total) = head(from, "the number of elements")?;
    let mut blocks = Vec::new();
    let mut found = 0u64;
    for _ in 0..count {
        let dimension = from.int("the dimension of an entity")?;
        let entity = from.int("the number of an entity")?;
        let number = from.int("a type of elements")?;
        let Some(of) = ElementType::of(number) else {
            let found = format!("elements of type {number} on entity {entity}");
            return Err(from.fault(
                found,
                "types of lines, triangles and tetrahedra: 1, 2, 4, 8, 9, 11",
            ));
        };
        let count = from.size("the number of elements in a block")?;
        let numbers = 1 + of.nodes;
        let count = from.checked(
            count,
            numbers,
            numbers * from.size_bytes(),
            "elements in a block",
        )?;
        if usize::try_from(dimension) != Ok(of.dimension) {
            let found = format!("a {} on entity {entity} of dimension {dimension}", of.name);
            return Err(from.fault(found, format!("dimension {}", of.dimension)));
        }
        let groups = match entities.groups.get(&(of.dimension, entity)) {
            Some(groups) => groups.clone(),
            None if !entities.is_known => Vec::new(),
            None => {
                let found = format!("elements on entity {entity} of dimension {dimension}");
                return Err(from.fault(found, "an entity of $Entities"));
            }
        };
        let mut block = Block {
            of,
            entity,
            groups,
            tags: Vec::with_capacity(count),
            nodes: Vec::with_capacity(count * of.nodes),
        };
        for _ in 0..count {
            block.tags.push(from.size("the number of an element")?);
            for _ in 0..of.nodes {
                block.nodes.push(from.size("a node of an element")?);
            }
        }
        found += count as u64;
        blocks.push(block);
    }
    match found == total {
        true => Ok(blocks),
        false => {
            let found = format!("{found} elements in the blocks");
            Err(from.fault(found, format!("{total}, as the section says")))
        }
    }
}
