//! What a point of linearisation says of a node, and what follows for its rows and columns of the Newton matrix.

use super::node::Node;
use super::problem::PressedProblem;

/// Entries of a node that belongs to no factorization yet.
pub(super) const UNKNOWN: f64 = -1.0;

/// Entries per node: what it does, growth of its friction force by p (signed in the plane), by the rate, fall of p by the
/// velocity; in space also its direction and what a turn of that does.
pub(super) const fn node_len(components: usize) -> usize {
    if components == 1 { 4 } else { 8 }
}

pub(super) fn is_same(a: &[f64], b: &[f64]) -> bool {
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

    pub fn is_unknown(self) -> bool {
        self.0[0] == UNKNOWN
    }

    pub fn has_same_status(self, other: Entries) -> bool {
        self.0[0] == other.0[0]
    }

    /// Whether the node has such an unknown.
    pub fn has(self, components: usize, kind: Unknown) -> bool {
        match kind {
            Unknown::Along => self.slips(),
            Unknown::Across => components == 2 && self.slips(),
            Unknown::Normal => self.is_free(),
        }
    }

    /// Unknowns of the node.
    pub fn count(self, components: usize) -> usize {
        components * usize::from(self.slips()) + usize::from(self.is_free())
    }

    /// Whether the row of an unknown that both have is the same.
    pub fn has_same_row(self, other: Entries, kind: Unknown) -> bool {
        match kind {
            Unknown::Normal => self.fall().to_bits() == other.fall().to_bits(),
            _ => is_same(&self.0[1..3], &other.0[1..3]) && is_same(&self.0[4..], &other.0[4..]),
        }
    }

    pub fn is_plausible(self) -> bool {
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

/// Forces of the body per unit of an unknown.
pub(super) fn fill(
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
pub(super) fn own(entries: Entries, kind: Unknown, components: usize) -> f64 {
    match kind {
        Unknown::Normal => entries.fall(),
        Unknown::Across if components == 2 => entries.turn()[1],
        _ => entries.by_rate(),
    }
}
