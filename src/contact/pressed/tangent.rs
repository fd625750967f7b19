//! The tangent of the contact problem with pressure at its solution.
//!
//! With `d` for the derivative, `n` the slip direction, `B_r`, `B_p`, `B_s` the slopes of the bound by slip rate, normal force and
//! accumulated slip, and `K` the stiffness of a foundation that gives way:
//!
//! ```text
//! open nodes       S dv = dr
//! closed nodes     dv_n = - dgap_base / gap_rate,   dp = S_n dv - dr_n
//! giving way       dp = dF - K (dgap_base + gap_rate dv_n),   S_n dv - dp = dr_n
//! sticking nodes   dv_t = 0,   dlam = dr_t - S_t dv
//! slipping nodes   S_t dv + dlam = dr_t,   dlam = [B_r n n^T + (B / |v_t|)(I - n n^T)] dv_t + (B_p dp + B_s ds + dB) n
//! ```
//!
//! `dB` is what the bound changes by otherwise: by the memory of the law; `dF` what the force changes by that of the foundation.

use super::problem::{NormalCondition, PressedProblem};
use crate::contact::SlipPath;
use crate::contact::problem::norm;
use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};

/// What a node does.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Motion {
    Open,
    Closed,
    /// The foundation gives way; K, N/m.
    GivesWay(f64),
}

/// Derivatives of the friction force of a slipping node.
#[derive(Debug, Clone, Copy, Default)]
struct Slip {
    /// By the tangential velocity.
    block: [[f64; 2]; 2],
    /// By the normal force, and by the accumulated slip.
    by_force: [f64; 2],
    by_slip: [f64; 2],
    direction: [f64; 2],
}

struct Node {
    motion: Motion,
    /// `None` where it sticks; an open node slips without friction.
    slip: Option<Slip>,
    /// Growth of the gap by the normal velocity.
    gap_rate: f64,
}

/// The tangent at a solution.
pub struct PressedTangent {
    nodes: Vec<Node>,
    factor: PartialPivLu<f64>,
}

/// Derivatives along one direction, by nodes and their components as in a problem.
pub struct Derivatives<'a> {
    /// Of the condensed load.
    pub load: &'a [f64],
    /// Of the accumulated slip before the stage, and of the gap at the normal velocity 0; one per node.
    pub slip: &'a [f64],
    pub gap: &'a [f64],
    /// Of the bound of a node at fixed slip rate, slip and force, N; empty where there is nothing else it depends on.
    pub bound: &'a [f64],
    /// Of the force of a node at a fixed gap, N; empty where the foundation remembers nothing.
    pub pressing: &'a [f64],
    /// Of velocities and forces: the result.
    pub velocity: &'a mut [f64],
    pub force: &'a mut [f64],
    /// Of the growth of the accumulated slip.
    pub magnitude: &'a mut [f64],
}

impl PressedTangent {
    /// At the solution `velocity`, `force` of a problem.
    pub fn new(problem: &PressedProblem, velocity: &[f64], force: &[f64]) -> PressedTangent {
        let node = |node: usize| {
            let (p, v) = (
                force[problem.normal(node)],
                &velocity[problem.tangential(node)],
            );
            let (condition, gap_rate) = problem.condition(node);
            let motion = match condition {
                _ if problem.is_away(node) => Motion::Open,
                NormalCondition::Bilateral => Motion::Closed,
                _ if p <= 0.0 => Motion::Open,
                NormalCondition::Unilateral => Motion::Closed,
                NormalCondition::Compliance { exponent } => {
                    let stiffness = problem.stiffness[node];
                    Motion::GivesWay(match problem.relaxing.get(node) {
                        // p = c d^m, so that c m d^(m-1) = m p / d
                        None => {
                            let depth = (p / stiffness).powf(1.0 / exponent);
                            exponent * p / depth
                        }
                        Some([growth, _]) => {
                            let normal = velocity[problem.normal(node)];
                            let depth = -(problem.gap_base[node] + gap_rate * normal);
                            exponent * stiffness * depth.powf(exponent - 1.0) + growth
                        }
                    })
                }
            };
            let slip = match motion {
                Motion::Open => Some(Slip::default()),
                _ => slip(problem, node, v, p),
            };
            Node {
                motion,
                slip,
                gap_rate,
            }
        };
        let nodes: Vec<Node> = (0..problem.nodes()).map(node).collect();
        let matrix = matrix(problem, &nodes);
        PressedTangent {
            nodes,
            factor: matrix.partial_piv_lu(),
        }
    }

