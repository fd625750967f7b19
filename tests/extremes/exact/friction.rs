//! The friction problem of a stage, `S w + omega g(|w|) w/|w| = r`, solved to far below double precision from a guess of who
//! sticks and who slips.

use super::number::{Matrix, Real, dot, solve, zeros};
use crate::case::Law;
use crate::within::length;

pub struct Problem {
    pub s: Matrix,
    pub r: Vec<Real>,
    pub weights: Vec<Real>,
    pub components: usize,
    pub law: Law,
}

pub struct Solution {
    pub w: Vec<Real>,
    /// The force on the body, N: `S w - r` at a node that sticks, the bound against the slip at one that slips.
    pub y: Vec<Real>,
    /// How far the slip rates (m/s) are off when every node misses its balance of forces by a relative 1.
    pub rate_per_residual: f64,
    /// The same for the nodal forces, N, by component.
    pub force_per_residual: Vec<f64>,
}

/// Changes of the slip rate below this share of it end the iteration.
const CONVERGED: f64 = 1e-60;

const MOST_ITERATIONS: usize = 200;

impl Problem {
    /// Bound and slope of the law, times the weight of a node.
    fn law(&self, node: usize, rate: &Real) -> (Real, Real) {
        let weight = &self.weights[node];
        match self.law {
            Law::Frictionless => (Real::zero(), Real::zero()),
            Law::Tresca(bound) => (weight * &Real::new(bound), Real::zero()),
            Law::Exponential { a, b, alpha } => {
                let (a, b, alpha) = (Real::new(a), Real::new(b), Real::new(alpha));
                let exponent = -&(&alpha * rate);
                let drop = &a - &b;
                // from the nearer end: a bound below 1e-96 of that at rest keeps its digits
                let (bound, left) = if exponent < Real::new(-1.0) {
                    let left = exponent.exp();
                    (&b + &(&drop * &left), left)
                } else {
                    let decay = exponent.exp_m1();
                    (&a + &(&drop * &decay), &Real::new(1.0) + &decay)
                };
                let slope = -&(&alpha * &drop * left);
                (weight * &bound, weight * &slope)
            }
        }
    }

    fn norm(&self, x: &[Real]) -> Real {
        match x {
            [x] => x.abs(),
            _ => x.iter().fold(Real::zero(), |sum, x| sum + x * x).sqrt(),
        }
    }

    fn forces(&self, w: &[Real]) -> Vec<Real> {
        self.s
            .iter()
            .zip(&self.r)
            .map(|(row, r)| dot(row, w) - r)
            .collect()
    }

    /// Solves from a guess; `None` when the iteration does not settle.
    pub fn solve(&self, guess: &[f64]) -> Option<Solution> {
        let c = self.components;
        let mut w: Vec<Real> = guess.iter().map(|&x| Real::new(x)).collect();
        for _ in 0..MOST_ITERATIONS {
            let slipping: Vec<usize> = (0..self.weights.len())
                .filter(|node| w[node * c..(node + 1) * c].iter().any(|x| !x.is_zero()))
                .collect();
            if !self.newton(&mut w, &slipping)? {
                continue;
            }
            let y = self.forces(&w);
            match self.node_to_release(&w, &y) {
                None => {
                    let y = self.with_bounds(&w, y, &slipping);
                    return self.with_effects(w, y, &slipping);
                }
                Some(node) => self.release(node, &y, &mut w),
            }
        }
        None
    }

    /// The forces of nodes that slip by the law: in `S w - r` a bound below 1e-96 of the forces that meet is rounding.
    fn with_bounds(&self, w: &[Real], mut y: Vec<Real>, slipping: &[usize]) -> Vec<Real> {
        let c = self.components;
        for &node in slipping {
            let velocity = &w[node * c..(node + 1) * c];
            let rate = self.norm(velocity);
            let (bound, _) = self.law(node, &rate);
            for (p, x) in velocity.iter().enumerate() {
                y[node * c + p] = -&(&bound * &(x / &rate));
            }
        }
        y
    }

    /// One step on the slipping nodes; whether they have settled.
    fn newton(&self, w: &mut [Real], slipping: &[usize]) -> Option<bool> {
        let c = self.components;
        let places: Vec<usize> = slipping.iter().flat_map(|n| n * c..(n + 1) * c).collect();
        if places.is_empty() {
            return Some(true);
        }
        let y = self.forces(w);
        let mut right = zeros(places.len(), 1);
        for (k, &node) in slipping.iter().enumerate() {
            let velocity = &w[node * c..(node + 1) * c];
            let rate = self.norm(velocity);
            let (bound, _) = self.law(node, &rate);
            for (p, x) in velocity.iter().enumerate() {
                right[k * c + p][0] = -&(&y[node * c + p] + &(&bound * &(x / &rate)));
            }
        }
        let moved = solve(self.jacobian(w, slipping), right)?;
        let mut settled = true;
        for (k, &node) in slipping.iter().enumerate() {
            let at = node * c..(node + 1) * c;
            let old = w[at.clone()].to_vec();
            let new: Vec<Real> = (0..c).map(|p| &old[p] + &moved[k * c + p][0]).collect();
            let (size, step) = (
                self.norm(&old),
                self.norm(
                    &moved[k * c..(k + 1) * c]
                        .iter()
                        .map(|x| x[0].clone())
                        .collect::<Vec<_>>(),
                ),
            );
            if step > &size * &Real::new(CONVERGED) {
                settled = false;
            }
            // who would turn round stops first
            let turns = dot(&old, &new) <= Real::zero();
            for (p, x) in new.into_iter().enumerate() {
                w[node * c + p] = if turns { Real::zero() } else { x };
            }
            settled &= !turns;
        }
        Some(settled)
    }

