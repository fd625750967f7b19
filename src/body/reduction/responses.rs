//! The responses that a body is projected on: the fields, and those to its ports at the shifts; their products in A and B.
//!
//! With `X_i = (c_i A + d_i B)^-1 P` and `det = c_i d_j - c_j d_i`, products of responses to ports are Loewner quotients, and
//! on the diagonal of the derivative by the angle, `H' = -X^T (-d A + c B) X`:
//!
//! ```text
//! i != j   X_i^T A X_j = (d_j H_j - d_i H_i) / det,   X_i^T B X_j = (c_i H_i - c_j H_j) / det
//! i == j   X_i^T A X_i = c_i H_i + d_i H'_i,          X_i^T B X_i = d_i H_i - c_i H'_i
//! ```
//!
//! Those with the fields Q are known in A (see `fields`), and in B from `P = (c A + d B) X`. The coordinates of the contact are
//! turned: first come the contact forces whose responses are fields.

use super::samples::Sampled;
use super::shifts::{Shifts, shift};
use faer::Mat;

/// Products of the responses, known from what the samples and the fields show.
pub struct Responses<'a> {
    shifts: &'a Shifts,
    /// Ports whose responses at the shifts are projected on.
    ports: Vec<usize>,
    /// Transfer matrix at the shifts, and its derivative.
    samples: Vec<Mat<f64>>,
    derivatives: Vec<Mat<f64>>,
    /// Products in A of the fields with the responses to the ports at the shifts: ports x fields.
    couplings: Vec<Mat<f64>>,
    /// What the fields show: ports x fields.
    seen: Mat<f64>,
}

impl<'a> Responses<'a> {
    /// Of the responses at the shifts those to the ports that are not `held` by the fields.
    pub fn new(sampled: &'a Sampled, is_held: impl Fn(usize) -> bool) -> Responses<'a> {
        let turn = &sampled.turn;
        let turned = |seen: &Mat<f64>| {
            let mut seen = seen.clone();
            turn.back(seen.as_mut());
            seen
        };
        let at_shifts = sampled.shifts.shifts.iter();
        let samples: Vec<_> = at_shifts
            .map(|&at| turn.of(&sampled.transfer[at]))
            .collect();
        Responses {
            shifts: &sampled.shifts,
            ports: (0..samples[0].nrows()).filter(|&p| !is_held(p)).collect(),
            samples,
            derivatives: sampled.derivatives.iter().map(|d| turn.of(d)).collect(),
            couplings: sampled.couplings.iter().map(turned).collect(),
            seen: turned(&sampled.fields.seen),
        }
    }

    /// Responses to ports at shifts.
    pub fn len(&self) -> usize {
        self.samples.len() * self.ports.len()
    }

    /// Shift and port of a response.
    pub fn place(&self, at: usize) -> (usize, usize) {
        (at / self.ports.len(), self.ports[at % self.ports.len()])
    }

    /// What a response shows at a port.
    pub fn seen(&self, at: usize, port: usize) -> f64 {
        let (i, own) = self.place(at);
        self.samples[i][(own, port)]
    }

    /// What a field shows at a port.
    pub fn seen_field(&self, field: usize, port: usize) -> f64 {
        self.seen[(port, field)]
    }

    /// Product in A of a field and a response.
    pub fn viscosity(&self, field: usize, at: usize) -> f64 {
        let (i, port) = self.place(at);
        self.couplings[i][(port, field)]
    }

    /// Product in B of a field and a response.
    pub fn elasticity(&self, field: usize, at: usize) -> f64 {
        let (i, port) = self.place(at);
        let (c, d) = shift(self.shifts.angle(i));
        (self.seen[(port, field)] - c * self.viscosity(field, at)) / d
    }

    /// Products of the responses at the shifts in A and in B.
    pub fn products(&self) -> (Mat<f64>, Mat<f64>) {
        let (m, size) = (self.ports.len(), self.len());
        let (mut a, mut b) = (Mat::<f64>::zeros(size, size), Mat::<f64>::zeros(size, size));
        for (i, hi) in self.samples.iter().enumerate() {
            let (ci, di) = shift(self.shifts.angle(i));
            for (j, hj) in self.samples.iter().enumerate() {
                let (cj, dj) = shift(self.shifts.angle(j));
                // H_i and H_j with their weights, or H and H' on the diagonal
                let (hj, a_weights, b_weights) = if i == j {
                    (&self.derivatives[i], (ci, di), (di, -ci))
                } else {
                    let det = ci * dj - cj * di;
                    (hj, (-di / det, dj / det), (ci / det, -cj / det))
                };
                for (q, &of_q) in self.ports.iter().enumerate() {
                    for (p, &of_p) in self.ports.iter().enumerate() {
                        let (hi, hj) = (hi[(of_p, of_q)], hj[(of_p, of_q)]);
                        a[(i * m + p, j * m + q)] = a_weights.0 * hi + a_weights.1 * hj;
                        b[(i * m + p, j * m + q)] = b_weights.0 * hi + b_weights.1 * hj;
                    }
                }
            }
        }
        (a, b)
    }
}
