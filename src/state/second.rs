//! The second solution of a state, which goes along for the estimate of the error in time.

use super::State;

/// A second solution that goes along; the blocks have the meaning of those of the same names in the state.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Second {
    pub displacement: Vec<f64>,
    pub velocity: Vec<f64>,
    pub slip_rate: Vec<f64>,
    pub force: Vec<f64>,
    pub reaction: Vec<f64>,
    pub accumulated_slip: Vec<f64>,
    pub output_velocity: Vec<f64>,
    pub linearisation: Vec<f64>,
}

impl State {
    /// Exchanges the main solution and the second one.
    pub(crate) fn swap_second(&mut self) {
        let second = &mut self.second;
        for (a, b) in [
            (&mut self.displacement, &mut second.displacement),
            (&mut self.velocity, &mut second.velocity),
            (&mut self.slip_rate, &mut second.slip_rate),
            (&mut self.force, &mut second.force),
            (&mut self.reaction, &mut second.reaction),
            (&mut self.accumulated_slip, &mut second.accumulated_slip),
            (&mut self.output_velocity, &mut second.output_velocity),
            (&mut self.linearisation, &mut second.linearisation),
        ] {
            std::mem::swap(a, b);
        }
    }

    /// Makes the second solution the same as the main one.
    pub(crate) fn copy_to_second(&mut self) {
        let second = &mut self.second;
        for (to, from) in [
            (&mut second.displacement, &self.displacement),
            (&mut second.velocity, &self.velocity),
            (&mut second.slip_rate, &self.slip_rate),
            (&mut second.force, &self.force),
            (&mut second.reaction, &self.reaction),
            (&mut second.accumulated_slip, &self.accumulated_slip),
            (&mut second.output_velocity, &self.output_velocity),
            (&mut second.linearisation, &self.linearisation),
        ] {
            to.copy_from_slice(from);
        }
    }
}
