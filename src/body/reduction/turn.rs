//! A turn of the contact that brings a few directions onto its first coordinates: a product of Householder reflections.

use faer::{Mat, MatMut};

/// The turn Q: its first columns are the directions, but for their signs.
pub struct Turn {
    /// Unit normals of the reflections, which are multiplied from left to right.
    normals: Vec<Vec<f64>>,
}

impl Turn {
    /// From orthonormal directions (contact x count).
    pub fn new(directions: &Mat<f64>) -> Turn {
        let mut turn = Turn {
            normals: Vec::new(),
        };
        for j in 0..directions.ncols() {
            let mut normal = directions.get(.., j..j + 1).to_owned();
            turn.back(normal.as_mut());
            let mut normal: Vec<f64> = normal.col(0).iter().copied().collect();
            normal[..j].fill(0.0);
            let length = normal.iter().map(|v| v * v).sum::<f64>().sqrt();
            normal[j] += length.copysign(normal[j]);
            let length = normal.iter().map(|v| v * v).sum::<f64>().sqrt();
            normal.iter_mut().for_each(|v| *v /= length);
            turn.normals.push(normal);
        }
        turn
    }

    /// Directions.
    pub fn len(&self) -> usize {
        self.normals.len()
    }

    /// `Q^T` times the first rows of a matrix.
    pub fn back(&self, mut to: MatMut<f64>) {
        self.normals
            .iter()
            .for_each(|normal| reflect(normal, to.as_mut()));
    }

    /// `Q` times the first rows of a matrix.
    pub fn forth(&self, mut to: MatMut<f64>) {
        let normals = self.normals.iter().rev();
        normals.for_each(|normal| reflect(normal, to.as_mut()));
    }

    /// The first rows and columns of a symmetric matrix in the turned coordinates.
    pub fn of(&self, matrix: &Mat<f64>) -> Mat<f64> {
        let mut turned = matrix.clone();
        self.back(turned.as_mut());
        self.back(turned.as_mut().transpose_mut());
        turned
    }
}

/// Reflects the first rows.
fn reflect(normal: &[f64], mut to: MatMut<f64>) {
    for j in 0..to.ncols() {
        let sum: f64 = normal.iter().enumerate().map(|(i, n)| n * to[(i, j)]).sum();
        for (i, n) in normal.iter().enumerate() {
            to[(i, j)] -= 2.0 * sum * n;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_become_the_first_coordinates() {
        let directions = Mat::from_fn(7, 3, |i, j| ((i + 1) as f64 * (j + 1) as f64).sin());
        let directions = directions.qr().compute_thin_Q();
        let turn = Turn::new(&directions);
        let mut turned = directions.clone();
        turn.back(turned.as_mut());
        for j in 0..3 {
            for i in 0..7 {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((turned[(i, j)].abs() - expected).abs() < 1e-14);
            }
        }
        turn.forth(turned.as_mut());
        assert!((turned - &directions).norm_max() < 1e-14);

        let matrix = Mat::from_fn(7, 7, |i, j| 1.0 / (1 + i + j) as f64);
        let of = turn.of(&matrix);
        assert!((of.transpose() - &of).norm_max() < 1e-14);
        let (own, whole) = (of[(0, 0)], directions.transpose() * &matrix * &directions);
        assert!((own - whole[(0, 0)]).abs() < 1e-14);
    }
}
