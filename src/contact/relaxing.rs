//! A foundation that gives way and of which a part of the pressure relaxes: an elastic layer with Maxwell branches.
//!
//! With `d >= 0` the deformation of the foundation and `gap` that of the body over the undeformed foundation,
//!
//! ```text
//! p = c d^m + sum_l c_l q_l,   q_l(t) = int_0^t exp(-(t-s)/tau_l) d'(s) ds
//! d >= -gap,   p >= 0,   p (d + gap) = 0
//! ```
//!
//! While it is pressed, d is the penetration of the body. Where a body that leaves it faster than it recovers would have to be pulled,
//! the foundation is free instead and recovers on its own, so it never pulls. The numbers (d, q_1, ..., q_n) of a node are its state:
//! a step costs the same however long the past is. d moves linearly over a stage and the branches follow exactly, so
//! `p = c d^m + A d + B` along a stage, with A and B known before it.
//!
//! `phi(S u)` of the abstract class with `S u = int b(t-s) u ds`: integrated by parts, the kernel is `b = -sum c_l/tau_l exp(-t/tau_l)`
//! beside the instantaneous stiffness `c + sum c_l`. Sofonea and Patrulescu, Math. Model. Anal. 19 (2014) 607-626, have surface
//! memory of this kind with a kernel of any sign.

use std::ops::Range;

/// Evaluations that a recovery may take; Newton's method comes from one side and needs a few.
const EVALUATIONS: usize = 200;

/// `c_l exp(-t/tau_l)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Branch {
    /// Stiffness, Pa/m, positive.
    pub weight: f64,
    /// Time in which its pressure relaxes, s, positive.
    pub tau: f64,
}

impl Branch {
    /// Shares of what was and of the change of depth after a stage of this length.
    fn over(&self, length: f64) -> [f64; 2] {
        if length == 0.0 {
            return [1.0, 1.0];
        }
        let x = length / self.tau;
        let lost = -(-x).exp_m1();
        [1.0 - lost, lost / x]
    }
}

/// The law of such a foundation.
#[derive(Debug, Clone, PartialEq)]
pub struct RelaxingFoundation {
    /// c, Pa/m^m.
    pub stiffness: f64,
    /// m, at least 1.
    pub exponent: f64,
    pub branches: Vec<Branch>,
}

impl RelaxingFoundation {
    /// Numbers of a node: the deformation, then the branches, m.
    pub fn numbers(&self) -> usize {
        1 + self.branches.len()
    }

    /// A and B of a stage from the numbers before it, Pa/m and Pa. B is linear in the numbers.
    pub fn line(&self, before: &[f64], length: f64) -> [f64; 2] {
        let depth = before[0];
        let branches = self.branches.iter().zip(&before[1..]);
        branches.fold([0.0, 0.0], |[slope, offset], (branch, q)| {
            let [kept, gained] = branch.over(length);
            let change = branch.weight * gained;
            [
                slope + change,
                offset + branch.weight * kept * q - change * depth,
            ]
        })
    }

    /// Pressure at a depth, Pa; negative where the foundation would have to be pulled.
    fn pressure(&self, [slope, offset]: [f64; 2], depth: f64) -> f64 {
        self.stiffness * depth.powf(self.exponent) + slope * depth + offset
    }

    fn slope(&self, [slope, _]: [f64; 2], depth: f64) -> f64 {
        self.exponent * self.stiffness * depth.powf(self.exponent - 1.0) + slope
    }

    /// Deformation at the end of a stage, m, at the end of which the body has this penetration (0 where it is away).
    pub fn depth(&self, line: [f64; 2], penetration: f64) -> f64 {
        if self.pressure(line, penetration) >= 0.0 {
            return penetration;
        }
        // convex and rising: from above, Newton's method stays above the root
        let mut depth = -line[1] / line[0];
        for _ in 0..EVALUATIONS {
            let next = depth - self.pressure(line, depth) / self.slope(line, depth);
            if next >= depth || next <= penetration {
                break;
            }
            depth = next;
        }
        depth
    }

