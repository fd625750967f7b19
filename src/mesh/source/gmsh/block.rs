//! Elements as an MSH file lists them.

use super::types::ElementType;

/// Elements of one type, entity and set of groups.
#[derive(Debug)]
pub(super) struct Block {
    pub of: &'static ElementType,
    /// Number of the geometric entity.
    pub entity: i64,
    /// Numbers of its physical groups, ascending, without sign.
    pub groups: Vec<i64>,
    /// Numbers of the elements.
    pub tags: Vec<u64>,
    /// Numbers of their nodes, `of.nodes` each.
    pub nodes: Vec<u64>,
}
