//! The step of large contacts with two tangential components per node: conjugate gradients with `K = S + D` at the present point.
//!
//! A factor costs a third of the cube of the slipping components, and with two components it hardly ever outlives an iteration:
//! above [`LARGE`] components it is most of a step. Conjugate gradients need a few dozen products with S, of which they read one
//! half in single precision (the residual of the law is that of S itself), and are stopped early: an inexact Newton step (Dembo, Eisenstat, Steihaug, SINUM 19, 1982; forcing term of Eisenstat and
//! Walker, SISC 17, 1996, choice 2). The preconditioner is K on clusters of neighbouring nodes, factored at every step for
//! little, so that no state and no bits depend on what was factored before.
//!
//! Started from zero, every iterate descends. Where a search direction has no positive curvature, K is not positive definite, and the next
//! share of the weakening is tried (see `attempts`).

use super::second_variation::SecondVariation;
use crate::linalg::{DenseCholesky, column, dot, multiply_lower};
use faer::{Mat, MatRef};

/// Components from which on steps are found iteratively. At 2450 a factor takes four times as long as the iterations, at 1122 they
/// are equal (docs/measured.md).
pub const LARGE: usize = 1800;
/// Most nodes of a cluster. Their matrices are small enough to be inverted (`linalg::cholesky`).
const CLUSTER: usize = 32;
/// Largest and first share of the imbalance that a step may leave, and the factor of the forcing term.
const LOOSEST: f64 = 0.1;
const FORCING: f64 = 0.9;
/// Share of what the solver asks for to which a step is solved at most.
const SAFETY: f64 = 0.1;
/// Most products of a step.
const MOST_PRODUCTS: usize = 400;

/// Scratch of the iteration.
pub struct Iterative {
    clusters: Vec<Cluster>,
    /// Lower half of S in single precision, and whether it is that of the present solve.
    single: Mat<f32>,
    is_known: bool,
    /// Components of the nodes that move, in ascending order.
    moving: Vec<usize>,
    /// D at every node that moves.
    blocks: Vec<[f64; 3]>,
    residual: Vec<f64>,
    preconditioned: Vec<f64>,
    search: Vec<f64>,
    image: Vec<f64>,
    half: Vec<f64>,
    of_cluster: [Vec<f64>; 2],
    /// Size of the imbalance at the last step of the solve, N.
    last_size: f64,
    /// What share of the imbalance would be enough.
    pub enough: f64,
    /// Products with S so far.
    pub products: u64,
}

/// Neighbouring nodes.
struct Cluster {
    nodes: Vec<usize>,
    /// Components of those that move.
    rows: Vec<usize>,
    cholesky: DenseCholesky,
}

impl Iterative {
    /// For contact nodes at these places, m.
    pub fn new(points: &[[f64; 3]]) -> Iterative {
        let (nodes, len) = (points.len(), 2 * points.len());
        let mut clusters = Vec::new();
        divide(points, &mut (0..nodes).collect::<Vec<_>>(), &mut clusters);
        let padded = DenseCholesky::padded(2 * CLUSTER);
        Iterative {
            clusters,
            single: Mat::zeros(len, len),
            is_known: false,
            moving: Vec::with_capacity(len),
            blocks: vec![[0.0; 3]; nodes],
            residual: vec![0.0; len],
            preconditioned: vec![0.0; len],
            search: vec![0.0; len],
            image: vec![0.0; len],
            half: vec![0.0; padded],
            of_cluster: [vec![0.0; padded], vec![0.0; padded]],
            last_size: 0.0,
            enough: 0.0,
            products: 0,
        }
    }

    /// A solve begins.
    pub fn begin(&mut self) {
        (self.last_size, self.is_known) = (0.0, false);
    }

    /// Finds the step of the matrix wanted from the gradient of W, in which nodes that stick are zero. False where the matrix is not
    /// positive definite, or not of numbers.
    pub fn solve(&mut self, wanted: &SecondVariation, gradient: &[f64], step: &mut [f64]) -> bool {
        if !self.prepare(wanted) {
            return false;
        }
        if !self.is_known {
            self.is_known = true;
            round_lower(wanted.problem.s, &mut self.single);
        }
        step.fill(0.0);
        self.search.fill(0.0);
        for i in &self.moving {
            self.residual[*i] = -gradient[*i];
        }
        let size = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        let ratio = if self.last_size > 0.0 {
            size / self.last_size
        } else {
            1.0
        };
        let share = (FORCING * ratio * ratio).clamp((SAFETY * self.enough).min(LOOSEST), LOOSEST);
        self.last_size = size;
        self.precondition();
        let mut energy = self.along(&self.residual, &self.preconditioned);
        let target = share * share * energy;
        let mut before = f64::INFINITY;
        for _ in 0..MOST_PRODUCTS {
            let weight = energy / before;
            for i in &self.moving {
                self.search[*i] = self.preconditioned[*i] + weight * self.search[*i];
            }
            self.apply();
            let curvature = self.along(&self.search, &self.image);
            // what is not a number is not positive
            if curvature.is_nan() || curvature <= 0.0 {
                return false;
            }
            let length = energy / curvature;
            for i in &self.moving {
                step[*i] += length * self.search[*i];
                self.residual[*i] -= length * self.image[*i];
            }
            self.precondition();
            before = energy;
            energy = self.along(&self.residual, &self.preconditioned);
            if energy <= target {
                break;
            }
        }
        energy.is_finite()
    }

