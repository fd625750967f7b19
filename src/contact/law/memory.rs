//! The memory of laws with a state of their own (`theta` of rate-and-state friction): one number per node, which the slip rate
//! moves over a stage.

/// The memory of a node within a stage: at a slip rate r it is moved by the mean rate `rate_base + rate_share * r`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MemoryPath {
    /// State before the stage, s; positive.
    pub state: f64,
    /// Length of the stage, s; 0 leaves the state as it is.
    pub length: f64,
    /// Part of the mean slip rate that is known, m/s.
    pub rate_base: f64,
    /// Share of the mean slip rate that the one of the stage has: 1, or 1/2 where it is averaged with the one before.
    pub rate_share: f64,
}

impl MemoryPath {
    /// Of laws without memory. A law with memory that is asked without one answers NaN.
    pub const NONE: MemoryPath = MemoryPath {
        state: f64::NAN,
        length: 0.0,
        rate_base: 0.0,
        rate_share: 1.0,
    };

    /// Mean slip rate at a slip rate of the stage.
    pub fn mean_rate(&self, rate: f64) -> f64 {
        self.rate_base + self.rate_share * rate
    }
}

/// The memory of all nodes within a stage.
#[derive(Debug, Clone, Copy)]
pub struct Memory<'a> {
    /// State of every node before the stage, s.
    pub states: &'a [f64],
    /// Slip rate of every node before the stage, m/s; read only where it is averaged.
    pub rates: &'a [f64],
    /// Length of the stage, s.
    pub length: f64,
    /// Whether the rate that moves the state is the mean of the one before and that of the stage (trapezoidal and BDF2 stages),
    /// and not that of the stage alone (backward Euler, midpoint).
    pub is_averaged: bool,
}

impl<'a> Memory<'a> {
    /// That of some of the nodes, which follow each other.
    pub fn of_nodes(&self, nodes: &std::ops::Range<usize>) -> Memory<'a> {
        Memory {
            states: &self.states[nodes.clone()],
            rates: &self.rates[nodes.clone()],
            ..*self
        }
    }

    /// The memory of a node.
    pub fn path(&self, node: usize) -> MemoryPath {
        let (rate_base, rate_share) = if self.is_averaged {
            (0.5 * self.rates[node], 0.5)
        } else {
            (0.0, 1.0)
        };
        MemoryPath {
            state: self.states[node],
            length: self.length,
            rate_base,
            rate_share,
        }
    }
}
