//! What a friction law is asked, at a node or at all nodes of the contact at once, and what it says.

use pulp::Arch;

/// Accumulated slip within a stage: `base + per_rate * rate` (m; per_rate in s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlipPath {
    pub base: f64,
    pub per_rate: f64,
}

impl SlipPath {
    /// The path times a factor.
    #[inline(always)]
    pub fn scaled(self, factor: f64) -> SlipPath {
        SlipPath {
            base: factor * self.base,
            per_rate: factor * self.per_rate,
        }
    }
}

/// All that a law says at one node and slip rate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Evaluation {
    /// Bound.
    pub bound: f64,
    /// Its derivative by the slip rate.
    pub slope: f64,
    /// Its integral over the slip rate.
    pub potential: f64,
}

/// Where a law is evaluated at all nodes at once.
#[derive(Debug, Clone, Copy)]
pub struct Nodes<'a> {
    /// Nodal contact weights, m^2 (m in 2D).
    pub weights: &'a [f64],
    /// Slip rates, m/s.
    pub rates: &'a [f64],
    /// Accumulated slip before the implicit part of the stage, m.
    pub slip_base: &'a [f64],
    /// Growth of the accumulated slip by the slip rate, s.
    pub per_rate: f64,
}

/// A law at all nodes, times their weights.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalLaw {
    /// Bounds, N.
    pub bound: Vec<f64>,
    /// Slopes, N s/m.
    pub slope: Vec<f64>,
    /// Potentials, W.
    pub potential: Vec<f64>,
}

impl NodalLaw {
    pub fn new(nodes: usize) -> NodalLaw {
        NodalLaw {
            bound: vec![0.0; nodes],
            slope: vec![0.0; nodes],
            potential: vec![0.0; nodes],
        }
    }

    /// Evaluates at every node; the loop is compiled for the vector instructions of the machine, which `evaluate` uses where
    /// it is `#[inline(always)]` and has no branches.
    #[inline(always)]
    pub fn fill(&mut self, nodes: Nodes, evaluate: impl FnMut(usize, f64, SlipPath) -> Evaluation) {
        Arch::new().dispatch(
            #[inline(always)]
            || self.fill_here(nodes, evaluate),
        );
    }

    #[inline(always)]
    fn fill_here(
        &mut self,
        nodes: Nodes,
        mut evaluate: impl FnMut(usize, f64, SlipPath) -> Evaluation,
    ) {
        let Nodes {
            weights,
            rates,
            slip_base,
            per_rate,
        } = nodes;
        let count = weights.len();
        let (rates, slip_base) = (&rates[..count], &slip_base[..count]);
        let bound = &mut self.bound[..count];
        let (slope, potential) = (&mut self.slope[..count], &mut self.potential[..count]);
        for (node, weight) in weights.iter().enumerate() {
            let slip = SlipPath {
                base: slip_base[node],
                per_rate,
            };
            let law = evaluate(node, rates[node], slip);
            bound[node] = weight * law.bound;
            slope[node] = weight * law.slope;
            potential[node] = weight * law.potential;
        }
    }
}
