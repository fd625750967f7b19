//! The contact laws of one node: from a velocity and a force that need not fit each other to those that do.
//!
//! A pair (v, f) is projected along lines of slope -rho: the result satisfies the law and `f + rho v` (tangential) or `p - rho v`
//! (normal) is what it was. So the projection of a pair that satisfies the law is the pair itself, and a resolvent of the law is
//! all that is ever computed: slopes of any size, or none, are harmless, because the unknown is neither rate nor force.

use super::problem::{NormalCondition, PressedBound, PressedProblem};
use crate::contact::problem::{SLOWEST, norm};
use crate::linalg::dot;

/// Evaluations of the law that one projection may take.
const EVALUATIONS: usize = 200;
/// A root is known when the forces balance to this share of them, or the bracket is as narrow.
const EXACT: f64 = 2.0 * f64::EPSILON;
/// A friction force fits its bound to this share of it.
const FITS: f64 = 16.0 * f64::EPSILON;
/// First step down from the largest rate of a bracket that begins at rest; every further one goes twice as many decades.
const FIRST_DESCENT: f64 = 1e-3;

/// Normal velocity and force that fit each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normal {
    pub velocity: f64,
    pub force: f64,
    /// Whether the velocity may change: the node is open, or its foundation yields.
    pub is_free: bool,
    /// How fast the force falls with the velocity of a free node, N s/m.
    pub fall: f64,
}

impl Normal {
    fn open(velocity: f64) -> Normal {
        Normal {
            velocity,
            force: 0.0,
            is_free: true,
            fall: 0.0,
        }
    }

    fn closed(velocity: f64, force: f64) -> Normal {
        Normal {
            velocity,
            force,
            is_free: false,
            fall: 0.0,
        }
    }
}

/// Projects a normal velocity and force along `p - rho v`.
pub fn project_normal(problem: &PressedProblem, node: usize, rho: f64, v: f64, p: f64) -> Normal {
    let open = v - p / rho;
    if problem.is_away(node) {
        return Normal::open(open);
    }
    let (condition, gap_rate) = problem.condition(node);
    let closing = -problem.gap_base[node] / gap_rate;
    let force = p - rho * (v - closing);
    match condition {
        NormalCondition::Bilateral => Normal::closed(closing, force),
        NormalCondition::Unilateral if force <= 0.0 => Normal::open(open),
        // what is not a number must show
        NormalCondition::Unilateral => Normal::closed(closing, force),
        NormalCondition::Compliance { exponent } => {
            let foundation = Foundation {
                stiffness: problem.stiffness[node],
                exponent,
                line: problem.relaxing.get(node).copied().unwrap_or_default(),
                gap_base: problem.gap_base[node],
                gap_rate,
            };
            foundation.project(rho, open, force, v)
        }
    }
}

/// A foundation that yields.
struct Foundation {
    stiffness: f64,
    exponent: f64,
    /// What relaxing branches add: growth by the depth, and force at depth 0.
    line: [f64; 2],
    gap_base: f64,
    gap_rate: f64,
}

impl Foundation {
    /// `stiffness depth^exponent`, N, and its derivative by the depth, N/m.
    fn power(&self, depth: f64) -> [f64; 2] {
        // a power of a small depth alone would leave the range of numbers
        let power = match self.exponent {
            1.0 => 1.0,
            1.5 => depth.sqrt(),
            2.0 => depth,
            exponent => depth.powf(exponent - 1.0),
        };
        let secant = self.stiffness * power;
        [secant * depth, self.exponent * secant]
    }

    /// Force at a depth, N, and its derivative by the depth, N/m. A foundation never pulls.
    fn force(&self, depth: f64) -> [f64; 2] {
        let [force, slope] = self.power(depth);
        let [growth, offset] = self.line;
        let force = force + growth * depth + offset;
        match offset < 0.0 && force <= 0.0 {
            true => [0.0, 0.0],
            false => [force, slope + growth],
        }
    }

    fn depth(&self, velocity: f64) -> f64 {
        let gap = self.gap_base + self.gap_rate * velocity;
        if gap >= 0.0 { 0.0 } else { -gap }
    }

