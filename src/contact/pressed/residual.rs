//! When a point is a solution: the imbalance at every node against what the node bears.

use super::point::Point;
use super::problem::PressedProblem;
use crate::contact::problem::{LARGEST_FLOOR, norm};

/// A node that bears less than this share of the most is measured against that share: a node that carries practically
/// nothing must not dictate the stop.
const SCALE_FLOOR: f64 = 1e-3;
/// Share of `eps (|S| |v| + |r|)` by which a node may be out of balance where rounding allows for no less.
const ROUNDING: f64 = 1.0;

/// What the imbalance of a point is measured against at least, N.
struct Measure {
    bound: f64,
    force: f64,
    meeting: f64,
}

/// Largest imbalance over the nodes, divided by what the node bears, and that node: tangentially its bound, normally its force,
/// and where no node of the contact has any, the forces that meet. NaN where a force is not a number.
pub fn worst_node(problem: &PressedProblem, point: &Point) -> (f64, usize) {
    let Some(measure) = measure(problem, point) else {
        return (f64::NAN, 0);
    };
    let mut worst = (0.0, 0);
    for node in 0..problem.nodes() {
        let residual = residual(problem, point, node, &measure);
        // what is not a number is the worst
        if residual > worst.0 || residual.is_nan() {
            worst = (residual, node);
        }
    }
    worst
}

/// What is left of the residual when rounding is taken into account; `None` where some node is out of balance by more than
/// `tolerance` times what it bears and more than rounding.
pub fn residual_beyond_rounding(
    problem: &PressedProblem,
    point: &Point,
    tolerance: f64,
) -> Option<f64> {
    let measure = measure(problem, point)?;
    let least = least_meeting(problem, point);
    let mut left: f64 = 0.0;
    for node in 0..problem.nodes() {
        let own = residual(problem, point, node, &measure);
        if own <= tolerance {
            left = left.max(own);
            continue;
        }
        let imbalance = norm3(&point.imbalance[problem.at(node)]);
        let scale = meeting(problem, point, node).max(least);
        // NaN is beyond rounding
        if !(imbalance <= LARGEST_FLOOR * scale && imbalance <= rounding(problem, point, node)) {
            return None;
        }
        left = left.max(imbalance / scale);
    }
    Some(left)
}

/// Whether the imbalance of every node is within [`LARGEST_FLOOR`] of the forces that meet there.
pub fn is_near_balance(problem: &PressedProblem, point: &Point) -> bool {
    if !point.merit.is_finite() {
        return false;
    }
    let nodes = 0..problem.nodes();
    let imbalance = |node: usize| norm3(&point.imbalance[problem.at(node)]);
    let most = most_meeting(problem, point);
    // the usual case far from a solution
    let is_far = |node: usize| imbalance(node) > LARGEST_FLOOR * most.max(f64::MIN_POSITIVE);
    if nodes.clone().any(is_far) {
        return false;
    }
    let least = least_of(most);
    let is_near =
        |node: usize| imbalance(node) / meeting(problem, point, node).max(least) <= LARGEST_FLOOR;
    nodes.clone().all(is_near)
}

fn measure(problem: &PressedProblem, point: &Point) -> Option<Measure> {
    let (mut bound, mut force) = (0.0_f64, 0.0_f64);
    for (node, at) in point.nodes.iter().enumerate() {
        bound = bound.max(at.law.bound);
        force = force.max(point.f[problem.normal(node)].abs());
    }
    // a share of a number at the end of its range may be nothing
    let (least_bound, least_force) = (SCALE_FLOOR * bound, SCALE_FLOOR * force);
    let has_both = least_bound > 0.0 && least_force > 0.0;
    let measure = Measure {
        bound: least_bound,
        force: least_force,
        meeting: if has_both {
            0.0
        } else {
            least_meeting(problem, point)
        },
    };
    (bound + force + point.merit).is_finite().then_some(measure)
}

/// The forces that meet at a node at least, N, where they are what it is measured against.
fn least_meeting(problem: &PressedProblem, point: &Point) -> f64 {
    least_of(most_meeting(problem, point))
}

fn least_of(most: f64) -> f64 {
    (SCALE_FLOOR * most).max(f64::MIN_POSITIVE)
}

fn most_meeting(problem: &PressedProblem, point: &Point) -> f64 {
    let all = (0..problem.nodes()).map(|node| meeting(problem, point, node));
    all.fold(0.0, f64::max)
}

/// The imbalance of a node divided by what the node bears.
fn residual(problem: &PressedProblem, point: &Point, node: usize, measure: &Measure) -> f64 {
    let forces = || meeting(problem, point, node).max(measure.meeting);
    let tangential = norm(&point.imbalance[problem.tangential(node)]);
    let normal = point.imbalance[problem.normal(node)].abs();
    let bearing = |own: f64, least: f64| {
        if least > 0.0 {
            own.max(least)
        } else {
            forces()
        }
    };
    let bound = bearing(point.nodes[node].law.bound, measure.bound);
    let force = bearing(point.f[problem.normal(node)].abs(), measure.force);
    (tangential / bound).max(normal / force)
}

/// Forces that meet at a node, N: applied, of the body, of the contact.
fn meeting(problem: &PressedProblem, point: &Point, node: usize) -> f64 {
    let at = problem.at(node);
    let mut body = [0.0; 3];
    for (body, i) in body.iter_mut().zip(at.clone()) {
        let is_normal = i == problem.normal(node);
        let force = if is_normal { -point.f[i] } else { point.f[i] };
        *body = point.imbalance[i] + problem.r[i] - force;
    }
    let bound = point.nodes[node].law.bound;
    norm3(&problem.r[at.clone()]) + norm3(&body[..at.len()]) + norm3(&point.f[at]).max(bound)
}

/// What rounding leaves unknown of the forces at a node, N.
fn rounding(problem: &PressedProblem, point: &Point, node: usize) -> f64 {
    let mut sum = point.nodes[node].law.bound;
    for i in problem.at(node) {
        let products = problem.column(i).iter().zip(&point.v);
        let products: f64 = products.map(|(s, v)| (s * v).abs()).sum();
        sum += problem.r[i].abs() + point.f[i].abs() + products;
    }
    ROUNDING * f64::EPSILON * sum
}

/// Length of a nodal vector with its normal component.
fn norm3(x: &[f64]) -> f64 {
    let (last, tangential) = (x[x.len() - 1], &x[..x.len() - 1]);
    crate::linalg::length(norm(tangential), last)
}