    /// Its derivative, from those of the offset B and of the penetration.
    pub fn depth_slope(&self, line: [f64; 2], penetration: f64, [offset, moved]: [f64; 2]) -> f64 {
        if self.pressure(line, penetration) >= 0.0 {
            return if penetration > 0.0 { moved } else { 0.0 };
        }
        -offset / self.slope(line, self.depth(line, penetration))
    }

    /// Moves the numbers over a stage to this deformation. Linear in all of them.
    pub fn advance(&self, numbers: &mut [f64], length: f64, depth: f64) {
        let change = depth - numbers[0];
        numbers[0] = depth;
        for (branch, q) in self.branches.iter().zip(&mut numbers[1..]) {
            let [kept, gained] = branch.over(length);
            *q = kept * *q + gained * change;
        }
    }

    /// What is stored, J/m^2.
    pub fn stored(&self, numbers: &[f64]) -> f64 {
        let power = self.exponent + 1.0;
        let branches = self.branches.iter().zip(&numbers[1..]);
        let relaxing = branches.map(|(branch, q)| 0.5 * branch.weight * q * q);
        self.stiffness * numbers[0].powf(power) / power + relaxing.sum::<f64>()
    }

    /// Its derivative along that of the numbers.
    pub fn stored_slope(&self, numbers: &[f64], along: &[f64]) -> f64 {
        let branches = self
            .branches
            .iter()
            .zip(numbers[1..].iter().zip(&along[1..]));
        let relaxing = branches.map(|(branch, (q, dq))| branch.weight * q * dq);
        self.stiffness * numbers[0].powf(self.exponent) * along[0] + relaxing.sum::<f64>()
    }

    /// The symmetric form whose square is what the branches dissipate over a stage, `int sum c_l q_l^2/tau_l dt`, J/m^2: of two
    /// courses, each by its numbers before and after.
    pub fn dissipated(&self, length: f64, [x0, x1]: [&[f64]; 2], [y0, y1]: [&[f64]; 2]) -> f64 {
        if length == 0.0 {
            return 0.0;
        }
        let [x_moved, y_moved] = [x1[0] - x0[0], y1[0] - y0[0]];
        let branches = self.branches.iter().zip(x0[1..].iter().zip(&y0[1..]));
        let losses = branches.map(|(branch, (x_q, y_q))| {
            // q = q_0 e^-s + (moved / x)(1 - e^-s) for s from 0 to x = L/tau
            let x = length / branch.tau;
            let lost = -(-x).exp_m1();
            let of_start = lost - 0.5 * lost * lost;
            let mixed = 0.5 * lost * lost / x;
            let of_move = ramp(x, lost) / (x * x);
            branch.weight
                * (x_q * y_q * of_start
                    + (x_q * y_moved + y_q * x_moved) * mixed
                    + x_moved * y_moved * of_move)
        });
        losses.sum()
    }
}

/// `int_0^x (1 - e^-s)^2 ds = x - e - e^2/2` with `e = 1 - e^-x`, without loss of digits.
fn ramp(x: f64, lost: f64) -> f64 {
    if lost > 0.1 {
        return x - lost - 0.5 * lost * lost;
    }
    // x = -ln(1 - e)
    let (mut power, mut sum) = (lost * lost, 0.0);
    for n in 3..20 {
        power *= lost;
        sum += power / f64::from(n);
    }
    sum
}

/// A contact on such a foundation.
#[derive(Debug, Clone, PartialEq)]
pub struct RelaxingPart {
    pub foundation: RelaxingFoundation,
    /// Place of the contact among those of the scene.
    pub contact: usize,
    /// Its nodes among all contact nodes.
    pub nodes: Range<usize>,
    /// Its numbers among those of all such contacts, node by node.
    pub numbers: Range<usize>,
}

