//! Where the Newton matrix of a step size was last factored, and its factor there.
//!
//! The matrix is `K = S_FF + D` on the free nodes F, `D` block diagonal: the second variation of the friction potential at
//! the point of linearisation. That point (theta_k, F and D) is part of the state of a simulation, because the directions
//! of a Newton step, and so the last bits of its result, depend on it. The factor is only a cache, keyed by the bits of
//! the point: a simulator that continues from a restored state refactors it, to the same bits.

use crate::contact::problem::ContactProblem;
use crate::linalg::{DenseCholesky, column};

/// Points kept, one per implicit weight: that of the start or of a jump, of the step, and of another step size.
pub const POINTS: usize = 3;
/// First entry of the block of a node that is not free.
const CLAMPED: f64 = f64::INFINITY;
/// Place of a node that is not free.
const NOWHERE: usize = usize::MAX;
/// Entries of a point before its blocks: theta_k, last use.
const HEAD: usize = 2;

/// Entries of a symmetric block: 1, or xx, xy, yy.
pub const fn block_len(components: usize) -> usize {
    components * (components + 1) / 2
}

/// Length of the points of a contact.
pub fn points_len(nodes: usize, components: usize) -> usize {
    POINTS * (HEAD + nodes * block_len(components))
}

/// Makes points those of no factorization yet.
pub fn clear_points(points: &mut [f64]) {
    let len = points.len() / POINTS;
    for point in points.chunks_exact_mut(len) {
        let (head, blocks) = point.split_at_mut(HEAD);
        head.fill(0.0);
        blocks.fill(CLAMPED);
    }
}

/// Whether points that were read from bytes are such: finite heads, and blocks that are finite or mark a node as not free.
pub fn is_plausible(points: &[f64], components: usize) -> bool {
    let count = |value: f64| (0.0..9e15).contains(&value);
    points.is_empty()
        || points.chunks_exact(points.len() / POINTS).all(|point| {
            let (head, blocks) = point.split_at(HEAD);
            head[0].is_finite()
                && head[0] >= 0.0
                && count(head[1])
                && blocks.chunks_exact(block_len(components)).all(|block| {
                    block.iter().all(|v| v.is_finite()) || block.iter().all(|v| *v == CLAMPED)
                })
        })
}

/// A point of linearisation.
pub struct Linearisation<'a> {
    theta_k: f64,
    blocks: &'a mut [f64],
}

