//! The friction bounds of a contact, as its solvers ask for them: at one node, or at all of them with one call.

use super::evaluation::{Evaluation, NodalLaw, Nodes, SlipPath};

/// A friction bound `g >= 0` in Pa at every node of a contact.
pub trait Bounds {
    /// Bound, slope and potential at a node and a slip rate `rate >= 0`, m/s.
    fn evaluate(&self, node: usize, rate: f64, slip: SlipPath) -> Evaluation;

    /// Bound at rest.
    fn at_rest(&self, node: usize, slip: SlipPath) -> f64;

    /// Partial derivative of the bound by the accumulated slip `slip.base` at fixed slip rate, Pa/m.
    fn slip_slope(&self, node: usize, rate: f64, slip: SlipPath) -> f64;

    /// The law at all nodes, times their weights.
    fn fill(&self, nodes: Nodes, out: &mut NodalLaw);

    /// Largest bound at rest, times the weights, over the nodes (whose rates are not looked at), N.
    fn largest_at_rest(&self, nodes: Nodes) -> f64;
}

/// Bounds frozen node by node: the majorising problem of the paper's iteration (Problem 7.4).
#[derive(Debug, Clone, Copy)]
pub struct FrozenBounds<'a>(pub &'a [f64]);

impl Bounds for FrozenBounds<'_> {
    #[inline(always)]
    fn evaluate(&self, node: usize, rate: f64, _slip: SlipPath) -> Evaluation {
        let bound = self.0[node];
        Evaluation {
            bound,
            slope: 0.0,
            potential: bound * rate,
        }
    }

    fn at_rest(&self, node: usize, _slip: SlipPath) -> f64 {
        self.0[node]
    }

    fn slip_slope(&self, _node: usize, _rate: f64, _slip: SlipPath) -> f64 {
        0.0
    }

    fn fill(&self, nodes: Nodes, out: &mut NodalLaw) {
        out.fill(
            nodes,
            #[inline(always)]
            |node, rate, slip| self.evaluate(node, rate, slip),
        );
    }

    fn largest_at_rest(&self, nodes: Nodes) -> f64 {
        let bounds = nodes.weights.iter().zip(self.0);
        bounds.fold(0.0, |most, (weight, bound)| most.max(weight * bound))
    }
}
