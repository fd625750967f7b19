//! The loops over the contact that run at every iteration with one tangential component per node, vectorized: no branches,
//! what differs between nodes that stick, slip and start is selected.

use super::point::Point;
use crate::linalg::lanes::{larger, map, visit};
use pulp::Simd;

/// Residual of the friction law: the largest violated force over the bound of the node, those not below `least_bound`; where
/// that is zero over the forces that meet at the node, those not below a share `floor` of the largest. NaN where a force is
/// not finite.
#[inline(always)]
pub fn residual<S: Simd>(simd: S, r: &[f64], point: &Point, least_bound: f64, floor: f64) -> f64 {
    if least_bound > 0.0 {
        return residual_over_bounds(simd, point, least_bound);
    }
    let zero = simd.splat_f64s(0.0);
    let (mut largest, mut total) = (zero, zero);
    visit(
        simd,
        [r, &point.y, &point.law.bound],
        #[inline(always)]
        |[r, y, bound]| {
            let scale = scale(simd, r, y, bound);
            largest = larger(simd, largest, scale);
            total = simd.add_f64s(total, scale);
        },
    );
    // what is not a number is never the larger one, and must not pass for converged
    if !simd.reduce_sum_f64s(total).is_finite() {
        return f64::NAN;
    }
    let least = (floor * simd.reduce_max_f64s(largest)).max(f64::MIN_POSITIVE);
    let least = simd.splat_f64s(least);
    let mut worst = zero;
    visit(
        simd,
        [r, &point.y, &point.law.bound, &point.w],
        #[inline(always)]
        |[r, y, bound, w]| {
            let own = larger(simd, scale(simd, r, y, bound), least);
            let relative = simd.div_f64s(violation(simd, w, y, bound), own);
            worst = larger(simd, worst, relative);
        },
    );
    simd.reduce_max_f64s(worst)
}

/// The residual where there is friction.
#[inline(always)]
fn residual_over_bounds<S: Simd>(simd: S, point: &Point, least_bound: f64) -> f64 {
    let zero = simd.splat_f64s(0.0);
    let least = simd.splat_f64s(least_bound);
    let (mut worst, mut total) = (zero, zero);
    visit(
        simd,
        [&point.y, &point.law.bound, &point.w],
        #[inline(always)]
        |[y, bound, w]| {
            let violation = violation(simd, w, y, bound);
            total = simd.add_f64s(total, simd.abs_f64s(violation));
            let relative = simd.div_f64s(violation, larger(simd, bound, least));
            worst = larger(simd, worst, relative);
        },
    );
    // as above
    if simd.reduce_sum_f64s(total).is_finite() {
        simd.reduce_max_f64s(worst)
    } else {
        f64::NAN
    }
}

/// Force by which a node violates the law; not above zero where a node sticks within its bound.
#[inline(always)]
fn violation<S: Simd>(simd: S, w: S::f64s, y: S::f64s, bound: S::f64s) -> S::f64s {
    let at_rest = simd.sub_f64s(simd.abs_f64s(y), bound);
    let slipping = simd.abs_f64s(simd.add_f64s(y, with_sign(simd, bound, w)));
    simd.select_f64s(simd.equal_f64s(w, simd.splat_f64s(0.0)), at_rest, slipping)
}

/// Forces that meet at a node: applied, of the body (S w = y + r), of friction.
#[inline(always)]
fn scale<S: Simd>(simd: S, r: S::f64s, y: S::f64s, bound: S::f64s) -> S::f64s {
    let body = simd.abs_f64s(simd.add_f64s(y, r));
    simd.add_f64s(simd.add_f64s(simd.abs_f64s(r), body), bound)
}

/// A magnitude with the sign of another number.
#[inline(always)]
fn with_sign<S: Simd>(simd: S, magnitude: S::f64s, sign: S::f64s) -> S::f64s {
    let mask = simd.splat_f64s(-0.0);
    simd.or_f64s(magnitude, simd.and_f64s(mask, sign))
}

/// What moves at a point, against the point before.
pub struct Motion<'a> {
    /// Slip direction, zero where a node sticks.
    pub normal: &'a mut [f64],
    /// Derivative of W, zero where a node sticks.
    pub gradient: &'a mut [f64],
    /// Change of the gradient.
    pub change: &'a mut [f64],
}

/// What a look at the motion finds.
pub struct Seen {
    pub moves: bool,
    /// A node at rest begins to move.
    pub starts: bool,
    /// The same nodes move as before, none of them back.
    pub is_same_set: bool,
    /// `step . change`.
    pub curvature: f64,
    /// `step . gradient`.
    pub progress: f64,
}