    fn at(&self, velocity: f64, depth: f64) -> Normal {
        let [force, slope] = self.force(depth);
        Normal {
            velocity,
            force,
            is_free: true,
            fall: slope * self.gap_rate,
        }
    }

    /// `open` is the velocity without any force, `force` what a rigid foundation would bear, `guess` a velocity to begin with.
    fn project(&self, rho: f64, open: f64, force: f64, guess: f64) -> Normal {
        let deepest = self.depth(open);
        let has_recovered = |depth: f64| self.line[1] == 0.0 || self.force(depth)[0] > 0.0;
        if deepest == 0.0 || !has_recovered(deepest) {
            return Normal::open(open);
        }
        if self.gap_rate == 0.0 {
            let [force, _] = self.force(deepest);
            return self.at(open + force / rho, deepest);
        }
        // a foundation stiffer than the body: the depth keeps the digits of the force
        let per_depth = rho / self.gap_rate;
        if force.is_finite() && per_depth.is_finite() {
            let depth = self.balance(per_depth, force, self.depth(guess));
            let found = self.at((-self.gap_base - depth) / self.gap_rate, depth);
            if found.fall >= rho {
                return found;
            }
        }
        // a softer one: the velocity keeps its own. The force is convex, so Newton's method from the open side stays there
        let mut velocity = open;
        for _ in 0..EVALUATIONS {
            let depth = self.depth(velocity);
            let [force, slope] = self.force(depth);
            let imbalance = rho * (velocity - open) - force;
            let next = velocity - imbalance / (rho + slope * self.gap_rate);
            let is_moving = next - velocity > EXACT * velocity.abs();
            // rounding may turn the last step back; what is not a number must show
            velocity = if next <= velocity { velocity } else { next };
            if !is_moving {
                break;
            }
        }
        self.at(velocity, self.depth(velocity))
    }

    /// The depth where `force(depth) + per_depth depth = total`, of a force that is not zero there. The sum is convex: Newton's method comes from the deep side
    /// after the first step, wherever `guess` is.
    fn balance(&self, per_depth: f64, total: f64, guess: f64) -> f64 {
        let (per_depth, total) = (per_depth + self.line[0], total - self.line[1]);
        if self.exponent == 1.0 {
            return total / (self.stiffness + per_depth);
        }
        let next = |depth: f64| {
            let [force, slope] = self.power(depth);
            depth - (force + per_depth * depth - total) / (slope + per_depth)
        };
        let deepest = total / per_depth;
        let mut depth = if guess > 0.0 && guess < deepest {
            next(guess).min(deepest)
        } else {
            let alone = (total / self.stiffness).powf(1.0 / self.exponent);
            deepest.min(alone)
        };
        for _ in 0..EVALUATIONS {
            let next = next(depth);
            let is_moving = depth - next > EXACT * depth && next > 0.0;
            if !is_moving {
                break;
            }
            depth = next;
        }
        depth
    }
}

/// Slip rate and law of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Whether the node slips; where it does not, it sticks with any force within the bound.
    pub slips: bool,
    /// Slip rate, m/s.
    pub rate: f64,
    /// The law at that rate.
    pub law: PressedBound,
}

