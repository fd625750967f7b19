//! Bodies of linear simplices, clamped at x = 0, condensed onto all components of the nodes of the face that is in contact: the
//! last coordinate is 0 there. Written for the tests, without the crate.

use faer::Mat;

/// Viscosity `mu1 tr(e) I + mu2 e`, elasticity `lambda tr(e) I + E / (1 + kappa) e`.
const VISCOSITY: [f64; 2] = [0.05, 0.1];
const ELASTICITY: [f64; 2] = [0.3 / (0.4 * 0.7), 1.0 / 1.3];

/// Matrices of a body on the velocities of its contact, node by node, the normal component last.
pub struct Condensed {
    pub nodes: usize,
    pub components: usize,
    /// Condensed operator of A + theta_k B.
    pub s: Mat<f64>,
    /// Its inverse.
    pub c: Mat<f64>,
    /// Area of a contact node.
    pub weight: f64,
}

/// A body of `cells` cubes along every axis (the last one normal to the contact), each cut into simplices.
pub fn condensed(cells: &[usize], theta_k: f64) -> Condensed {
    let dimension = cells.len();
    let size = 1.0 / cells[0] as f64;
    let points: Vec<usize> = cells.iter().map(|n| n + 1).collect();
    // numbers with x slowest: the band is one layer wide
    let number = |at: &[usize]| {
        let inner = at.iter().zip(&points).skip(1);
        inner.fold(at[0], |number, (i, n)| number * n + i)
    };
    let layer: usize = points.iter().skip(1).product();
    let count = layer * cells[0];
    let half = (layer + layer / points[1].max(1) + 2) * dimension;
    let len = count * dimension;
    // a lower band, by rows, without the clamped layer
    let mut band = vec![0.0; len * (half + 1)];
    let mut add = |i: usize, j: usize, value: f64| {
        if i >= j {
            assert!(i - j <= half);
            band[i * (half + 1) + half + j - i] += value;
        }
    };
    let [form] = [std::array::from_fn::<f64, 2, _>(|i| {
        VISCOSITY[i] + theta_k * ELASTICITY[i]
    })];
    for cell in grid(cells) {
        for order in permutations(dimension) {
            let mut corner = cell.clone();
            let mut nodes = vec![number(&corner)];
            for axis in &order {
                corner[*axis] += 1;
                nodes.push(number(&corner));
            }
            let element = element(&order, size, form);
            for (a, na) in nodes.iter().enumerate() {
                for (b, nb) in nodes.iter().enumerate() {
                    if *na < layer || *nb < layer {
                        continue;
                    }
                    for i in 0..dimension {
                        for j in 0..dimension {
                            let row = (na - layer) * dimension + i;
                            let column = (nb - layer) * dimension + j;
                            add(row, column, element[a * dimension + i][b * dimension + j]);
                        }
                    }
                }
            }
        }
    }
    factor(&mut band, half);
    let mut face = cells.to_vec();
    face[dimension - 1] = 0;
    let ports: Vec<usize> = grid(&face.iter().map(|n| n + 1).collect::<Vec<_>>())
        .into_iter()
        .filter(|at| at[0] > 0)
        .flat_map(|at| (0..dimension).map(move |i| (at.clone(), i)))
        .map(|(at, i)| (number(&at) - layer) * dimension + i)
        .collect();
    let n = ports.len();
    let mut c = Mat::zeros(n, n);
    for (j, port) in ports.iter().enumerate() {
        let mut x = vec![0.0; len];
        x[*port] = 1.0;
        substitute(&band, half, &mut x);
        for (i, port) in ports.iter().enumerate() {
            c[(i, j)] = x[*port];
        }
    }
    Condensed {
        nodes: n / dimension,
        components: dimension - 1,
        s: inverse(&c),
        c,
        weight: size.powi(dimension as i32 - 1),
    }
}