    /// D, what moves, and the matrices of the clusters. False where one is not positive definite.
    fn prepare(&mut self, wanted: &SecondVariation) -> bool {
        self.moving.clear();
        for (node, block) in self.blocks.iter_mut().enumerate() {
            if wanted.moves(node) {
                self.moving.extend([2 * node, 2 * node + 1]);
                *block = wanted.curvature(node);
            }
        }
        let (blocks, s) = (&self.blocks, wanted.problem.s);
        self.clusters.iter_mut().all(|cluster| {
            let Cluster {
                nodes,
                rows,
                cholesky,
            } = cluster;
            rows.clear();
            for node in nodes.iter().filter(|node| wanted.moves(**node)) {
                rows.extend([2 * node, 2 * node + 1]);
            }
            let is_made = rows.is_empty()
                || cholesky.factor(rows.len(), |j, entries| {
                    let own = column(s, rows[j]);
                    for (entry, row) in entries.iter_mut().zip(&rows[j..]) {
                        *entry = own[*row];
                    }
                    let [xx, xy, yy] = blocks[rows[j] / 2];
                    if rows[j].is_multiple_of(2) {
                        entries[0] += xx;
                        entries[1] += xy;
                    } else {
                        entries[0] += yy;
                    }
                });
            if is_made && !rows.is_empty() {
                cholesky.prepare_solves();
            }
            is_made
        })
    }

    /// `preconditioned` from `residual`.
    fn precondition(&mut self) {
        let [from, to] = &mut self.of_cluster;
        for cluster in &self.clusters {
            let rows = &cluster.rows;
            if rows.is_empty() {
                continue;
            }
            let padded = cluster.cholesky.padded_order();
            from[rows.len()..padded].fill(0.0);
            for (from, row) in from.iter_mut().zip(rows) {
                *from = self.residual[*row];
            }
            let half = &mut self.half[..padded];
            cluster.cholesky.solve_lower(&from[..padded], half);
            cluster.cholesky.solve_upper(half, &mut to[..padded]);
            for (to, row) in to.iter().zip(rows) {
                self.preconditioned[*row] = *to;
            }
        }
    }

    /// `image = K search` where nodes move.
    fn apply(&mut self) {
        self.products += 1;
        multiply_lower(self.single.as_ref(), &self.search, &mut self.image);
        for i in self.moving.iter().step_by(2) {
            let [xx, xy, yy] = self.blocks[i / 2];
            let (x, y) = (self.search[*i], self.search[i + 1]);
            self.image[*i] += xx * x + xy * y;
            self.image[i + 1] += xy * x + yy * y;
        }
    }

    /// Scalar product over what moves.
    fn along(&self, a: &[f64], b: &[f64]) -> f64 {
        if self.moving.len() == a.len() {
            return dot(a, b);
        }
        self.moving.iter().map(|i| a[*i] * b[*i]).sum()
    }
}

/// The lower half in single precision.
fn round_lower(s: MatRef<f64>, single: &mut Mat<f32>) {
    for j in 0..s.ncols() {
        let from = column(s, j)[j..].iter();
        let to = single.as_mut().col_mut(j).subrows_mut(j, s.nrows() - j);
        for (to, from) in to.iter_mut().zip(from) {
            *to = *from as f32;
        }
    }
}

/// Halves the nodes across their longest extent until they are few. The same for the same places, whatever their order.
fn divide(points: &[[f64; 3]], nodes: &mut [usize], clusters: &mut Vec<Cluster>) {
    if nodes.len() <= CLUSTER {
        let mut nodes = nodes.to_vec();
        nodes.sort_unstable();
        clusters.push(Cluster {
            rows: Vec::with_capacity(2 * nodes.len()),
            cholesky: DenseCholesky::new(2 * nodes.len()),
            nodes,
        });
        return;
    }
    let extent = |axis: usize| {
        let all = nodes.iter().map(|node| points[*node][axis]);
        let [low, high] = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        });
        high - low
    };
    let extents = [0, 1, 2].map(extent);
    let longest = if extents[1] > extents[0] { 1 } else { 0 };
    let axis = if extents[2] > extents[longest] {
        2
    } else {
        longest
    };
    nodes.sort_unstable_by(|a, b| {
        let places = points[*a][axis].total_cmp(&points[*b][axis]);
        places.then(a.cmp(b))
    });
    let (low, high) = nodes.split_at_mut(nodes.len() / 2);
    divide(points, low, clusters);
    divide(points, high, clusters);
}
