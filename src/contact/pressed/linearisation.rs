//! Where the Newton matrix of a step size was last factored, and its factor there.
//!
//! The matrix depends on S and on what the nodes do: whether they slip, whether their normal velocity may change, and the slopes
//! of their laws. These numbers are the point of linearisation. It is part of the state of a simulation, because the steps
//! taken with an older factor, and so the last bits of the result, depend on it. The factor is only a cache, keyed by the bits
//! of the point: whoever continues from a restored point factors anew, to the same bits.

use super::node::Node;
use super::problem::PressedProblem;
use crate::linalg::DenseLu;

/// Points kept: that of the start or of a jump, of the step, and of another step size.
pub const POINTS: usize = 3;
/// Entries of a point before those of its nodes: theta_k, growth of the gap by the velocity, last use.
const HEAD: usize = 3;
/// Entries of a node that belongs to no factorization yet.
const UNKNOWN: f64 = -1.0;

/// Entries per node: what it does, growth of its friction force by p (signed in the plane), by the rate, fall of p by the
/// velocity; in space also its direction and what a turn of that does.
const fn node_len(components: usize) -> usize {
    if components == 1 { 4 } else { 8 }
}

/// Length of the points of a contact.
pub fn points_len(nodes: usize, components: usize) -> usize {
    POINTS * (HEAD + nodes * node_len(components))
}

/// Makes points those of no factorization yet.
pub fn clear_points(points: &mut [f64]) {
    for point in points.chunks_exact_mut(points.len() / POINTS) {
        let (head, nodes) = point.split_at_mut(HEAD);
        head.fill(0.0);
        nodes.fill(UNKNOWN);
    }
}

/// Whether points that were read from bytes are such.
pub fn is_plausible(points: &[f64], components: usize) -> bool {
    let count = |value: f64| (0.0..9e15).contains(&value);
    points.is_empty()
        || points.chunks_exact(points.len() / POINTS).all(|point| {
            let (head, nodes) = point.split_at(HEAD);
            head[..2].iter().all(|v| v.is_finite() && *v >= 0.0)
                && count(head[2])
                && nodes
                    .chunks_exact(node_len(components))
                    .all(|node| Entries::new(node).is_plausible())
        })
}

/// A point of linearisation.
pub struct PressedPoint<'a> {
    key: [f64; 2],
    nodes: &'a mut [f64],
}

