//! Matrices on the components of Voigt: (xx, yy, zz, yz, xz, xy), engineering shear.

use nalgebra::{
    Cholesky, DMatrix, Dyn, Matrix3, Matrix6, Matrix6x3, SymmetricEigen, Vector3, Vector6,
};
use std::f64::consts::SQRT_2;

/// Components of a strain or stress in Voigt's order, by their axes.
pub const COMPONENTS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [1, 2], [0, 2], [0, 1]];

/// Matrix on the components of Voigt.
pub type Voigt = Matrix6<f64>;

/// The components of a plane strain or stress.
const PLANE: [usize; 3] = [0, 1, 5];
const ALL: [usize; 6] = [0, 1, 2, 3, 4, 5];

/// Most iterations for the eigenvalues of a matrix, which take a few per row.
const MOST_ITERATIONS: usize = 10_000;

/// The components that a dimension has, in Voigt's order.
pub fn components(dimension: usize) -> &'static [usize] {
    if dimension == 2 { &PLANE } else { &ALL }
}

/// Engineering components of a symmetric strain.
pub fn engineering(strain: &Matrix3<f64>) -> Vector6<f64> {
    Vector6::from_fn(|i, _| {
        let [p, q] = COMPONENTS[i];
        if p == q {
            strain[(p, p)]
        } else {
            strain[(p, q)] + strain[(q, p)]
        }
    })
}

/// The tensor with these stress components.
pub fn tensor(stress: &Vector6<f64>) -> Matrix3<f64> {
    let mut out = Matrix3::zeros();
    for (value, [p, q]) in stress.iter().zip(COMPONENTS) {
        out[(p, q)] = *value;
        out[(q, p)] = *value;
    }
    out
}

/// Engineering strains of a shape function with this gradient, one column per component of the displacement.
pub(super) fn strains(g: &Vector3<f64>) -> Matrix6x3<f64> {
    let mut out = Matrix6x3::zeros();
    for (row, [p, q]) in COMPONENTS.into_iter().enumerate() {
        out[(row, p)] = g[q];
        out[(row, q)] = g[p];
    }
    out
}

/// `lambda tr(eps) I + two_mu eps`.
pub fn isotropic(lambda: f64, two_mu: f64) -> Voigt {
    Voigt::from_fn(|i, j| {
        let shared = if i < 3 && j < 3 { lambda } else { 0.0 };
        let own = match (i == j, i < 3) {
            (true, true) => two_mu,
            (true, false) => two_mu / 2.0,
            _ => 0.0,
        };
        shared + own
    })
}

/// The matrix in global axes of one in the axes whose directions are the rows of `axes`, which are orthonormal.
pub fn turned(matrix: &Voigt, axes: &Matrix3<f64>) -> Voigt {
    // strains in the axes from those in global ones
    let mut to_axes = Voigt::zeros();
    for (column, [p, q]) in COMPONENTS.into_iter().enumerate() {
        let mut unit = Matrix3::zeros();
        let value = if p == q { 1.0 } else { 0.5 };
        unit[(p, q)] = value;
        unit[(q, p)] = value;
        let there = axes * unit * axes.transpose();
        to_axes.set_column(column, &engineering(&there));
    }
    let turned = to_axes.transpose() * matrix * to_axes;
    (turned + turned.transpose()) / 2.0
}

/// The matrix in the Frobenius metric, on the components of a dimension.
pub(super) fn metric(d: &Voigt, dimension: usize) -> DMatrix<f64> {
    let of = components(dimension);
    let root = |i: usize| if i < 3 { 1.0 } else { SQRT_2 };
    DMatrix::from_fn(of.len(), of.len(), |i, j| {
        let (i, j) = (of[i], of[j]);
        d[(i, j)] * root(i) * root(j)
    })
}

/// Eigenvalues and eigenvectors; `None` for numbers that are not finite.
pub(super) fn eigen(matrix: DMatrix<f64>) -> Option<SymmetricEigen<f64, Dyn>> {
    if !matrix.iter().all(|value| value.is_finite()) {
        return None;
    }
    SymmetricEigen::try_new(matrix, f64::EPSILON, MOST_ITERATIONS)
}

pub(super) fn extreme_eigenvalues(matrix: DMatrix<f64>) -> [f64; 2] {
    match eigen(matrix) {
        Some(found) => {
            let values = found.eigenvalues.iter();
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                [low.min(*value), high.max(*value)]
            })
        }
        None => [f64::NAN; 2],
    }
}

/// Smallest and largest eigenvalue over all strains of a dimension.
pub(super) fn extremes(d: &Voigt, dimension: usize) -> [f64; 2] {
    extreme_eigenvalues(metric(d, dimension))
}

/// Smallest and largest eigenvalue of `A^-1 B` over all strains of a dimension; not numbers where A is not positive.
pub(super) fn rates(a: &Voigt, b: &Voigt, dimension: usize) -> [f64; 2] {
    let Some(factor) = Cholesky::new(metric(a, dimension)) else {
        return [f64::NAN; 2];
    };
    let lower = factor.l_dirty();
    let mut pair = metric(b, dimension);
    let solved = lower.solve_lower_triangular_mut(&mut pair);
    pair.transpose_mut();
    let solved = solved && lower.solve_lower_triangular_mut(&mut pair);
    match solved {
        true => extreme_eigenvalues((&pair + pair.transpose()) / 2.0),
        false => [f64::NAN; 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    /// A turned matrix gives the stress that the fourth-order tensor gives: turn the strain, apply, turn the stress back.
    #[test]
    fn a_turned_matrix_is_the_turned_tensor() {
        let any =
            Voigt::from_fn(|i, j| ((i + 1) * (j + 1)) as f64 + if i == j { 30.0 } else { 0.0 });
        let axes = *Rotation3::from_euler_angles(0.4, -0.8, 1.3).matrix();
        let found = turned(&any, &axes);
        let strain = Matrix3::new(0.3, -0.2, 0.5, -0.2, 0.1, 0.4, 0.5, 0.4, -0.8);
        let there = axes * strain * axes.transpose();
        let stress = axes.transpose() * tensor(&(any * engineering(&there))) * axes;
        let difference = tensor(&(found * engineering(&strain))) - stress;
        assert!(difference.amax() < 1e-13 * stress.amax());
    }

    #[test]
    fn eigenvalues_are_those_in_the_frobenius_metric() {
        let mut matrix = isotropic(0.0, 1.0);
        matrix[(5, 5)] = 3.0;
        // the strain e1 e2 + e2 e1 has the square 2 and the engineering component 2
        assert!((extremes(&matrix, 2)[1] - 6.0).abs() < 1e-14);
        assert!((extremes(&matrix, 2)[0] - 1.0).abs() < 1e-14);
    }
}
