//! Pieces of a mesh: cells that hang together by common nodes.

use super::Mesh;

impl Mesh {
    /// The piece of every node, numbered from 0 in the order of their first nodes; nodes of no cell are pieces of their own.
    pub fn pieces(&self) -> Vec<u32> {
        let mut parent: Vec<u32> = self.leader.clone();
        for cell in self.cells() {
            let first = root(&mut parent, cell[0]);
            for &node in &cell[1..] {
                let other = root(&mut parent, node);
                // towards the smaller number, so that the numbers do not depend on the order of the cells
                let first = root(&mut parent, first);
                parent[first.max(other) as usize] = first.min(other);
            }
        }
        let mut next = 0;
        let mut number = vec![u32::MAX; parent.len()];
        (0..parent.len() as u32)
            .map(|node| {
                let root = root(&mut parent, node) as usize;
                if number[root] == u32::MAX {
                    number[root] = next;
                    next += 1;
                }
                number[root]
            })
            .collect()
    }
}

/// The node that stands for the piece of a node; ways to it are halved as they are walked.
fn root(parent: &mut [u32], mut node: u32) -> u32 {
    while parent[node as usize] != node {
        let above = parent[parent[node as usize] as usize];
        parent[node as usize] = above;
        node = above;
    }
    node
}