/// All index tuples below `counts`.
fn grid(counts: &[usize]) -> Vec<Vec<usize>> {
    counts.iter().fold(vec![vec![]], |all, count| {
        all.iter()
            .flat_map(|at| (0..*count).map(move |i| [at.as_slice(), &[i]].concat()))
            .collect()
    })
}

fn permutations(count: usize) -> Vec<Vec<usize>> {
    if count == 2 {
        return vec![vec![0, 1], vec![1, 0]];
    }
    vec![
        vec![0, 1, 2],
        vec![0, 2, 1],
        vec![1, 0, 2],
        vec![1, 2, 0],
        vec![2, 0, 1],
        vec![2, 1, 0],
    ]
}

/// Matrix of the simplex that goes from a corner along the axes in this order.
fn element(order: &[usize], size: f64, [volumetric, shear]: [f64; 2]) -> Vec<Vec<f64>> {
    let d = order.len();
    let volume = size.powi(d as i32) / (1..=d).product::<usize>() as f64;
    // the shape functions of such a simplex change along two axes each
    let mut gradients = vec![vec![0.0; d]; d + 1];
    for (step, axis) in order.iter().enumerate() {
        gradients[step][*axis] -= 1.0 / size;
        gradients[step + 1][*axis] += 1.0 / size;
    }
    let mut matrix = vec![vec![0.0; (d + 1) * d]; (d + 1) * d];
    for a in 0..=d {
        for b in 0..=d {
            let dot: f64 = (0..d).map(|k| gradients[a][k] * gradients[b][k]).sum();
            for i in 0..d {
                for j in 0..d {
                    let trace = volumetric * gradients[a][i] * gradients[b][j];
                    let diagonal = if i == j { dot } else { 0.0 };
                    let strain = 0.5 * shear * (diagonal + gradients[a][j] * gradients[b][i]);
                    matrix[a * d + i][b * d + j] = volume * (trace + strain);
                }
            }
        }
    }
    matrix
}

/// Cholesky factor of a lower band, by rows.
fn factor(band: &mut [f64], half: usize) {
    let width = half + 1;
    for i in 0..band.len() / width {
        for j in i.saturating_sub(half)..=i {
            let first = i.saturating_sub(half).max(j.saturating_sub(half));
            let mut sum = band[i * width + half + j - i];
            for k in first..j {
                sum -= band[i * width + half + k - i] * band[j * width + half + k - j];
            }
            band[i * width + half + j - i] = if i == j {
                assert!(sum > 0.0);
                sum.sqrt()
            } else {
                sum / band[j * width + half]
            };
        }
    }
}

fn substitute(band: &[f64], half: usize, x: &mut [f64]) {
    let width = half + 1;
    for i in 0..x.len() {
        for j in i.saturating_sub(half)..i {
            x[i] -= band[i * width + half + j - i] * x[j];
        }
        x[i] /= band[i * width + half];
    }
    for i in (0..x.len()).rev() {
        x[i] /= band[i * width + half];
        for j in i.saturating_sub(half)..i {
            x[j] -= band[i * width + half + j - i] * x[i];
        }
    }
}

/// Inverse of a symmetric positive definite matrix, by Gauss and Jordan, symmetric to the bit.
fn inverse(a: &Mat<f64>) -> Mat<f64> {
    let n = a.nrows();
    let mut work = Mat::from_fn(n, 2 * n, |i, j| {
        if j < n {
            a[(i, j)]
        } else {
            f64::from(u8::from(j - n == i))
        }
    });
    for k in 0..n {
        let pivot = work[(k, k)];
        for j in 0..2 * n {
            work[(k, j)] /= pivot;
        }
        for i in (0..n).filter(|i| *i != k) {
            let factor = work[(i, k)];
            if factor != 0.0 {
                for j in k..2 * n {
                    work[(i, j)] -= factor * work[(k, j)];
                }
            }
        }
    }
    Mat::from_fn(n, n, |i, j| 0.5 * (work[(i, n + j)] + work[(j, n + i)]))
}
