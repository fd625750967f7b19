//! Order of elimination by nested dissection of a mesh: halves first, what separates them last.
//!
//! A set of nodes is cut at its median along an axis; the nodes of one half that touch the other separate them. On a mesh this
//! needs fewer operations than a minimum degree ordering, the more so in space. George, SIAM J. Numer. Anal. 10 (1973). The
//! separator is the smallest one among the axes and the cuts directly before and after the median: it cuts the longest side,
//! and on a layered mesh it is a single layer.

/// Sets of at most this many nodes are no longer cut. They become dense blocks of the factor; smaller ones cost more in handling
/// than in arithmetic.
const LEAF: usize = 8;

/// Elimination order of the first `places.len()` dofs of a symmetric pattern (lower triangle by columns); `places[dof]` are the
/// coordinates of the node of a dof. The dofs of a node follow each other and stay together.
pub fn nested_dissection(col_ptr: &[usize], row_idx: &[usize], places: &[[f64; 3]]) -> Vec<usize> {
    let first = first_dofs(places);
    let mut dissection = Dissection {
        graph: Graph::new(col_ptr, row_idx, &first, places.len()),
        ranks: std::array::from_fn(|axis| ranks(places, &first, axis)),
        part: vec![OUTSIDE; first.len()],
        order: Vec::with_capacity(first.len()),
    };
    let mut nodes: Vec<u32> = (0..first.len() as u32).collect();
    dissection.cut(&mut nodes);
    let end = |node: usize| first.get(node + 1).copied().unwrap_or(places.len());
    let nodes = dissection.order.iter().map(|&node| node as usize);
    nodes.flat_map(|node| first[node]..end(node)).collect()
}

/// First dof of every node: dofs at the same place.
fn first_dofs(places: &[[f64; 3]]) -> Vec<usize> {
    (0..places.len())
        .filter(|&dof| dof == 0 || places[dof] != places[dof - 1])
        .collect()
}

/// Place of every node among the distinct coordinates along an axis.
fn ranks(places: &[[f64; 3]], first: &[usize], axis: usize) -> Vec<u32> {
    let at = |node: u32| places[first[node as usize]][axis];
    let mut sorted: Vec<u32> = (0..first.len() as u32).collect();
    sorted.sort_unstable_by(|&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)));
    let mut ranks = vec![0; first.len()];
    let mut rank = 0;
    for pair in sorted.windows(2) {
        rank += u32::from(at(pair[1]) > at(pair[0]));
        ranks[pair[1] as usize] = rank;
    }
    ranks
}

/// Neighbours of every node.
struct Graph {
    start: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Graph {
    fn new(col_ptr: &[usize], row_idx: &[usize], first: &[usize], dofs: usize) -> Graph {
        let count = first.len();
        let mut node_of = vec![0_u32; dofs];
        for node in 0..count {
            let end = first.get(node + 1).copied().unwrap_or(dofs);
            node_of[first[node]..end].fill(node as u32);
        }
        // the first dof of a node couples with all its neighbours
        let pairs = |visit: &mut dyn FnMut(u32, u32)| {
            for (node, &dof) in first.iter().enumerate() {
                let rows = &row_idx[col_ptr[dof]..col_ptr[dof + 1]];
                let mut last = node as u32;
                for &row in rows.iter().filter(|&&row| row < dofs) {
                    let other = node_of[row];
                    if other != last {
                        last = other;
                        visit(node as u32, other);
                    }
                }
            }
        };
        let mut start = vec![0_u32; count + 1];
        pairs(&mut |a, b| {
            start[a as usize + 1] += 1;
            start[b as usize + 1] += 1;
        });
        for node in 0..count {
            start[node + 1] += start[node];
        }
        let mut next = start.clone();
        let mut neighbours = vec![0_u32; start[count] as usize];
        pairs(&mut |a, b| {
            for (from, to) in [(a, b), (b, a)] {
                neighbours[next[from as usize] as usize] = to;
                next[from as usize] += 1;
            }
        });
        Graph { start, neighbours }
    }

    fn neighbours(&self, node: u32) -> &[u32] {
        let node = node as usize;
        &self.neighbours[self.start[node] as usize..self.start[node + 1] as usize]
    }
}

/// Parts of the set that is being cut.
const OUTSIDE: u8 = 0;
const BELOW: u8 = 1;
const ABOVE: u8 = 2;
const SEPARATOR: u8 = 3;

struct Dissection {
    graph: Graph,
    /// Place of every node among the coordinates along each axis.
    ranks: [Vec<u32>; 3],
    /// Part of every node of the set being cut; `OUTSIDE` for all others.
    part: Vec<u8>,
    order: Vec<u32>,
}

impl Dissection {
    fn cut(&mut self, nodes: &mut [u32]) {
        if nodes.len() <= LEAF || !self.split(nodes) {
            self.order.extend_from_slice(nodes);
            return;
        }
        let of = |part: &[u8], node: u32| part[node as usize];
        nodes.sort_unstable_by_key(|&node| (of(&self.part, node), node));
        let part = &self.part;
        let above = nodes.partition_point(|&node| of(part, node) < ABOVE);
        let separator = nodes.partition_point(|&node| of(part, node) < SEPARATOR);
        for node in nodes.iter() {
            self.part[*node as usize] = OUTSIDE;
        }
        let (halves, separator) = nodes.split_at_mut(separator);
        let (below, above) = halves.split_at_mut(above);
        self.cut(below);
        self.cut(above);
        self.order.extend_from_slice(separator);
    }

