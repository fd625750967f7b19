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

/// A body whose viscosity and elasticity are lower bands, by rows, without the clamped layer.
pub struct Body {
    pub dimension: usize,
    /// Free components.
    pub len: usize,
    half: usize,
    matrices: [Vec<f64>; 2],
    /// Components of the contact nodes.
    pub ports: Vec<usize>,
    /// Normal components of the nodes opposite to the contact.
    pub opposite: Vec<usize>,
    /// Area of a contact node.
    pub weight: f64,
}

/// A factor of A + theta_k B.
pub struct Factor {
    band: Vec<f64>,
    half: usize,
}

/// A body of `cells` cubes along every axis (the last one normal to the contact), each cut into simplices, condensed.
pub fn condensed(cells: &[usize], theta_k: f64) -> Condensed {
    let body = Body::new(cells);
    body.condensed(&body.factor(theta_k))
}

impl Body {
    pub fn new(cells: &[usize]) -> Body {
        let dimension = cells.len();
        let size = 1.0 / cells[0] as f64;
        let points: Vec<usize> = cells.iter().map(|n| n + 1).collect();
        // numbers with x slowest: the band is one layer wide
        let number = |at: &[usize]| {
            let inner = at.iter().zip(&points).skip(1);
            inner.fold(at[0], |number, (i, n)| number * n + i)
        };
        let layer: usize = points.iter().skip(1).product();
        let half = (layer + layer / points[1].max(1) + 2) * dimension;
        let len = layer * cells[0] * dimension;
        let assemble = |form: [f64; 2]| {
            let mut band = vec![0.0; len * (half + 1)];
            let mut add = |i: usize, j: usize, value: f64| {
                if i >= j {
                    assert!(i - j <= half);
                    band[i * (half + 1) + half + j - i] += value;
                }
            };
            for cell in grid(cells) {
                for order in permutations(dimension) {
                    let mut corner = cell.clone();
                    let mut nodes = vec![number(&corner)];
                    for axis in &order {
                        corner[*axis] += 1;
                        nodes.push(number(&corner));
                    }
                    let element = element(&order, size, form);
                    // component of a node of the element, unless it is clamped
                    let component = |at: usize| {
                        let node = nodes[at / dimension].checked_sub(layer)?;
                        Some(node * dimension + at % dimension)
                    };
                    for (a, row) in element.iter().enumerate() {
                        for (b, value) in row.iter().enumerate() {
                            if let (Some(i), Some(j)) = (component(a), component(b)) {
                                add(i, j, *value);
                            }
                        }
                    }
                }
            }
            band
        };
        let face = |last: usize| {
            let mut counts = points.clone();
            counts[dimension - 1] = 1;
            let mut nodes = grid(&counts);
            nodes.retain(|at| at[0] > 0);
            nodes.iter_mut().for_each(|at| at[dimension - 1] = last);
            nodes
        };
        let first = |at: &Vec<usize>| (number(at) - layer) * dimension;
        Body {
            dimension,
            len,
            half,
            matrices: [assemble(VISCOSITY), assemble(ELASTICITY)],
            ports: face(0)
                .iter()
                .flat_map(|at| first(at)..first(at) + dimension)
                .collect(),
            opposite: face(cells[dimension - 1])
                .iter()
                .map(|at| first(at) + dimension - 1)
                .collect(),
            weight: size.powi(dimension as i32 - 1),
        }
    }

    pub fn factor(&self, theta_k: f64) -> Factor {
        let [a, b] = &self.matrices;
        let mut band: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + theta_k * b).collect();
        factor(&mut band, self.half);
        Factor {
            band,
            half: self.half,
        }
    }

    pub fn condensed(&self, factor: &Factor) -> Condensed {
        let n = self.ports.len();
        let mut c = Mat::zeros(n, n);
        for (j, port) in self.ports.iter().enumerate() {
            let mut x = vec![0.0; self.len];
            x[*port] = 1.0;
            factor.solve(&mut x);
            for (i, port) in self.ports.iter().enumerate() {
                c[(i, j)] = x[*port];
            }
        }
        Condensed {
            nodes: n / self.dimension,
            components: self.dimension - 1,
            s: inverse(&c),
            c,
            weight: self.weight,
        }
    }

    /// `B u`.
    pub fn elastic(&self, u: &[f64]) -> Vec<f64> {
        let (half, width) = (self.half, self.half + 1);
        let mut forces = vec![0.0; u.len()];
        for i in 0..u.len() {
            for j in i.saturating_sub(half)..=i {
                let value = self.matrices[1][i * width + half + j - i];
                forces[i] += value * u[j];
                if i != j {
                    forces[j] += value * u[i];
                }
            }
        }
        forces
    }
}

impl Factor {
    pub fn solve(&self, x: &mut [f64]) {
        substitute(&self.band, self.half, x);
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