impl<'a> PressedPoint<'a> {
    /// The point for `theta_k` and `gap_rate` among those of a state, [`points_len`] numbers that begin as [`clear_points`] makes
    /// them; the one used longest ago makes room for a new one.
    pub fn of(points: &'a mut [f64], theta_k: f64, gap_rate: f64) -> PressedPoint<'a> {
        let key = [theta_k, gap_rate];
        let len = points.len() / POINTS;
        let (mut chosen, mut is_known, mut clock) = (0, false, 0.0);
        let mut oldest = f64::INFINITY;
        for (at, point) in points.chunks_exact(len).enumerate() {
            let last_use = point[2];
            clock = last_use.max(clock);
            let is_this = last_use > 0.0 && is_same(&point[..2], &key);
            if is_this || (!is_known && last_use < oldest) {
                (chosen, is_known, oldest) = (at, is_this, last_use);
            }
        }
        let point = &mut points[chosen * len..(chosen + 1) * len];
        if !is_known {
            point[..2].copy_from_slice(&key);
            point[HEAD..].fill(UNKNOWN);
        }
        point[2] = clock + 1.0;
        PressedPoint {
            key,
            nodes: &mut point[HEAD..],
        }
    }

    /// A point of its own in `memory`, which is as long as the points of a state.
    pub(super) fn fresh(memory: &'a mut [f64], problem: &PressedProblem) -> PressedPoint<'a> {
        let nodes = &mut memory[..problem.nodes() * node_len(problem.components)];
        nodes.fill(UNKNOWN);
        PressedPoint {
            key: [problem.theta_k, problem.gap_rate],
            nodes,
        }
    }

    /// Moves to what the nodes do now.
    pub(super) fn set(&mut self, components: usize, nodes: &[Node]) {
        let len = node_len(components);
        for (entries, node) in self.nodes.chunks_exact_mut(len).zip(nodes) {
            entries.copy_from_slice(&entries_of(components, node)[..len]);
        }
    }

    /// How these nodes differ from the point.
    pub(super) fn compare(&self, components: usize, nodes: &[Node]) -> Difference {
        let len = node_len(components);
        let mut difference = Difference::None;
        for (entries, node) in self.nodes.chunks_exact(len).zip(nodes) {
            let now = &entries_of(components, node)[..len];
            if now[0].to_bits() != entries[0].to_bits() {
                return Difference::Status;
            }
            if !is_same(now, entries) {
                difference = Difference::Slopes;
            }
        }
        difference
    }

    fn is_at(&self, factor: &Factor) -> bool {
        factor.is_made && is_same(&self.key, &factor.key) && is_same(self.nodes, &factor.nodes)
    }
}

/// How nodes differ from those of a point of linearisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Difference {
    None,
    /// The same nodes slip and are free, with other slopes.
    Slopes,
    Status,
}

fn is_same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// What a point says of a node. Entries that do not matter are zero, so that they make no difference.
pub(super) fn entries_of(components: usize, node: &Node) -> [f64; 8] {
    let mut entries = [0.0; 8];
    // a bound of infinite slope holds as a sticking node does
    let slips = node.slips && node.law.by_rate.is_finite();
    entries[0] = f64::from(u8::from(slips) + 2 * u8::from(node.is_free));
    entries[3] = node.fall;
    if slips {
        // the force of an open node does not grow
        let has_force = !node.is_free || node.fall > 0.0;
        let by_force = if node.law.by_force == 0.0 || !has_force {
            0.0
        } else if components == 1 {
            node.law.by_force * node.direction[0]
        } else {
            node.law.by_force
        };
        (entries[1], entries[2]) = (by_force, node.law.by_rate);
        if components == 2 {
            entries[4..6].copy_from_slice(&node.direction);
            entries[6..].copy_from_slice(&node.turn);
        }
    }
    entries
}

/// The entries of a node.
#[derive(Clone, Copy)]
pub(super) struct Entries<'a>(&'a [f64]);

impl<'a> Entries<'a> {
    pub(super) fn new(entries: &'a [f64]) -> Entries<'a> {
        Entries(entries)
    }

    pub fn slips(self) -> bool {
        self.0[0] == 1.0 || self.0[0] == 3.0
    }

    pub fn is_free(self) -> bool {
        self.0[0] >= 2.0
    }

    /// Growth of the friction force by p; in the plane along the tangent, in space along the direction of slip.
    pub fn by_force(self) -> f64 {
        self.0[1]
    }

    pub fn by_rate(self) -> f64 {
        self.0[2]
    }

    pub fn fall(self) -> f64 {
        self.0[3]
    }

    pub fn direction(self) -> [f64; 2] {
        [self.0[4], self.0[5]]
    }

    pub fn turn(self) -> [f64; 2] {
        [self.0[6], self.0[7]]
    }

    fn is_plausible(self) -> bool {
        let is_status = [0.0, 1.0, 2.0, 3.0].contains(&self.0[0]);
        self.0.iter().all(|v| *v == UNKNOWN) || (is_status && self.0.iter().all(|v| v.is_finite()))
    }
}

/// What an unknown of the Newton matrix is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unknown {
    /// Slip rate of a node, in the plane with its sign.
    Along,
    /// What turns the direction of slip.
    Across,
    Normal,
}

/// The factored Newton matrix at a point of linearisation.
pub(super) struct Factor {
    is_made: bool,
    key: [f64; 2],
    nodes: Vec<f64>,
    /// Node and kind of every unknown and row.
    pub unknowns: Vec<(usize, Unknown)>,
    pub lu: DenseLu,
    column: Vec<f64>,
    last_use: u64,
}

impl Factor {
    fn new(nodes: usize, components: usize) -> Factor {
        let len = nodes * (components + 1);
        Factor {
            is_made: false,
            key: [0.0; 2],
            nodes: vec![UNKNOWN; nodes * node_len(components)],
            unknowns: Vec::with_capacity(len),
            lu: DenseLu::new(len),
            column: vec![0.0; len],
            last_use: 0,
        }
    }

