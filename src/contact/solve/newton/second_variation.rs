//! The second variation of W at a point: which nodes are free in the Newton matrix there, and how it differs from a matrix
//! that was factored elsewhere.
//!
//! On the nodes that move it is `K = S + D` with, at every node,
//!
//! ```text
//! D = g' n n^T + (g / |w|) (I - n n^T)    (times the nodal weight; n the slip direction)
//! ```
//!
//! The difference of two such matrices is a sum of few terms `delta e e^T` where few nodes have changed; a free node that
//! sticks is a term with infinite delta.

use super::linearisation::{Factor, Linearisation, block_len};
use super::small::{Term, symmetric_terms};
use crate::contact::point::Point;
use crate::contact::problem::{ContactProblem, norm};

/// A difference in curvature below this share of what the node resists with is left to the iteration.
pub const NOTICEABLE: f64 = 0.03;
/// Limits of the number of terms, which is an eighth of the contact components. Half of the terms are reserved for nodes
/// that stick but are close to slipping: they are freed in the matrix in advance, and clamped by a term while they stick.
const TERMS: std::ops::RangeInclusive<usize> = 4..=96;
/// Halvings in the search for the share of the bound above which nodes that stick are freed.
const HALVINGS: usize = 10;
/// Largest curvature across the slip direction, in units of the node's own stiffness. At a node that is about to stop the
/// curvature `g / |w|` grows without bound; beyond this value the direction is fixed in practice, and the digits of the
/// motion along it would be lost in the sum of both.
pub const LARGEST_ACROSS: f64 = 1e8;

/// Terms allowed for this many contact components.
pub fn most_terms(len: usize) -> usize {
    (len / 8).clamp(*TERMS.start(), *TERMS.end())
}

/// Terms that are listed at most before they are found to be too many: one node beyond those allowed.
pub fn term_capacity(nodes: usize, len: usize) -> usize {
    most_terms(len) + len / nodes
}

/// Share of the bound above which the nodes that stick are no more than `spare`, from the nearness of every node.
fn share_to_free(nearness: &[f64], spare: usize) -> f64 {
    let frees_few = |share: f64| nearness.iter().filter(|n| **n >= share).count() <= spare;
    if frees_few(0.0) {
        return 0.0;
    }
    let (mut low, mut share) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + share);
        if frees_few(middle) {
            share = middle;
        } else {
            low = middle;
        }
    }
    share
}

/// K at a point.
pub struct SecondVariation<'a, 'p> {
    pub problem: &'a ContactProblem<'p>,
    pub point: &'a Point,
    /// Slip direction of what moves, all components; zero where a node sticks.
    pub normal: &'a [f64],
    /// Share of the weakening of the bound that is taken into account: 1, or less for a matrix above K.
    pub weakening: f64,
}

impl SecondVariation<'_, '_> {
    pub fn moves(&self, node: usize) -> bool {
        self.normal[self.problem.at(node)].iter().any(|n| *n != 0.0)
    }

    /// How near a node that sticks is to slipping, as a share of its bound; negative where a node moves.
    fn nearness(&self, node: usize) -> f64 {
        if self.moves(node) {
            return -1.0;
        }
        let bound = self.point.law.bound[node];
        if bound > 0.0 {
            norm(&self.point.y[self.problem.at(node)]) / bound
        } else {
            1.0
        }
    }

    /// D at a node that moves: the entry, or xx, xy, yy.
    pub fn curvature(&self, node: usize) -> [f64; 3] {
        let mut along = self.point.law.slope[node];
        if along < 0.0 {
            along *= self.weakening;
        }
        if self.problem.components == 1 {
            return [along, 0.0, 0.0];
        }
        let most = LARGEST_ACROSS * self.problem.stiffness(node);
        let across = (self.point.law.bound[node] / self.point.rates[node]).min(most);
        let (x, y) = (self.normal[2 * node], self.normal[2 * node + 1]);
        [
            along * x * x + across * y * y,
            (along - across) * x * y,
            along * y * y + across * x * x,
        ]
    }

    /// Makes this point the point of linearisation. Nodes that move are free; with `frees_near` also the sticking nodes closest
    /// to slipping, as many as there are terms to clamp them with. `scratch` has an entry per node.
    pub fn linearise(&self, at: &mut Linearisation, frees_near: bool, scratch: &mut [f64]) {
        let mut least = f64::INFINITY;
        if frees_near {
            let nodes = scratch.iter_mut().enumerate();
            nodes.for_each(|(node, nearness)| *nearness = self.nearness(node));
            let spare = most_terms(self.point.w.len()) / (2 * self.problem.components);
            least = share_to_free(scratch, spare);
        }
        at.set(block_len(self.problem.components), |node| {
            if self.moves(node) {
                Some(self.curvature(node))
            } else {
                (least < 1.0 && scratch[node] >= least).then_some([0.0; 3])
            }
        });
    }

    /// Lists the terms by which K differs from the factored matrix at the nodes whose `differences` are noticeable. False when
    /// there are too many, or when a node moves that is not free in the factored matrix.
    #[inline(never)]
    pub fn list_terms(&self, factor: &Factor, differences: &[f64], terms: &mut Vec<Term>) -> bool {
        let c = self.problem.components;
        let most = most_terms(self.point.w.len());
        terms.clear();
        for (node, difference) in differences.iter().enumerate() {
            if *difference <= NOTICEABLE {
                continue;
            }
            let moves = self.moves(node);
            let Some(place) = factor.place(node) else {
                if moves {
                    return false;
                }
                continue;
            };
            if moves {
                let own = factor.yielding[self.problem.at(node)].iter();
                let yielding = own.fold(0.0, |most: f64, y| y.max(most));
                for (delta, e) in self.differences(node, factor) {
                    if delta.abs() * yielding > NOTICEABLE {
                        let reciprocal = 1.0 / delta;
                        terms.push(Term {
                            place,
                            e,
                            reciprocal,
                        });
                    }
                }
            } else {
                for e in [[1.0, 0.0], [0.0, 1.0]].into_iter().take(c) {
                    let reciprocal = 0.0;
                    terms.push(Term {
                        place,
                        e,
                        reciprocal,
                    });
                }
            }
            if terms.len() > most {
                return false;
            }
        }
        // positive deltas first
        terms.sort_unstable_by_key(|term| term.reciprocal < 0.0);
        true
    }

    /// Difference in curvature of a free node as `delta e e^T` terms.
    fn differences(&self, node: usize, factor: &Factor) -> [(f64, [f64; 2]); 2] {
        let wanted = self.curvature(node);
        let len = block_len(self.problem.components);
        let at_hand = &factor.blocks[node * len..(node + 1) * len];
        if len == 1 {
            return [(wanted[0] - at_hand[0], [1.0, 0.0]), (0.0, [0.0; 2])];
        }
        symmetric_terms([
            wanted[0] - at_hand[0],
            wanted[1] - at_hand[1],
            wanted[2] - at_hand[2],
        ])
    }
}
