//! A basis of fields that is orthonormal in the viscosity A, or another operator, made block by block.

use faer::linalg::matmul::matmul;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, Mat, MatMut, MatRef, Par, Scale};

/// A response is dropped when this share of it is all that the others do not hold.
const DEPENDENT: f64 = 1e-11;
/// A response that loses more than this share of its energy to the others of its block is made orthogonal to all fields again.
const SHRUNK: f64 = 1e-2;

/// Orthonormal fields, and A times them: n x len, in memory for more.
pub struct Basis {
    fields: Mat<f64>,
    images: Mat<f64>,
    len: usize,
    /// Share of a response below which it is dropped.
    dependent: f64,
}

impl Basis {
    /// For up to `most` fields.
    pub fn new(rows: usize, most: usize) -> Basis {
        Basis::dropping(rows, most, DEPENDENT)
    }

    /// The same, where a response is dropped when no more than a share of it is what the others do not hold.
    pub fn dropping(rows: usize, most: usize, dependent: f64) -> Basis {
        Basis {
            dependent,
            fields: Mat::zeros(rows, most),
            images: Mat::zeros(rows, most),
            len: 0,
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// A times the fields.
    pub fn images(&self) -> MatRef<'_, f64> {
        self.images.get(.., ..self.len)
    }

    /// The fields.
    pub fn fields(&self) -> MatRef<'_, f64> {
        self.fields.get(.., ..self.len)
    }

    pub fn into_fields(mut self) -> Mat<f64> {
        let n = self.fields.nrows();
        self.fields.resize_with(n, self.len, |_, _| 0.0);
        self.fields
    }

    /// Orthonormalises the columns of `block` against the basis and each other (A inner product) and appends them. Columns that
    /// are linearly dependent to working precision are dropped. Returns the indices of the columns kept.
    pub fn add(
        &mut self,
        mut block: Mat<f64>,
        mut viscosity: impl FnMut(MatRef<f64>) -> Mat<f64>,
    ) -> Vec<usize> {
        let mut held = vec![0.0; block.ncols()];
        // the second time for the rounding of the first
        for _ in 0..2 {
            let shares = self.images().transpose() * &block;
            subtract(block.as_mut(), self.fields.get(.., ..self.len), &shares);
            for (held, shares) in held.iter_mut().zip(shares.col_iter()) {
                *held += shares.squared_norm_l2();
            }
        }
        let mut images = viscosity(block.as_ref());
        let first = self.len;
        let mut kept = Vec::new();
        for (j, mut held) in held.into_iter().enumerate() {
            let mut own = block.get_mut(.., j..j + 1);
            let mut image = images.get_mut(.., j..j + 1);
            let before = energy(own.rb(), image.rb());
            held += self.remove(first, own.rb_mut(), image.rb_mut());
            if energy(own.rb(), image.rb()) < SHRUNK * before {
                // the remainder has lost as many digits against all others, and in its image
                image.copy_from(viscosity(own.rb()));
                self.remove(0, own.rb_mut(), image.rb_mut());
                image.copy_from(viscosity(own.rb()));
            }
            held += self.remove(first, own.rb_mut(), image.rb_mut());
            let length = energy(own.rb(), image.rb()).sqrt();
            if length > self.dependent * held.sqrt() && self.len < self.fields.ncols() {
                let unit = Scale(1.0 / length);
                let at = self.len..self.len + 1;
                self.fields
                    .get_mut(.., at.clone())
                    .copy_from(own.rb() * unit);
                self.images.get_mut(.., at).copy_from(image.rb() * unit);
                self.len += 1;
                kept.push(j);
            }
        }
        kept
    }

    /// Takes the fields from `first` on out of a column and its image; returns the energy that they held.
    fn remove(&self, first: usize, mut own: MatMut<f64>, image: MatMut<f64>) -> f64 {
        let images = self.images.get(.., first..self.len);
        let shares = images.transpose() * &own;
        subtract(own.rb_mut(), self.fields.get(.., first..self.len), &shares);
        subtract(image, images, &shares);
        shares.squared_norm_l2()
    }
}

/// Energy of a column, from its image.
fn energy(own: MatRef<f64>, image: MatRef<f64>) -> f64 {
    (own.col(0).transpose() * image.col(0)).max(0.0)
}

/// `to -= basis * shares`.
fn subtract(to: MatMut<f64>, basis: MatRef<f64>, shares: &Mat<f64>) {
    matmul(to, Accum::Add, basis, shares, -1.0, Par::Seq);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearly_dependent_columns_become_orthonormal_and_dependent_ones_are_left_out() {
        let n = 40;
        let viscosity =
            |x: MatRef<f64>| Mat::from_fn(n, x.ncols(), |i, j| (1 + i) as f64 * x[(i, j)]);
        let wave = |i: usize, k: usize| ((i + 1) as f64 * (k + 1) as f64 * 0.7).sin();
        let mut basis = Basis::new(n, 8);
        let kept = basis.add(Mat::from_fn(n, 2, wave), viscosity);
        assert_eq!(kept, [0, 1]);
        // a new direction, nearly the same once more, a sum of old ones, and what is new in it by a billionth
        let block = Mat::from_fn(n, 4, |i, j| match j {
            0 => wave(i, 5),
            1 => wave(i, 5) + 1e-9 * wave(i, 6),
            2 => wave(i, 0) - 3.0 * wave(i, 1),
            _ => wave(i, 0) + 1e-9 * wave(i, 7),
        });
        assert_eq!(basis.add(block, viscosity), [0, 1, 3]);
        let images = viscosity(basis.fields.get(.., ..basis.len()));
        let gram = basis.fields.get(.., ..basis.len()).transpose() * &images;
        assert!(
            (&gram - Mat::<f64>::identity(5, 5)).norm_max() < 1e-13,
            "{gram:?}"
        );
        assert!((images - basis.images()).norm_max() < 1e-12);
    }
}
