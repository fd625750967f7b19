//! The contact problem of one stage with normal ports, and what a friction law says of a node that is pressed.

use crate::contact::SlipPath;
use crate::linalg::column;
use faer::MatRef;
use std::ops::Range;

/// A bound that falls with the slip rate by less than this share of what the body rises is gentle.
const GENTLE: f64 = 0.25;

/// What a friction bound is at a node, at a slip rate r and a normal force p.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PressedBound {
    /// The bound B, N; not negative.
    pub bound: f64,
    /// Its derivative by the slip rate along the stage, in which the accumulated slip grows with the rate, N s/m.
    pub by_rate: f64,
    /// Its derivative by the normal force.
    pub by_force: f64,
}

/// Friction bounds that may depend on the normal force.
pub trait PressedBounds {
    /// The bound of a node at the slip rate `rate >= 0` (m/s) under the normal force `force` (N, pressing where positive;
    /// negative in bilateral contact only).
    fn evaluate(&self, node: usize, rate: f64, force: f64, slip: SlipPath) -> PressedBound;

    /// L: the largest rate at which the bound falls with the slip rate at this force, N s/m; 0 where it never does.
    fn weakening(&self, node: usize, force: f64) -> f64;
}

/// How the contact holds a node in the normal direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NormalCondition {
    /// `gap = 0`, forces of either sign.
    Bilateral,
    /// `0 <= p`, `gap >= 0`, `p gap = 0`.
    Unilateral,
    /// `p = stiffness max(0, -gap)^exponent`, with what a foundation that relaxes adds, where that is positive.
    Compliance {
        /// Exponent m, at least 1.
        exponent: f64,
    },
}

/// The normal conditions of all nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NormalConditions<'a> {
    /// The same at all nodes.
    Uniform(NormalCondition),
    /// One per node, and what a problem has for the growth of the gap, s, where a node has compliance.
    Nodal(&'a [NormalCondition], f64),
}

impl From<NormalCondition> for NormalConditions<'_> {
    fn from(condition: NormalCondition) -> Self {
        NormalConditions::Uniform(condition)
    }
}

/// `S v + [lam; -p] = r` with friction and a normal condition.
///
/// Vectors of the contact have `components + 1` entries per node: the tangential ones, relative to the foundation, and the
/// normal one, from the foundation into the body. In forces the last one is p, pressing where positive:
///
/// ```text
/// lam in B(|v_t|, p) d|v_t|,   gap = gap_base + gap_rate v_n with the normal condition
/// ```
pub struct PressedProblem<'a> {
    /// Condensed operator, symmetric positive definite, N s/m.
    pub s: MatRef<'a, f64>,
    /// Condensed load, N.
    pub r: &'a [f64],
    /// Diagonal of `S^-1`, m/(N s). It shapes the iteration, not the solution.
    pub yielding: &'a [f64],
    /// Tangential components per node, 1 or 2.
    pub components: usize,
    /// Nodal contact weights omega, m^2 (m in 2D): as many as there are nodes.
    pub weights: &'a [f64],
    /// Friction bounds of the nodes.
    pub bounds: &'a dyn PressedBounds,
    /// Accumulated slip of every node before the implicit part of the stage, m.
    pub slip_base: &'a [f64],
    /// Implicit weight of the stage, s: accumulated slip grows by this times the slip rate.
    pub theta_k: f64,
    /// Normal conditions.
    pub conditions: NormalConditions<'a>,
    /// Stiffness of every node, weight included, N/m^exponent; empty without compliance, without meaning where a node has none.
    pub stiffness: &'a [f64],
    /// What a foundation that relaxes adds to the force of a depth at every node: growth by the depth, N/m, and force at depth 0,
    /// N, not positive (see [`crate::contact::relaxing`]); empty where none does.
    pub relaxing: &'a [[f64; 2]],
    /// Gap at the normal velocity 0, m; infinite where a node is open whatever happens, without any force.
    pub gap_base: &'a [f64],
    /// Growth of the gap by the normal velocity, s; 1 where `gap_base` is a velocity. 0 is for compliance alone: the normal
    /// forces are then given.
    pub gap_rate: f64,
}

impl PressedProblem<'_> {
    #[inline(always)]
    pub fn nodes(&self) -> usize {
        self.weights.len()
    }

    /// Components per node, the normal one included.
    #[inline(always)]
    pub fn size(&self) -> usize {
        self.components + 1
    }

    /// Range of the components of a node.
    #[inline(always)]
    pub fn at(&self, node: usize) -> Range<usize> {
        node * self.size()..(node + 1) * self.size()
    }

    /// Range of its tangential components.
    #[inline(always)]
    pub fn tangential(&self, node: usize) -> Range<usize> {
        let first = node * self.size();
        first..first + self.components
    }

    /// Its normal component.
    #[inline(always)]
    pub fn normal(&self, node: usize) -> usize {
        node * self.size() + self.components
    }

    #[inline(always)]
    pub fn slip_path(&self, node: usize) -> SlipPath {
        SlipPath {
            base: self.slip_base[node],
            per_rate: self.theta_k,
        }
    }

    /// The normal condition of a node, and the growth of its gap by the normal velocity.
    #[inline(always)]
    pub fn condition(&self, node: usize) -> (NormalCondition, f64) {
        match self.conditions {
            NormalConditions::Uniform(condition) => (condition, self.gap_rate),
            NormalConditions::Nodal(conditions, yielding) => match conditions[node] {
                condition @ NormalCondition::Compliance { .. } => (condition, yielding),
                condition => (condition, self.gap_rate),
            },
        }
    }

    /// Whether no force can act at a node.
    #[inline(always)]
    pub fn is_away(&self, node: usize) -> bool {
        self.gap_base[node] == f64::INFINITY
    }

    /// The law at a node.
    #[inline(always)]
    pub fn bound(&self, node: usize, rate: f64, force: f64) -> PressedBound {
        if self.is_away(node) {
            return PressedBound::default();
        }
        let slip = self.slip_path(node);
        self.bounds.evaluate(node, rate, force, slip)
    }

    /// Whether the bound of any node falls with its slip rate, under these forces, so fast that the body alone does not make up
    /// for it.
    pub fn can_weaken(&self, forces: &[f64]) -> bool {
        (0..self.nodes()).any(|node| {
            let weakening = self.weakening(node, forces[self.normal(node)]);
            let yielding = &self.yielding[self.tangential(node)];
            // not a number is too fast
            !yielding
                .iter()
                .all(|yielding| weakening * yielding <= GENTLE)
        })
    }

    /// Largest rate at which the bound of a node falls with its slip rate under this force.
    pub fn weakening(&self, node: usize, force: f64) -> f64 {
        if self.is_away(node) {
            return 0.0;
        }
        self.bounds.weakening(node, force)
    }

    /// Largest eigenvalue of the tangential block of S at a node, N s/m.
    pub fn resistance(&self, node: usize) -> f64 {
        let at = self.tangential(node).start;
        let a = self.s[(at, at)];
        if self.components == 1 {
            return a;
        }
        let (b, d) = (self.s[(at, at + 1)], self.s[(at + 1, at + 1)]);
        0.5 * (a + d) + crate::linalg::length(0.5 * (a - d), b)
    }

    /// A column of S.
    #[inline(always)]
    pub fn column(&self, i: usize) -> &[f64] {
        column(self.s, i)
    }
}