    fn make(&mut self, problem: &PressedProblem, point: &PressedPoint) -> bool {
        self.is_made = false;
        self.key = point.key;
        self.nodes.copy_from_slice(point.nodes);
        let c = problem.components;
        let len = node_len(c);
        let at = |node: usize| Entries::new(&point.nodes[node * len..][..len]);
        self.unknowns.clear();
        for node in 0..problem.nodes() {
            let entries = at(node);
            if entries.slips() {
                self.unknowns.push((node, Unknown::Along));
                if c == 2 {
                    self.unknowns.push((node, Unknown::Across));
                }
            }
            if entries.is_free() {
                self.unknowns.push((node, Unknown::Normal));
            }
        }
        let (unknowns, forces) = (&self.unknowns, &mut self.column);
        self.is_made = self.lu.factor(unknowns.len(), |j, column| {
            let (node, kind) = unknowns[j];
            fill(problem, at(node), node, kind, forces);
            let rows = column.iter_mut().zip(unknowns).enumerate();
            for (i, (entry, &(row, row_kind))) in rows {
                *entry = reduce(problem, at(row), row, row_kind, forces);
                if i == j {
                    *entry += own(at(row), row_kind, c);
                }
            }
        });
        self.is_made
    }
}

/// Forces of the body per unit of an unknown.
fn fill(
    problem: &PressedProblem,
    entries: Entries,
    node: usize,
    kind: Unknown,
    forces: &mut [f64],
) {
    let first = problem.at(node).start;
    match (kind, problem.components) {
        (Unknown::Normal, _) => forces.copy_from_slice(problem.column(problem.normal(node))),
        (_, 1) => forces.copy_from_slice(problem.column(first)),
        (kind, _) => {
            let ([x, y], [share, _]) = (entries.direction(), entries.turn());
            let [x, y] = match kind {
                Unknown::Across => [-share * y, share * x],
                _ => [x, y],
            };
            let columns = problem.column(first).iter().zip(problem.column(first + 1));
            for (force, (a, b)) in forces.iter_mut().zip(columns) {
                *force = x * a + y * b;
            }
        }
    }
}

/// The row of an unknown in forces at all components: normal forces that follow from their own rows are put in.
#[inline(always)]
pub(super) fn reduce(
    problem: &PressedProblem,
    entries: Entries,
    node: usize,
    kind: Unknown,
    forces: &[f64],
) -> f64 {
    let forces = &forces[problem.at(node)];
    match (kind, problem.components) {
        (Unknown::Normal, c) => forces[c],
        (_, 1) => forces[0] + entries.by_force() * forces[1],
        (kind, _) => {
            let [x, y] = entries.direction();
            match kind {
                Unknown::Across => x * forces[1] - y * forces[0],
                _ => x * forces[0] + y * forces[1] + entries.by_force() * forces[2],
            }
        }
    }
}

/// What the law of the node adds on the diagonal.
fn own(entries: Entries, kind: Unknown, components: usize) -> f64 {
    match kind {
        Unknown::Normal => entries.fall(),
        Unknown::Across if components == 2 => entries.turn()[1],
        _ => entries.by_rate(),
    }
}

/// The factors at the last few points; never changes a result. For the problems of one model: the matrix S must follow from
/// `theta_k` and `gap_rate`.
pub(super) struct FactorCache {
    factors: Vec<Factor>,
    clock: u64,
    /// Factorizations made so far.
    pub factorizations: u64,
}

impl FactorCache {
    pub fn new(nodes: usize, components: usize) -> FactorCache {
        FactorCache {
            factors: (0..POINTS)
                .map(|_| Factor::new(nodes, components))
                .collect(),
            clock: 0,
            factorizations: 0,
        }
    }

    /// The factor at a point; `None` when the matrix there is singular.
    pub fn at(&mut self, problem: &PressedProblem, point: &PressedPoint) -> Option<&Factor> {
        self.clock += 1;
        let known = self.factors.iter().position(|f| point.is_at(f));
        let slot = match known {
            Some(slot) => slot,
            None => {
                // a point moves: what was made for the same step size is of no use any more
                let oldest = (0..self.factors.len())
                    .min_by_key(|&i| {
                        let factor = &self.factors[i];
                        (!is_same(&factor.key, &point.key), factor.last_use)
                    })
                    .unwrap_or(0);
                self.factorizations += 1;
                if !self.factors[oldest].make(problem, point) {
                    return None;
                }
                oldest
            }
        };
        self.factors[slot].last_use = self.clock;
        Some(&self.factors[slot])
    }
}