/// Slip directions and gradient of W at a point, and what has changed since the last step.
#[inline(always)]
pub fn motion<S: Simd>(
    simd: S,
    point: &Point,
    (last_normal, last_gradient, last_step): (&[f64], &[f64], &[f64]),
    out: Motion,
) -> Seen {
    let (zero, one) = (simd.splat_f64s(0.0), simd.splat_f64s(1.0));
    let (mut moving, mut starting, mut changed) = (zero, zero, zero);
    let (mut curvature, mut progress) = (zero, zero);
    map(
        simd,
        [
            &point.w,
            &point.y,
            &point.law.bound,
            last_normal,
            last_gradient,
            last_step,
        ],
        [out.normal, out.gradient, out.change],
        #[inline(always)]
        |[w, y, bound, last_normal, last_gradient, step]| {
            let at_rest = simd.equal_f64s(w, zero);
            let within = simd.less_than_or_equal_f64s(simd.abs_f64s(y), bound);
            let sticks = simd.and_m64s(at_rest, within);
            // a node at rest starts against the imbalance
            let along = simd.select_f64s(at_rest, simd.neg_f64s(y), w);
            let normal = simd.select_f64s(sticks, zero, with_sign(simd, one, along));
            let gradient = simd.mul_add_e_f64s(bound, normal, y);
            let gradient = simd.select_f64s(sticks, zero, gradient);
            let change = simd.sub_f64s(gradient, last_gradient);
            let is_same = simd.equal_f64s(normal, last_normal);
            changed = simd.select_f64s(is_same, changed, one);
            moving = simd.select_f64s(sticks, moving, one);
            let begins = simd.select_f64s(at_rest, one, starting);
            starting = simd.select_f64s(sticks, starting, begins);
            curvature = simd.mul_add_e_f64s(step, change, curvature);
            progress = simd.mul_add_e_f64s(step, gradient, progress);
            [normal, gradient, change]
        },
    );
    Seen {
        moves: simd.reduce_max_f64s(moving) > 0.0,
        starts: simd.reduce_max_f64s(starting) > 0.0,
        is_same_set: simd.reduce_max_f64s(changed) == 0.0,
        curvature: simd.reduce_sum_f64s(curvature),
        progress: simd.reduce_sum_f64s(progress),
    }
}

/// Difference at every node between the present slope and the one in the factored matrix, relative to the node's stiffness in
/// that matrix. Above 1 where a free node sticks, and where a node moves that is not free. Returns the largest.
#[inline(always)]
pub fn differences<S: Simd>(
    simd: S,
    normal: &[f64],
    slope: &[f64],
    (at_hand, yielding): (&[f64], &[f64]),
    out: &mut [f64],
) -> f64 {
    let (zero, much) = (simd.splat_f64s(0.0), simd.splat_f64s(2.0));
    let mut largest = zero;
    map(
        simd,
        [normal, slope, at_hand, yielding],
        [out],
        #[inline(always)]
        |[normal, wanted, at_hand, yielding]| {
            let sticks = simd.equal_f64s(normal, zero);
            let is_clamped = simd.equal_f64s(yielding, zero);
            let delta = simd.abs_f64s(simd.sub_f64s(wanted, at_hand));
            let moving = simd.select_f64s(is_clamped, much, simd.mul_f64s(delta, yielding));
            let sticking = simd.select_f64s(is_clamped, zero, much);
            let share = simd.select_f64s(sticks, sticking, moving);
            largest = larger(simd, largest, share);
            [share]
        },
    );
    simd.reduce_max_f64s(largest)
}

/// `share * change - gradient`.
#[inline(always)]
pub fn right_side<S: Simd>(simd: S, share: f64, change: &[f64], gradient: &[f64], out: &mut [f64]) {
    let share = simd.splat_f64s(share);
    map(
        simd,
        [change, gradient],
        [out],
        #[inline(always)]
        |[change, gradient]| {
            let minus = simd.neg_f64s(gradient);
            [simd.mul_add_e_f64s(share, change, minus)]
        },
    );
}

/// The step from the solution on all nodes, exactly zero where a node sticks, and `S step`. Returns `change . step`.
#[inline(always)]
pub fn step_of_all<S: Simd>(
    simd: S,
    (solution, rhs, blocks): (&[f64], &[f64], &[f64]),
    normal: &[f64],
    change: &[f64],
    step: &mut [f64],
    forces: &mut [f64],
) -> f64 {
    let zero = simd.splat_f64s(0.0);
    let mut product = zero;
    map(
        simd,
        [solution, rhs, blocks, normal, change],
        [step, forces],
        #[inline(always)]
        |[solution, rhs, block, normal, change]| {
            let sticks = simd.equal_f64s(normal, zero);
            let step = simd.select_f64s(sticks, zero, solution);
            product = simd.mul_add_e_f64s(change, step, product);
            let own = simd.mul_f64s(block, step);
            [step, simd.sub_f64s(rhs, own)]
        },
    );
    simd.reduce_sum_f64s(product)
}

/// Velocities, forces and rates at `length` steps from a point. Whether a node that moves would reverse.
#[inline(always)]
pub fn advance<S: Simd>(
    simd: S,
    from: &Point,
    length: f64,
    (step, forces, normal): (&[f64], &[f64], &[f64]),
    to: &mut Point,
) -> bool {
    let (zero, one) = (simd.splat_f64s(0.0), simd.splat_f64s(1.0));
    let length = simd.splat_f64s(length);
    let mut reverses = zero;
    map(
        simd,
        [&from.w, &from.y, step, forces, normal],
        [&mut to.w, &mut to.y, &mut to.rates],
        #[inline(always)]
        |[w, y, step, forces, normal]| {
            let w = simd.mul_add_e_f64s(length, step, w);
            let y = simd.mul_add_e_f64s(length, forces, y);
            let forward = simd.mul_f64s(w, normal);
            let is_back = simd.less_than_or_equal_f64s(forward, zero);
            let flag = simd.select_f64s(is_back, one, zero);
            // zero normal: a node that sticks does not reverse
            reverses = larger(simd, reverses, simd.mul_f64s(flag, simd.abs_f64s(normal)));
            [w, y, simd.abs_f64s(w)]
        },
    );
    simd.reduce_max_f64s(reverses) > 0.0
}
