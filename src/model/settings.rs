//! What a model says of the time settings of its scene.

use super::Model;
use crate::body::digits::can_lose_in_steps;
use crate::scene::Start;

impl Model {
    /// Error in time aimed at; `None` for equal steps.
    pub(crate) fn tolerance(&self) -> Option<f64> {
        self.scene().time.tolerance
    }

    /// Slip rate, m/s, up to which steps of the largest size at steady slip resist more the faster they slip; beyond it a step may
    /// have several solutions. Infinite for friction without memory, and where a scheme has no such limit.
    pub fn steady_slip_limit(&self) -> f64 {
        let tableau = self.tableau();
        let share = if tableau.uses_start_velocity() {
            0.5
        } else {
            1.0
        };
        let (mut before, mut longest) = (0.0, 0.0_f64);
        for stage in tableau.stages() {
            longest = longest.max(stage.instant - before);
            before = stage.instant;
        }
        let length = longest * self.largest_step();
        self.friction().steady_limit(length, share)
    }

    /// Most friction iterations of a communication step; `None` without a limit.
    pub(crate) fn work_limit(&self) -> Option<u64> {
        self.scene().fidelity.work_limit.map(u64::from)
    }

    /// Whether the error in time is estimated.
    pub(crate) fn has_error_estimate(&self) -> bool {
        self.scene().time.estimates_error()
    }

    /// Order in time that the error of equal steps falls with: the scheme's, or 1 when it starts from an inconsistent
    /// velocity.
    pub(crate) fn order(&self) -> u32 {
        let tableau = self.tableau();
        if self.start() == Start::Zero && tableau.uses_start_velocity() {
            1
        } else {
            tableau.order()
        }
    }

    /// Whether internal steps of `k` may lose digits of displacement and slip.
    pub(crate) fn can_lose_digits(&self, k: f64) -> bool {
        let fastest = match self.free {
            Some(_) => f64::INFINITY,
            None => self.summary().rates[1],
        };
        can_lose_in_steps(self.scene(), self.tableau(), fastest, k)
    }

    /// Step sizes whose factorizations a simulator keeps: the start, the communication step, its last remainder, and a trial
    /// size; that of the second solution; and those that a control goes through between a kink and smooth motion.
    pub(crate) fn sizes_kept(&self) -> usize {
        let halves = if self.tolerance().is_some() { 5 } else { 0 };
        4 + usize::from(self.has_error_estimate()) + halves
    }

    /// Discrete L2 norm over the contact, weights omega, of the components `x(i)`.
    pub(crate) fn contact_norm(&self, x: impl Fn(usize) -> f64) -> f64 {
        let contact = self.contact();
        let square = |i: usize| contact.weights[i / contact.components] * x(i) * x(i);
        (0..contact.len()).map(square).sum::<f64>().sqrt()
    }
}
