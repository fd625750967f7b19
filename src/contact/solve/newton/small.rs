//! Correction of a factored matrix `K_0` by a few terms `delta e e^T` (Woodbury).
//!
//! With `K_0 = L L^T` and `Y = L^-1 E`, the forward half of a solve with the terms e as right-hand sides, the matrix of the
//! Woodbury formula is `Delta^-1 + Y^T Y`, and the forces of the terms are subtracted between the two halves of a solve:
//! `L^-1 g - Y b`. Small matrices are inverted instead (`H = K_0^-1`, see `linalg::cholesky`). Their forward half is the
//! identity: `Delta^-1 + E^T (H E)` and `g - E b`.

use super::linearisation::Factor;
use crate::linalg::{lanes, length};
use pulp::{Arch, Simd, WithSimd};

/// A term `delta e e^T` of the difference between K and the factored matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// First row of the node in the factor.
    pub place: usize,
    pub e: [f64; 2],
    /// `1 / delta`; zero for a node that sticks.
    pub reciprocal: f64,
}

impl Term {
    /// What the term, whose row is `own`, does to that of `other`.
    #[inline(always)]
    fn effect<S: Simd>(
        &self,
        simd: S,
        is_direct: bool,
        c: usize,
        own: &[f64],
        other: &[f64],
    ) -> f64 {
        if is_direct {
            let seen = &other[self.place..self.place + c];
            seen.iter().zip(&self.e).map(|(y, e)| y * e).sum::<f64>()
        } else {
            lanes::dot(simd, &other[self.place..], &own[self.place..])
        }
    }
}

/// Eigenvalues and eigenvectors of the symmetric block xx, xy, yy.
pub fn symmetric_terms([xx, xy, yy]: [f64; 3]) -> [(f64, [f64; 2]); 2] {
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = length(half, xy);
    if radius == 0.0 {
        return [(mean, [1.0, 0.0]), (mean, [0.0, 1.0])];
    }
    // the larger of two parallel vectors, so that neither cancels
    let (x, y) = if half >= 0.0 {
        (half + radius, xy)
    } else {
        (xy, radius - half)
    };
    let norm = length(x, y);
    let (x, y) = (x / norm, y / norm);
    [(mean + radius, [x, y]), (mean - radius, [-y, x])]
}

/// `L D L^T` of `Delta^-1 + Y^T Y`. The leading terms that are the same as those of the last call are not factored again:
/// most nodes that stick in one iteration stick in the next.
pub struct SmallSystem {
    stride: usize,
    /// The terms factored, and with which factor.
    known: Vec<Term>,
    version: u64,
    /// Columns of Y, or of H E, each as long as the largest factor: they read what the terms see from half a solve.
    rows: Vec<f64>,
    len: usize,
    /// L^T by columns.
    lower: Vec<f64>,
    /// D L^T by columns.
    scaled: Vec<f64>,
    pivots: Vec<f64>,
    forces: Vec<f64>,
    /// Terms that have been factored.
    order: usize,
}

impl SmallSystem {
    /// For at most `stride` terms and factors of padded order `len`.
    pub fn new(stride: usize, len: usize) -> SmallSystem {
        SmallSystem {
            stride,
            known: Vec::with_capacity(stride),
            version: 0,
            rows: vec![0.0; stride * len],
            len,
            lower: vec![0.0; stride * stride],
            scaled: vec![0.0; stride * stride],
            pivots: vec![0.0; stride],
            forces: vec![0.0; stride],
            order: 0,
        }
    }

    /// Subtracts the forces of the terms from the right-hand side `g` and from `half = L^-1 g`. Whether all could be taken into
    /// account: see the pivots.
    #[inline(never)]
    pub fn apply(
        &mut self,
        terms: &[Term],
        factor: &Factor,
        c: usize,
        g: &mut [f64],
        half: &mut [f64],
    ) -> bool {
        Arch::new().dispatch(Application {
            small: self,
            terms,
            factor,
            c,
            g,
            half,
        })
    }

    /// Factors term by term. Stops at the first pivot whose sign differs from that of its delta and returns false; true when
    /// every term was factored.
    #[inline(always)]
    fn factor<S: Simd>(&mut self, simd: S, terms: &[Term], factor: &Factor, c: usize) -> bool {
        let stride = self.stride;
        if self.version != factor.version {
            (self.version, self.order) = (factor.version, 0);
        }
        let mut pairs = self.known[..self.order].iter().zip(terms);
        let common = pairs.position(|(a, b)| a != b);
        self.order = common.unwrap_or(self.order.min(terms.len()));
        self.known.clear();
        self.known.extend_from_slice(terms);
        let (padded, is_direct) = (factor.cholesky.padded_order(), factor.cholesky.is_direct());
        for (j, term) in terms.iter().enumerate().skip(self.order) {
            let (others, rest) = self.rows.split_at_mut(j * self.len);
            let own = &mut rest[..padded];
            own.fill(0.0);
            for (p, e) in term.e[..c].iter().enumerate() {
                let row = factor.cholesky.row(term.place + p).iter();
                own.iter_mut().zip(row).for_each(|(own, y)| *own += e * y);
            }
            let (done, rest) = self.lower.split_at_mut(j * stride);
            let (lower, scaled) = (&mut rest[..j], &mut self.scaled[j * stride..][..j]);
            for (i, other) in others.chunks_exact(self.len).enumerate() {
                let effect = term.effect(simd, is_direct, c, own, other);
                scaled[i] = effect - lanes::dot(simd, &done[i * stride..][..i], &scaled[..i]);
                lower[i] = scaled[i] / self.pivots[i];
            }
            let own_effect = term.effect(simd, is_direct, c, own, own);
            let pivot = own_effect + term.reciprocal - lanes::dot(simd, lower, scaled);
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

    /// Forces of the factored terms, from half a solve.
    #[inline(always)]
    fn solve<S: Simd>(&mut self, simd: S, half: &[f64]) {
        let (stride, order) = (self.stride, self.order);
        let x = &mut self.forces[..order];
        for (j, row) in self.rows.chunks_exact(self.len).take(order).enumerate() {
            let value = lanes::dot(simd, row, half);
            x[j] = value - lanes::dot(simd, &self.lower[j * stride..][..j], &x[..j]);
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
    }
}

/// See [`SmallSystem::apply`].
struct Application<'a> {
    small: &'a mut SmallSystem,
    terms: &'a [Term],
    factor: &'a Factor,
    c: usize,
    g: &'a mut [f64],
    half: &'a mut [f64],
}

impl WithSimd for Application<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Application {
            small,
            terms,
            factor,
            c,
            g,
            half,
        } = self;
        let has_all = small.factor(simd, terms, factor, c);
        small.solve(simd, half);
        let is_direct = factor.cholesky.is_direct();
        for (j, (term, force)) in terms.iter().zip(&small.forces[..small.order]).enumerate() {
            for p in 0..c {
                g[term.place + p] -= force * term.e[p];
            }
            if !is_direct {
                let own = &small.rows[j * small.len..][..half.len()];
                lanes::add_scaled(simd, &mut half[term.place..], -force, &own[term.place..]);
            }
        }
        if is_direct {
            half[..g.len()].copy_from_slice(g);
        }
        has_all
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
