//! Fading memory of slip: what a law takes for the accumulated slip where friction has a kernel.
//!
//! ```text
//! H(t) = int_0^t sum_l w_l exp(-(t-s)/tau_l) |w_tau(s)| ds = sum_l w_l z_l
//! ```
//!
//! The numbers z_l of a node are its state: a step costs the same however long the past is. Over a stage of length L at a mean slip
//! rate rb they move as
//!
//! ```text
//! z_l -> z_l exp(-L/tau_l) + tau_l (1 - exp(-L/tau_l)) rb
//! ```
//!
//! exactly, so they are never negative. With `rb = known + share r` H is `base + per_rate r` along the stage, which is the form in
//! which laws take the slip. A term without a time does not fade: with the weight 1 it is the accumulated slip.

/// `weight exp(-(t-s)/tau)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KernelTerm {
    /// Positive, without unit.
    pub weight: f64,
    /// Time over which slip is forgotten, s; positive, infinite where it is not.
    pub tau: f64,
}

impl KernelTerm {
    /// Shares of what was and of the mean slip rate (s) after a stage of this length.
    fn over(&self, length: f64) -> [f64; 2] {
        if self.tau == f64::INFINITY {
            return [1.0, length];
        }
        let lost = (-length / self.tau).exp_m1();
        [1.0 + lost, -self.tau * lost]
    }
}

/// A stage as memory of slip sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlipStage {
    /// How long it moves the memory, s.
    pub length: f64,
    /// Share of the mean slip rate that its own slip rate has.
    pub share: f64,
    /// Its implicit weight, s: contact problems take the slip of a law as `base + theta_k rate`.
    pub theta_k: f64,
}

impl SlipStage {
    /// One in which laws take the slip of the problem as it is.
    pub const NONE: SlipStage = SlipStage {
        length: 0.0,
        share: 1.0,
        theta_k: 0.0,
    };

    /// What the slip of a contact problem is to be multiplied by in the law; 1 without a kernel.
    pub fn scale(&self, kernel: &SlipKernel) -> f64 {
        if kernel.is_empty() || self.theta_k == 0.0 {
            return 1.0;
        }
        kernel.per_rate(self.length, self.share) / self.theta_k
    }
}

/// The kernel of a law.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SlipKernel {
    terms: Vec<KernelTerm>,
}

impl SlipKernel {
    /// No term means no kernel: laws then take the accumulated slip itself.
    pub fn new(terms: Vec<KernelTerm>) -> SlipKernel {
        SlipKernel { terms }
    }

    pub fn terms(&self) -> &[KernelTerm] {
        &self.terms
    }

    pub fn is_empty(&self) -> bool {
        self.terms.is_empty()
    }

    /// H of a node with these numbers, m.
    pub fn value(&self, states: &[f64]) -> f64 {
        let terms = self.terms.iter().zip(states);
        terms.map(|(term, z)| term.weight * z).sum()
    }

    /// Growth of H by the slip rate of a stage of this length, s, of which the mean slip rate has a share.
    fn per_rate(&self, length: f64, share: f64) -> f64 {
        let gains = self
            .terms
            .iter()
            .map(|term| term.weight * term.over(length)[1]);
        share * gains.sum::<f64>()
    }

    /// H at the end of a stage at the slip rate 0, m, with the known part of the mean slip rate, m/s.
    pub fn base(&self, states: &[f64], length: f64, known: f64) -> f64 {
        let terms = self.terms.iter().zip(states);
        let moved = terms.map(|(term, z)| {
            let [kept, gained] = term.over(length);
            term.weight * (kept * z + gained * known)
        });
        moved.sum()
    }

    /// The numbers after a stage at this mean slip rate, m/s.
    pub fn advance(&self, before: &[f64], length: f64, mean: f64, after: &mut [f64]) {
        for ((term, z), after) in self.terms.iter().zip(before).zip(after) {
            let [kept, gained] = term.over(length);
            *after = kept * z + gained * mean;
        }
    }

    /// Largest growth of H by the slip rate of a stage whose implicit weight is `theta_k`, s.
    pub fn largest_per_rate(&self, theta_k: f64) -> f64 {
        if self.is_empty() {
            return theta_k;
        }
        theta_k * self.terms.iter().map(|term| term.weight).sum::<f64>()
    }
}