impl RelaxingPart {
    /// Every node with the range of its numbers.
    pub fn nodes(&self) -> impl Iterator<Item = (usize, Range<usize>)> + use<> {
        let (first, each) = (self.numbers.start, self.foundation.numbers());
        let nodes = self.nodes.clone().enumerate();
        nodes.map(move |(i, node)| (node, first + i * each..first + (i + 1) * each))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer() -> RelaxingFoundation {
        RelaxingFoundation {
            stiffness: 2.0,
            exponent: 1.5,
            branches: vec![
                Branch {
                    weight: 3.0,
                    tau: 0.2,
                },
                Branch {
                    weight: 0.5,
                    tau: 1e6,
                },
            ],
        }
    }

    /// Moves in many small stages to `depth`, linearly in `time`.
    fn ramped(layer: &RelaxingFoundation, numbers: &mut [f64], time: f64, depth: f64, stages: u32) {
        let start = numbers[0];
        for i in 1..=stages {
            let at = start + (depth - start) * f64::from(i) / f64::from(stages);
            layer.advance(numbers, time / f64::from(stages), at);
        }
    }

    #[test]
    fn a_ramp_is_exact_whatever_the_stages() {
        let layer = layer();
        let [mut one, mut many] = [[0.1, 0.05, 0.02]; 2];
        ramped(&layer, &mut one, 0.7, 0.4, 1);
        ramped(&layer, &mut many, 0.7, 0.4, 1000);
        for (one, many) in one.iter().zip(&many) {
            assert!((one - many).abs() < 1e-13, "{one} {many}");
        }
        // q = v tau (1 - e^-x) + q_0 e^-x
        let decay = f64::exp(-0.7 / 0.2);
        let expected = 0.3 / 0.7 * 0.2 * (1.0 - decay) + 0.05 * decay;
        assert!((one[1] - expected).abs() < 1e-15);
        let [slope, offset] = layer.line(&[0.1, 0.05, 0.02], 0.7);
        let by_line = layer.pressure([slope, offset], 0.4);
        let by_numbers = 2.0 * 0.4_f64.powf(1.5) + 3.0 * one[1] + 0.5 * one[2];
        assert!((by_line - by_numbers).abs() < 1e-14 * by_numbers);
    }

    #[test]
    fn work_is_stored_or_dissipated() {
        let layer = RelaxingFoundation {
            exponent: 1.0,
            ..layer()
        };
        for length in [1e-9, 1e-3, 0.3, 5.0] {
            let before = [0.1, 0.05, 0.02];
            let mut after = before;
            layer.advance(&mut after, length, 0.4);
            // the work of the spring is exact, that of the branches v int q dt with int q' = v - q/tau
            let spring = 0.5 * 2.0 * (0.4 * 0.4 - 0.1 * 0.1);
            let branches = layer.branches.iter().enumerate();
            let branches = branches.map(|(i, branch)| {
                let integral = branch.tau * (0.3 - (after[1 + i] - before[1 + i]));
                branch.weight * 0.3 / length * integral
            });
            let work = spring + branches.sum::<f64>();
            let lost = layer.dissipated(length, [&before, &after], [&before, &after]);
            let balance = layer.stored(&after) - layer.stored(&before) + lost - work;
            // the integral above loses digits where a branch hardly relaxes
            let rounding = 1e-15 * 1e6 / length * 0.5 * 0.3;
            assert!(lost > 0.0);
            assert!(balance.abs() < rounding.max(1e-14), "{length}: {balance:e}");
        }
    }

    #[test]
    fn a_foundation_that_is_left_recovers_and_does_not_pull() {
        let layer = layer();
        let mut numbers = [0.4, 0.1, 0.4];
        let mut last = 0.4;
        for _ in 0..50 {
            let line = layer.line(&numbers, 0.02);
            let depth = layer.depth(line, 0.0);
            assert!(depth < last && depth > 0.0);
            assert!(layer.pressure(line, depth).abs() < 1e-14);
            let change = 1e-6;
            let moved = layer.depth([line[0], line[1] + change], 0.0) - depth;
            let slope = layer.depth_slope(line, 0.0, [1.0, 0.0]);
            assert!((moved / change - slope).abs() < 1e-4 * slope.abs());
            layer.advance(&mut numbers, 0.02, depth);
            last = depth;
        }
    }
}
