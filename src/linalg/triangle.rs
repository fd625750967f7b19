//! Products with triangular matrices by columns, of an order that is a whole number of blocks, with zeros beyond the triangle in
//! the diagonal blocks: half the entries are never read.

use super::products::Entry;
use super::tiles::BLOCK;
use pulp::{Simd, WithSimd};

/// `y = A x`.
pub struct TriangularProduct<'a> {
    /// A, in columns `stride` apart.
    pub a: &'a [f64],
    pub stride: usize,
    pub is_upper: bool,
    pub x: &'a [f64],
    pub y: &'a mut [f64],
}

impl WithSimd for TriangularProduct<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (x, y) = (self.x, self.y);
        y.fill(0.0);
        for (block, x) in x.as_chunks::<BLOCK>().0.iter().enumerate() {
            let first = block * BLOCK;
            let rows = if self.is_upper {
                0..first + BLOCK
            } else {
                first..y.len()
            };
            let columns: [&[f64]; BLOCK] =
                std::array::from_fn(|q| &self.a[(first + q) * self.stride..][rows.clone()]);
            f64::add_columns(simd, columns, *x, &mut y[rows]);
        }
    }
}
