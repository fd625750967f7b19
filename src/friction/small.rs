//! The few terms by which the matrix of a Newton step differs from the one whose inverse is at hand.

use super::linearisation::Inverse;
use crate::linalg::{column, dot};

/// A term `delta e e^T` of the difference between the matrix wanted and the one at hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// First row of the node in the inverse.
    pub place: usize,
    pub e: [f64; 2],
    /// `1 / delta`; zero for a node that sticks.
    pub reciprocal: f64,
}

/// `e_i^T H e_j`.
#[inline(always)]
pub fn entry(
    inverse: &Inverse,
    c: usize,
    (i, e): (usize, [f64; 2]),
    (j, f): (usize, [f64; 2]),
) -> f64 {
    if c == 1 {
        return inverse.at(i, j);
    }
    let column = |q: usize| e[0] * inverse.at(i, j + q) + e[1] * inverse.at(i + 1, j + q);
    f[0] * column(0) + f[1] * column(1)
}

/// Eigenvalues and eigenvectors of the symmetric block xx, xy, yy.
pub fn symmetric_terms([xx, xy, yy]: [f64; 3]) -> [(f64, [f64; 2]); 2] {
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = half.hypot(xy);
    if radius == 0.0 {
        return [(mean, [1.0, 0.0]), (mean, [0.0, 1.0])];
    }
    // the larger of two parallel vectors, so that neither cancels
    let (x, y) = if half >= 0.0 {
        (half + radius, xy)
    } else {
        (xy, radius - half)
    };
    let length = x.hypot(y);
    let (x, y) = (x / length, y / length);
    [(mean + radius, [x, y]), (mean - radius, [-y, x])]
}

/// `L D L^T` of `Delta^-1 + E^T H E`. What the terms have in common with the last ones is not factored again: most nodes that
/// stick stick on.
pub struct SmallSystem {
    stride: usize,
    /// The terms factored, and of which inverse.
    known: Vec<Term>,
    version: u64,
    /// L^T by columns.
    lower: Vec<f64>,
    /// D L^T by columns.
    scaled: Vec<f64>,
    pivots: Vec<f64>,
    rhs: Vec<f64>,
    /// Terms that have been factored.
    order: usize,
}

impl SmallSystem {
    pub fn new(stride: usize) -> SmallSystem {
        SmallSystem {
            stride,
            known: Vec::with_capacity(stride),
            version: 0,
            lower: vec![0.0; stride * stride],
            scaled: vec![0.0; stride * stride],
            pivots: vec![0.0; stride],
            rhs: vec![0.0; stride],
            order: 0,
        }
    }

    /// Subtracts from `g` the forces of the terms on it. Whether all could be taken into account: see the pivots.
    #[inline(never)]
    pub fn apply(&mut self, terms: &[Term], inverse: &Inverse, c: usize, g: &mut [f64]) -> bool {
        let has_all = self.factor(terms, inverse, c);
        let forces = self.solve(terms, inverse, c, g);
        for (term, force) in terms.iter().zip(forces) {
            for p in 0..c {
                g[term.place + p] -= force * term.e[p];
            }
        }
        has_all
    }

    /// Factors term by term, up to the first whose pivot has not the sign of its delta; whether there is none.
    fn factor(&mut self, terms: &[Term], inverse: &Inverse, c: usize) -> bool {
        let stride = self.stride;
        if self.version != inverse.version {
            (self.version, self.order) = (inverse.version, 0);
        }
        let mut pairs = self.known[..self.order].iter().zip(terms);
        let common = pairs.position(|(a, b)| a != b);
        self.order = common.unwrap_or(self.order.min(terms.len()));
        self.known.clear();
        self.known.extend_from_slice(terms);
        for (j, term) in terms.iter().enumerate().skip(self.order) {
            let (done, rest) = self.lower.split_at_mut(j * stride);
            let (lower, scaled) = (&mut rest[..j], &mut self.scaled[j * stride..][..j]);
            for (i, other) in terms[..j].iter().enumerate() {
                let entry = entry(inverse, c, (other.place, other.e), (term.place, term.e));
                scaled[i] = entry - dot(&done[i * stride..][..i], &scaled[..i]);
                lower[i] = scaled[i] / self.pivots[i];
            }
            let own = entry(inverse, c, (term.place, term.e), (term.place, term.e));
            let pivot = own + term.reciprocal - dot(lower, scaled);
            let is_as_expected = if term.reciprocal < 0.0 {
                pivot < 0.0
            } else {
                pivot > 0.0
            };
            if !is_as_expected {
                return false;
            }
            self.pivots[j] = pivot;
            self.order = j + 1;
        }
        true
    }

    /// Forces of the factored terms on the right-hand side `g`.
    fn solve(&mut self, terms: &[Term], inverse: &Inverse, c: usize, g: &[f64]) -> &[f64] {
        let (stride, order) = (self.stride, self.order);
        let x = &mut self.rhs[..order];
        for j in 0..order {
            let term = &terms[j];
            let mut value = 0.0;
            for p in 0..c {
                value += term.e[p] * dot(column(inverse.matrix(), term.place + p), g);
            }
            x[j] = value - dot(&self.lower[j * stride..][..j], &x[..j]);
        }
        for (x, pivot) in x.iter_mut().zip(&self.pivots) {
            *x /= pivot;
        }
        for j in (0..order).rev() {
            let value = x[j];
            for (x, l) in x.iter_mut().zip(&self.lower[j * stride..][..j]) {
                *x -= l * value;
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::symmetric_terms;

    #[test]
    fn terms_add_up_to_the_block() {
        for block in [
            [1.0, 0.0, 1.0],
            [3.0, 0.0, -2.0],
            [-2.0, 0.0, 3.0],
            [1.0, 1e-9, 1.0],
            [-1.0, 2.0, 5.0],
            [1e12, -3.0, 1.0],
        ] {
            let mut sum = [0.0; 3];
            for (delta, e) in symmetric_terms(block) {
                sum[0] += delta * e[0] * e[0];
                sum[1] += delta * e[0] * e[1];
                sum[2] += delta * e[1] * e[1];
            }
            let scale = block.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            for (sum, expected) in sum.iter().zip(block) {
                assert!(
                    (sum - expected).abs() <= 1e-14 * scale,
                    "{block:?}: {sum:?}"
                );
            }
        }
    }
}