    fn jacobian(&self, w: &[Real], slipping: &[usize]) -> Matrix {
        let c = self.components;
        let places: Vec<usize> = slipping.iter().flat_map(|n| n * c..(n + 1) * c).collect();
        let mut matrix: Matrix = places
            .iter()
            .map(|&i| places.iter().map(|&j| self.s[i][j].clone()).collect())
            .collect();
        for (k, &node) in slipping.iter().enumerate() {
            let velocity = &w[node * c..(node + 1) * c];
            let rate = self.norm(velocity);
            let (bound, slope) = self.law(node, &rate);
            let turning = &bound / &rate;
            for p in 0..c {
                for q in 0..c {
                    let direction = &velocity[p] * &velocity[q] / (&rate * &rate);
                    let entry = &mut matrix[k * c + p][k * c + q];
                    *entry = &*entry + &((&slope - &turning) * direction);
                    if p == q {
                        *entry = &*entry + &turning;
                    }
                }
            }
        }
        matrix
    }

    /// The sticking node whose force is furthest above its bound at rest.
    fn node_to_release(&self, w: &[Real], y: &[Real]) -> Option<usize> {
        let c = self.components;
        let mut worst: Option<(Real, usize)> = None;
        for node in 0..self.weights.len() {
            if w[node * c..(node + 1) * c].iter().all(Real::is_zero) {
                let (bound, _) = self.law(node, &Real::zero());
                let excess = self.norm(&y[node * c..(node + 1) * c]) - &bound;
                // beyond what 96 digits leave of a node exactly at its bound
                if excess > &bound * &Real::new(1e-50)
                    && worst.as_ref().is_none_or(|(most, _)| excess > *most)
                {
                    worst = Some((excess, node));
                }
            }
        }
        worst.map(|(_, node)| node)
    }

    /// Starts the slip of a node as if all others stood still.
    fn release(&self, node: usize, y: &[Real], w: &mut [Real]) {
        let c = self.components;
        let force = &y[node * c..(node + 1) * c];
        let size = self.norm(force);
        let (bound, _) = self.law(node, &Real::zero());
        for (p, f) in force.iter().enumerate() {
            let i = node * c + p;
            w[i] = -&((&size - &bound) / &self.s[i][i] * (f / &size));
        }
    }

    /// A solution with the effects of a residual on it.
    fn with_effects(&self, w: Vec<Real>, y: Vec<Real>, slipping: &[usize]) -> Option<Solution> {
        let c = self.components;
        let n = self.r.len();
        let doubles = |x: &[Real]| x.iter().map(Real::double).collect::<Vec<f64>>();
        let (forces, applied) = (doubles(&y), doubles(&self.r));
        // forces that meet at a node: applied, of the body, of friction; a node with next to none counts a thousandth
        let mut scales: Vec<f64> = (0..n / c)
            .map(|node| {
                let at = node * c..(node + 1) * c;
                let body: Vec<f64> = at.clone().map(|i| forces[i] + applied[i]).collect();
                let rate = self.norm(&w[at.clone()]);
                length(&applied[at]) + length(&body) + self.law(node, &rate).0.double()
            })
            .collect();
        let floor = 1e-3 * scales.iter().copied().fold(0.0, f64::max);
        scales.iter_mut().for_each(|x| *x = x.max(floor));
        let places: Vec<usize> = slipping.iter().flat_map(|n| n * c..(n + 1) * c).collect();
        let mut unit = zeros(places.len(), places.len());
        for (k, row) in unit.iter_mut().enumerate() {
            row[k] = Real::new(1.0);
        }
        let inverse = solve(self.jacobian(&w, slipping), unit)?;
        let mut moved = vec![0.0; n];
        for (i, row) in places.iter().zip(&inverse) {
            moved[*i] = places
                .iter()
                .zip(row)
                .map(|(j, x)| x.double().abs() * scales[j / c])
                .sum();
        }
        let force_per_residual = (0..n)
            .map(|i| {
                let node = i / c;
                let at = node * c..(node + 1) * c;
                let rate = self.norm(&w[at.clone()]);
                let (bound, slope) = self.law(node, &rate);
                if !rate.is_zero() {
                    // by size, and in space by direction
                    let moved = moved[at].iter().sum::<f64>();
                    let turned = if c == 1 {
                        0.0
                    } else {
                        (&bound / &rate).double() * moved
                    };
                    return bound.double() + slope.double().abs() * moved + turned;
                }
                let of_others: f64 = self.s[i]
                    .iter()
                    .zip(&moved)
                    .map(|(s, m)| s.double().abs() * m)
                    .sum();
                of_others + scales[node]
            })
            .collect();
        Some(Solution {
            rate_per_residual: moved.into_iter().fold(0.0, f64::max),
            force_per_residual,
            w,
            y,
        })
    }
}