/// The slip rate at which `rho rate + B(rate, p) = pull`, or rest where the bound at rest holds the pull. `guess` is a rate to
/// begin with, and the friction force that goes with it: `pull` is rho times the one and the other.
pub fn project_tangential(
    problem: &PressedProblem,
    node: usize,
    rho: f64,
    pull: f64,
    force: f64,
    (guess, friction): (f64, f64),
) -> Friction {
    let at_rest = problem.bound(node, 0.0, force);
    let rest = |slips| Friction {
        slips,
        rate: 0.0,
        law: at_rest,
    };
    if pull <= at_rest.bound {
        // without any bound at rest there is nothing to stick to
        return rest(at_rest.bound == 0.0);
    }
    // NaN ends here too
    let (mut low, mut high) = (0.0, pull / rho);
    let mut rate = (pull - at_rest.bound) / rho;
    let mut law = at_rest;
    let is_within = low < guess && guess < high;
    if is_within {
        law = problem.bound(node, guess, force);
        // a pair that fits stays: the pull knows a rate to the digits of the force alone
        if (law.bound - friction).abs() <= FITS * law.bound {
            return Friction {
                slips: true,
                rate: guess,
                law,
            };
        }
    }
    // a bound that does not begin to change is the same bound further on, as a rule
    if is_within && at_rest.by_rate != 0.0 {
        rate = guess;
    } else {
        law = problem.bound(node, rate, force);
    }
    let mut descent = FIRST_DESCENT;
    let mut last_width = f64::INFINITY;
    for _ in 0..EVALUATIONS {
        // summed so that the largest terms meet first
        let imbalance = (law.bound - pull) + rho * rate;
        if imbalance.abs() <= EXACT * pull || imbalance.is_nan() {
            break;
        }
        if imbalance > 0.0 {
            high = rate;
        } else {
            low = rate;
        }
        let width = high - low;
        if width <= EXACT * high {
            break;
        }
        let newton = rate - imbalance / (rho + law.by_rate);
        let is_within = low < newton && newton < high;
        let is_fast = width <= 0.5 * last_width || (newton - rate).abs() <= 0.25 * width;
        last_width = width;
        rate = if is_within && is_fast {
            newton
        } else if low == 0.0 {
            // the root may be any number of decades below
            let next = high * descent;
            descent = (descent * descent).max(f64::MIN_POSITIVE);
            next
        } else if high > 4.0 * low {
            low.sqrt() * high.sqrt()
        } else {
            low + 0.5 * width
        };
        if rate == 0.0 {
            break;
        }
        law = problem.bound(node, rate, force);
    }
    // a node so slow that underflow takes digits from its direction is at rest; what is not a number goes on
    if rate < SLOWEST && at_rest.bound > 0.0 {
        return rest(false);
    }
    Friction {
        slips: true,
        rate,
        law,
    }
}

/// A node of a trial point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Node {
    /// Whether the node slips.
    pub slips: bool,
    /// Whether its normal velocity may change.
    pub is_free: bool,
    /// How fast the normal force of a free node falls with its velocity, N s/m.
    pub fall: f64,
    /// Slip rate, m/s.
    pub rate: f64,
    /// The law there.
    pub law: PressedBound,
    /// Direction of slip, and of the force of a node that slips.
    pub direction: [f64; 2],
    /// Velocity and force (N s/m) per unit of a turn of the direction; they sum, the first times rho, to rho.
    pub turn: [f64; 2],
}

/// Projects the velocities and forces of a node, of `size` components each, along `rho` (tangential, normal).
pub fn project(
    problem: &PressedProblem,
    node: usize,
    rho: [f64; 2],
    v: &mut [f64],
    f: &mut [f64],
) -> Node {
    let c = problem.components;
    let normal = project_normal(problem, node, rho[1], v[c], f[c]);
    (v[c], f[c]) = (normal.velocity, normal.force);
    let mut z = [0.0; 2];
    for i in 0..c {
        z[i] = f[i] + rho[0] * v[i];
    }
    let pull = norm(&z[..c]);
    let direction = match z {
        _ if pull > 0.0 => z.map(|z| z / pull),
        _ => [1.0, 0.0],
    };
    let along = |x: &[f64]| dot(&x[..c], &direction[..c]);
    let Friction { slips, rate, law } = project_tangential(
        problem,
        node,
        rho[0],
        pull,
        normal.force,
        (along(v), along(f)),
    );
    // a node that is at rest for being slow pulls a little more than its bound
    let held = if pull > law.bound {
        law.bound / pull
    } else {
        1.0
    };
    for i in 0..c {
        (v[i], f[i]) = if slips {
            (rate * direction[i], law.bound * direction[i])
        } else {
            (0.0, z[i] * held)
        };
    }
    // of the force `rho rate + bound` the share that turns the velocity
    let share = if pull > 0.0 && rate > 0.0 {
        rho[0] * rate / (rho[0] * rate + law.bound)
    } else if pull > 0.0 {
        0.0
    } else {
        rho[0] / (rho[0] + law.by_rate.max(0.0))
    };
    Node {
        slips,
        is_free: normal.is_free,
        fall: normal.fall,
        rate,
        law,
        direction,
        turn: [share, rho[0] * (1.0 - share)],
    }
}
