//! Where the Newton matrix of a step size was last factored, and its factor there.
//!
//! The matrix depends on S and on what the nodes do: whether they slip, whether their normal velocity may change, and the slopes
//! of their laws. These numbers are the point of linearisation. It is part of the state of a simulation, because the steps
//! taken with an older factor, and so the last bits of the result, depend on it. The factor is only a cache, keyed by the bits
//! of the point: whoever continues from a restored point factors anew, to the same bits. Where a few nodes do something else
//! than at the point, the factor gets a border (see `border`) and the point stays.

use super::border::{Border, Inner, Place, count_changes, largest};
use super::entries::{Entries, UNKNOWN, Unknown, entries_of, fill, is_same, node_len, own, reduce};
use super::node::Node;
use super::problem::PressedProblem;
use crate::linalg::DenseLu;

/// Points kept: that of the start or of a jump, of the step, and of another step size.
pub const POINTS: usize = 3;
/// Entries of a point before those of its nodes: theta_k, growth of the gap by the velocity, last use.
const HEAD: usize = 3;

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

    /// Moves to what the nodes do now; false where it is there.
    pub(super) fn set(&mut self, components: usize, nodes: &[Node]) -> bool {
        let len = node_len(components);
        let mut has_moved = false;
        for (entries, node) in self.nodes.chunks_exact_mut(len).zip(nodes) {
            let now = entries_of(components, node);
            has_moved |= !is_same(entries, &now[..len]);
            entries.copy_from_slice(&now[..len]);
        }
        has_moved
    }

    /// How far these nodes are from the point.
    pub(super) fn compare(&self, components: usize, nodes: &[Node]) -> Distance {
        let len = node_len(components);
        let (mut order, mut statuses, mut all) = (0, 0, 0);
        for (entries, node) in self.nodes.chunks_exact(len).zip(nodes) {
            let old = Entries::new(entries);
            if old.is_unknown() {
                return Distance::Far;
            }
            order += old.count(components);
            let now = &entries_of(components, node)[..len];
            if is_same(now, entries) {
                continue;
            }
            let changes = count_changes(components, old, Entries::new(now));
            all += changes;
            if !old.has_same_status(Entries::new(now)) {
                statuses += changes;
            }
        }
        match largest(order) {
            most if all <= most => Distance::Bordered,
            most if statuses <= most => Distance::Slopes,
            _ => Distance::Far,
        }
    }

    fn is_at(&self, factor: &Factor) -> bool {
        factor.is_made && is_same(&self.key, &factor.key) && is_same(self.nodes, &factor.nodes)
    }
}

/// How far nodes are from those of a point of linearisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Distance {
    /// A border makes the factor that of the matrix at these nodes.
    Bordered,
    /// A border does so but for the slopes of laws.
    Slopes,
    /// Too much is different.
    Far,
}

/// What of the nodes a factor is to follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Following {
    All,
    /// Those that do something else; the others keep the slopes of the point.
    Statuses,
}

/// The factored Newton matrix at a point of linearisation.
pub(super) struct Factor {
    is_made: bool,
    key: [f64; 2],
    nodes: Vec<f64>,
    /// Node and kind of every unknown and row.
    unknowns: Vec<(usize, Unknown)>,
    lu: DenseLu,
    border: Border,
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
            border: Border::new(len, nodes * node_len(components)),
            column: vec![0.0; len],
            last_use: 0,
        }
    }

    fn make(&mut self, problem: &PressedProblem, point: &PressedPoint) -> bool {
        self.is_made = false;
        self.border.clear();
        self.key = point.key;
        self.nodes.copy_from_slice(point.nodes);
        let c = problem.components;
        let len = node_len(c);
        let at = |node: usize| Entries::new(&point.nodes[node * len..][..len]);
        self.unknowns.clear();
        for node in 0..problem.nodes() {
            let kinds = [Unknown::Along, Unknown::Across, Unknown::Normal];
            let own = kinds.iter().filter(|kind| at(node).has(c, **kind));
            self.unknowns.extend(own.map(|kind| (node, *kind)));
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

    /// Makes the border for what the nodes do now; false where the matrix is singular.
    fn follow(&mut self, problem: &PressedProblem, nodes: &[Node], what: Following) -> bool {
        let inner = Inner {
            lu: &self.lu,
            unknowns: &self.unknowns,
            nodes: &self.nodes,
        };
        let len = node_len(problem.components);
        self.border.make(problem, &inner, |node, entries| {
            let now = &entries_of(problem.components, &nodes[node])[..len];
            let old = &inner.nodes[node * len..][..len];
            let is_kept =
                what == Following::Statuses && Entries::new(old).has_same_status(Entries::new(now));
            entries.copy_from_slice(if is_kept { old } else { now });
        })
    }

    /// Solves for all unknowns: `right` gives the right-hand side of an unknown, `found` gets its value. `x` is scratch.
    pub fn solve(
        &mut self,
        x: &mut [f64],
        right: impl Fn(usize, Unknown) -> f64,
        mut found: impl FnMut(usize, Unknown, f64),
    ) {
        let order = self.unknowns.len();
        let x = &mut x[..self.lu.padded_order()];
        x[order..].fill(0.0);
        let has_border = !self.border.places().is_empty();
        for (i, (value, &(node, kind))) in x.iter_mut().zip(&self.unknowns).enumerate() {
            let is_dropped = has_border && self.border.drops_row(i);
            *value = if is_dropped { 0.0 } else { right(node, kind) };
        }
        if order > 0 {
            self.lu.solve(x);
        }
        if has_border {
            for p in 0..self.border.places().len() {
                let value = match self.border.places()[p] {
                    Place::Out(_) => 0.0,
                    Place::Replaced(i) => right(self.unknowns[i].0, self.unknowns[i].1),
                    Place::In(node, kind) => right(node, kind),
                };
                self.border.values()[p] = value;
            }
            self.border.solve(x, order);
            for p in 0..self.border.places().len() {
                if let Place::In(node, kind) = self.border.places()[p] {
                    found(node, kind, self.border.values()[p]);
                }
            }
        }
        for (value, &(node, kind)) in x.iter().zip(&self.unknowns) {
            found(node, kind, *value);
        }
    }

    /// Sign of the determinant of the matrix at the point.
    pub fn sign(&self) -> f64 {
        self.lu.sign()
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
    /// Forgets all factors: those of problems to come have another S.
    pub fn forget(&mut self) {
        for factor in &mut self.factors {
            factor.is_made = false;
        }
    }

    pub fn new(nodes: usize, components: usize) -> FactorCache {
        FactorCache {
            factors: (0..POINTS)
                .map(|_| Factor::new(nodes, components))
                .collect(),
            clock: 0,
            factorizations: 0,
        }
    }

    /// The factor at a point, with a border for what the nodes do now; `None` when the matrix is singular.
    pub fn at(
        &mut self,
        problem: &PressedProblem,
        point: &PressedPoint,
        (nodes, what): (&[Node], Following),
    ) -> Option<&mut Factor> {
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
        let factor = &mut self.factors[slot];
        factor.last_use = self.clock;
        factor.follow(problem, nodes, what).then_some(factor)
    }

    /// Solves with factors made for borders so far.
    pub fn border_solves(&self) -> u64 {
        self.factors.iter().map(|factor| factor.border.solves).sum()
    }
}