    /// Marks the parts of a set; false when no cut leaves something on both sides.
    fn split(&mut self, nodes: &mut [u32]) -> bool {
        let middle = nodes.len() / 2;
        // the separator is taken from above or from below a cut before or after the median
        let mut best: Option<(usize, usize, u32, u8)> = None;
        for axis in 0..3 {
            let ranks = &self.ranks[axis];
            // nothing to cut across a flat body
            let first = ranks[nodes[0] as usize];
            if nodes.iter().all(|&node| ranks[node as usize] == first) {
                continue;
            }
            let rank = |node: u32| (ranks[node as usize], node);
            let (_, &mut median, _) = nodes.select_nth_unstable_by_key(middle, |&node| rank(node));
            let (median, _) = rank(median);
            for cut in [median, median + 1] {
                self.mark(nodes, axis, cut);
                for from in [ABOVE, BELOW] {
                    let (mut inside, mut touching) = (0, 0);
                    for &node in nodes.iter() {
                        if self.part[node as usize] == from {
                            inside += 1;
                            touching += usize::from(self.touches(node, ABOVE + BELOW - from));
                        }
                    }
                    let is_cut = inside > touching && nodes.len() > inside;
                    if is_cut && best.is_none_or(|(size, ..)| touching < size) {
                        best = Some((touching, axis, cut, from));
                    }
                }
            }
        }
        let Some((_, axis, cut, from)) = best else {
            for node in nodes.iter() {
                self.part[*node as usize] = OUTSIDE;
            }
            return false;
        };
        self.mark(nodes, axis, cut);
        for &node in nodes.iter() {
            if self.part[node as usize] == from && self.touches(node, ABOVE + BELOW - from) {
                self.part[node as usize] = SEPARATOR;
            }
        }
        true
    }

    fn mark(&mut self, nodes: &[u32], axis: usize, cut: u32) {
        for &node in nodes {
            let is_below = self.ranks[axis][node as usize] < cut;
            self.part[node as usize] = if is_below { BELOW } else { ABOVE };
        }
    }

    fn touches(&self, node: u32, part: u8) -> bool {
        let neighbours = self.graph.neighbours(node);
        neighbours.iter().any(|&n| self.part[n as usize] == part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five-point (seven-point) pattern of a grid, two dofs per node.
    fn grid(n: [usize; 3]) -> (Vec<usize>, Vec<usize>, Vec<[f64; 3]>) {
        let (mut col_ptr, mut row_idx, mut places) = (vec![0], Vec::new(), Vec::new());
        let at = |i: usize, j: usize, k: usize| (k * n[1] + j) * n[0] + i;
        for k in 0..n[2] {
            for j in 0..n[1] {
                for i in 0..n[0] {
                    let node = at(i, j, k);
                    let mut later = vec![];
                    later.extend((i + 1 < n[0]).then(|| at(i + 1, j, k)));
                    later.extend((j + 1 < n[1]).then(|| at(i, j + 1, k)));
                    later.extend((k + 1 < n[2]).then(|| at(i, j, k + 1)));
                    for component in 0..2 {
                        row_idx.extend(2 * node + component..2 * node + 2);
                        row_idx.extend(later.iter().flat_map(|&l| [2 * l, 2 * l + 1]));
                        col_ptr.push(row_idx.len());
                        places.push([i as f64, j as f64, k as f64]);
                    }
                }
            }
        }
        (col_ptr, row_idx, places)
    }

    #[test]
    fn every_dof_comes_once_and_nodes_stay_together() {
        for n in [[1, 1, 1], [7, 1, 1], [9, 6, 1], [5, 4, 6]] {
            let (col_ptr, row_idx, places) = grid(n);
            let order = nested_dissection(&col_ptr, &row_idx, &places);
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..places.len()).collect::<Vec<_>>());
            for pair in order.chunks_exact(2) {
                assert_eq!(pair[1], pair[0] + 1);
            }
        }
    }

    #[test]
    fn the_last_nodes_cut_the_longest_side_in_the_middle() {
        let (col_ptr, row_idx, places) = grid([15, 6, 1]);
        let order = nested_dissection(&col_ptr, &row_idx, &places);
        for &dof in &order[order.len() - 12..] {
            assert_eq!(places[dof][0], 7.0);
        }
    }

    #[test]
    fn nodes_in_one_place_or_none_give_an_order_too() {
        let (col_ptr, row_idx, _) = grid([3, 3, 1]);
        // all dofs in one place are one node
        let order = nested_dissection(&col_ptr, &row_idx, &[[0.5; 3]; 18]);
        assert_eq!(order, (0..18).collect::<Vec<_>>());
        assert!(nested_dissection(&[0], &[], &[]).is_empty());
    }
}