    /// Derivatives of the solution along one direction.
    pub fn apply(&self, problem: &PressedProblem, d: &mut Derivatives) {
        let c = problem.components;
        let pressing = d.pressing;
        let pressing = |node: usize| pressing.get(node).copied().unwrap_or(0.0);
        let mut column = Mat::zeros(d.velocity.len(), 1);
        for (at, node) in self.nodes.iter().enumerate() {
            let normal = problem.normal(at);
            let dp = match node.motion {
                Motion::Open => 0.0,
                Motion::Closed => -d.load[normal],
                Motion::GivesWay(stiffness) => pressing(at) - stiffness * d.gap[at],
            };
            column[(normal, 0)] = match node.motion {
                Motion::Open => d.load[normal],
                Motion::Closed => -d.gap[at] / node.gap_rate,
                Motion::GivesWay(_) => d.load[normal] + dp,
            };
            if let Some(slip) = &node.slip {
                let bound = d.bound.get(at).copied().unwrap_or(0.0);
                for (i, row) in problem.tangential(at).enumerate() {
                    let given = slip.by_force[i] * dp
                        + slip.by_slip[i] * d.slip[at]
                        + slip.direction[i] * bound;
                    column[(row, 0)] = d.load[row] - given;
                }
            }
        }
        self.factor.solve_in_place(&mut column);
        for (to, from) in d.velocity.iter_mut().zip(column.col(0).iter()) {
            *to = *from;
        }
        for (at, node) in self.nodes.iter().enumerate() {
            let normal = problem.normal(at);
            let balance = |row: usize, velocity: &[f64]| {
                let products = problem.column(row).iter().zip(velocity);
                d.load[row] - products.map(|(s, v)| s * v).sum::<f64>()
            };
            d.force[normal] = match node.motion {
                Motion::Open => 0.0,
                Motion::Closed => -balance(normal, d.velocity),
                Motion::GivesWay(stiffness) => {
                    pressing(at) - stiffness * (d.gap[at] + node.gap_rate * d.velocity[normal])
                }
            };
            d.magnitude[at] = 0.0;
            let first = problem.tangential(at).start;
            let bound = d.bound.get(at).copied().unwrap_or(0.0);
            for i in 0..c {
                let row = first + i;
                d.force[row] = match &node.slip {
                    None => balance(row, d.velocity),
                    Some(slip) => {
                        d.magnitude[at] += slip.direction[i] * d.velocity[row];
                        let along = slip.block[i].iter().zip(&d.velocity[first..first + c]);
                        along.map(|(b, v)| b * v).sum::<f64>()
                            + slip.by_force[i] * d.force[normal]
                            + slip.by_slip[i] * d.slip[at]
                            + slip.direction[i] * bound
                    }
                };
            }
        }
    }
}

/// The slopes of a node that is pressed; `None` where it sticks.
fn slip(problem: &PressedProblem, node: usize, v: &[f64], p: f64) -> Option<Slip> {
    let rate = norm(v);
    // without a bound at rest a node at rest does not stick
    if rate == 0.0 && problem.bound(node, 0.0, p).bound > 0.0 {
        return None;
    }
    let law = problem.bound(node, rate, p);
    if rate == 0.0 {
        // no direction: what rises with the slip rate resists in all
        let mut slip = Slip::default();
        (slip.block[0][0], slip.block[1][1]) = (law.by_rate, law.by_rate);
        return Some(slip);
    }
    let path = problem.slip_path(node);
    // at one slip, whatever share of it the stage adds
    let total = path.base + path.per_rate * rate;
    let along_slip = |per_rate: f64| {
        let path = SlipPath {
            base: total - per_rate * rate,
            per_rate,
        };
        problem.bounds.evaluate(node, rate, p, path).by_rate
    };
    let by_slip = along_slip(1.0) - along_slip(0.0);
    let across = law.bound / rate;
    let mut slip = Slip::default();
    for (n, v) in slip.direction.iter_mut().zip(v) {
        *n = v / rate;
    }
    let n = slip.direction;
    for i in 0..2 {
        slip.by_force[i] = law.by_force * n[i];
        slip.by_slip[i] = by_slip * n[i];
        for j in 0..2 {
            let identity = f64::from(u8::from(i == j));
            slip.block[i][j] = law.by_rate * n[i] * n[j] + across * (identity - n[i] * n[j]);
        }
    }
    Some(slip)
}

/// The matrix of the equations for `dv`.
fn matrix(problem: &PressedProblem, nodes: &[Node]) -> Mat<f64> {
    let (c, len) = (problem.components, problem.r.len());
    let mut matrix = Mat::zeros(len, len);
    let mut add_row = |row: usize, of: usize, factor: f64| {
        for (j, s) in problem.column(of).iter().enumerate() {
            matrix[(row, j)] += factor * s;
        }
    };
    for (at, node) in nodes.iter().enumerate() {
        let normal = problem.normal(at);
        if node.motion != Motion::Closed {
            add_row(normal, normal, 1.0);
        }
        let Some(slip) = &node.slip else { continue };
        for (i, row) in problem.tangential(at).enumerate() {
            add_row(row, row, 1.0);
            if node.motion == Motion::Closed {
                add_row(row, normal, slip.by_force[i]);
            }
        }
    }
    for (at, node) in nodes.iter().enumerate() {
        let normal = problem.normal(at);
        let first = problem.tangential(at).start;
        let mut falls = 0.0;
        match node.motion {
            Motion::Open => {}
            Motion::Closed => matrix[(normal, normal)] = 1.0,
            Motion::GivesWay(stiffness) => {
                falls = stiffness * node.gap_rate;
                matrix[(normal, normal)] += falls;
            }
        }
        for i in 0..c {
            match &node.slip {
                None => matrix[(first + i, first + i)] = 1.0,
                Some(slip) => {
                    matrix[(first + i, normal)] -= slip.by_force[i] * falls;
                    for j in 0..c {
                        matrix[(first + i, first + j)] += slip.block[i][j];
                    }
                }
            }
        }
    }
    matrix
}
