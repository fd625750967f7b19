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