impl<'a> Linearisation<'a> {
    /// The point for `theta_k` among those of a state; the one used longest ago makes room for a new one.
    pub fn of(points: &'a mut [f64], theta_k: f64) -> Linearisation<'a> {
        let len = points.len() / POINTS;
        let (mut chosen, mut is_known, mut clock) = (0, false, 0.0);
        let mut oldest = f64::INFINITY;
        for (at, point) in points.chunks_exact(len).enumerate() {
            let (theta, last_use) = (point[0], point[1]);
            clock = last_use.max(clock);
            let is_this = last_use > 0.0 && theta.to_bits() == theta_k.to_bits();
            if is_this || (!is_known && last_use < oldest) {
                (chosen, is_known, oldest) = (at, is_this, last_use);
            }
        }
        let point = &mut points[chosen * len..(chosen + 1) * len];
        if !is_known {
            point[0] = theta_k;
            point[HEAD..].fill(CLAMPED);
        }
        point[1] = clock + 1.0;
        Linearisation {
            theta_k,
            blocks: &mut point[HEAD..],
        }
    }

    /// A point of its own, with nothing free, on `blocks`.
    pub fn fresh(blocks: &'a mut [f64], theta_k: f64) -> Linearisation<'a> {
        blocks.fill(CLAMPED);
        Linearisation { theta_k, blocks }
    }

    /// Frees the nodes for which `block` gives the entries of D, clamps the others.
    pub fn set(&mut self, len: usize, mut block: impl FnMut(usize) -> Option<[f64; 3]>) {
        for (node, to) in self.blocks.chunks_exact_mut(len).enumerate() {
            match block(node) {
                Some(entries) => to.copy_from_slice(&entries[..len]),
                None => to.fill(CLAMPED),
            }
        }
    }

    fn is_at(&self, other: &Factor) -> bool {
        let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
        other.is_made
            && same((&self.theta_k, &other.theta_k))
            && self.blocks.iter().zip(&other.blocks).all(same)
    }
}

/// `L L^T = S_FF + D` at a point of linearisation.
pub struct Factor {
    is_made: bool,
    theta_k: f64,
    /// D, node by node; its first entry is infinite where the node is not free.
    pub blocks: Vec<f64>,
    /// First row of every node, `NOWHERE` where it is not free.
    places: Vec<usize>,
    /// Contact component of every row.
    pub components: Vec<usize>,
    /// Contact compliance: diagonal of K^-1, m/(N s). Zero where the component is clamped.
    pub yielding: Vec<f64>,
    pub cholesky: DenseCholesky,
    last_use: u64,
    /// Tells apart all factors ever made here.
    pub version: u64,
}

impl Factor {
    fn new(nodes: usize, len: usize) -> Factor {
        Factor {
            is_made: false,
            theta_k: 0.0,
            blocks: vec![CLAMPED; nodes * block_len(len / nodes)],
            places: vec![NOWHERE; nodes],
            components: Vec::with_capacity(len),
            yielding: vec![0.0; len],
            cholesky: DenseCholesky::new(len),
            last_use: 0,
            version: 0,
        }
    }

    /// Free components.
    pub fn order(&self) -> usize {
        self.components.len()
    }

    /// First row of a node, if it is free.
    #[inline(always)]
    pub fn place(&self, node: usize) -> Option<usize> {
        let place = self.places[node];
        (place != NOWHERE).then_some(place)
    }

    fn make(&mut self, problem: &ContactProblem, point: &Linearisation) -> bool {
        let c = problem.components;
        let len = block_len(c);
        self.is_made = false;
        self.theta_k = point.theta_k;
        self.blocks.copy_from_slice(point.blocks);
        self.components.clear();
        for (node, block) in self.blocks.chunks_exact(len).enumerate() {
            self.places[node] = if block[0] == CLAMPED {
                NOWHERE
            } else {
                self.components.extend(problem.at(node));
                self.components.len() - c
            };
        }
        let components = &self.components;
        self.is_made = self.cholesky.factor(components.len(), |j, entries| {
            let component = components[j];
            let s = column(problem.s, component);
            for (entry, row) in entries.iter_mut().zip(&components[j..]) {
                *entry = s[*row];
            }
            let block = &point.blocks[component / c * len..][..len];
            if c == 1 {
                entries[0] += block[0];
            } else if component.is_multiple_of(2) {
                entries[0] += block[0];
                entries[1] += block[1];
            } else {
                entries[0] += block[2];
            }
        });
        if self.is_made {
            self.cholesky.prepare_solves();
            self.yielding.fill(0.0);
            for (row, component) in components.iter().enumerate() {
                self.yielding[*component] = self.cholesky.inverse_diagonal(row);
            }
        }
        self.is_made
    }
}

/// The factors at the last few points; never changes a result.
pub struct FactorCache {
    factors: Vec<Factor>,
    current: Option<usize>,
    clock: u64,
    /// Factorizations made so far.
    pub factorizations: u64,
}

impl FactorCache {
    /// Room for the factors at `points` points, of `nodes` nodes with `len` components in all.
    pub fn new(points: usize, nodes: usize, len: usize) -> FactorCache {
        FactorCache {
            factors: (0..points).map(|_| Factor::new(nodes, len)).collect(),
            current: None,
            factorizations: 0,
            clock: 0,
        }
    }

    /// Makes sure of the factor at a point; false when the matrix there is not positive definite.
    pub fn prepare(&mut self, problem: &ContactProblem, point: &Linearisation) -> bool {
        self.clock += 1;
        self.current = None;
        let known = self.factors.iter().position(|f| point.is_at(f));
        let slot = match known {
            Some(slot) => slot,
            None => {
                let oldest = (0..self.factors.len())
                    .min_by_key(|&i| self.factors[i].last_use)
                    .unwrap_or(0);
                let factor = &mut self.factors[oldest];
                self.factorizations += 1;
                if !factor.make(problem, point) {
                    return false;
                }
                factor.version = self.clock;
                oldest
            }
        };
        self.factors[slot].last_use = self.clock;
        self.current = Some(slot);
        true
    }

    /// Forgets all factors: those of problems to come have another S.
    pub fn forget(&mut self) {
        self.current = None;
        for factor in &mut self.factors {
            factor.is_made = false;
        }
    }

    /// The factor prepared last, if it could be.
    pub fn current(&self) -> Option<&Factor> {
        self.current.map(|slot| &self.factors[slot])
    }
}
