//! Quadratures of the history on the points `t_n = n k`, with nonnegative weights:
//!
//! ```text
//! int_0^{t_n} q(t_n, s) v(s) ds  ~  sum_{j <= n} w_nj q(t_n, t_j) v_j
//! ```
//!
//! | rule | weights | order |
//! |---|---|---|
//! | trapezoid (3.2)-(3.4) | k/2, k, ..., k, k/2 | 2 |
//! | rectangle (3.26) | k, ..., k, 0 | 1 |
//! | right rectangle | 0, k, ..., k | 1 |
//! | product | q exactly, v linear in every step | 2 |
//! | mean | q exactly, v the mean of its ends in every step | 2 |
//! | relaxation | trapezoid of `z' = v - z / tau`, for every term of the kernel | 2 |
//! | weights | the user's | theirs |
//!
//! Product, mean and relaxation are rules of exponential sums. With terms that decay within a step the trapezoid is useless (it gives
//! `k/2` where the integral is about tau), the product and mean rules right, and the relaxation rule stable but ringing.

use std::fmt;
use std::sync::Arc;

/// Weights of a quadrature, each >= 0.
pub trait Weights {
    /// w_nj for `j <= n`, s.
    fn weight(&self, k: f64, n: usize, j: usize) -> f64;

    /// The weight of point j in all later rows `n > j`, where it is the same in all of them: kernels that keep sums instead of the
    /// history need it.
    fn settled(&self, _k: f64, _j: usize) -> Option<f64> {
        None
    }
}

/// How the history is integrated.
#[derive(Clone)]
pub enum Quadrature {
    Trapezoid,
    Rectangle,
    RightRectangle,
    Product,
    Mean,
    Relaxation,
    Weights(Arc<dyn Weights>),
}

impl fmt::Debug for Quadrature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Quadrature {
    /// Its name.
    pub fn name(&self) -> &'static str {
        match self {
            Quadrature::Trapezoid => "trapezoid",
            Quadrature::Rectangle => "rectangle",
            Quadrature::RightRectangle => "right rectangle",
            Quadrature::Product => "product",
            Quadrature::Mean => "mean",
            Quadrature::Relaxation => "relaxation",
            Quadrature::Weights(_) => "weights",
        }
    }

    /// Whether the rule is one of weights at the points, which any kernel can take.
    pub fn is_nodal(&self) -> bool {
        !matches!(
            self,
            Quadrature::Product | Quadrature::Mean | Quadrature::Relaxation
        )
    }

    /// w_nj; the rules of exponential sums have the one that they give a constant kernel, the trapezoid's.
    pub fn weight(&self, k: f64, n: usize, j: usize) -> f64 {
        match self {
            Quadrature::Rectangle => k * f64::from(u8::from(j < n)),
            Quadrature::RightRectangle => k * f64::from(u8::from(j > 0)),
            Quadrature::Weights(weights) => weights.weight(k, n, j),
            _ if n == 0 => 0.0,
            _ if j == 0 || j == n => 0.5 * k,
            _ => k,
        }
    }

    /// The weight of point j in all later rows.
    pub fn settled(&self, k: f64, j: usize) -> Option<f64> {
        match self {
            Quadrature::Weights(weights) => weights.settled(k, j),
            _ => Some(self.weight(k, j + 2, j)),
        }
    }
}
